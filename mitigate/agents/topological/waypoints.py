"""Depth-only waypoint predictor: 12 views to 120 angles x 12 distances to at most 6 waypoints.

Angles are clockwise from view 0 in steps of 3 degrees: bin ``10 k + i`` looks at
``30 k - 15 + 3 (i + 0.5)`` degrees to the right of the heading. Distances are 0.25 ... 3 m. A cell
is positive where the agent can go straight to that distance. The layout follows ETPNav's
predictor; the target here is the free space itself.
"""

from __future__ import annotations

import numpy as np
import torch.nn.functional as F
from torch import Tensor, nn

from mitigate.core.observation import VIEWS

ANGLES, DISTANCES = 120, 12
STEP = 0.25  # metres a distance bin
_PER_VIEW = ANGLES // VIEWS
YAWS = np.radians(3.0 * (np.arange(ANGLES) + 0.5) - 15.0)  # clockwise from the heading
COUNT, SEPARATION = 6, 8  # waypoints at most; bins (24 degrees) between two of them
SHORTEST, LONGEST = 0.5, 2.25  # metres to a waypoint
_MARGIN = 0.25  # metres kept before an obstacle


class WaypointHead(nn.Module):
    """Depth features ``[n, 12, width]`` to logits ``[n, 120, 12]``; circular over the views."""

    def __init__(self, width: int = 128, hidden: int = 160) -> None:
        super().__init__()
        self.first = nn.Conv1d(width, hidden, 3, padding=1, padding_mode="circular")
        self.second = nn.Conv1d(hidden, hidden, 3, padding=1, padding_mode="circular")
        self.out = nn.Conv1d(hidden, _PER_VIEW * DISTANCES, 1)

    def forward(self, features: Tensor) -> Tensor:
        x = F.gelu(self.first(features.transpose(1, 2)))
        x = x + F.gelu(self.second(x))
        return self.out(x).transpose(1, 2).reshape(-1, ANGLES, DISTANCES)


def select(logits: np.ndarray) -> np.ndarray:
    """Waypoints of one panorama from logits float [120, 12]: float32 [n <= 6, 2] = (yaw, metres).

    The free length of each angle (smoothed over neighbours) is its score; greedy non-maximum
    suppression keeps directions ``SEPARATION`` bins apart. ``yaw`` is clockwise from the heading.
    """
    sure = 1.0 / (1.0 + np.exp(-np.clip(logits, -30, 30)))
    length = STEP * np.cumprod(sure > 0.5, axis=1).sum(1)
    soft = STEP * np.cumprod(sure, axis=1).sum(1)
    score = (soft + 0.5 * (np.roll(soft, 1) + np.roll(soft, -1))) / 2
    left = np.where(length - _MARGIN >= SHORTEST, score, -1.0)
    chosen: list[tuple[float, float]] = []
    while len(chosen) < COUNT and left.max() > 0:
        best = int(left.argmax())
        chosen.append((YAWS[best], min(float(length[best]) - _MARGIN, LONGEST)))
        left[(best + np.arange(-SEPARATION, SEPARATION + 1)) % ANGLES] = -1.0
    return np.array(chosen, np.float32).reshape(-1, 2)
