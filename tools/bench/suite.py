"""Measure the time of every corruption (steady state, new episode, new severity) and of other
libraries.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from statistics import fmean

import cv2
import numpy as np

from mitigate.corruptions import NAMES, Key, corrupt
from mitigate.corruptions.registry import record, unseen_names
from tools.bench.peers import peers
from tools.bench.timing import fresh, steady
from tools.pages.gallery import rendered_frame

SEVERITY = 0.6  # the severity that the paper uses for R2R
SEED = 7  # seed of the rendered apartment and of the keys
SIZES = {"480x640": (1, 480, 640), "224x224": (1, 224, 224), "12x64x64": (12, 64, 64)}
PANORAMA = (12, 224, 224)  # for the slowest pair: low_light_noise, then multipath
EPISODES = 4  # number of episodes over which the steady state is averaged


@dataclass(frozen=True)
class Cost:
    """Milliseconds of one corruption at one size.

    Attributes:
        steady: Time for consecutive frames of an episode.
        per_frame: Time per frame if each frame starts a new episode, as with the schedule
            ``per_frame``.
        first: Time per frame if each frame also has a new severity, for which tables must be built.
        copy: Time for a plain copy of the frame.
        peers: Times of other libraries, by name.
    """

    steady: float
    per_frame: float
    first: float
    copy: float
    peers: dict[str, float]

    @property
    def best_peer(self) -> tuple[str, float] | None:
        """Return the fastest of the other libraries and its time in milliseconds."""
        return min(self.peers.items(), key=lambda item: item[1]) if self.peers else None


def frames(views: int, height: int, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Return RGB uint8 [V, H, W, 3] and depth float32 metres [V, H, W] of a rendered panorama."""
    rgb, depth = rendered_frame(SEED, min(height, width))
    size = width, height
    rgb = np.stack([cv2.resize(view, size) for view in rgb[:views]])
    nearest = cv2.INTER_NEAREST
    return rgb, np.stack([cv2.resize(view, size, interpolation=nearest) for view in depth[:views]])


def measure(seconds: float) -> dict[str, dict[str, Cost]]:
    """Return costs by size and corruption; unseen corruptions are measured only at the last size.

    There are several hundred measurements, and each takes about ``seconds``.
    """
    costs: dict[str, dict[str, Cost]] = {}
    for column, (label, shape) in enumerate(SIZES.items()):
        rgb, depth = frames(*shape)
        names = NAMES if column < 2 else (*NAMES, *unseen_names("rgb", "depth"))
        others: dict[str, dict[str, float]] = {name: {} for name in names}
        for library, calls in peers(rgb, depth, SEVERITY).items():
            for name, call in calls.items():
                others[name][library] = steady(lambda _, call=call: call(), seconds)
        costs[label] = {}
        for name in names:
            frame = rgb if record(name).modality == "rgb" else depth
            costs[label][name] = cost(name, frame, seconds, others[name])
    return costs


def cost(name: str, frame: np.ndarray, seconds: float, others: dict[str, float]) -> Cost:
    """Time one corruption.

    Args:
        name: Name of the corruption.
        frame: uint8 [V, H, W, 3] or float32 metres [V, H, W].
        seconds: Duration of each measurement.
        others: Times of other libraries.
    """
    # a single view needs no heading, because the flare is in that view
    heading = 0.3 if len(frame) > 1 else None

    def episode(i, number):
        key = Key(SEED, f"bench {number}", i)
        return corrupt(frame, name, SEVERITY, key=key, heading=heading)

    episodes = [
        steady(partial(episode, number=number), seconds / EPISODES) for number in range(EPISODES)
    ]

    def new_episode(i):
        return corrupt(frame, name, SEVERITY, key=Key(SEED, f"episode {i}"), heading=heading)

    def new_severity(i):
        severity = math.nextafter(SEVERITY, 1.0) + 1e-7 * i
        return corrupt(frame, name, severity, key=Key(SEED, f"first {i}"), heading=heading)

    return Cost(
        fmean(episodes),
        fresh(new_episode, seconds),
        fresh(new_severity, seconds),
        steady(lambda _: frame.copy(), seconds),
        others,
    )


def worst_pair(seconds: float) -> float:
    """Return the milliseconds of low_light_noise and multipath together on a panorama of 12 x 224 x
    224.
    """
    rgb, depth = frames(*PANORAMA)

    def both(i):
        key = Key(SEED, "bench", i)
        return (
            corrupt(rgb, "low_light_noise", SEVERITY, key=key),
            corrupt(depth, "multipath", SEVERITY, key=key),
        )

    return steady(both, seconds)
