"""Pairs of corrupted and clean frames to learn from: panoramas of random poses of a world, or the
frames of a folder."""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
import torch

from mitigate.core.seeding import generator
from mitigate.corruptions import DepthSensor, Schedule
from mitigate.corruptions.suite import SENSOR
from mitigate.encoders.sources import TRAIN, Frames, Source, collect, corrupted, source_of
from mitigate.training import success
from mitigate.training.poses import Poses, check_panoramas
from mitigate.worlds.world import TrainingEpisodes

GROUP = 12  # frames of a folder that count as one panorama of a batch


class PosePairs(Poses):
    """Panoramas of random poses (``training/poses.py``); of a world with one camera, views of
    random poses."""

    ring = False  # whether the views of an instant are of one panorama

    def start(self) -> None:
        """Learn from the world what its views are; ValueError if it cannot look from anywhere or
        has no such sensor."""
        if self.sensor not in self.placed.sensors:
            raise ValueError(
                f"{type(self.placed).__name__} shows no {self.sensor}: set agent.sensors to what "
                f"it shows ({', '.join(self.placed.sensors)})."
            )
        self.ring = len(self.placed.sensors[self.sensor].yaws) > 1

    def identity(self) -> dict[str, str]:
        """Nothing: poses follow from the settings."""
        return {}

    def collate(self, pieces: list[Any]) -> dict[str, Any]:
        """As :meth:`Poses.collate`, without targets."""
        made = super().collate(pieces)
        return {"frames": made["frames"], "clean": made["clean"]}


@dataclass(eq=False, repr=False)
class FramePairs:
    """Frames of a folder, each corrupted as an instant of its own (``encoders/sources.py``).

    Attributes:
        source: of the frames.
        schedule: of corruptions of ``sensor``.
        count: frames that are read, once.
        panoramas: groups of ``GROUP`` frames of a step.
        seed: of frames and corruptions.
        depth: what depth is in them.
    """

    source: Source
    schedule: Schedule
    sensor: str
    count: int
    panoramas: int
    seed: int
    depth: DepthSensor
    frames: Frames | None = None
    ring: ClassVar[bool] = False  # each frame is an instant of its own

    def __post_init__(self) -> None:
        check_panoramas(self.panoramas)

    def start(self) -> None:
        """Read the frames, once."""
        if self.frames is None:
            self.frames = collect(self.source, TRAIN, self.count, self.seed)

    def identity(self) -> dict[str, str]:
        """The sum of the frames."""
        self.start()
        assert self.frames is not None
        return {"frames_sha256": self.frames.sha256()}

    def __getstate__(self) -> dict[str, Any]:
        """Without the frames, of which workers get those of their jobs."""
        return {**self.__dict__, "frames": None}

    def jobs(self, step: int) -> list[tuple[int, int, Frames]]:
        """(step, group, its frames) of each group."""
        assert self.frames is not None, "start() reads the frames"
        made = []
        for group in range(self.panoramas):
            rng = generator(self.seed, "restore frames", step, group)
            made.append((step, group, self.frames.some(rng.integers(len(self.frames), size=GROUP))))
        return made

    def work(self, job: tuple[int, int, Frames]) -> tuple[np.ndarray, np.ndarray]:
        """Corrupted and clean frames [GROUP, H, W, c] of a group."""
        step, group, clean = job
        frames = []
        for index in range(len(clean)):
            drawn = self.schedule.draw(self.seed, f"{step}-{group}-{index}", 0)
            frames.append(corrupted(clean, index, *drawn, self.depth))
        return np.stack(frames), clean.frames

    def collate(self, pieces: list[Any]) -> dict[str, Any]:
        """The groups as tensors "frames" and "clean"."""
        frames, clean = (np.stack(part) for part in zip(*pieces, strict=True))
        return {"frames": torch.from_numpy(frames), "clean": torch.from_numpy(clean)}


Pairs = PosePairs | FramePairs  # the source of "frames" and "clean" [instants, views, H, W, c]


def pairs_of(
    agent: Any,
    world: Callable[[], Any],
    training: TrainingEpisodes | None,
    modality: str,
    schedule: Schedule,
    panoramas: int = 4,
    frames: int = 4800,
    seed: int = 0,
) -> Pairs:
    """Return the pairs of an ``env`` config: of a world, or of a folder of frames.

    A folder has no ``training`` episodes, and ``frames`` of it are read, once.

    Raises:
        ValueError: for a schedule by success.
    """
    success.refuse(schedule)
    if training is None:
        depth = replace(SENSOR, z_max=agent.parts()[modality].far)
        source = source_of(world, modality, None, "", None)
        own = schedule.only(modality)
        return FramePairs(source, own, modality, frames, panoramas, seed, depth)
    return PosePairs(agent, world, training, modality, schedule, panoramas, seed, own=True)


def with_clean_share(pairs: Pairs, share: float) -> Pairs:
    """Return ``pairs`` of which a ``share`` stays clean; neither has been started."""
    copied = copy.copy(pairs)
    copied.schedule = replace(pairs.schedule, clean_share=share)
    return copied
