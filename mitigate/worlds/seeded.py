"""What worlds made of other libraries' environments share: an episode is a seed."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

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


class SeededWorld(World):
    """A subclass sets ``_steps``, ``_reward`` and ``done`` as it goes, and says what it saw.

    Args: found: shape, dtype and greatest value of each entry of the environment's observations.
    entries: names of its frames by ours ("rgb", "depth", "pose"), and of whatever else the agent
    reads, by the names that it reads ("goal"). success: the entry that says at
    the end whether it went well; None: a reward above 0 in the last step. unit: metres of one unit
    of depth, which whole numbers need, and depth that ends at 1 or below; None: 1. limit: steps
    after which an episode is over at the latest. rule: what success means, in words, for the rows;
    None: what ``success`` says.

    Depth that is not finite or below 0 reads 0, no reading. Raises ValueError if an entry is not
    there, frames have other shapes than the suite takes, RGB is not uint8, or ``unit`` or ``limit``
    is none; and for the first depth of an episode if that cannot be metres.
    """

    done = True

    def __init__(
        self,
        found: Mapping[str, tuple[tuple[int, ...], str, float]],
        entries: Mapping[str, str],
        success: str | None,
        unit: float | None,
        limit: int,
        rule: str | None,
    ) -> None:
        if type(limit) is not int or limit < 1:
            raise ValueError(f"limit={limit!r} must be a whole number of steps, 1 or more.")
        self.entries, self.success = dict(entries), success
        self.unit, self.limit = 1.0 if unit is None else unit, limit
        self.rule = rule or (f"{success} at the end" if success else "reward > 0 at the end")
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
        """success, spl (the same: no shortest path is known) and steps."""
        won = int(self.done and self._won())
        return {"success": won, "spl": float(won), "steps": self._steps}

    def _begin(self, episode: Episode) -> int:
        """Count from 0 again; the seed of an episode, ``info["seed"]`` or else made of its id."""
        self.done, self._reward, self._steps = False, 0.0, 0
        seed = episode.info.get("seed", digest("episode", episode.episode_id))
        return int(seed) % 2**31

    def _end_step(self, reward: float, over: bool) -> None:
        self._reward, self._steps = reward, self._steps + 1
        self.done = over or self._steps >= self.limit

    def _flag(self) -> bool:
        """What the entry ``success`` says."""
        raise NotImplementedError(f"{type(self).__name__} defines no _flag()")

    def _won(self) -> bool:
        return self._reward > 0 if self.success is None else self._flag()

    def _observation(self, seen: Mapping[str, Any]) -> Observation:
        """Copies: an environment may use its buffers again."""
        frames = {name: np.array(seen[entry]) for name, entry in self.entries.items()}
        if DEPTH in frames:
            frames[DEPTH] = self._metres(frames[DEPTH])
        pose = {POSE: frames.pop(POSE)} if POSE in frames else {}
        return Observation(pose, lambda: frames, tuple(frames))

    def _metres(self, depth: np.ndarray) -> np.ndarray:
        """Depth as float32 metres; of the first in an episode it is asked whether it can be."""
        metres = depth.astype(np.float32) * np.float32(self.unit)
        metres = np.where(np.isfinite(metres) & (metres > 0), metres, np.float32(0))
        if self._steps == 0:
            unit = "Give unit=, the metres of one unit of it (0.001 for millimetres)."
            check_metres(metres, "the depth", unit)
        return metres


def _check_shape(name: str, entry: str, shape: tuple[int, ...]) -> None:
    """Raise ValueError for frames that the suite does not take: ``corruptions/views.py``."""
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
