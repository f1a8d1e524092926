"""Base class of worlds that wrap environments of other libraries. Each episode is identified by a
seed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from mitigate.core.errors import own_place
from mitigate.core.observation import DEPTH, POSE, RGB, Observation, Sensor
from mitigate.core.seeding import digest
from mitigate.core.spaces import ActionSpace
from mitigate.worlds.episodes import Episode, is_seed, placeless_episode
from mitigate.worlds.world import World, check_metres


def seeded_episodes(seeds: Iterable[int], instruction: str = "Reach the goal.") -> list[Episode]:
    """Return one episode per seed, all with the same instruction.

    These episodes fit worlds that use only the seed of an episode, such as ``GymWorld``. Pass the
    list to ``mitigate.benchmark(listed=...)``.

    Raises:
        ValueError: If a seed is not an integer from 0 to 2147483647.
    """
    seeds = [int(seed) if isinstance(seed, np.integer) else seed for seed in seeds]
    for seed in seeds:
        if not is_seed(seed):
            raise ValueError(
                f"The seed must be a whole number from 0 to 2147483647, got {seed!r:.80}."
            )
    return [placeless_episode(str(seed), instruction, seed=seed) for seed in seeds]


FIRST_TRAINING_SEED = 1_000_000  # first seed of training episodes; comparisons use seeds below this
# name of the measure "return"; also the success rule of worlds that have no success criterion
RETURN = "return"
SCORES = ("success", RETURN)


@dataclass(frozen=True)
class Ending:
    """Description of the end of an episode, which is passed to a ``success`` function.

    Attributes:
        info: Entries that the environment reported with the last step.
        reward: Reward of the last step.
        total: Sum of the rewards of the episode.
        steps: Number of steps of the episode.
    """

    info: Mapping[str, Any]
    reward: float
    total: float
    steps: int


WHOLE = ""  # entry name used if the observation is a single frame and not a dict


@dataclass(frozen=True)
class NativeFormat:
    """Convert frames back to the observation format of the environment.

    Attributes:
        entries: Name of the observation entry for each sensor. Nested entries are written as
            "camera.rgb".
        dtypes: dtype of the entry for each sensor.
        unit: Metres per unit of depth.
    """

    entries: Mapping[str, str]
    dtypes: Mapping[str, str]
    unit: float = 1.0

    def __call__(self, frames: Mapping[str, Any]) -> Any:
        """Return the observation, which is an array or nested dictionaries of arrays.

        Args:
            frames: Arrays by sensor. They may have a batch axis in front.
        """
        observation: dict[str, Any] = {}
        for name, entry in self.entries.items():
            array = np.asarray(frames[name])
            if name == DEPTH:
                array = self._depth(array)
            if entry == WHOLE:
                return array
            *path, last = entry.split(".")
            inner = observation
            for part in path:
                inner = inner.setdefault(part, {})
            inner[last] = array
        return observation

    def _depth(self, metres: np.ndarray) -> np.ndarray:
        dtype = np.dtype(self.dtypes[DEPTH])
        depth = metres / np.float32(self.unit)
        if np.issubdtype(dtype, np.integer):
            limits = np.iinfo(dtype)
            depth = np.rint(np.clip(depth, limits.min, limits.max))
        return depth.astype(dtype)


# type of a dict that contains the shape, dtype and maximum of each entry of an observation
Arrays = dict[str, tuple[tuple[int, ...], str, float]]
# type of a success criterion: the name of an entry that the environment reports, or a function
Success = str | Callable[[Ending], bool]


class SeededWorld(World):
    """Base class of worlds in which a seed determines an episode.

    A subclass defines ``_spaces``, ``_reset_env``, ``_step_env`` and ``_report``. Negative and
    non-finite depth becomes 0, which means missing.

    Args:
        env: The environment.
        entries: Mapping from "rgb", "depth", "pose" and other names that the agent reads (such as
            "goal") to entries of the observation. Nested entries are written as "camera.rgb". By
            default, a single frame is "rgb", and the entries "rgb", "depth" and "pose" of a dict
            keep their names.
        success: Name of the entry that reports success at the end of an episode, or a function that
            takes an :class:`Ending`. The default is the entry "success".
        unit: Metres per unit of depth (default 1). It is required if depth consists of integers or
            if its maximum is 1 or less.
        limit: Maximum number of steps. If None, episodes end only when the environment ends them.
            With a limit, the measures also contain ``limit`` and ``cut``; ``cut`` is 1 if the limit
            ended the episode.
        rule: The success rule in words, for rows and tables. The default is the name of the entry.
            A rule is required if ``success`` is a function.
        score: "success", or "return" for a task without a success criterion. With "return", rows
            contain the sum of the rewards, and tables show which fraction of the clean return is
            retained (``evaluation/comparison.py``).
        extra: Names of additional entries that the environment reports at the end of an episode.
            They are stored as measures.
        hfov: Horizontal field of view of the cameras in degrees. Camera faults require it.

    Attributes:
        native: Converter from frames to the environment's own observation format
            (:class:`NativeFormat`).
        reward: Reward of the last step.
        terminated: Whether the task ended the episode; False if a step limit ended it.

    Raises:
        ValueError: If an argument is invalid, if an entry is missing, or if frames have a shape or
            dtype that the suite does not support. During an episode, this error is also raised if
            success is not reported, if depth is implausible, if a frame does not match its space,
            or if the environment raises any error.
    """

    done = True
    action_space: ActionSpace
    reward = 0.0
    terminated = False

    def __init__(
        self,
        env: Any,
        entries: Mapping[str, str] | None = None,
        *,
        success: Success | None = None,
        unit: float | None = None,
        limit: int | None = None,
        rule: str | None = None,
        score: str = "success",
        extra: Sequence[str] = (),
        hfov: float | None = None,
    ) -> None:
        if score not in SCORES:
            raise ValueError(f"score must be one of {', '.join(SCORES)}, got {score!r:.80}.")
        if score == RETURN and (success is not None or rule is not None):
            raise ValueError("success= and rule= must not be set with score='return'. Remove them.")
        if hfov is not None and not 0 < hfov < 180:
            raise ValueError(f"hfov must be above 0 and below 180 degrees, got {hfov!r:.80}.")
        if limit is not None and (type(limit) is not int or limit < 1):
            raise ValueError(
                f"limit must be a whole number of steps >= 1 or None (no limit), got {limit!r}."
            )
        _check_success(success, rule)
        self.action_space, arrays = self._spaces(env)
        default = {RGB: WHOLE} if WHOLE in arrays else {n: n for n in (RGB, DEPTH, POSE)}
        entries = entries or {name: entry for name, entry in default.items() if entry in arrays}
        missing = [entry or name for name, entry in entries.items() if entry not in arrays]
        if missing or not entries:
            raise ValueError(
                f"The observation has no array {', '.join(missing) or 'rgb or depth'}; it has "
                f"{', '.join(map(str, arrays)) or 'none'}. Name its frames: "
                "entries={'rgb': 'image'}."
            )
        self.env = env
        self.entries = dict(entries)
        self.success: Success = "success" if success is None else success
        self.unit = 1.0 if unit is None else unit
        self.limit = limit
        self.rule = RETURN if score == RETURN else rule or f"{self.success} at the end"
        self.extra = tuple(extra)
        self.sensors: dict[str, Sensor] = {}
        for name, entry in entries.items():
            shape, dtype, high = arrays[entry]
            options: dict[str, Any] = {}
            if name in (RGB, DEPTH):
                _check_format(name, entry, tuple(shape), dtype)
                options["hfov"] = hfov
            if name == DEPTH:
                _check_unit(entry, dtype, high, unit)
                options |= {"unit": "m", "high": high * self.unit}
            self.sensors[name] = Sensor(name, tuple(shape), dtype, **options)
        dtypes = {name: sensor.dtype for name, sensor in self.sensors.items()}
        self.native = NativeFormat(self.entries, dtypes, self.unit)

    def reset(self, episode: Episode) -> Observation:
        """Start an episode from its seed, which is ``info["seed"]`` or derived from the episode
        id.
        """
        self.done = self._cut = self.terminated = False
        self._name = episode.episode_id
        self.reward = self._total = 0.0
        self._steps = 0
        seed = int(episode.info.get("seed", digest("episode", episode.episode_id))) % 2**31
        with self._calling(f"{type(self.env).__name__}.reset()"):
            parts = self._reset_env(seed)
        return self._observation(parts)

    def step(self, action: Any) -> Observation:
        """Take an action.

        Raises:
            RuntimeError: If the episode is over.
            ValueError: If the action does not exist, the environment ended the episode without
                reporting success, or the reward is NaN although the score depends on it.
        """
        if self.done:
            raise RuntimeError("The episode is over. Call reset() before step().")
        action = self.action_space.check(action)
        with self._calling(f"{type(self.env).__name__}.step()"):
            parts, reward, over = self._step_env(action)
        if math.isnan(reward) and (callable(self.success) or self.rule == RETURN):
            raise ValueError(
                f"The reward of step {self._steps + 1} of episode {self._name} must not be NaN."
            )
        self.reward = reward
        self._total += reward
        self._steps += 1
        self._cut = not over and self.limit is not None and self._steps >= self.limit
        self.done = over or self._cut
        named = isinstance(self.success, str) and self.rule != RETURN
        if over and named and self.success not in self._report():
            raise ValueError(
                f"At the end of episode {self._name} the environment must report success, but it "
                f"has no entry {self.success!r}, only {_listed(self._report())}. Set success= to "
                "an entry that is False after a failure, or to a function, such as "
                'success=lambda end: end.total > 0, rule="return > 0". If the task has '
                'no success criterion, set score="return".'
            )
        return self._observation(parts)

    def _spaces(self, env: Any) -> tuple[ActionSpace, Arrays]:
        """Return the action space, and the shape, dtype and maximum of each observation entry.

        Raises:
            ValueError: If the actions are not supported (``core/spaces.py``).
        """
        raise NotImplementedError(f"{type(self).__name__} defines no _spaces(env)")

    def _reset_env(self, seed: int) -> Mapping[str, Any]:
        """Reset the environment and return its observation as a dict of entries."""
        raise NotImplementedError(f"{type(self).__name__} defines no _reset_env()")

    def _step_env(self, action: Any) -> tuple[Mapping[str, Any], float, bool]:
        """Step the environment.

        Return its observation, the reward, and whether the episode is over. A subclass also sets
        ``terminated``.
        """
        raise NotImplementedError(f"{type(self).__name__} defines no _step_env()")

    def measures(self) -> dict[str, float]:
        """Return ``success``, ``spl``, ``return`` and ``steps``. With a step limit, also return
        ``cut`` and ``limit``.

        ``spl`` equals ``success``, because the shortest path is unknown. If the score is "return",
        both are missing.
        """
        measures: dict[str, float] = {}
        if self.rule != RETURN:
            succeeded = int(self.done and self._succeeded())
            measures |= {"success": succeeded, "spl": float(succeeded)}
        measures |= {RETURN: self._total, "steps": self._steps}
        measures |= {name: self._extra(name) for name in self.extra}
        if self.limit is not None:
            measures |= {"cut": int(self._cut), "limit": self.limit}
        return measures

    def _extra(self, name: str) -> float:
        value = np.asarray(self._report().get(name, math.nan)).ravel()
        if value.size != 1 or value.dtype.kind not in "biuf" or np.isnan(value[0]):
            raise ValueError(
                f"The entry {name!r} of extra must be a number at the end of episode {self._name}; "
                f"the environment reports {_listed(self._report())}."
            )
        return float(value[0])

    def _report(self) -> Mapping[str, Any]:
        """Return the entries that the environment reported with the last step."""
        raise NotImplementedError(f"{type(self).__name__} defines no _report()")

    def _succeeded(self) -> bool:
        if isinstance(self.success, str):
            source = f"The entry {self.success!r}"
            value = self._report().get(self.success, False)
        else:
            source = "The success function"
            end = Ending(self._report(), self.reward, self._total, self._steps)
            with self._calling(source):
                value = self.success(end)
        return _as_bool(value, source, self._name)

    @contextmanager
    def _calling(self, what: str) -> Iterator[None]:
        """Convert errors in the user's code to a ValueError that names the episode."""
        try:
            yield
        except MemoryError:  # core/errors.py handles this error
            raise
        except Exception as error:
            place = own_place(error)
            cause = " ".join(str(error).split())[:300]
            raise ValueError(
                f"{what} raised {type(error).__name__} in episode {self._name}: {cause}"
                f"{f' (raised in {place})' if place else ''}"
            ) from error

    def _observation(self, values: Mapping[str, Any]) -> Observation:
        """Return an observation with copied arrays, because environments may reuse buffers."""
        absent = [entry for entry in self.entries.values() if entry not in values]
        if absent:
            raise ValueError(
                f"The observation after step {self._steps} of episode {self._name} must have the "
                f"entry {absent[0]!r} of the observation space, got {_listed(values)}."
            )
        frames = {name: np.array(values[entry]) for name, entry in self.entries.items()}
        for name in {RGB, DEPTH}.intersection(frames):
            frame, sensor = frames[name], self.sensors[name]
            if frame.shape != sensor.shape or (name == RGB and frame.dtype != np.uint8):
                raise ValueError(
                    f"The {name} frame after step {self._steps} of episode {self._name} must be "
                    f"{sensor.dtype} {list(sensor.shape)}, as in the environment's space, got "
                    f"{frame.dtype} {list(frame.shape)}."
                )
        if DEPTH in frames:
            frames[DEPTH] = self._metres(frames[DEPTH])
        pose = {POSE: frames.pop(POSE)} if POSE in frames else {}
        return Observation(pose, lambda: frames, tuple(frames))

    def _metres(self, depth: np.ndarray) -> np.ndarray:
        """Convert depth to float32 metres. Check the unit on the first frame of an episode."""
        metres = depth.astype(np.float32) * np.float32(self.unit)
        metres = np.where(np.isfinite(metres) & (metres > 0), metres, np.float32(0))
        if self._steps == 0:
            fix = "Set unit= to the metres per unit of depth (0.001 for millimetres)."
            check_metres(metres, "the depth", fix)
        return metres


