"""Use a gymnasium environment as a world. Its observations must contain frames."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from mitigate.core.spaces import ActionSpace, from_gymnasium
from mitigate.worlds.seeded import WHOLE, Arrays, SeededWorld


class GymWorld(SeededWorld):
    """World that wraps a gymnasium environment.

    The arguments are the same as for :class:`~mitigate.worlds.seeded.SeededWorld`. The observation
    of ``env`` is an RGB frame (uint8 [H, W, 3] or [V, H, W, 3]) or a ``Dict`` that contains such a
    frame. ``success`` is the name of an entry of ``info``, or a function.
    """

    def _spaces(self, env: Any) -> tuple[ActionSpace, Arrays]:
        arrays = {}
        for name, space in _by_name(env.observation_space).items():
            # Text and Tuple spaces have no shape, and they contain no frames
            if space.shape is not None:
                high = float(np.max(getattr(space, "high", np.inf)))
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
    """Return a dict from dotted names to the parts of an observation or space.

    If it has no parts, the only name is ``WHOLE``.
    """
    # spaces of gymnasium, gym and similar libraries share attribute names but no base class
    parts = getattr(observation, "spaces", observation)
    if not isinstance(parts, Mapping):
        return {WHOLE: observation}
    return {
        f"{name}.{inner}".rstrip("."): part
        for name, value in parts.items()
        for inner, part in _by_name(value).items()
    }
