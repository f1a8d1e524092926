"""The interface of worlds, and a world that corrupts the frames of another world.

A world produces observations and computes the measures of episodes. It does not depend on any
agent. ``docs/bring-your-own.md`` describes how to add a world.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from typing import Any, Protocol, runtime_checkable

import numpy as np

from mitigate.core.contracts import take_over
from mitigate.core.observation import (
    DEPTH,
    FORWARD,
    FORWARD_METRES,
    LEFT,
    RGB,
    RIGHT,
    TURN_DEGREES,
    Observation,
    Sensor,
)
from mitigate.core.spaces import ActionSpace
from mitigate.corruptions import Corruption, DepthSensor, FrameStream, Key, Schedule
from mitigate.corruptions.faults.camera import Mount
from mitigate.corruptions.schedule import drawn
from mitigate.corruptions.stream import is_timed, mount_of, shows_past
from mitigate.worlds.episodes import Episode

MAX_MEDIAN_DEPTH = 100.0  # in metres (heuristic); the median depth of an indoor frame is below this
# maps each action to (metres forward, degrees turned to the left)
MOVES = {FORWARD: (FORWARD_METRES, 0.0), LEFT: (0.0, TURN_DEGREES), RIGHT: (0.0, -TURN_DEGREES)}


class Expert:
    """Base class of experts, which know the shortest path to the goal of the current episode.

    A subclass defines ``action``, ``distance`` or both. Agents that act step by step need
    ``action``, and agents that plan need ``distance``.
    """

    def distance(self, xy: np.ndarray) -> float:
        """Return the length in metres of the shortest path from ``xy`` [2] to the nearest goal.

        Return NaN if the length is unknown.
        """
        return math.nan

    def action(self) -> int:
        """Return the next low-level action."""
        raise NotImplementedError(f"{type(self).__name__} defines no action()")

    def counts(self, metres: float) -> bool:
        """Return whether STOP at this distance from the goal is a success.

        The default implementation returns True. The agent's teacher then decides where to stop.
        """
        return True


class World:
    """Base class of worlds, which have one agent and run one episode at a time.

    A subclass defines ``reset``, ``step``, ``measures``, ``sensors`` and ``done``. All other
    members have defaults. Objects that do not inherit from this class also work, because
    :func:`as_world` adds the missing defaults.

    A class may define ``beside()``, which returns a second world of the same kind. Several episodes
    can then run at the same time.

    A class with discrete actions may define ``move(metres, degrees)``. It moves the agent
    ``metres`` forward and then turns it ``degrees`` to the left, as one step. Motion faults
    use this method.

    Attributes:
        sensors: Descriptions of the entries of an observation. Frames that are to be corrupted must
            be named "rgb" and "depth", and the pose must be named "pose".
        rule: The success rule of ``measures`` in words, such as "STOP and geodesic < 3 m". It is
            part of every result row.
        done: Whether the episode is over. If it is, ``step`` must not be called.
        action_space: Actions of the world (``core/spaces.py``). If None, actions are integers, and
            0 is STOP.
        native: Function that converts a dict of frames to the environment's own observation format,
            or None. Its attribute ``entries`` maps "rgb" and "depth" to names in that format.
        draw: Function that draws a floor plan on Matplotlib axes, or None if there is no plan.
    """

    rule: str
    sensors: Mapping[str, Sensor]
    done: bool
    action_space: ActionSpace | None = None
    native: Callable[[Mapping[str, Any]], Any] | None = None
    draw: Callable[[Any], None] | None = None

    def reset(self, episode: Episode) -> Observation:
        """Start an episode and return its first observation. Its frames are rendered when they are
        read.

        The world may reuse the arrays of the observation, so copy them if you keep them.

        Raises:
            ValueError: If the episode does not belong to this world.
        """
        raise NotImplementedError(f"{type(self).__name__} defines no reset(episode)")

    def step(self, action: Any) -> Observation:
        """Take an action and return the next observation."""
        raise NotImplementedError(f"{type(self).__name__} defines no step(action)")

    def measures(self) -> dict[str, float]:
        """Return the measures of the episode so far. ``success`` (0 or 1) and ``spl`` are
        required.
        """
        raise NotImplementedError(f"{type(self).__name__} defines no measures()")

    def expert(self) -> Any:
        """Return the :class:`Expert` for the current episode, or None.

        In a world without an expert, agents can be evaluated but not trained by imitation.
        """
        return None

    def truth(self) -> Mapping[str, np.ndarray]:
        """Return the ground-truth labels of the current view, as arrays by name."""
        return {}

    def displaced(self, mount: Mount) -> dict[str, np.ndarray] | None:
        """Render what a displaced camera would see at the current pose.

        Camera faults use this method.

        Returns:
            The frames, in the format of an observation. If the world cannot render them, return
            None. Camera faults then warp the frames of the observation instead. This requires the
            ``hfov`` of the sensors.
        """
        return None

    def remembering(self) -> AbstractContextManager:
        """Return a context manager in which frames are cached.

        Several conditions of an episode then share the frames. The cache does not affect results.
        """
        return nullcontext()


@runtime_checkable
class Placeable(Protocol):
    """A world that can render from any pose, which allows training on random poses without
    episodes.

    Attributes:
        scenes: Names of the training scenes.
    """

    scenes: Sequence[str]

    @property
    def sensors(self) -> Mapping[str, Sensor]: ...

    def enter(self, scene: str) -> None:
        """Load a scene."""

    def point(self, rng: np.random.Generator) -> np.ndarray:
        """Return a random point [2] of the scene where an agent can stand."""

    def put(
        self, xy: np.ndarray, heading: float, *, views: Sequence[int] | None, rgb: bool
    ) -> tuple[dict[str, np.ndarray], Mapping[str, np.ndarray]]:
        """Render from a pose.

        A world that can render displaced cameras also has the argument ``mount``
        (``corruptions/faults/camera.py``). ``camera_share`` in ``training/poses.py`` requires it.

        Args:
            xy: Plan position [2] in metres.
            heading: Heading in radians, counter-clockwise.
            views: Indices of the views that are needed; other views may be 0. If None, all views
                are needed.
            rgb: Whether RGB is needed.

        Returns:
            The frames and the pose as one dict, and the ground-truth labels.
        """


@runtime_checkable
class TrainingEpisodes(Protocol):
    """Source of training episodes."""

    def draw(self, rng: np.random.Generator, share: tuple[int, int]) -> Episode:
        """Sample an episode. The result depends only on the state of ``rng`` and on ``share``.

        ``share`` is the pair (index of this worker, number of workers). A world may use it to
        divide its scenes among workers.
        """


def as_world(world: Any) -> World:
    """Return ``world`` as a :class:`World`.

    An object of another class is wrapped, which adds the missing defaults. The object itself is not
    changed.
    """
    return world if isinstance(world, World) else _WorldView(world)


class WorldWrapper(World):
    """Base class of worlds that wrap an inner world and change its observations in ``_observe``."""

    def __init__(self, world: Any) -> None:
        self.world = world
        self._inner = as_world(world)  # ``world`` with the defaults of World

    def __getattr__(self, name: str) -> Any:
        """Return an attribute of the inner world, such as rule, sensors, done or point()."""
        # copy and pickle read these attributes before __init__ has set them
        if name.startswith("__") or name in ("world", "_inner"):
            raise AttributeError(name)
        return getattr(self.world, name)

    def reset(self, episode: Episode) -> Observation:
        return self._observe(self._inner.reset(episode))

    def step(self, action: Any) -> Observation:
        return self._observe(self._inner.step(action))

    def move(self, metres: float, degrees: float) -> Observation:
        """Take a step by calling ``move`` of the inner world (see ``worlds/motion.py``)."""
        return self._observe(self._inner.move(metres, degrees))  # type: ignore[attr-defined]

    def measures(self) -> dict[str, float]:
        return self._inner.measures()

    def expert(self) -> Any:
        return self._inner.expert()

    def truth(self) -> Mapping[str, np.ndarray]:
        return self._inner.truth()

    def displaced(self, mount: Mount) -> dict[str, np.ndarray] | None:
        return self._inner.displaced(mount)

    def remembering(self) -> AbstractContextManager:
        return self._inner.remembering()

    @property
    def action_space(self) -> ActionSpace | None:  # type: ignore[override]
        return self._inner.action_space

    @property
    def native(self) -> Callable[[Mapping[str, Any]], Any] | None:  # type: ignore[override]
        return self._inner.native

    @property
    def draw(self) -> Callable[[Any], None] | None:  # type: ignore[override]
        return self._inner.draw

    def _observe(self, observation: Observation) -> Observation:
        """Convert an observation of the inner world to the observation that the agent receives."""
        raise NotImplementedError


class _WorldView(World):
    """Wrap a user-defined object as a :class:`World`."""

    def __init__(self, world: Any) -> None:
        self._world = world
        optional = ("expert", "truth", "displaced", "remembering", "draw", "action_space", "native")
        take_over(self, world, ("reset", "step", "measures", *optional))

    def __getattr__(self, name: str) -> Any:
        """Read other attributes at each access, because they may change during an episode."""
        if name.startswith("_"):
            raise AttributeError(name)
        return getattr(self._world, name)


class Corrupted(WorldWrapper):
    """World whose frames are corrupted by one corruption, or by the corruptions that a schedule
    selects.

    Random numbers depend on the seed, the name, and the index of the frame. Usually, the index
    counts the frames that were read. With a temporal fault, the index is the number of the step. If
    the fault may show a frame at a later step, the frame is rendered even if it is not read.
    ``observation.clean`` is the clean observation. Instructions are corrupted in
    ``evaluation/episode.py`` instead.

    Args:
        world: The world.
        by: The corruption, or a schedule that selects a corruption for each frame.
        seed: Corruption seed.
        name: Name of the episode in the random keys. The default is the episode id.
    """

    def __init__(
        self, world: World, by: Corruption | Schedule, seed: int, name: str | None = None
    ) -> None:
        super().__init__(world)
        self.by = by
        self.seed = seed
        self.name = name
        self.frames_read = 0
        # the corrupted frames of the last observation that was read
        self.last: dict[str, np.ndarray] | None = None
        self._timed = isinstance(by, Corruption) and is_timed(by)
        self._shows_past = isinstance(by, Corruption) and shows_past(by)
        self._steps = 0

    def reset(self, episode: Episode) -> Observation:
        """Start an episode and restart the counts of frames and steps."""
        self.episode = episode
        self.frames_read = 0
        self.last = None
        self._stream = FrameStream()
        self._steps = 0
        return super().reset(episode)

    def step(self, action: Any) -> Observation:
        self._steps += 1
        return super().step(action)

    def _observe(self, clean: Observation) -> Observation:
        if not isinstance(clean, Observation):
            raise ValueError(
                f"reset() and step() of {type(self.world).__name__} must return an Observation, "
                f"got {type(clean).__name__}. Return for example Observation({{'pose': pose}}, "
                "lambda: {'rgb': rgb}, ('rgb',)) (docs/bring-your-own.md)."
            )
        name = self.episode.episode_id if self.name is None else self.name
        step = self._steps
        if self._shows_past:
            key = Key(self.seed, name, step)
            self._stream.remember(self._displaced(clean, key) or clean, key)

        def corrupted() -> dict[str, np.ndarray]:
            number = step if self._timed else self.frames_read
            corruption, key = drawn(self.by, self.seed, name, number)
            self.frames_read += 1
            frames = self._displaced(clean, key)
            sensors = self.world.sensors
            self._stream.sensor = depth_sensor(sensors)
            self._stream.hfov = {n: sensors[n].hfov for n in {RGB, DEPTH}.intersection(sensors)}
            self.last = self._stream.corrupt(
                frames or clean, corruption, key, displaced=frames is not None
            )
            return self.last

        return Observation(clean.ready, corrupted, clean.frames, clean=clean)

    def _displaced(self, clean: Observation, key: Key) -> dict[str, Any] | None:
        """Return the observation as rendered with the camera fault.

        Return None if there is no camera fault or if the world cannot render it.
        """
        mount = mount_of(self.by, key) if isinstance(self.by, Corruption) else None
        frames = None if mount is None else self._inner.displaced(mount)
        return None if frames is None else {**clean.ready, **frames}


def depth_sensor(sensors: Mapping[str, Sensor]) -> DepthSensor:
    """Return the range of a world's depth sensor, and the value that marks missing depth.

    An unlimited range is replaced by the range of R2R-CE.
    """
    default = DepthSensor()
    if DEPTH not in sensors:
        return default
    depth = sensors[DEPTH]
    z_max = depth.high if math.isfinite(depth.high) else default.z_max
    missing = default.missing if depth.missing is None else depth.missing
    return replace(default, z_max=z_max, missing=missing)


def expert_of(world: World) -> Expert:
    """Return the expert of a world for the current episode. Raise ValueError if it has none."""
    expert = as_world(world).expert()
    if expert is None:
        inner = world.world if isinstance(world, WorldWrapper) else world
        raise ValueError(
            f"{type(inner).__name__} has no expert, which imitation needs. Define expert() with "
            "the actions to take or the distances to the goal (docs/bring-your-own.md)."
        )
    return expert if isinstance(expert, Expert) else _ExpertView(expert)


def greedy_action(heading: float, distance_after: Callable[[float], float]) -> int:
    """Find the heading in which a step forward ends nearest to the goal.

    Return FORWARD if the agent has this heading, and otherwise the turn towards it.

    Args:
        heading: Heading of the agent in radians.
        distance_after: Function that takes a heading and returns the distance to the goal after a
            step in that direction.
    """
    turns = sorted(range(-12, 13), key=abs)
    headings = [heading + math.radians(TURN_DEGREES) * turn for turn in turns]
    best = turns[int(np.argmin([distance_after(each) for each in headings]))]
    return FORWARD if best == 0 else LEFT if best > 0 else RIGHT


class _ExpertView(Expert):
    """Wrap a user-defined object as an :class:`Expert`."""

    def __init__(self, expert: Any) -> None:
        take_over(self, expert, ("distance", "action", "counts"))


def check_metres(depth: np.ndarray, name: str, fix: str) -> None:
    """Raise ValueError if the median of ``depth`` is above ``MAX_MEDIAN_DEPTH`` metres.

    Depth values of 0 mean missing depth. The message names the data ``name`` and ends with the
    advice ``fix``.
    """
    readings = depth[depth > 0]
    median = float(np.median(readings)) if len(readings) else 0.0
    if median > MAX_MEDIAN_DEPTH:
        raise ValueError(
            f"Half of {name} is farther than {median:.0f} m: it is not in metres. {fix}"
        )
