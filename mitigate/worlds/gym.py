"""Use a gymnasium environment with frames as a world."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from mitigate.core.spaces import ActionSpace, from_gymnasium
from mitigate.worlds.seeded import WHOLE, Arrays, SeededWorld


class GymWorld(SeededWorld):
    """World that wraps a gymnasium environment.

    The arguments are those of :class:`~mitigate.worlds.seeded.SeededWorld`. The observation of
    ``env`` is an RGB frame (uint8 [H, W, 3] or [V, H, W, 3]) or a ``Dict`` that contains such a
    frame. ``success`` names an entry in ``info``, or is a function.
    """

    def _spaces(self, env: Any) -> tuple[ActionSpace, Arrays]:
        arrays = {}
        for name, space in _by_name(env.observation_space).items():
            if space.shape is not None:  # Text and Tuple spaces have no shape
                high = float(np.max(_attribute(space, "high", np.inf)))
                arrays[name] = (space.shape, str(space.dtype), high)
        return from_gymnasium(env.action_space), arrays

    def _reset_env(self, seed: int) -> dict[str, Any]:
        observation, self._info = self.env.reset(seed=seed)
        return _by_name(observation)

    def _step_env(self, action: Any) -> tuple[dict[str, Any], float, bool]:
        observation, reward, terminated, truncated, info = self.env.step(action)
        self._info = dict(info)
        self.terminated = bool(terminated)
        return _by_name(observation), float(reward), bool(terminated or truncated)

    def _report(self) -> Mapping[str, Any]:
        return self._info


def _by_name(observation: Any) -> dict[str, Any]:
    """Return the parts of an observation or space by dotted name, or ``WHOLE`` if it has no
    parts.
    """
    parts = _attribute(observation, "spaces", observation)
    if not isinstance(parts, Mapping):
        return {WHOLE: observation}
    return {
        f"{name}.{inner}".rstrip("."): part
        for name, value in parts.items()
        for inner, part in _by_name(value).items()
    }


def _attribute(space: Any, name: str, default: Any = None) -> Any:
    """Return an attribute of a space, which may be a class of gymnasium, gym or another library."""
    # these libraries have common attributes but no common classes
    return getattr(space, name, default)
