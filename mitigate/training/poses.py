"""Make batches of corrupted panoramas at random poses, with labels, to train encoders.

The batches do not depend on the agent's weights, so worker processes compute them in advance.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from inspect import signature
from typing import Any, ClassVar

import numpy as np
import torch

from mitigate.core.observation import RGB, VIEWS
from mitigate.core.pictures import side_by_side
from mitigate.core.seeding import generator
from mitigate.corruptions import Schedule, corrupt_observation
from mitigate.corruptions.faults.camera import random_mount
from mitigate.corruptions.keying import Key, digest, uniform
from mitigate.training.objective import OnSource, check_counts, check_share
from mitigate.training.parts import OWN, SEEING
from mitigate.training.success import DrawsBySuccess, ScheduledJob
from mitigate.worlds.episodes import share_of
from mitigate.worlds.world import Placeable, TrainingEpisodes, depth_sensor

PIECE = 6  # number of panoramas that one job renders (heuristic)
VIEWS_ALONE = (
    f"This stage trains encoders on single views. {OWN} A policy can train on episodes instead, "
    "in a recipe with a stage imitation or with recipes/adapt.py (Adapt). Restorers, safeguards "
    "and encoders have their own recipes (recipes/README.md)."
)


@dataclass(eq=False, repr=False)
class Poses(DrawsBySuccess):
    """Source of batches that contain corrupted and clean panoramas at random poses.

    Args:
        agent: the agent whose success rates are measured if the schedule samples corruptions by
            success rate and has no rates yet.
        world: function that constructs a world with random poses (``Placeable`` in
            ``worlds/world.py``).
        training: episodes on which success rates are measured.
        modality: the sensor, "rgb" or "depth".
        schedule: chooses the corruption of each panorama. If None, frames stay clean.
        panoramas: number of panoramas per batch.
        seed: seed of poses and corruptions.
        refresh_episodes: number of episodes per corruption when success rates are measured.
        own: whether to sample only corruptions of this sensor. If false, corruptions of other
            sensors are also sampled, and they leave the frames of this sensor clean.
        camera_share: fraction of panoramas that are rendered from a displaced camera
            (``random_mount`` in ``corruptions/faults/camera.py``). For these panoramas, the clean
            frames and the labels still come from the undisplaced camera.

    Raises:
        ValueError: If the sensor is unknown, if there are no panoramas, or if the world has no
            random poses. It is also raised if ``camera_share`` is invalid; it must be 0 in a world
            that cannot displace its camera.
    """

    agent: Any
    world: Callable[[], Any]
    training: TrainingEpisodes
    modality: str
    schedule: Schedule = None  # type: ignore[assignment]
    panoramas: int = 12
    seed: int = 0
    refresh_episodes: int = 8
    own: bool = False
    camera_share: float = 0.0

    def __post_init__(self) -> None:
        if self.modality not in ("rgb", "depth"):
            raise ValueError(f"modality must be 'rgb' or 'depth', got {self.modality!r}.")
        check_counts(panoramas=self.panoramas)
        check_share("camera_share", self.camera_share)
        self.sensor = self.modality  # ``modality`` is the name of the option in configs
        self.schedule = self.schedule or Schedule("clean", 0.0)
        if self.own:
            self.schedule = self.schedule.only(self.sensor)
        self.label: str | None = None
        self.every = 1
        self._placed: Placeable | None = None
        self._last: np.ndarray | None = None

    def learn(self, label: str, every: int) -> None:
        """Choose which targets and views later batches contain.

        Without this call, targets are empty.

        Args:
            label: ground-truth entry of the world to use as targets.
            every: use every n-th view of a panorama. The value 2 is useful because neighbouring
                views overlap.
        """
        self.label = label
        self.every = every

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_placed": None}

    @property
    def placed(self) -> Placeable:
        """The world, which each process constructs once."""
        if self._placed is None:
            world = self.world()
            if not isinstance(world, Placeable):
                raise ValueError(
                    f"{type(world).__name__} does not support random poses, which encoder training "
                    "needs. Leave out those stages (stages.NAME=null), or add scenes, enter, point "
                    "and put to the world (docs/bring-your-own.md)."
                )
            if self.camera_share and "mount" not in signature(world.put).parameters:
                raise ValueError(
                    f"camera_share must be 0 in {type(world).__name__}, got {self.camera_share}: "
                    "its put() does not take the argument mount, so it cannot render a displaced "
                    "camera."
                )
            self._placed = world
        return self._placed

    def identity(self) -> dict[str, str]:
        """Return an empty dict of file hashes, because the poses depend only on the settings."""
        return {}

    @property
    def pieces(self) -> int:
        """The number of jobs in every step."""
        return -(-self.panoramas // PIECE)

    def jobs(self, step: int, workers: int | None = None) -> list[ScheduledJob]:
        """Return the jobs of a step, whose items are panoramas.

        If the schedule needs success rates but has none, they are measured with ``workers``
        processes.
        """
        self.refresh_if_needed(step, workers)
        return self.scheduled_jobs(step, self.panoramas, self.pieces)

    def work(self, job: ScheduledJob) -> list[tuple[np.ndarray, ...]]:
        """Return (corrupted frames, clean frames, labels) for each random pose of a job."""
        step, number, jobs, count, schedule_state = job
        self.schedule.load_state_dict(schedule_state)
        rng = generator(self.seed, "perception", self.sensor, step, number)
        scenes = share_of(self.placed.scenes, number, jobs)
        return [self._panorama(rng, scenes, f"{step}-{number}-{i}") for i in range(count)]

    def collate(self, pieces: list[Any]) -> dict[str, Any]:
        """Join the results of all jobs into the tensors "frames", "clean" and "targets"."""
        rows = [row for piece in pieces for row in piece]
        names = ("frames", "clean", "targets")
        self._last = rows[-1][0]
        return {
            name: torch.from_numpy(np.stack(column))
            for name, column in zip(names, zip(*rows, strict=True), strict=True)
        }

    def figures(self) -> dict[str, np.ndarray]:
        """Return the last panorama of the last batch as one picture; depth is shown as grey."""
        return {} if self._last is None else {"views": side_by_side(self._last)}

    def _panorama(self, rng: np.random.Generator, scenes: Any, name: str) -> tuple[np.ndarray, ...]:
        """Return corrupted frames, clean frames and labels of one random pose."""
        self.placed.enter(scenes[int(rng.integers(len(scenes)))])
        xy = self.placed.point(rng)
        if len(self.placed.sensors[self.sensor].yaws) == 1:
            rows = [self._view(xy, rng, name, i) for i in range(VIEWS // self.every)]
            return tuple(np.stack(part) for part in zip(*rows, strict=True))
        heading = float(rng.uniform(-np.pi, np.pi))
        first = int(rng.integers(self.every)) if self.every > 1 else 0
        views = list(range(first, VIEWS, self.every))
        clean, seen, truth = self._put(xy, heading, views, Key(self.seed, name, 0))
        # A corruption may replace one view with another.
        # Views that were not rendered are therefore filled with copies of rendered views.
        sources = [views[(view - first) // self.every % len(views)] for view in range(VIEWS)]
        seen = {**seen, self.sensor: seen[self.sensor][sources]}
        corruption, key = self.schedule.draw(self.seed, name, 0)
        frames = corrupt_observation(seen, corruption, key, depth_sensor(self.placed.sensors))
        target = self._target(truth)
        target = target[views] if len(target) == VIEWS else target
        return frames[self.sensor][views], clean[self.sensor][views], target

    def _view(
        self, xy: np.ndarray, rng: np.random.Generator, name: str, number: int
    ) -> tuple[np.ndarray, ...]:
        """Return the result of :meth:`_panorama` for one view of a single camera."""
        heading = float(rng.uniform(-np.pi, np.pi))
        clean, seen, truth = self._put(xy, heading, None, Key(self.seed, f"{name}-{number}", 0))
        corruption, key = self.schedule.draw(self.seed, name, number)
        frames = corrupt_observation(seen, corruption, key, depth_sensor(self.placed.sensors))
        return frames[self.sensor], clean[self.sensor], self._target(truth)

    def _put(
        self, xy: np.ndarray, heading: float, views: list[int] | None, key: Key
    ) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray], Mapping[str, np.ndarray]]:
        """Return the frames of two cameras, and the labels.

        The first camera is not displaced. The second camera may be displaced.
        """
        rgb = self.sensor == RGB
        clean, truth = self.placed.put(xy, heading, views=views, rgb=rgb)
        if uniform(digest(key, "camera_share")) >= self.camera_share:
            return clean, clean, truth
        world: Any = self.placed
        seen, _ = world.put(xy, heading, views=views, rgb=rgb, mount=random_mount(key))
        return clean, seen, truth

    def _target(self, truth: Mapping[str, np.ndarray]) -> np.ndarray:
        return np.zeros(0, np.float32) if self.label is None else truth[self.label]


class OnViews(OnSource):
    """Base class of objectives that train encoders on the views of a source ``poses``."""

    sources: ClassVar[Mapping[str, Callable[..., Any]]] = {"poses": Poses}
    ahead = True
    needs: ClassVar[tuple[str, ...]] = SEEING
    otherwise = VIEWS_ALONE
    poses: Poses

    def collate(self, step: int, pieces: list[Any]) -> dict[str, Any]:
        return self.poses.collate(pieces)

    def weight(self, batch: dict[str, Any]) -> float:
        """Return the number of panoramas in the batch.

        With a single camera, the views of one position count as a panorama.
        """
        return float(len(batch["frames"]))
