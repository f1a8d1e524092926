"""How a drive is cut into an agent's steps, and what whoever drove did at each."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from mitigate.core.observation import FORWARD, FORWARD_METRES, LEFT, RIGHT, STOP, TURN_DEGREES

NONE = -1  # what was done is none of an agent's actions: it went back, or sideways
NEARLY = 0.98  # of a step: one of exactly its length must not be missed by rounding (ours)
MOVES = 0.05  # metres: a robot that stands is measured to move by less (ours)
PAUSE = 0.5  # of a step: less is none (ours)


@dataclass(frozen=True)
class Step:
    """How far apart the instants are that an agent is shown: as far as its own steps take it.

    metres, degrees: moved or turned since the last one. seconds: where poses are not known. Raises
    ValueError for what is not above 0.
    """

    metres: float = FORWARD_METRES
    degrees: float = TURN_DEGREES
    seconds: float = 0.5

    def __post_init__(self) -> None:
        for name in ("metres", "degrees", "seconds"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0):
                raise ValueError(f"step.{name}={value:g} must be above 0.")

    def share(self, before: np.ndarray, after: np.ndarray) -> float:
        """How much of a step lies between two poses [3]."""
        moved = float(np.hypot(*(after[:2] - before[:2]))) / self.metres
        return max(moved, abs(turn(before[2], after[2])) / math.radians(self.degrees))

    def choose(self, times: np.ndarray, poses: np.ndarray | None) -> np.ndarray:
        """Which instants are shown: the first, each that is a step away from the one before, and
        the last, in place of its neighbour if it stands where that does."""
        chosen = [0]
        for index in range(1, len(times)):
            last = chosen[-1]
            if poses is None:
                away = times[index] - times[last] >= self.seconds
            else:
                away = self.share(poses[last], poses[index]) > NEARLY
            if away:
                chosen.append(index)
        end = len(times) - 1
        if chosen[-1] != end and poses is not None:
            if len(chosen) > 1 and self.share(poses[chosen[-1]], poses[end]) < PAUSE:
                chosen.pop()
            chosen.append(end)
        return np.array(chosen)


@dataclass(frozen=True)
class Driven:
    """What was done at each of T steps, the last one included, at which the drive ends.

    actions: int [T], the nearest of an agent's actions, ``NONE`` where none is like it. metres:
    float [T], gone ahead (below 0: back). radians: float [T], turned to the left.
    """

    actions: np.ndarray
    metres: np.ndarray
    radians: np.ndarray


def turn(before: float, after: float) -> float:
    """Radians turned to the left from one heading to another, -pi to pi."""
    return float((after - before + math.pi) % (2 * math.pi) - math.pi)


def driven(poses: np.ndarray) -> Driven:
    """What whoever drove did at poses [T, 3]; at the last, STOP.

    A step that did both counts as what it did more of, one unit being 0.25 m or 15 degrees.
    """
    count = len(poses)
    actions, metres, radians = np.full(count, STOP), np.zeros(count), np.zeros(count)
    for index in range(count - 1):
        before, after = poses[index], poses[index + 1]
        dx, dy = after[:2] - before[:2]
        radians[index] = turn(before[2], after[2])
        middle = before[2] + radians[index] / 2
        ahead = -dx * math.sin(middle) + dy * math.cos(middle)
        aside = abs(dx * math.cos(middle) + dy * math.sin(middle))
        metres[index] = ahead
        turned = abs(radians[index]) / math.radians(TURN_DEGREES)
        if turned >= math.hypot(ahead, aside) / FORWARD_METRES:
            actions[index] = LEFT if radians[index] > 0 else RIGHT if turned > 0 else NONE
        else:
            actions[index] = FORWARD if ahead > aside else NONE
    return Driven(actions, metres, radians)


def strange(poses: np.ndarray, taken: Driven) -> tuple[int, int]:
    """How many of the steps between poses [T, 3] that move, by ``MOVES`` or more, none of an
    agent's actions is like, and how many move."""
    moves = np.hypot(*np.diff(poses[:, :2], axis=0).T) >= MOVES
    moves &= np.isin(taken.actions[:-1], (FORWARD, NONE))
    return int((taken.actions[:-1][moves] == NONE).sum()), int(moves.sum())


def answered(actions: np.ndarray) -> Driven:
    """What would have been done, had the driver taken ``actions``: whole steps."""
    turned = math.radians(TURN_DEGREES) * ((actions == LEFT) * 1.0 - (actions == RIGHT))
    return Driven(actions, FORWARD_METRES * (actions == FORWARD), turned)
