"""Any gymnasium environment that shows frames as a world, to evaluate in under the suite."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from mitigate.core.observation import DEPTH, POSE, RGB, Observation, Sensor
from mitigate.core.seeding import digest
from mitigate.worlds.episodes import Episode


class GymWorld:
    """An episode is a seed: ``info["seed"]`` of it, or else a number made of its id.

    Args:
        env: a gymnasium environment with discrete actions. Its observation is an RGB frame (uint8
            [H, W, 3] or [V, H, W, 3]) or a ``Dict`` that holds one.
        entries: names of the entries of a ``Dict`` by ours ("rgb", "depth", "pose"); by default
            those that are called so.
        success: the entry of ``info`` that says at the end whether it went well; None: a reward
            above 0 in the last step. unit: metres of one unit of depth. rule: what success means,
            in words, for the rows. limit: steps after which an episode is over at the latest.

    Raises ValueError for an environment without frames or with actions that are not discrete.
    """

    def __init__(
        self,
        env: Any,
        entries: Mapping[str, str] | None = None,
        *,
        success: str | None = None,
        unit: float = 1.0,
        limit: int = 500,
        rule: str = "reward > 0 at the end",
    ) -> None:
        if not hasattr(env.action_space, "n"):
            raise ValueError(
                f"The actions {env.action_space} are not discrete: wrap the environment."
            )
        self.env, self.rule, self.unit, self.success, self.limit = env, rule, unit, success, limit
        space = env.observation_space
        boxes = dict(space.spaces) if hasattr(space, "spaces") else {"": space}
        whole = {RGB: ""} if "" in boxes else {n: n for n in (RGB, DEPTH, POSE) if n in boxes}
        self.entries = dict(entries or whole)
        lacking = [entry for entry in self.entries.values() if entry not in boxes]
        if lacking or not self.entries:
            raise ValueError(
                f"The observation has no entry {', '.join(lacking) or 'rgb or depth'}; it has "
                f"{', '.join(boxes)}. Name its frames: entries={{'rgb': 'image'}}."
            )
        self.sensors = {
            name: _sensor_of(name, boxes[entry], unit) for name, entry in self.entries.items()
        }
        if RGB in self.sensors and self.sensors[RGB].dtype != "uint8":
            raise ValueError(
                f"RGB must be uint8 in 0-255, but its space is {boxes[self.entries[RGB]]}: "
                "take wrappers that scale or transpose frames off."
            )
        self.done = True

    def reset(self, episode: Episode) -> Observation:
        seed = episode.info.get("seed", digest("episode", episode.episode_id))
        seen, self._info = self.env.reset(seed=int(seed) % 2**31)
        self.done, self._reward, self._steps = False, 0.0, 0
        return self._observation(seen)

    def step(self, action: int) -> Observation:
        """Raises ValueError for an action that the environment does not have."""
        if not 0 <= action < self.env.action_space.n:
            raise ValueError(
                f"Unknown action {action}: the environment has {self.env.action_space.n}."
            )
        first = int(getattr(self.env.action_space, "start", 0))
        seen, reward, terminated, truncated, self._info = self.env.step(action + first)
        self._steps += 1
        self.done = bool(terminated or truncated) or self._steps >= self.limit
        self._reward = float(reward)
        return self._observation(seen)

    def measures(self) -> dict[str, float]:
        """success, spl (the same: no shortest path is known) and steps."""
        won = self._reward > 0 if self.success is None else bool(self._info.get(self.success))
        return {
            "success": int(won and self.done),
            "spl": float(won and self.done),
            "steps": self._steps,
        }

    def expert(self) -> None:
        return None

    def truth(self) -> dict[str, np.ndarray]:
        return {}

    def _observation(self, seen: Any) -> Observation:
        held = seen if isinstance(seen, Mapping) else {"": seen}
        frames = {name: np.array(held[entry]) for name, entry in self.entries.items()}
        if DEPTH in frames:
            frames[DEPTH] = frames[DEPTH].astype(np.float32) * np.float32(self.unit)
        pose = {POSE: frames.pop(POSE)} if POSE in frames else {}
        return Observation(pose, lambda: frames, tuple(frames))


def _sensor_of(name: str, box: Any, unit: float) -> Sensor:
    shape, dtype = tuple(box.shape), str(box.dtype)
    if name == DEPTH:
        return Sensor(name, shape, dtype, "m", high=float(np.max(box.high)) * unit)
    return Sensor(name, shape, dtype)
