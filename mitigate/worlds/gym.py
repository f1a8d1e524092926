"""Any gymnasium environment that shows frames as a world, to evaluate in under the suite."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from mitigate.core.observation import DEPTH, POSE, RGB, Observation
from mitigate.worlds.episodes import Episode
from mitigate.worlds.seeded import SeededWorld, Success

WHOLE = ""  # the name of an observation that is one frame


class GymWorld(SeededWorld):
    """Args:
    env: with discrete actions. Its observation is an RGB frame (uint8 [H, W, 3] or [V, H, W, 3]) or
    a ``Dict`` that holds one.
    entries: of a ``Dict``, by default those that are called "rgb", "depth" and "pose"; one within
    another is "camera.rgb". success: an entry of ``info``, or a function. The others: as
    ``SeededWorld``.

    Raises ValueError as ``SeededWorld`` does, and for actions that are not discrete.
    """

    def __init__(
        self,
        env: Any,
        entries: Mapping[str, str] | None = None,
        *,
        success: Success | None = None,
        unit: float | None = None,
        limit: int | None = None,
        rule: str | None = None,
    ) -> None:
        space = env.action_space
        if _attribute(space, "n") is None or _attribute(space, "shape", ()) != ():
            raise ValueError(
                f"The actions {env.action_space} are not discrete, and an agent answers with one "
                "whole number: wrap the environment in a gymnasium.ActionWrapper with a Discrete "
                "action_space, whose action() says what each number does."
            )
        boxes = _by_name(env.observation_space)
        known = {RGB: WHOLE} if WHOLE in boxes else {n: n for n in (RGB, DEPTH, POSE) if n in boxes}
        most = {n: np.max(_attribute(b, "high", np.inf)) for n, b in boxes.items()}
        arrays = {n: b for n, b in boxes.items() if b.shape is not None}  # no text, no Tuple
        found = {n: (b.shape, str(b.dtype), float(most[n])) for n, b in arrays.items()}
        super().__init__(found, entries or known, success, unit, limit, rule)
        self.env = env

    def reset(self, episode: Episode) -> Observation:
        seed = self._begin(episode)
        with self._calling(f"{type(self.env).__name__}.reset()"):
            seen, self._info = self.env.reset(seed=seed)
            parts = _by_name(seen)
        return self._observation(parts)

    def step(self, action: int) -> Observation:
        """Raises ValueError for an action that the environment does not have, and at the end of an
        episode whose ``info`` does not say ``success``."""
        self._check_going()
        space = self.env.action_space
        if not 0 <= action < space.n:
            raise ValueError(f"Unknown action {action}: the environment has {space.n}.")
        first = int(_attribute(space, "start", 0))
        with self._calling(f"{type(self.env).__name__}.step()"):
            seen, reward, terminated, truncated, info = self.env.step(action + first)
            reward, over, parts = float(reward), bool(terminated or truncated), _by_name(seen)
            self._info = dict(info)
        self._end_step(reward, over)
        return self._observation(parts)

    def _report(self) -> Mapping[str, Any]:
        return self._info


def _by_name(seen: Any) -> dict[str, Any]:
    """The parts of an observation, or of its space, by dotted name; ``WHOLE`` if it has none."""
    parts = _attribute(seen, "spaces", seen)
    if not isinstance(parts, Mapping):
        return {WHOLE: seen}
    return {
        f"{name}.{inner}".rstrip("."): part
        for name, value in parts.items()
        for inner, part in _by_name(value).items()
    }


def _attribute(space: Any, name: str, default: Any = None) -> Any:
    """Return an attribute of a space, which may be of gymnasium, of gym or of another class."""
    return getattr(space, name, default)  # these libraries share attributes, not classes
