"""What worlds made of other libraries' environments share: an episode is a seed."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from mitigate.core.errors import own_place
from mitigate.core.observation import DEPTH, POSE, RGB, Observation, Sensor
from mitigate.core.seeding import digest
from mitigate.worlds.episodes import Episode, Instruction, is_seed
from mitigate.worlds.world import World, check_metres


def seeded_episodes(seeds: Iterable[int], instruction: str = "Reach the goal.") -> list[Episode]:
    """An episode for each seed, all with the same instruction, of a world that reads nothing else
    of an episode; a list for ``mitigate.benchmark(listed=...)``. Raises ValueError for a seed that
    is no whole number from 0 to 2147483647."""
    seeds = [int(seed) if isinstance(seed, np.integer) else seed for seed in seeds]
    wrong = [seed for seed in seeds if not is_seed(seed)]
    if wrong:
        raise ValueError(f"The seed {wrong[0]!r:.80} must be a whole number from 0 to 2147483647.")
    nowhere, ahead, told = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), Instruction(instruction)
    return [
        Episode(str(seed), str(seed), "", nowhere, ahead, (), told, (), info={"seed": int(seed)})
        for seed in seeds
    ]


@dataclass(frozen=True)
class Ending:
    """What a ``success`` function is asked at the end of an episode.

    Attributes:
        info: what the environment reported with the last step.
        reward: of the last step.
        total: sum of the rewards of the episode.
        steps: number of steps.
    """

    info: Mapping[str, Any]
    reward: float
    total: float
    steps: int


Success = str | Callable[[Ending], bool]  # an entry of the environment's report, or a function


class SeededWorld(World):
    """A subclass sets ``_steps``, ``_reward`` and ``done`` as it goes, and says what it saw.

    It calls the environment within ``_calling``, so that an error names the episode.

    Args: found: shape, dtype and greatest value of each entry of the environment's observations.
    entries: names of its frames by ours ("rgb", "depth", "pose"), and of whatever else the agent
    reads, by the names that it reads ("goal"). success: the entry that says at
    the end whether it went well, or a function of the :class:`Ending`; None: the entry "success".
    unit: metres of one unit of depth, which whole numbers need, and depth that ends at 1 or below;
    None: 1. limit: steps after which an episode is cut; None: the environment ends it. Measures
    then say ``limit``, and whether it ``cut`` the episode before the environment ended it. rule:
    what success means, in words, for the rows; None: the entry's name. A function needs it.

    Depth that is not finite or below 0 reads 0, no reading. Raises ValueError if an entry is not
    there, frames have other shapes than the suite takes, RGB is not uint8, ``unit`` or ``limit`` is
    invalid, or a ``success`` function has no ``rule``; at the end of an episode that does not
    report success; for the first depth of an episode if that cannot be metres; for frames of
    another shape or type than the environment says; and in place of any error of the environment.
    """

    done = True

    def __init__(
        self,
        found: Mapping[str, tuple[tuple[int, ...], str, float]],
        entries: Mapping[str, str],
        success: Success | None,
        unit: float | None,
        limit: int | None,
        rule: str | None,
    ) -> None:
        if limit is not None and (type(limit) is not int or limit < 1):
            raise ValueError(
                f"limit must be a whole number of steps >= 1 or None, got {limit!r}. None lets the "
                "environment end its episodes."
            )
        _check_success(success, rule)
        self.entries = dict(entries)
        self.success: Success = "success" if success is None else success
        self.unit, self.limit = 1.0 if unit is None else unit, limit
        self.rule = rule or f"{self.success} at the end"
        named = self.entries.items()
        lacking = [repr(entry) if entry else name for name, entry in named if entry not in found]
        if lacking or not self.entries:
            raise ValueError(
                f"The observation has no array {', '.join(lacking) or 'rgb or depth'}; it has "
                f"{', '.join(map(str, found)) or 'none'}. Name its frames: "
                "entries={'rgb': 'image'}."
            )
        self.sensors: dict[str, Sensor] = {}
        for name, entry in self.entries.items():
            shape, dtype, most = found[entry]
            if name == DEPTH:
                _check_unit(entry, dtype, most, unit)
            of_depth = {"unit": "m", "high": most * self.unit} if name == DEPTH else {}
            self.sensors[name] = Sensor(name, tuple(shape), dtype, **of_depth)  # type: ignore[arg-type]
        if RGB in self.sensors and self.sensors[RGB].dtype != "uint8":
            raise ValueError(
                f"RGB must be uint8 in 0-255, but it is {self.sensors[RGB].dtype}: take off what "
                "scales or transposes frames."
            )
        for name in [name for name in (RGB, DEPTH) if name in self.sensors]:
            _check_shape(name, self.entries[name], self.sensors[name].shape)

    def _check_going(self) -> None:
        """Raise RuntimeError after the last step of an episode."""
        if self.done:
            raise RuntimeError("The episode is over: reset first.")

    def measures(self) -> dict[str, float]:
        """Return success, spl (the same: no shortest path is known), steps; with a limit also
        whether it cut the episode, and the limit."""
        won = int(self.done and self._won())
        found = {"success": won, "spl": float(won), "steps": self._steps}
        if self.limit is None:
            return found
        return found | {"cut": int(self._cut), "limit": self.limit}

    def _begin(self, episode: Episode) -> int:
        """Count from 0 again; the seed of an episode, ``info["seed"]`` or else made of its id."""
        self.done = self._cut = False
        self._name = episode.episode_id
        self._reward = self._total = 0.0
        self._steps = 0
        seed = episode.info.get("seed", digest("episode", episode.episode_id))
        return int(seed) % 2**31

    def _end_step(self, reward: float, over: bool) -> None:
        """Count a step. Raises ValueError if the environment ended the episode and does not say
        whether it succeeded, and for a reward that is NaN where success is asked of a function."""
        if math.isnan(reward) and callable(self.success):
            raise ValueError(
                f"The reward of step {self._steps + 1} of episode {self._name} must be a number, "
                "got NaN: no success function can compare it."
            )
        self._reward = reward
        self._total += reward
        self._steps += 1
        self._cut = not over and self.limit is not None and self._steps >= self.limit
        self.done = over or self._cut
        if over and isinstance(self.success, str) and self.success not in self._report():
            raise ValueError(
                f"At the end of episode {self._name} the environment must report success, but it "
                f"has no entry {self.success!r}, only "
                f"{', '.join(map(repr, self._report())) or 'none'}. Give success= the name of an "
                "entry, which says False for a failure, or a function, such as "
                'success=lambda end: end.total > 0, rule="return > 0".'
            )

    def _report(self) -> Mapping[str, Any]:
        """What the environment reported with the last step."""
        raise NotImplementedError(f"{type(self).__name__} defines no _report()")

    def _won(self) -> bool:
        if isinstance(self.success, str):
            answer, source = self._report().get(self.success, False), f"The entry {self.success!r}"
        else:
            source = "The success function"
            end = Ending(self._report(), self._reward, self._total, self._steps)
            with self._calling(source):
                answer = self.success(end)
        return _truth(answer, source, self._name)

    @contextmanager
    def _calling(self, what: str) -> Iterator[None]:
        """Raise ValueError, naming the episode, in place of any error of the user's code inside."""
        try:
            yield
        except MemoryError:  # explained by core/errors.py
            raise
        except Exception as error:
            place = own_place(error)
            cause = " ".join(str(error).split())[:300]
            raise ValueError(
                f"{what} raised {type(error).__name__} in episode {self._name}: {cause}"
                f"{f' (raised in {place})' if place else ''}"
            ) from error

    def _observation(self, seen: Mapping[str, Any]) -> Observation:
        """Copies: an environment may use its buffers again."""
        frames = {name: np.array(seen[entry]) for name, entry in self.entries.items()}
        for name in {RGB, DEPTH}.intersection(frames):
            self._check_frame(name, frames[name])
        if DEPTH in frames:
            frames[DEPTH] = self._metres(frames[DEPTH])
        pose = {POSE: frames.pop(POSE)} if POSE in frames else {}
        return Observation(pose, lambda: frames, tuple(frames))

    def _check_frame(self, name: str, frame: np.ndarray) -> None:
        """Raise ValueError for a frame that is not what the environment's space says."""
        sensor = self.sensors[name]
        if frame.shape != sensor.shape or (name == RGB and frame.dtype != np.uint8):
            raise ValueError(
                f"The {name} frame after step {self._steps} of episode {self._name} must be "
                f"{sensor.dtype} {list(sensor.shape)}, as the environment's space says, got "
                f"{frame.dtype} {list(frame.shape)}."
            )

    def _metres(self, depth: np.ndarray) -> np.ndarray:
        """Depth as float32 metres; of the first in an episode it is asked whether it can be."""
        metres = depth.astype(np.float32) * np.float32(self.unit)
        metres = np.where(np.isfinite(metres) & (metres > 0), metres, np.float32(0))
        if self._steps == 0:
            unit = "Give unit=, the metres of one unit of it (0.001 for millimetres)."
            check_metres(metres, "the depth", unit)
        return metres


