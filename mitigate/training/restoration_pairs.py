"""Sources of pairs of corrupted and clean frames, from random poses or a folder of frames."""

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
from mitigate.training.objective import check_counts
from mitigate.training.poses import Poses
from mitigate.training.success import reject_success_distributed
from mitigate.worlds.world import TrainingEpisodes

# number of frames per group; batches from a folder contain groups instead of panoramas
GROUP = 12


class PosePairs(Poses):
    """Source of corrupted and clean panoramas, or single views, at random poses (``poses.py``)."""

    ring = False  # whether the views of a time step form a panorama

    def start(self) -> None:
        """Read the number of views from the world.

        Raises ValueError if the world has no random poses or lacks the sensor.
        """
        if self.sensor not in self.placed.sensors:
            raise ValueError(
                f"{type(self.placed).__name__} has no {self.sensor}. Set agent.sensors to sensors "
                f"that it has ({', '.join(self.placed.sensors)})."
            )
        self.ring = len(self.placed.sensors[self.sensor].yaws) > 1


@dataclass(eq=False, repr=False)
class FramePairs:
    """Source of corrupted and clean frames from a folder (``encoders/sources.py``).

    Each frame is corrupted as a separate time step.
    """

    source: Source
    schedule: Schedule  # schedule of corruptions of ``sensor``
    sensor: str  # "rgb" or "depth"
    count: int  # number of frames, which are read once
    panoramas: int  # number of groups per step; a group has ``GROUP`` frames
    seed: int  # seed of frames and corruptions
    depth: DepthSensor  # properties of the depth sensor that recorded the frames
    frames: Frames | None = None  # the frames, which :meth:`start` reads
    ring: ClassVar[bool] = False  # each frame is a separate time step

    def __post_init__(self) -> None:
        check_counts(panoramas=self.panoramas)

    def start(self) -> None:
        """Read the frames at the first call."""
        if self.frames is None:
            self.frames = collect(self.source, TRAIN, self.count, self.seed)

    def identity(self) -> dict[str, str]:
        """Return the sha256 of the frames."""
        self.start()
        assert self.frames is not None
        return {"frames_sha256": self.frames.sha256()}

    def __getstate__(self) -> dict[str, Any]:
        """Return the state to pickle, without the frames.

        Workers receive only the frames of their jobs.
        """
        return {**self.__dict__, "frames": None}

    def jobs(self, step: int) -> list[tuple[int, int, Frames]]:
        """Return one job per group: a tuple (step, index of the group, frames of the group)."""
        assert self.frames is not None, "start() reads the frames"
        jobs = []
        for group in range(self.panoramas):
            rng = generator(self.seed, "restore frames", step, group)
            jobs.append((step, group, self.frames.some(rng.integers(len(self.frames), size=GROUP))))
        return jobs

    def work(self, job: tuple[int, int, Frames]) -> tuple[np.ndarray, np.ndarray]:
        """Return corrupted and clean frames [GROUP, H, W, c] of a group."""
        step, group, clean = job
        frames = []
        for i in range(len(clean)):
            corruption, key = self.schedule.draw(self.seed, f"{step}-{group}-{i}", 0)
            frames.append(corrupted(clean, i, corruption, key, self.depth))
        return np.stack(frames), clean.frames

    def collate(self, pieces: list[Any]) -> dict[str, Any]:
        """Return the groups as tensors "frames" and "clean"."""
        frames, clean = (np.stack(part) for part in zip(*pieces, strict=True))
        return {"frames": torch.from_numpy(frames), "clean": torch.from_numpy(clean)}


# type of a source of batches with "frames" and "clean", each of shape [time steps, views, H, W, c]
Pairs = PosePairs | FramePairs


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
    """Return the source of pairs for an ``env`` config, which is a world or a folder of frames.

    A folder of frames has no ``training`` episodes. From a folder, a sample of ``frames`` frames is
    read once.

    Raises:
        ValueError: If the schedule samples corruptions by success rate.
    """
    reject_success_distributed(schedule)
    if training is None:
        depth = replace(SENSOR, z_max=agent.parts()[modality].far)
        source = source_of(world, modality, None, "", None)
        sensor_schedule = schedule.only(modality)
        return FramePairs(source, sensor_schedule, modality, frames, panoramas, seed, depth)
    return PosePairs(agent, world, training, modality, schedule, panoramas, seed, own=True)


def with_clean_share(pairs: Pairs, share: float) -> Pairs:
    """Return a copy of ``pairs`` in which a fraction ``share`` of the frames stays clean.

    Call this function before ``start``.
    """
    copied = copy.copy(pairs)
    copied.schedule = replace(pairs.schedule, clean_share=share)
    return copied
