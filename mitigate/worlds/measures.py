"""Compute the measures of an episode with the formulas of VLN-CE, and apply success rules.

Paths are ``[N, 2]`` or ``[N, 3]`` arrays of positions in metres. If a function takes two paths,
both must use the same coordinate frame. Distances to the goal are geodesic and measured by the
simulator.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

# in metres; the value of TASK.SUCCESS_DISTANCE in VLN-CE for R2R-CE and RxR-CE
SUCCESS_DISTANCE = 3.0


@dataclass(frozen=True)
class Rule:
    """A success rule: an episode succeeds if it ends within ``metres`` of the goal.

    Attributes:
        name: Name of the benchmark that uses the rule.
        metres: Maximum distance.
        stop: Whether the agent must end the episode with the action STOP.
        inclusive: Whether a distance of exactly ``metres`` is a success.
        view_points: Whether the distance is measured to the nearest point from which the goal is
            visible. If false, it is measured to the goal itself.
    """

    name: str
    metres: float
    stop: bool = True
    inclusive: bool = False
    view_points: bool = False

    @property
    def stop_within(self) -> float:
        """Distance in metres at which an oracle stops: 1 m (heuristic), or the distance of the rule
        if that is smaller.
        """
        return min(1.0, self.metres)

    @property
    def path_metres(self) -> float:
        """Threshold of nDTW in metres, which is the success distance of the rule.

        A rule that uses view points measures distances to them, not to the reference path. Its
        threshold is therefore the success distance of VLN-CE.
        """
        return SUCCESS_DISTANCE if self.view_points else self.metres

    def met(self, distance: float, stopped: bool) -> bool:
        """Return whether an episode that ends ``distance`` metres from the goal succeeds.

        An infinite distance means that the goal is unreachable, and counts as a failure.

        Raises:
            ValueError: If the distance is NaN.
        """
        if math.isnan(distance):
            raise ValueError(
                "The distance to the goal must be metres, or inf if it is unreachable, got nan."
            )
        near = distance <= self.metres if self.inclusive else distance < self.metres
        return bool(near and (stopped or not self.stop))

    def __str__(self) -> str:
        """Return the text that describes the rule in result rows and tables."""
        distance = f"geodesic {'<=' if self.inclusive else '<'} {float(self.metres)} m"
        distance += " to a view point" if self.view_points else ""
        return f"{self.name}: {f'STOP and {distance}' if self.stop else f'{distance}, STOP or not'}"


RULES = {  # success rules by option value; docs/agents.md lists the source of each rule
    "vln_ce": Rule("vln", SUCCESS_DISTANCE),
    "etpnav": Rule("etpnav", 3.0, stop=False, inclusive=True),
    "habitat_vln": Rule("habitat-lab vln", 0.2),
    "objectnav": Rule("objectnav", 0.1, view_points=True),
    "wmnav": Rule("wmnav", 1.0, stop=False, view_points=True),
}


def path_length(path: ArrayLike) -> float:
    """Return the Euclidean length of ``path`` in metres."""
    steps = np.diff(_points(path, "path"), axis=0)
    return float(np.sqrt((steps**2).sum(axis=1)).sum())


def spl(succeeded: bool, geodesic_distance: float, length: float) -> float:
    """Return success weighted by path length (SPL, Anderson et al., 2018): S times ``L* / max(L*,
    L)``.

    If the episode starts at its goal (L* = 0) and the agent does not move, the result is S.

    Args:
        succeeded: whether the episode succeeded (S).
        geodesic_distance: L*, distance in metres from start to goal.
        length: L, length of the agent's path in metres.

    Raises:
        ValueError: If a length is negative or not finite.
    """
    for name, metres in (("geodesic distance", geodesic_distance), ("path length", length)):
        if not 0 <= metres < math.inf:
            raise ValueError(f"The {name} of SPL must be finite and >= 0 metres, got {metres}.")
    longer = max(geodesic_distance, length)
    return float(succeeded) * (geodesic_distance / longer if longer else 1.0)


def dtw(path: ArrayLike, reference: ArrayLike) -> float:
    """Return the dynamic time warping cost of the two paths, in metres.

    The exact value is computed along the anti-diagonals of the cost matrix. VLN-CE uses
    ``fastdtw``, whose approximate cost is never smaller.
    """
    a = _points(path, "path")
    b = _points(reference, "reference path")
    if a.shape[1] != b.shape[1]:
        raise ValueError(
            f"Both paths must have 2 or 3 coordinates, got {a.shape[1]} and {b.shape[1]}."
        )
    rows, columns = len(a), len(b)
    cost = np.sqrt(((a[:, None] - b[None]) ** 2).sum(axis=2))[:, ::-1]
    # These are the costs of the anti-diagonals d - 2 and d - 1.
    # Entry [i + 1] is the cost of matrix element (i, d - i).
    before, last = np.full((2, rows + 1), np.inf)
    before[0] = 0.0
    for d in range(rows + columns - 1):
        first, end = max(0, d - columns + 1), min(rows, d + 1)
        best = np.minimum(before[first:end], last[first:end])
        np.minimum(best, last[first + 1 : end + 1], out=best)
        before, last = last, np.full(rows + 1, np.inf)
        last[first + 1 : end + 1] = best + cost.diagonal(columns - 1 - d)
    return float(last[rows])


def ndtw(path: ArrayLike, reference: ArrayLike, *, threshold: float = SUCCESS_DISTANCE) -> float:
    """Return nDTW, ``exp(-DTW / (n * threshold))`` for n reference points (Ilharco et al., 2019).

    As in VLN-CE, consecutive equal positions count once. Turns and collisions cause such positions.
    """
    points = _points(path, "path")
    moved = np.append(True, np.any(np.diff(points, axis=0) != 0, axis=1))
    count = len(_points(reference, "reference path"))
    return math.exp(-dtw(points[moved], reference) / (count * threshold))


def of_episode(
    rule: Rule, path: ArrayLike, reference: ArrayLike, *, start: float, left: float, stopped: bool
) -> dict[str, float]:
    """Return the measures of an episode: success, SPL, nDTW, and lengths in metres.

    Infinite distances are left out, and so is nDTW if ``reference`` is empty.

    Args:
        rule: The success rule.
        path: The agent's path.
        reference: The reference path.
        start: Distance in metres from start to goal.
        left: Distance in metres from the agent to the goal.
        stopped: Whether the agent took STOP.
    """
    length, start = round(path_length(path), 4), round(start, 4)  # the row can confirm its SPL
    succeeded = rule.met(left, stopped)
    shortest = spl(succeeded, start, length) if math.isfinite(start) else 0.0
    measures = {"success": int(succeeded), "spl": round(shortest, 6)}
    metres = {"path_length": length, "geodesic_distance": start, "distance_to_goal": left}
    measures |= {name: round(value, 4) for name, value in metres.items() if math.isfinite(value)}
    if len(np.asarray(reference)):
        measures["ndtw"] = round(ndtw(path, reference, threshold=rule.path_metres), 6)
    return measures


def _points(path: ArrayLike, name: str) -> np.ndarray:
    points = np.asarray(path, float)
    if points.ndim != 2 or not len(points) or points.shape[1] not in (2, 3):
        raise ValueError(f"The {name} must be [N, 2] or [N, 3] with N > 0, got {points.shape}.")
    if not np.isfinite(points).all():
        raise ValueError(f"The {name} must have finite coordinates, got NaN or infinity.")
    return points
