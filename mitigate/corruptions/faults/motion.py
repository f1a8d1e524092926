"""Faults of motion: the robot does not execute its actions exactly.

``draw(severity, key)`` of a record returns how the action of a step is executed, a ``Movement``;
``key.frame`` is the number of the step. ``mitigate/worlds/motion.py`` documents what that means for
each kind of action, and applies it.

A repeated action is Machado et al.'s sticky action (JAIR 2018), whose probability of 0.25 is
reached at severity 0.5. Drift turns the robot while it moves forward, as in RobustNav (ICCV 2021);
its size and all others are heuristic.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

from mitigate.corruptions.keying import Key, digest, uniform
from mitigate.corruptions.record import ACTION, MOTION, Record

SLIP = 0.8  # largest part of a movement that is lost in a step at severity 1
DRIFT = 10.0  # degrees per forward step at severity 1
GAIN = 0.5  # largest relative error at severity 1
LOST = 0.5  # probability of a dropped, and of a repeated action at severity 1


@dataclass(frozen=True)
class Movement:
    """How the action of a step is executed.

    Attributes:
        gain: Factor of the movement: metres of a forward step, a continuous action.
        turn: Factor of the degrees of a turn.
        drift: From -1 to 1: ``DRIFT`` degrees to the left per forward step; for continuous actions
            a bias.
        dropped: Whether the robot does not move.
        repeated: Whether the previous action is executed again instead.
    """

    gain: float = 1.0
    turn: float = 1.0
    drift: float = 0.0
    dropped: bool = False
    repeated: bool = False


def motion_slip(severity: float, key: Key) -> Movement:
    """Return a movement that falls short by a random part in each step."""
    remaining = 1.0 - severity * SLIP * uniform(digest(key, "motion_slip", frame=True))
    return Movement(gain=remaining, turn=remaining)


def motion_drift(severity: float, key: Key) -> Movement:
    """Return a movement that drifts to one side, the same in the whole episode."""
    side = 1.0 if uniform(digest(key, "motion_drift")) < 0.5 else -1.0
    return Movement(drift=severity * side)


def motion_gain(severity: float, key: Key) -> Movement:
    """Return constant errors of the gains of forward movement and turns, drawn separately."""
    value = digest(key, "motion_gain")
    gain, turn = (1.0 + severity * GAIN * (2.0 * uniform(value, i) - 1.0) for i in range(2))
    return Movement(gain=gain, turn=turn)


def dropped_action(severity: float, key: Key) -> Movement:
    """Return whether the command of this step is lost."""
    return Movement(dropped=_happens(severity, key, "dropped_action"))


def repeated_action(severity: float, key: Key) -> Movement:
    """Return whether the previous command is executed again in this step."""
    return Movement(repeated=_happens(severity, key, "repeated_action"))


def _happens(severity: float, key: Key, name: str) -> bool:
    return uniform(digest(key, name, frame=True)) < severity * LOST


_record = partial(
    Record, modality=ACTION, apply=None, family=MOTION, source="heuristic", version="1"
)
RECORDS = (
    _record(
        "motion_slip",
        draw=motion_slip,
        severity=f"part of each movement that may be lost, up to {SLIP:g}",
        frame="part, per step",
    ),
    _record(
        "motion_drift",
        draw=motion_drift,
        severity=f"degrees per forward step, up to {DRIFT:g}",
        source="RobustNav",
        episode="side",
    ),
    _record(
        "motion_gain",
        draw=motion_gain,
        severity=f"range of the gains, up to +-{GAIN:g}",
        episode="gains",
    ),
    _record(
        "dropped_action",
        draw=dropped_action,
        severity=f"probability of a lost command, up to {LOST:g}",
        frame="loss, per step",
    ),
    _record(
        "repeated_action",
        draw=repeated_action,
        severity=f"probability of the previous command, up to {LOST:g}",
        source="Machado et al. 2018",
        frame="repetition, per step",
    ),
)
