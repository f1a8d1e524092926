"""Frames to learn from and to measure on, read once from a source and held in memory: 4,800 frames
of 96 pixels are 133 MB.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

import numpy as np

from mitigate.core.observation import POSE
from mitigate.core.progress import Progress
from mitigate.core.seeding import generator
from mitigate.corruptions import Corruption, DepthSensor, Key, corrupt_observation
from mitigate.encoders.sources import Shot, Source

MOST_BYTES = 6 << 30  # of frames in memory (ours)


@dataclass
class Frames:
    """frames uint8 [N, H, W, 3] or float32 [N, H, W, 1]; headings and labels or None; scene: of
    each frame, a number; names: the scenes."""

    frames: np.ndarray
    headings: list[float | None]
    labels: np.ndarray | None
    scene: np.ndarray
    names: list[str]

    def __len__(self) -> int:
        return len(self.frames)

    def some(self, chosen: np.ndarray) -> Frames:
        """Those of the numbers ``chosen``, in their order."""
        labels = None if self.labels is None else self.labels[chosen]
        headings = [self.headings[index] for index in chosen]
        return Frames(self.frames[chosen], headings, labels, self.scene[chosen], self.names)

    def sha256(self) -> str:
        """The first 12 hex digits of the sha256 of all pixels."""
        return hashlib.sha256(np.ascontiguousarray(self.frames).data).hexdigest()[:12]


def corrupted(
    frames: Frames, index: int, corruption: Corruption, key: Key, sensor: DepthSensor
) -> np.ndarray:
    """Frame ``index`` under a corruption, an instant of its own."""
    name = "depth" if frames.frames.dtype == np.float32 else "rgb"
    heading = frames.headings[index]
    pose = {} if heading is None else {POSE: np.array([0, 0, heading], np.float32)}
    shot = {name: frames.frames[index], **pose}
    return corrupt_observation(shot, corruption, key, sensor)[name]


def collect(source: Source, split: str, count: int, seed: int) -> Frames:
    """About ``count`` frames of a split, as many from each scene; fewer frames are some of these.
    Raises ValueError for frames of several sizes, too many for the memory, or all black."""
    scenes = list(source.scenes(split))
    order = generator(seed, "encoder scenes", split).permutation(len(scenes))
    used = sorted(order[:count])
    each = [len(part) for part in np.array_split(np.arange(count), len(used))]
    shots: list[Shot] = []
    scene: list[int] = []
    with Progress(f"{split} frames", len(used), unit="scene") as progress:
        for index, number in zip(used, each, strict=True):
            found = list(source.shots(scenes[index], number, seed))
            _check(found, shots, count)
            shots += found
            scene += [int(index)] * len(found)
            progress.advance()
    if not any(shot.frame.any() for shot in shots):
        raise ValueError(
            f"All of the {len(shots)} {split} frames are 0 everywhere: black, or depth without a "
            "pixel that is a number of metres. Look at the files, or at the world's sensors."
        )
    labels = None if shots[0].labels is None else np.stack([s.labels for s in shots])  # type: ignore[misc]
    return Frames(
        np.stack([shot.frame for shot in shots]),
        [shot.heading for shot in shots],
        labels,
        np.array(scene),
        scenes,
    )


def _check(found: list[Shot], shots: list[Shot], count: int) -> None:
    sizes = {shot.frame.shape for shot in (*shots[:1], *found)}
    if len(sizes) > 1:
        raise ValueError(
            f"The frames have several sizes ({', '.join(map(str, sorted(sizes)[:3]))}): set "
            "env.size=PIXELS, to which all are resized."
        )
    if found and found[0].frame.nbytes * count > MOST_BYTES:
        raise ValueError(
            f"{count} frames of {found[0].frame.shape} need more than {MOST_BYTES >> 30} GB of "
            "memory: set env.size=PIXELS, or fewer frames (stages.encoder.recipe.frames=...)."
        )
