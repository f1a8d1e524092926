"""What is stored of a scene: the features that an agent's encoders give on a lattice of poses.

Worker processes make them (``ScenesTask``), the store that asked for them writes them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
import torch
from torch import Tensor

from mitigate.agents.topological.waypoints import COUNT, select
from mitigate.core.observation import DEPTH, POSE, RGB
from mitigate.core.precision import computing
from mitigate.corruptions import Schedule, corrupt_observation
from mitigate.worlds.world import depth_sensor

if TYPE_CHECKING:
    from mitigate.agents.topological.agent import TopologicalAgent

SPACING = 0.5  # metres between poses
_BATCH = 16  # panoramas encoded at once

Job = tuple[str, Sequence[int]]  # a scene, and which variants of it


@dataclass
class ScenesTask:
    """Makes scenes (``mitigate/core/workers.py``): of each job, (variant, the entries of
    ``ScenePoses`` by name) of each variant; variant 0 is the clean one, ``schedule`` draws the
    corruption of the others by ``seed``. kind: the precision that the encoders compute in."""

    agent: TopologicalAgent
    make_world: Callable[[], Any]
    schedule: Schedule | None
    seed: int
    kind: str
    world: Any = None
    preload: ClassVar[str] = "mitigate.agents.topological.stored"

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "world": None}

    @contextmanager
    def ready(self) -> Iterator[None]:
        """One thread for torch, whoever calls: features are the same in any number of processes."""
        threads = torch.get_num_threads()
        torch.set_num_threads(1)
        self.agent.eval()
        self.world = self.world or self.make_world()
        try:
            with computing(self.kind, self.agent.device):
                yield
        finally:
            torch.set_num_threads(threads)

    def work(self, jobs: Sequence[Job]) -> Iterator[list[tuple[int, dict[str, np.ndarray]]]]:
        """What is stored of the variants of each scene."""
        for scene, variants in jobs:
            yield list(self._poses(scene, variants))

    def name(self, job: Job) -> str:
        return f"scene {job[0]}"

    @torch.no_grad()
    def _poses(
        self, scene: str, variants: Sequence[int]
    ) -> Iterator[tuple[int, dict[str, np.ndarray]]]:
        self.world.enter(scene)
        points = self.world.points()
        xy = points[lattice(points)]
        clean = [_frames(self.world, p) for p in xy]
        known = _features(self.agent, clean)
        for variant in variants:
            frames = clean if not variant else self._corrupted(clean, f"{scene}-{variant}")
            made = {**known, **_features(self.agent, frames, clean)}
            views = np.concatenate([made["rgb"], made["depth"]], -1)
            kept = {"views": views, "waypoints": made["waypoints"], "seen": made["seen"]}
            yield variant, {"xy": xy, **kept}

    def _corrupted(self, frames: list[tuple], name: str) -> list[tuple]:
        """Frames of all poses under the corruption of the variant ``name``."""
        assert self.schedule is not None
        schedule, sensor = replace(self.schedule, clean_share=0.0), depth_sensor(self.world.sensors)
        made = []
        for number, (rgb, depth, seen) in enumerate(frames):
            drawn = schedule.draw(self.seed, name, number)
            shot = {RGB: rgb, DEPTH: depth, POSE: np.zeros(3, np.float32)}  # a flare has a yaw
            found = corrupt_observation(shot, *drawn, sensor)
            made.append((found[RGB], found[DEPTH], seen))
        return made


def lattice(points: np.ndarray) -> np.ndarray:
    """Indices of the points [n, 2] on a ``SPACING`` lattice: the nearest to each lattice point."""
    key = np.floor(points / SPACING).astype(int)
    middle = np.abs(points / SPACING - key - 0.5).sum(1)
    order = np.lexsort((middle, key[:, 1], key[:, 0]))
    first = np.ones(len(order), bool)
    first[1:] = (np.diff(key[order], axis=0) != 0).any(1)
    return np.sort(order[first])


def _frames(world: Any, xy: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """RGB, depth and, for each view, which things show (bits of a uint64)."""
    frames, truth = world.put(xy, 0.0)
    seen = truth["seen"]
    bits = (seen.astype(np.uint64) << np.arange(seen.shape[1], dtype=np.uint64)).sum(
        1, dtype=np.uint64
    )
    return frames[RGB], frames[DEPTH], bits


def _features(
    agent: TopologicalAgent, frames: list[tuple], known: list[tuple] | None = None
) -> dict[str, np.ndarray]:
    """Features of frames by what made them; those of frames that ``known`` holds are left out."""
    seen = np.stack([frame[2] for frame in frames]).view(np.int64)  # torch maps no uint64
    found = {"seen": seen}
    rgb, depth = ([frame[i] for frame in frames] for i in (0, 1))
    same_rgb, same_depth = (
        known is not None and all(a[i] is b[i] for a, b in zip(frames, known, strict=True))
        for i in (0, 1)
    )
    if not same_rgb:
        found["rgb"] = np.concatenate([_rgb(agent, part) for part in _parts(agent, rgb)])
    if not same_depth:
        views, logits = zip(*(_depth(agent, part) for part in _parts(agent, depth)), strict=True)
        found["depth"] = np.concatenate(views)
        found["waypoints"] = np.zeros((len(frames), COUNT, 2), np.float32)
        for row, grid in enumerate(np.concatenate(logits)):
            chosen = select(grid)
            found["waypoints"][row, : len(chosen)] = chosen
    return found


def _parts(agent: TopologicalAgent, frames: list[np.ndarray]) -> Iterator[Tensor]:
    for first in range(0, len(frames), _BATCH):
        yield torch.from_numpy(np.stack(frames[first : first + _BATCH])).to(agent.device)


def _rgb(agent: TopologicalAgent, frames: Tensor) -> np.ndarray:
    """float16 [n, 12, rgb + concepts]."""
    features, concepts = agent.encode_rgb(frames)
    return torch.cat([features, concepts.sigmoid()], -1).half().cpu().numpy()


def _depth(agent: TopologicalAgent, frames: Tensor) -> tuple[np.ndarray, np.ndarray]:
    """float16 [n, 12, depth] and waypoint logits."""
    features, logits = agent.encode_depth(frames)
    return features.half().cpu().numpy(), logits.float().cpu().numpy()
