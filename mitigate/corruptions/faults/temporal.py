"""Faults in time: frames that arrive late, again or not at all.

``draw(severity, key)`` of a record returns the age of the frame that arrives, in frames: 0 is the
current frame. It depends on the key only, so the arriving frame is a pure function of the key and
the sequence of frames. The frame is corrupted further with the key of the instant at which it was
taken, so that its noise is as old as its picture. All views and both sensors fail together, except
in ``depth_lag``.

All durations are heuristic: no published model fits all robots. A frame is an observation of the
sequence; in the apartments and in Habitat one step of 0.25 m or 15 degrees.
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
GAMMA = 2.2  # sRGB as a power law
OLDEST = max(DELAY, LONGEST_FREEZE, LONGEST_BURST)  # largest age in frames that a draw can give
GATE = "intermittent"  # the first part of a pair, which limits the second part to intervals


def _frames_inside(name: str, period: int, longest: int, length: int, key: Key) -> int:
    """Return how many frames of the current interval have passed, with this one; 0 outside.

    Time is divided into periods, with one interval in each. A longer interval begins at the same
    frame.

    Args:
        name: Name of the draw.
        period: Frames per period.
        longest: Largest length.
        length: Frames per interval.
        key: Seed, episode and frame.
    """
    phase = int(period * uniform(digest(key, name)))
    number, place = divmod(key.frame + phase, period)
    draw = uniform(digest(Key(key.seed, key.episode, number), name, frame=True))
    begin = 1 + int(draw * (period - longest))  # a good frame separates two intervals
    return place - begin + 1 if begin <= place < begin + length else 0


def _burst(severity: float, key: Key) -> int:
    length = round(severity * LONGEST_BURST)
    return _frames_inside("burst", BURST_PERIOD, LONGEST_BURST, length, key)


def frozen_frame(severity: float, key: Key) -> int:
    """Return the age during a freeze: the last frame before it is repeated."""
    length = round(severity * LONGEST_FREEZE)
    return _frames_inside("frozen_frame", FREEZE_PERIOD, LONGEST_FREEZE, length, key)


def repeated_frames(severity: float, key: Key) -> int:
    """Return the age during a burst of lost frames: the last frame before it is repeated."""
    return _burst(severity, key)


def frame_delay(severity: float, key: Key) -> int:
    """Return a constant age."""
    return round(severity * DELAY)


def depth_lag(severity: float, key: Key) -> int:
    """Return a constant age, for depth only."""
    return round(severity * DELAY)


def dropped_frames(
    views: np.ndarray, severity: float, key: Key, context: DepthSensor | float | None
) -> np.ndarray:
    """Return black RGB, or depth without a reading, in the bursts of ``repeated_frames``."""
    if not _burst(severity, key):
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


def is_active(severity: float, key: Key) -> bool:
    """Return whether the second corruption of a pair with ``intermittent`` is active now.

    The severity does not matter.
    """
    return _frames_inside(GATE, ACTIVE_PERIOD, ACTIVE, ACTIVE, key) > 0


_record = partial(Record, family=TEMPORAL, apply=None, source="heuristic", version="1")
RECORDS = (
    _record(
        "frozen_frame",
        FRAMES,
        draw=frozen_frame,
        severity=f"frames per freeze, up to {LONGEST_FREEZE} of {FREEZE_PERIOD}",
        episode="phase",
        frame="start",
    ),
    _record(
        "repeated_frames",
        FRAMES,
        draw=repeated_frames,
        severity=f"frames per burst, up to {LONGEST_BURST} of {BURST_PERIOD}",
        episode="phase",
        frame="start",
    ),
    _record(
        "dropped_frames",
        FRAMES,
        apply=dropped_frames,
        severity=f"frames per burst, up to {LONGEST_BURST} of {BURST_PERIOD}",
        episode="phase",
        frame="start",
    ),
    _record("frame_delay", FRAMES, draw=frame_delay, severity=f"delay, up to {DELAY} frames"),
    _record(
        "depth_lag",
        "depth",
        draw=depth_lag,
        severity=f"frames that depth is older than RGB, up to {DELAY}",
        label="Depth behind RGB",
    ),
    _record(
        "exposure_flicker",
        "rgb",
        apply=exposure_flicker,
        severity=f"range of the exposure, up to {STOPS:g} stops",
        frame="exposure",
    ),
    _record(
        GATE,
        FRAMES,
        draw=is_active,
        severity="of the other corruption of the pair",
        episode="phase",
        frame="start",
    ),
)
