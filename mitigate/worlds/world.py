"""What evaluation, training and pictures know of a world, and the corrupted world.

A world gives observations of episodes and says how well they went; it knows no agent. How to bring
one: ``docs/bring-your-own.md``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from typing import Any, Protocol, runtime_checkable

import numpy as np

from mitigate.core.observation import DEPTH, Observation, Sensor
from mitigate.corruptions import Corruption, DepthSensor, Key, Schedule, corrupt_observation
from mitigate.corruptions.schedule import drawn
from mitigate.worlds.episodes import Episode


class Expert(Protocol):
    """What a shortest-path oracle knows of the episode that is on.

    ``counts(metres)`` (optional): whether STOP at that distance is a success. Without it, what an
    agent's teacher takes for near enough is.
    """

    def distance(self, xy: np.ndarray) -> float:
        """Metres along the shortest way from the point ``xy`` [2] to the nearest goal."""

    def action(self) -> int:
        """The low-level action that an oracle takes next."""


class World(Protocol):
    """One agent in one place, an episode at a time.

    sensors: what each entry of an observation is; the frames that are corrupted are called "rgb"
    and "depth", and the place is "pose". rule: what its ``measures`` count as success, in words,
    such as "STOP and geodesic < 3 m"; it is part of every row. done: no step may follow.
    ``truth()`` (optional): labels of what is seen from here, arrays by name. ``beside()``
    (optional): another world like this one, for an episode at the same time.
    """

    rule: str

    @property
    def sensors(self) -> Mapping[str, Sensor]: ...

    @property
    def done(self) -> bool: ...

    def reset(self, episode: Episode) -> Observation:
        """Begin an episode; frames are rendered when they are read. The arrays may be the world's
        own: whoever keeps them copies them. Raises ValueError for an episode of another world."""

    def step(self, action: int) -> Observation: ...

    def measures(self) -> dict[str, float]:
        """How the episode went so far: ``success`` (0 or 1) and ``spl`` at least."""

    def expert(self) -> Expert | None:
        """The oracle of the episode that is on; None in a world that has none: agents can be
        evaluated there, not trained by imitation."""


@runtime_checkable
class Placeable(Protocol):
    """A world that can look from anywhere, for pretraining without episodes.

    scenes: names of the places to train in.
    """

    scenes: Sequence[str]

    @property
    def sensors(self) -> Mapping[str, Sensor]: ...

    def enter(self, scene: str) -> None: ...

    def point(self, rng: np.random.Generator) -> np.ndarray:
        """A random point [2] of the scene where an agent can stand."""

    def put(
        self, xy: np.ndarray, heading: float, *, views: Sequence[int] | None, rgb: bool
    ) -> tuple[dict[str, np.ndarray], Mapping[str, np.ndarray]]:
        """Frames and pose from there, and the truth. ``views``: those that are needed, None: all;
        the others may be 0. ``rgb`` False: colours are not needed."""


@runtime_checkable
class TrainingEpisodes(Protocol):
    """Where the episodes of a training come from."""

    def draw(self, rng: np.random.Generator, share: tuple[int, int]) -> Episode:
        """An episode: a function of the generator's state and of ``share`` = (piece, of how many),
        by which worker processes that draw different pieces of a batch may split the scenes."""


class WorldWrapper:
    """A world whose observations are changed on their way to the agent; itself a world. A subclass
    says how in ``_seen``."""

    def __init__(self, world: World) -> None:
        self.world = world

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or name == "world":
            raise AttributeError(name)
        return getattr(self.world, name)

    @property
    def sensors(self) -> Mapping[str, Sensor]:
        return self.world.sensors

    @property
    def done(self) -> bool:
        return self.world.done

    def reset(self, episode: Episode) -> Observation:
        return self._seen(self.world.reset(episode))

    def step(self, action: int) -> Observation:
        return self._seen(self.world.step(action))

    def measures(self) -> dict[str, float]:
        return self.world.measures()

    def expert(self) -> Expert | None:
        return getattr(self.world, "expert", lambda: None)()

    def truth(self) -> Mapping[str, np.ndarray]:
        return getattr(self.world, "truth", dict)()

    def _seen(self, met: Observation) -> Observation:
        """What the agent gets for an observation of the world."""
        raise NotImplementedError


class Corrupted(WorldWrapper):
    """A world whose frames meet a corruption, or what a schedule draws.

    The draws are keyed by (seed, name, number of the look): an observation whose frames nobody
    reads is no look. ``observation.clean`` is what it was before. ``name``: of the episode in the
    keys; None: its id. Instructions are corrupted before the agent hears them
    (``evaluation/episode.py``), not here.
    """

    def __init__(
        self, world: World, by: Corruption | Schedule, seed: int, name: str | None = None
    ) -> None:
        super().__init__(world)
        self.by, self.seed, self.name = by, seed, name
        self.looks = 0
        self.last: dict[str, np.ndarray] | None = None  # frames that were read last

    def reset(self, episode: Episode) -> Observation:
        """Begin an episode, and the count of looks."""
        self.episode, self.looks, self.last = episode, 0, None
        return super().reset(episode)

    def _seen(self, clean: Observation) -> Observation:
        if not isinstance(clean, Observation):
            raise ValueError(
                f"{type(self.world).__name__} showed a {type(clean).__name__}: its reset() and "
                "step() return an Observation, such as Observation({'pose': pose}, "
                "lambda: {'rgb': rgb}, ('rgb',)) (docs/bring-your-own.md)."
            )

        def corrupted() -> dict[str, np.ndarray]:
            corruption, key = self._draw()
            self.looks += 1
            sensor = depth_sensor(self.world.sensors)
            self.last = corrupt_observation(dict(clean), corruption, key, sensor)
            return self.last

        return Observation(clean.ready, corrupted, clean.frames, clean=clean)

    def _draw(self) -> tuple[Corruption, Key]:
        name = self.episode.episode_id if self.name is None else self.name
        return drawn(self.by, self.seed, name, self.looks)


def depth_sensor(sensors: Mapping[str, Sensor]) -> DepthSensor:
    """What the corruptions must know of a world's depth: its range, and what stands for no
    reading. A range without an end is R2R-CE's."""
    depth, usual = sensors.get(DEPTH), DepthSensor()
    if depth is None:
        return usual
    far = depth.high if math.isfinite(depth.high) else usual.z_max
    return replace(
        usual, z_max=far, missing=usual.missing if depth.missing is None else depth.missing
    )


def expert_of(world: World) -> Expert:
    """The expert of a world that is on; ValueError, naming the world, if it has none."""
    expert = world.expert()
    if expert is None:
        own = getattr(world, "world", world)  # of a corrupted one
        raise ValueError(
            f"{type(own).__name__} has no expert, so there is nobody to imitate there: give it an "
            "expert() with the actions to take or distances to the goal (docs/bring-your-own.md)."
        )
    return expert


def counts(expert: Any, metres: float) -> bool:
    """Whether STOP so far from the goal is a success, as far as the expert says."""
    return bool(expert.counts(metres)) if hasattr(expert, "counts") else True


def remembering(thing: Any) -> AbstractContextManager:
    """``thing.remembering()``, within which an agent or a world keeps what it computed for equal
    input, where it has that; its results do not depend on it."""
    return getattr(thing, "remembering", nullcontext)()
