"""A user's callables and guards for ``restore=tests.guards.filters:NAME``."""

from __future__ import annotations

from contextlib import contextmanager

import cv2
import numpy as np

from mitigate.guards.guard import Guard


def median(frames):
    """The filter of ``docs/restoration.md``."""
    views = frames["rgb"] if frames["rgb"].ndim == 4 else frames["rgb"][None]
    smooth = np.stack([cv2.medianBlur(view, 3) for view in views])
    return {"rgb": smooth.reshape(frames["rgb"].shape)}


median.frames = ("rgb",)
median.version = "3 pixels"


class Brighter:
    """A frame filter that is constructed once and counts its calls."""

    frames = "rgb"

    def __init__(self):
        self.calls = 0

    def __call__(self, frames):
        self.calls += 1
        return {"rgb": np.minimum(frames["rgb"].astype(int) + 100, 255).astype(np.uint8)}


def guided(frames):
    """A fake depth completion, which needs RGB and depth of the same view."""
    rgb, depth = frames["rgb"], frames["depth"]
    assert rgb.shape[:-1] == depth.shape[:-1]
    return {"depth": np.where(depth == 0, rgb.mean(), depth).astype(np.float32)}


def unchanged(frames):
    return frames


def in_place(frames):
    for frame in frames.values():
        frame[:] = 0
    return frames


def broken(frames):
    raise RuntimeError("out of memory")


class Returns:
    """A frame filter; each call returns the keyword arguments of the constructor."""

    def __init__(self, **output):
        self.made = output

    def __call__(self, frames):
        return self.made


not_a_dict = Returns()
not_a_dict.made = [1, 2]
wrong_key = Returns(sound=np.zeros(3))
wrong_type = Returns(rgb=[[1.0]])
wrong_shape = Returns(rgb=np.zeros((2, 2, 3), np.uint8))
wrong_dtype = Returns(rgb=np.zeros((4, 4, 3), np.float32))
not_a_number = Returns(depth=np.full((4, 4, 1), np.nan, np.float32))
NUMBER = 3


class Politely(Guard):
    """A user's guard that changes the instruction and adapts the agent during an episode."""

    def begin(self, episode):
        return f"please {episode.instruction}"

    @contextmanager
    def attach(self, agent):
        before = agent.steps
        agent.steps = before + 1
        try:
            yield
        finally:
            agent.steps = before
