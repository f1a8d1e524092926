"""Unseen depth corruptions from calibration: wrong scale, misalignment with RGB, and wiggling.

Functions have the same arguments and results as in ``corruptions/depth.py``, and treat invalid
pixels in the same way.
"""

from __future__ import annotations

import math
from functools import lru_cache, partial

import numpy as np

from mitigate.corruptions.depth_sensor import LIGHT_SPEED, NEAREST, DepthSensor
from mitigate.corruptions.keying import Key, digest, uniform
from mitigate.corruptions.record import TEST, VALIDATION, Record
from mitigate.corruptions.unseen.optics import shifted

# minimum and maximum error at severity 1, as a fraction of depth
SCALE_LEAST, SCALE_MOST = 0.25, 0.40
ASIDE = 0.12  # horizontal shift as a fraction of the image width, at severity 1
ASIDE_DOWN = 0.25  # vertical shift as a fraction of the horizontal shift
WIGGLE = 0.30  # amplitude in metres, at severity 1
WIGGLE_HERTZ = 20e6
# period of the error in metres, for a sensor that takes four samples of the phase
WIGGLE_PERIOD = LIGHT_SPEED / (2.0 * WIGGLE_HERTZ) / 4.0
WIGGLE_CELLS = 4096


def valid(views: np.ndarray) -> np.ndarray:
    """Return a mask of valid depth."""
    return (views > 0) & (views < np.inf)


def clip_valid(views: np.ndarray, moved: np.ndarray, sensor: DepthSensor) -> np.ndarray:
    """Clip ``moved`` to the sensor's range, and keep the invalid pixels of ``views``."""
    inside = np.clip(moved, NEAREST, np.float32(sensor.z_max))
    return np.where(valid(views), inside, views)


def scale_factor(severity: float, key: Key) -> float:
    """Return the factor by which ``scale_error`` multiplies depth."""
    value = digest(key, "scale_error")
    change = SCALE_LEAST + (SCALE_MOST - SCALE_LEAST) * uniform(value, 0)
    return 1.0 + severity * change * (1 if uniform(value, 1) < 0.5 else -1)


def scale_error(views: np.ndarray, severity: float, key: Key, sensor: DepthSensor) -> np.ndarray:
    """Multiply depth by 1 +- severity * k; the sign and k ~ U(0.25, 0.4) are fixed per episode."""
    factor = scale_factor(severity, key)
    return clip_valid(views, np.where(valid(views), views, 0) * np.float32(factor), sensor)


def depth_offset(severity: float, key: Key, width: int) -> tuple[int, int]:
    """Return the offset (down, right), in pixels, from each pixel to the source of its depth."""
    value = digest(key, "misalignment")
    reach = ASIDE * severity * width * (1 if uniform(value, 0) < 0.5 else -1)
    return round(reach * ASIDE_DOWN * (2.0 * uniform(value, 1) - 1.0)), round(reach)


def misalignment(views: np.ndarray, severity: float, key: Key, sensor: DepthSensor) -> np.ndarray:
    """Shift depth by 0.12 * severity * W.

    Edges are repeated. Pixels whose source is invalid keep their depth.
    """
    moved = shifted(views, *depth_offset(severity, key, views.shape[2]))
    return clip_valid(views, np.where(valid(moved), moved, views), sensor)


@lru_cache(maxsize=32)
def wiggle_table(phase: float, amplitude: float, z_max: float) -> np.ndarray:
    """Return depth errors in metres for depths from 0 to z_max, float32 [WIGGLE_CELLS + 1]."""
    z = np.linspace(0.0, z_max, WIGGLE_CELLS + 1)
    turns = z / WIGGLE_PERIOD + phase
    return (amplitude * np.sin(2.0 * math.pi * turns)).astype(np.float32)


def wiggling(views: np.ndarray, severity: float, key: Key, sensor: DepthSensor) -> np.ndarray:
    """Add the error 0.3 * severity * sin(2 pi (z / P + p)) to depth z.

    In time-of-flight cameras, harmonics of the light cause this error.
    """
    phase = uniform(digest(key, "wiggling"))
    table = wiggle_table(phase, WIGGLE * severity, sensor.z_max)
    clean = np.clip(np.where(valid(views), views, 0), 0, np.float32(sensor.z_max))
    place = clean * np.float32(WIGGLE_CELLS / sensor.z_max) + np.float32(0.5)
    return clip_valid(views, clean + table[place.astype(np.int32)], sensor)


_validation = partial(Record.of, "depth", version="1", half=VALIDATION)
_test = partial(Record.of, "depth", version="1", half=TEST)
RECORDS = (
    _validation(
        scale_error,
        "all depth off by 0.25 s to 0.4 s",
        "Khoshelham & Elberink 2012",
        episode="sign and size",
    ),
    _validation(
        wiggling,
        "0.3 s metres too near and too far by turns",
        "Lindner & Kolb 2006",
        episode="phase p",
    ),
    _test(
        misalignment,
        "moved by 0.12 s of the width against RGB",
        "Khoshelham & Elberink 2012",
        episode="direction",
    ),
)
