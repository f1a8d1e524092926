"""Temporal faults: frames that arrive late, repeatedly or not at all.

The function ``draw(severity, key)`` of a record returns the age, in frames, of the frame that the
agent receives; the current frame has age 0. The age depends only on the severity and the key, so
the received frame is a pure function of severity, key and the sequence of frames. Other corruptions
of an old frame use the key of the step at which it was taken, so its noise is as old as its image.
All views and both sensors fail together, except in ``depth_lag`` and ``exposure_flicker``.

Three faults work differently. ``dropped_frames`` and ``exposure_flicker`` change pixels.
``intermittent`` returns whether the other corruption of its pair is active.

All durations are heuristic: no published model fits all robots. Each step of an episode gives one
frame. In the apartments and in Habitat, a step is 0.25 m or 15 degrees.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from mitigate.corruptions.depth_sensor import DepthSensor
from mitigate.corruptions.keying import Key, digest, uniform
from mitigate.corruptions.record import FRAMES, TEMPORAL, Record

DELAY = 5  # frames at severity 1
FREEZE_PERIOD, LONGEST_FREEZE = 20, 15  # in frames; each period has one freeze
BURST_PERIOD, LONGEST_BURST = 8, 6  # in frames; each period has one burst
ACTIVE_PERIOD, ACTIVE = 20, 10  # in frames; each period has one interval of ``intermittent``
STOPS = 2.0  # exposure changes by at most this many stops at severity 1
GAMMA = 2.2  # exponent of a power law that approximates sRGB
# maximum age, in frames, of a frame that the agent receives
OLDEST = max(DELAY, LONGEST_FREEZE, LONGEST_BURST)
# name of the fault that makes the second corruption of a pair active only in intervals
GATE = "intermittent"


def _frames_inside(name: str, period: int, longest: int, length: int, key: Key) -> int:
    """Return the number of frames of the current interval so far, or 0 outside of intervals.

    The number includes this frame. Time is divided into periods of ``period`` frames. Each period
    contains one interval of ``length`` frames, and ``longest`` is the maximum length. The first
    frame of an interval does not depend on ``length``. ``name`` is hashed with the key to get the
    random numbers of this fault.
    """
    phase = int(period * uniform(digest(key, name)))
    number, place = divmod(key.frame + phase, period)
    draw = uniform(digest(Key(key.seed, key.episode, number), name, frame=True))
    begin = 1 + int(draw * (period - longest))  # at least one good frame separates two intervals
    return place - begin + 1 if begin <= place < begin + length else 0


def frozen_frame(severity: float, key: Key) -> int:
    """Return the age of the received frame; a freeze repeats the frame before it."""
    length = round(severity * LONGEST_FREEZE)
    return _frames_inside("frozen_frame", FREEZE_PERIOD, LONGEST_FREEZE, length, key)


def repeated_frames(severity: float, key: Key) -> int:
    """Return the age of the received frame; a burst of lost frames repeats the frame before it."""
    length = round(severity * LONGEST_BURST)
    return _frames_inside("burst", BURST_PERIOD, LONGEST_BURST, length, key)


def frame_delay(severity: float, key: Key) -> int:
    """Return a constant age."""
    return round(severity * DELAY)


def depth_lag(severity: float, key: Key) -> int:
    """Return a constant age, which applies to depth only."""
    return round(severity * DELAY)


def dropped_frames(
    views: np.ndarray, severity: float, key: Key, context: DepthSensor | float | None
) -> np.ndarray:
    """During the bursts of ``repeated_frames``, return black RGB, or depth without readings."""
    if not repeated_frames(severity, key):
        return views.copy()
    if isinstance(context, DepthSensor):
        valid = np.isfinite(views) & (views > 0)
        return np.where(valid, np.float32(context.missing), views)
    return np.zeros_like(views)


def exposure_flicker(
    views: np.ndarray, severity: float, key: Key, heading: float | None
) -> np.ndarray:
    """Change the exposure of each frame by a random factor, the same in all views."""
    stops = severity * STOPS * (2.0 * uniform(digest(key, "exposure_flicker", frame=True)) - 1.0)
    levels = np.arange(256) * 2.0 ** (stops / GAMMA)
    return np.minimum(np.rint(levels), 255).astype(np.uint8)[views]


def intermittent(severity: float, key: Key) -> bool:
    """Return whether the corruption that is paired with ``intermittent`` is active in this frame.

    The result does not depend on the severity.
    """
    return _frames_inside(GATE, ACTIVE_PERIOD, ACTIVE, ACTIVE, key) > 0


_drawn = partial(Record.drawn, TEMPORAL)
_applied = partial(Record.of, source="heuristic", version="1", family=TEMPORAL)
# the random values from which the position of an interval is computed
_INTERVALS = {"episode": "phase", "frame": "start"}
_FREEZE = f"frames per freeze, up to {LONGEST_FREEZE} of {FREEZE_PERIOD}"
_BURST = f"frames per burst, up to {LONGEST_BURST} of {BURST_PERIOD}"
_LAG = f"frames that depth is older than RGB, up to {DELAY}"
_EXPOSURE = f"range of the exposure, up to {STOPS:g} stops"
RECORDS = (
    _drawn(FRAMES, frozen_frame, _FREEZE, **_INTERVALS),
    _drawn(FRAMES, repeated_frames, _BURST, **_INTERVALS),
    _applied(FRAMES, dropped_frames, _BURST, **_INTERVALS),
    _drawn(FRAMES, frame_delay, f"delay, up to {DELAY} frames"),
    _drawn("depth", depth_lag, _LAG, label="Depth behind RGB"),
    _applied("rgb", exposure_flicker, _EXPOSURE, frame="exposure"),
    _drawn(FRAMES, intermittent, "of the other corruption of the pair", **_INTERVALS),
)