def _listed(names: Iterable[str]) -> str:
    return ", ".join(map(repr, names)) or "none"


def _as_bool(value: Any, source: str, episode: str) -> bool:
    """Return whether a value, or at least one of its elements, is true. None counts as false.

    Raises:
        ValueError: If an element is something other than a boolean, 0 or 1.
    """
    try:
        parts = np.asarray(value).ravel().tolist()
        valid = all(part is None or part in (0, 1) for part in parts)
    # the value may be a ragged list, or an object that is not a number
    except (ValueError, TypeError):
        valid = False
    if not valid:
        raise ValueError(
            f"{source} must be True, False, 0 or 1 (or an array or a list of these) at the end of "
            f"episode {episode}, got {value!r:.80}. Set success= to a function that returns True "
            'or False, such as success=lambda end: end.info["score"] >= 0.5, with '
            'rule="score >= 0.5".'
        )
    return any(parts)


def _check_success(success: Any, rule: str | None) -> None:
    """Raise ValueError if ``success`` is invalid, or if it is a function without ``rule``."""
    if callable(success) and not rule:
        raise ValueError(
            'A success function needs rule=, the rule in words, such as rule="return > 0".'
        )
    if not (success is None or callable(success) or (isinstance(success, str) and success)):
        raise ValueError(
            f"success must be the name of an entry or a function, got {success!r:.80}. Set "
            'success="is_success", or success=lambda end: end.total > 0 with rule="return > 0".'
        )