def _truth(told: Any, source: str, episode: str) -> bool:
    """Return whether what ``source`` said, or any part of it, is true; None is false.

    Raises ValueError for what is neither a truth value nor 0 or 1.
    """
    try:
        parts = np.asarray(told).ravel().tolist()
        valid = all(part is None or part in (0, 1) for part in parts)
    except (ValueError, TypeError):  # a ragged list, or an object that is no number
        parts, valid = [], False
    if not valid:
        raise ValueError(
            f"{source} says {told!r:.80} at the end of episode {episode}, and success must be a "
            "truth value, or 0 or 1 (or an array or a list of these). Give success= a function "
            'that compares it, such as success=lambda end: end.info["score"] >= 0.5, with '
            'rule="score >= 0.5".'
        )
    return any(parts)


def _check_success(success: Any, rule: str | None) -> None:
    """Raise ValueError for what cannot say whether an episode succeeded."""
    if callable(success) and not rule:
        raise ValueError(
            "A success function needs rule=, what counts as success in words, such as "
            'rule="return > 0": rows and tables show it.'
        )
    if not (success is None or callable(success) or (isinstance(success, str) and success)):
        raise ValueError(
            f"success must be the name of an entry or a function, got {success!r:.80}. Give "
            'success="is_success", or success=lambda end: end.total > 0 with rule="return > 0".'
        )


