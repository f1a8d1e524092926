"""Use a gymnasium environment with frames as a world."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from mitigate.core.observation import DEPTH, POSE, RGB
from mitigate.core.spaces import from_gymnasium
from mitigate.worlds.seeded import WHOLE, SeededWorld, Success


class GymWorld(SeededWorld):
    """World that wraps a gymnasium environment.

    Args:
        env: An environment. Its observation is an RGB frame (uint8 [H, W, 3]
            or [V, H, W, 3]) or a ``Dict`` that contains such a frame.
        entries: Names of the entries of a ``Dict``, by default "rgb", "depth" and "pose". Nested
            entries are written as "camera.rgb".
        success: Name of an entry in ``info``, or a function.
        unit: See :class:`~mitigate.worlds.seeded.SeededWorld`.
        limit: See ``SeededWorld``.
        rule: See ``SeededWorld``.
        score: See ``SeededWorld``.
        extra: See ``SeededWorld``.
        hfov: See ``SeededWorld``.

    Raises:
        ValueError: The action space is not supported by ``core/spaces.py``, or an error of
            ``SeededWorld``.
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
        score: str = "success",
        extra: Sequence[str] = (),
        hfov: float | None = None,
    ) -> None:
        spaces = _by_name(env.observation_space)
        default = {n: n for n in (RGB, DEPTH, POSE) if n in spaces}
        if WHOLE in spaces:
            default = {RGB: WHOLE}
        arrays = {}
        for name, space in spaces.items():
            if space.shape is not None:  # Text and Tuple spaces have no shape
                high = float(np.max(_attribute(space, "high", np.inf)))
                arrays[name] = (space.shape, str(space.dtype), high)
        super().__init__(
            env,
            from_gymnasium(env.action_space),
            arrays,
            entries or default,
            success,
            unit,
            limit,
            rule,
            score,
            extra,
            hfov,
        )

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
