"""Follow a route of plan positions with low-level actions, using only odometry."""

from __future__ import annotations

import numpy as np

from mitigate.core.observation import FORWARD, LEFT, RIGHT, TURN_DEGREES

_ARRIVED = 0.18  # distance in metres at which a position counts as reached; a step is 0.25 m
_STUCK = 0.05  # a forward step that moves less than this distance (metres) counts as blocked
_PATIENCE = 2  # number of blocked steps before the agent skips a position


class Controller:
    """Controller that follows one route at a time; ``action`` is None when the route is done."""

    def __init__(self) -> None:
        self.route: list[np.ndarray] = []
        self._last: np.ndarray | None = None
        self._blocked = 0
        self._budget = 0

    def follow(self, route: list[np.ndarray]) -> None:
        """Start to follow a route (list of positions [x, y] in metres)."""
        self.route = [np.array(p, np.float64) for p in route]
        self._last, self._blocked, self._budget = None, 0, 40 * max(1, len(route))

    def action(self, pose: np.ndarray) -> int | None:
        """Return the next low-level action from pose [3], or None at the end of the route."""
        # copied, because a world may change its pose array in place
        xy = np.array(pose[:2], np.float64)
        if self._last is not None:
            self._blocked = self._blocked + 1 if np.hypot(*(xy - self._last)) < _STUCK else 0
            self._last = None
        while self.route and (
            np.hypot(*(self.route[0] - xy)) < _ARRIVED or self._blocked >= _PATIENCE
        ):
            self.route.pop(0)
            self._blocked = 0
        self._budget -= 1
        if not self.route or self._budget < 0:
            self.route = []
            return None
        offset = self.route[0] - xy
        error = np.degrees(np.arctan2(-offset[0], offset[1]) - float(pose[2]))
        error = (error + 180.0) % 360.0 - 180.0
        if abs(error) > TURN_DEGREES / 2 + 0.1:
            return LEFT if error > 0 else RIGHT
        self._last = xy
        return FORWARD
