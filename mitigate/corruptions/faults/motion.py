"""Motion faults: the robot does not execute its actions exactly.

The function ``draw(severity, key)`` of a record returns a ``Movement``, which describes how the
action of a step is executed; ``key.frame`` is the number of the step. ``mitigate/worlds/motion.py``
applies the ``Movement`` and documents its effect on each kind of action.

Repeated actions are the sticky actions of Machado et al. (JAIR 2018); severity 0.5 gives their
probability of 0.25. Drift turns the robot while it moves forward, as in RobustNav (ICCV 2021). The
size of the drift and all other sizes are heuristic.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

from mitigate.corruptions.keying import Key, digest, sign, uniform
from mitigate.corruptions.record import ACTION, MOTION, Record

SLIP = 0.8  # maximum fraction of a movement that is lost in a step at severity 1
DRIFT = 10.0  # degrees per forward step at severity 1
GAIN = 0.5  # maximum relative error of a gain at severity 1
LOST = 0.5  # probability that an action is dropped, or repeated, at severity 1


@dataclass(frozen=True)
class Movement:
    """How the action of a step is executed."""

    gain: float = 1.0  # factor of the length of a forward step, or of a continuous action
    turn: float = 1.0  # factor of the angle of a turn
    # drift to the left, from -1 to 1, in units of DRIFT degrees per forward step; for continuous
    # actions, the drift is a bias
    drift: float = 0.0
    dropped: bool = False  # whether the robot stands still instead of executing the action
    repeated: bool = False  # whether the previous action is executed instead of this one


def motion_slip(severity: float, key: Key) -> Movement:
    """Return a ``Movement`` that is too short by a random fraction, which differs in each step."""
    remaining = 1.0 - severity * SLIP * uniform(digest(key, "motion_slip", frame=True))
    return Movement(gain=remaining, turn=remaining)


def motion_drift(severity: float, key: Key) -> Movement:
    """Return a ``Movement`` that drifts to one side; the side is constant in an episode."""
    return Movement(drift=severity * sign(key, "motion_drift"))


def motion_gain(severity: float, key: Key) -> Movement:
    """Return a ``Movement`` with wrong gains for forward steps and for turns.

    The two errors are sampled separately, and are constant in an episode.
    """
    value = digest(key, "motion_gain")
    gain, turn = (1.0 + severity * GAIN * (2.0 * uniform(value, i) - 1.0) for i in range(2))
    return Movement(gain=gain, turn=turn)


def dropped_action(severity: float, key: Key) -> Movement:
    """Return a ``Movement`` that drops the action with a probability of 0.5 * severity."""
    return Movement(dropped=_happens(severity, key, "dropped_action"))


def repeated_action(severity: float, key: Key) -> Movement:
    """Return a ``Movement`` that repeats the previous action with probability 0.5 * severity."""
    return Movement(repeated=_happens(severity, key, "repeated_action"))


def _happens(severity: float, key: Key, name: str) -> bool:
    return uniform(digest(key, name, frame=True)) < severity * LOST


_record = partial(Record.drawn, MOTION, ACTION)
RECORDS = (
    _record(
        motion_slip,
        f"part of each movement that may be lost, up to {SLIP:g}",
        frame="part, per step",
    ),
    _record(
        motion_drift, f"degrees per forward step, up to {DRIFT:g}", "RobustNav", episode="side"
    ),
    _record(motion_gain, f"range of the gains, up to +-{GAIN:g}", episode="gains"),
    _record(
        dropped_action, f"probability of a lost command, up to {LOST:g}", frame="loss, per step"
    ),
    _record(
        repeated_action,
        f"probability of the previous command, up to {LOST:g}",
        "Machado et al. 2018",
        frame="repetition, per step",
    ),
)
