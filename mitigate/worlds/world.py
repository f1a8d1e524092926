"""What evaluation, training and pictures know of a world, and the corrupted world.

A world gives observations of episodes and says how well they went; it knows no agent. How to bring
one: ``docs/bring-your-own.md``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from typing import Any, Protocol, runtime_checkable

import numpy as np

from mitigate.core.contracts import take_over
from mitigate.core.observation import DEPTH, Observation, Sensor
from mitigate.corruptions import Corruption, DepthSensor, Key, Schedule, corrupt_observation
from mitigate.corruptions.schedule import drawn
from mitigate.worlds.episodes import Episode

FARTHEST = 100.0  # metres: half of an indoor frame's readings are nearer (ours)


class Expert:
    """Base class of a shortest-path oracle: what it knows of the current episode.

    A subclass defines ``action`` for agents that act step by step, or ``distance`` for agents that
    plan, or both.
    """

    def distance(self, xy: np.ndarray) -> float:
        """Metres along the shortest path from the point ``xy`` [2] to the nearest goal; NaN where
        that is unknown."""
        return math.nan

    def action(self) -> int:
        """The low-level action that an oracle takes next."""
        raise NotImplementedError(f"{type(self).__name__} defines no action()")

    def counts(self, metres: float) -> bool:
        """Whether STOP at that distance is a success; by default the agent's teacher decides."""
        return True


class World:
    """Base class of worlds: one agent in one place, an episode at a time.

    A subclass defines ``reset``, ``step``, ``measures``, ``sensors`` and ``done``; the rest has
    defaults. Objects of any other class work, too: :func:`as_world` fills in what they lack.

    Attributes:
        sensors: what each entry of an observation is; the frames that are corrupted are called
            "rgb" and "depth", and the place is "pose".
        rule: what ``measures`` counts as success, in words, such as "STOP and geodesic < 3 m"; it
            is part of every row.
        done: whether the episode is over; no step may follow.
        draw: draws the plan of the place on Matplotlib axes; None where there is no plan.

    A class of worlds that defines ``beside()``, another world like this one, can run several
    episodes at the same time.
    """

    rule: str
    sensors: Mapping[str, Sensor]
    done: bool
    draw: Callable[[Any], None] | None = None

    def reset(self, episode: Episode) -> Observation:
        """Start an episode; frames are rendered when they are read.

        The arrays may be the world's own: copy them to keep them. Raises ValueError for an episode
        of another world.
        """
        raise NotImplementedError(f"{type(self).__name__} defines no reset(episode)")

    def step(self, action: int) -> Observation:
        """Take an action."""
        raise NotImplementedError(f"{type(self).__name__} defines no step(action)")

    def measures(self) -> dict[str, float]:
        """How the episode went so far: ``success`` (0 or 1) and ``spl`` at least."""
        raise NotImplementedError(f"{type(self).__name__} defines no measures()")

    def expert(self) -> Any:
        """The oracle (:class:`Expert`) of the current episode. None in a world without one: agents
        can be evaluated there, not trained by imitation."""
        return None

    def truth(self) -> Mapping[str, np.ndarray]:
        """Labels of what is seen from here, arrays by name."""
        return {}

    def remembering(self) -> AbstractContextManager:
        """A context within which frames are kept between the conditions of an episode; no result
        depends on it."""
        return nullcontext()


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


OPTIONAL = ("expert", "truth", "remembering", "draw")


def as_world(world: Any) -> World:
    """Return ``world``, or a view of it with the defaults of :class:`World` if its class does not
    build on that. The world itself is not changed."""
    return world if isinstance(world, World) else _WorldView(world)


class WorldWrapper(World):
    """A world whose observations are changed on their way to the agent; itself a world. A subclass
    says how in ``_seen``."""

    def __init__(self, world: Any) -> None:
        self.world = world
        self._inner = as_world(world)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or name in ("world", "_inner"):  # of a copy that is being made
            raise AttributeError(name)
        return getattr(self.world, name)  # whatever else the world has, such as point() and put()

    @property
    def rule(self) -> str:  # type: ignore[override]
        return self._inner.rule

    @property
    def sensors(self) -> Mapping[str, Sensor]:  # type: ignore[override]
        return self._inner.sensors

    @property
    def done(self) -> bool:  # type: ignore[override]
        return self._inner.done

    def reset(self, episode: Episode) -> Observation:
        return self._seen(self._inner.reset(episode))

    def step(self, action: int) -> Observation:
        return self._seen(self._inner.step(action))

    def measures(self) -> dict[str, float]:
        return self._inner.measures()

    def expert(self) -> Any:
        return self._inner.expert()

    def truth(self) -> Mapping[str, np.ndarray]:
        return self._inner.truth()

    def remembering(self) -> AbstractContextManager:
        return self._inner.remembering()

    @property
    def draw(self) -> Callable[[Any], None] | None:  # type: ignore[override]
        return self._inner.draw

    def _seen(self, met: Observation) -> Observation:
        """What the agent gets for an observation of the world."""
        raise NotImplementedError


class _WorldView(World):
    """An object of a user's class as a :class:`World`."""

    def __init__(self, world: Any) -> None:
        self._world = world
        take_over(self, world, OPTIONAL)

    @property
    def rule(self) -> str:  # type: ignore[override]
        return self._world.rule

    @property
    def sensors(self) -> Mapping[str, Sensor]:  # type: ignore[override]
        return self._world.sensors

    @property
    def done(self) -> bool:  # type: ignore[override]
        return self._world.done

    def reset(self, episode: Episode) -> Observation:
        return self._world.reset(episode)

    def step(self, action: int) -> Observation:
        return self._world.step(action)

    def measures(self) -> dict[str, float]:
        return self._world.measures()


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
    """Return the expert of a world for the current episode.

    Raises ValueError, naming the world, if it has none.
    """
    expert = as_world(world).expert()
    if expert is None:
        own = world.world if isinstance(world, WorldWrapper) else world
        raise ValueError(
            f"{type(own).__name__} has no expert, so there is nobody to imitate there: give it an "
            "expert() with the actions to take or distances to the goal (docs/bring-your-own.md)."
        )
    return expert if isinstance(expert, Expert) else _ExpertView(expert)


class _ExpertView(Expert):
    """An object of a user's class as an :class:`Expert`."""

    def __init__(self, expert: Any) -> None:
        take_over(self, expert, ("distance", "action", "counts"))


def check_metres(depth: np.ndarray, whose: str, fix: str) -> None:
    """Raise ValueError, with ``fix`` behind it, for ``depth`` (0: no reading) of ``whose`` frames
    half of the readings are farther than ``FARTHEST``."""
    known = depth[depth > 0]
    if len(known) and float(np.median(known)) > FARTHEST:
        middle = np.median(known)
        raise ValueError(
            f"Half of {whose} is farther than {middle:.0f} m: that is not metres. {fix}"
        )
