"""Measures of one episode by VLN-CE's formulas, and rules of success.

Paths are ``[N, 2]`` or ``[N, 3]`` arrays of positions in metres, the two of a call in one frame.
Distances "to the goal" and of the episode are geodesic, as the simulator measures them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

SUCCESS_DISTANCE = 3.0  # metres; VLN-CE's TASK.SUCCESS_DISTANCE for R2R-CE and RxR-CE


def success(distance_to_goal: float, stopped: bool, *, threshold: float = SUCCESS_DISTANCE) -> bool:
    """Return whether the agent said STOP strictly within ``threshold`` metres of the goal.

    VLN-CE's rule. (ETPNav counts ``<=`` without STOP; habitat-lab's own VLN task has 0.2 m.)
    A NaN distance raises ValueError; an infinite one (goal out of reach) is a failure.
    """
    if math.isnan(distance_to_goal):
        raise ValueError("The distance to the goal is NaN: give metres, or inf out of reach.")
    return bool(stopped) and distance_to_goal < threshold


@dataclass(frozen=True)
class Rule:
    """When an episode counts as a success: nearer than ``metres`` to the goal.

    name: of whose rule it is. stop: the agent must have said STOP. inclusive: at exactly that
    distance, too. view_points: not the goal counts, but the nearest place to see it from.
    """

    name: str
    metres: float
    stop: bool = True
    inclusive: bool = False
    view_points: bool = False

    @property
    def stop_within(self) -> float:
        """Metres at which an oracle stops, from the goal or a view point as the rule counts them: 1
        (ours), or the rule's where it counts less."""
        return min(1.0, self.metres)

    @property
    def path_metres(self) -> float:
        """Metres by which nDTW calls a walk near its path: the rule's, or VLN-CE's where success is
        counted from view points, which lie on no path."""
        return SUCCESS_DISTANCE if self.view_points else self.metres

    def met(self, distance: float, stopped: bool) -> bool:
        """Whether it is a success to end ``distance`` metres away, with STOP or without. A NaN
        distance raises ValueError."""
        if self.inclusive:
            distance = math.nextafter(distance, -math.inf)
        return success(distance, stopped or not self.stop, threshold=self.metres)

    def __str__(self) -> str:
        """What result rows and tables carry."""
        away = f"geodesic {'<=' if self.inclusive else '<'} {float(self.metres)} m"
        away += " to a view point" if self.view_points else ""
        return f"{self.name}: {f'STOP and {away}' if self.stop else f'{away}, STOP or not'}"


RULES = {  # by name, as options take them; the source of each is in docs/agents.md
    "vln_ce": Rule("vln", SUCCESS_DISTANCE),
    "etpnav": Rule("etpnav", 3.0, stop=False, inclusive=True),
    "habitat_vln": Rule("habitat-lab vln", 0.2),
    "objectnav": Rule("objectnav", 0.1, view_points=True),
    "wmnav": Rule("wmnav", 1.0, stop=False, view_points=True),
}


def path_length(path: ArrayLike) -> float:
    """Return the summed Euclidean length of the steps of ``path``, in metres."""
    steps = np.diff(_points(path, "path"), axis=0)
    return float(np.sqrt((steps**2).sum(axis=1)).sum())


def spl(succeeded: bool, geodesic_distance: float, length: float) -> float:
    """Return success weighted by path length, ``S L* / max(L*, L)`` (Anderson et al., 2018).

    ``geodesic_distance`` L* is from start to goal, ``length`` L what was walked, both metres. An
    episode that starts at its goal (L* = 0) and walks nowhere scores S.
    """
    for name, metres in (("geodesic distance", geodesic_distance), ("path length", length)):
        if not 0 <= metres < math.inf:
            raise ValueError(f"SPL needs a finite {name} >= 0 in metres, not {metres}.")
    longer = max(geodesic_distance, length)
    return float(succeeded) * (geodesic_distance / longer if longer else 1.0)


def dtw(path: ArrayLike, reference: ArrayLike) -> float:
    """Return the dynamic time warping cost of the two paths, in metres.

    Exact: the dynamic programme over all alignments, vectorised along anti-diagonals. VLN-CE
    calls ``fastdtw``, an approximation from above; its value is never below ours.
    """
    a, b = _points(path, "path"), _points(reference, "reference path")
    if a.shape[1] != b.shape[1]:
        raise ValueError(f"One path has {a.shape[1]} coordinates, the other {b.shape[1]}.")
    rows, columns = len(a), len(b)
    cost = np.sqrt(((a[:, None] - b[None]) ** 2).sum(axis=2))[:, ::-1]
    before, last = np.full((2, rows + 1), np.inf)  # at [i + 1]: cell (i, d - i) of d - 2, d - 1
    before[0] = 0.0
    for d in range(rows + columns - 1):
        first, end = max(0, d - columns + 1), min(rows, d + 1)
        best = np.minimum(before[first:end], last[first:end])
        np.minimum(best, last[first + 1 : end + 1], out=best)
        before, last = last, np.full(rows + 1, np.inf)
        last[first + 1 : end + 1] = best + cost.diagonal(columns - 1 - d)
    return float(last[rows])


def ndtw(path: ArrayLike, reference: ArrayLike, *, threshold: float = SUCCESS_DISTANCE) -> float:
    """Return nDTW, ``exp(-DTW / (n threshold))`` with n reference points (Ilharco et al., 2019).

    As in VLN-CE, steps that did not move (turns, collisions) count once.
    """
    points = _points(path, "path")
    moved = np.append(True, np.any(np.diff(points, axis=0) != 0, axis=1))
    count = len(_points(reference, "reference path"))
    return math.exp(-dtw(points[moved], reference) / (count * threshold))


def _points(path: ArrayLike, name: str) -> np.ndarray:
    points = np.asarray(path, float)
    if points.ndim != 2 or not len(points) or points.shape[1] not in (2, 3):
        raise ValueError(f"The {name} has shape {points.shape}: [N, 2] or [N, 3] is needed, N > 0.")
    if not np.isfinite(points).all():
        raise ValueError(f"The {name} holds NaN or infinity: give finite metres.")
    return points
