"""Replace empty frames by the last frame that was not empty, with ``restore=hold``.

A receiver without this guard passes a lost frame on as black pixels or as depth without a reading,
which an agent takes for a dark room or an open space. This module does not need torch.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from mitigate.core.observation import DEPTH, RGB
from mitigate.guards.frames.choices import HOLD
from mitigate.guards.guard import Guard

# maximum repetitions of a view in a row; the view becomes outdated while the robot moves
LIMIT = 10


class HoldLast(Guard):
    """Repeat the last view of a camera in place of an empty one.

    An RGB view is empty if all its values are 0. A depth view is empty if it has no finite reading
    above 0. Each view of a panorama is treated separately. A view is repeated at most ``limit``
    times in a row; after that, the agent receives the empty view.
    """

    label = HOLD
    frames = (RGB, DEPTH)

    def __init__(self, limit: int = LIMIT) -> None:
        self.limit = limit
        self._views: dict[str, np.ndarray] = {}  # last view of each camera that was not empty
        # number of empty observations since the last view that was not empty
        self._ages: dict[str, np.ndarray] = {}

    def for_episode(self) -> HoldLast:
        return HoldLast(self.limit)

    def observe(self, observation: Mapping[str, Any]) -> Mapping[str, Any]:
        changed = {}
        for name in self.frames:
            if name in observation:
                frame = observation[name]
                views = frame if frame.ndim == 4 else frame[None]
                repeated = self._hold(name, views)
                if repeated is not views:
                    changed[name] = repeated.reshape(frame.shape)
        return {**observation, **changed} if changed else observation

    def _hold(self, name: str, views: np.ndarray) -> np.ndarray:
        """Return ``views`` [V, H, W, C] with empty views replaced where possible."""
        signal = np.isfinite(views) & (views > 0) if name == DEPTH else views > 0
        empty = ~signal.any(axis=(1, 2, 3))
        last = self._views.get(name)
        if last is None or last.shape != views.shape:
            self._views[name] = views.copy()
            self._ages[name] = np.where(empty, self.limit, 0)
            return views
        self._ages[name] = ages = np.where(empty, self._ages[name] + 1, 0)
        last[~empty] = views[~empty]
        repeated = empty & (ages <= self.limit)
        if not repeated.any():
            return views
        return np.where(repeated[:, None, None, None], last, views)