def _check_format(name: str, entry: str, shape: tuple[int, ...], dtype: str) -> None:
    """Raise ValueError for frames that ``corruptions/suite.py`` does not support."""
    if name == RGB and dtype != "uint8":
        raise ValueError(
            f"RGB must be uint8 in 0-255, got {dtype}. Remove wrappers that scale or transpose "
            "frames."
        )
    channels = 3 if name == RGB else 1
    flat = name == DEPTH and len(shape) == 2
    if not flat and (len(shape) not in (3, 4) or shape[-1] != channels):
        raise ValueError(
            f"The shape of the {name} frames{f' {entry!r}' if entry else ''} must be "
            f"[H, W, {channels}], or [views, H, W, {channels}] for a panorama, got {list(shape)}. "
            "Wrap the environment (gymnasium.wrappers.TransformObservation)."
        )


def _check_unit(entry: str, dtype: str, high: float, unit: float | None) -> None:
    """Raise ValueError if the unit of depth is invalid, or if it is required but missing."""
    if unit is not None and not (type(unit) in (int, float) and 0 < unit < math.inf):
        raise ValueError(f"unit must be a number of metres above 0, got {unit!r}.")
    if unit is None and not dtype.startswith("float"):
        raise ValueError(
            f"The depth {entry!r} is {dtype}, so its unit is unknown. Set unit= to the metres per "
            "unit (0.001 for millimetres)."
        )
    if unit is None and high <= 1:
        raise ValueError(
            f"The maximum of depth {entry!r} is {high:g}, so it may be normalised to [0, 1]. Set "
            "unit= to the depth in metres that the value 1 means (10 for a sensor of 0 to 10 m), "
            "or unit=1.0 if the depth is in metres."
        )