def _check_shape(name: str, entry: str, shape: tuple[int, ...]) -> None:
    """Raise ValueError for frames that the suite does not take: ``corruptions/suite.py``."""
    flat = name == DEPTH and len(shape) == 2
    if flat or (len(shape) in (3, 4) and shape[-1] == (3 if name == RGB else 1)):
        return
    channels = "3" if name == RGB else "1"
    raise ValueError(
        f"The {name} frames{f' {entry!r}' if entry else ''} have the shape {list(shape)}, and it "
        f"must be [H, W, {channels}], or [views, H, W, {channels}] for a panorama: channels last, "
        "no alpha, no grey, no stack. Wrap the environment "
        "(gymnasium.wrappers.TransformObservation)."
    )


def _check_unit(entry: str, dtype: str, most: float, unit: float | None) -> None:
    """Raise ValueError for a unit of depth that is none, or is not said and must be."""
    if unit is not None and not (type(unit) in (int, float) and 0 < unit < math.inf):
        raise ValueError(f"unit={unit!r} is no unit of depth: give a number of metres above 0.")
    if unit is None and not dtype.startswith("float"):
        raise ValueError(
            f"The depth {entry!r} is {dtype}, which may be anything: give unit=, the metres of one "
            "unit of it (0.001 for millimetres)."
        )
    if unit is None and most <= 1:
        raise ValueError(
            f"The depth {entry!r} ends at {most:g}, as depth does that is normalised to [0, 1] "
            "(habitat does so): give unit=, the metres of 1 (10 for a sensor of 0 to 10 m), or "
            "unit=1.0 if it is in metres."
        )
