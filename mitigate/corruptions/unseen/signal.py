"""Unseen RGB corruptions during sensor read-out: rolling shutter, flicker and bit errors.

Functions have the same arguments and results as in ``corruptions/rgb.py``.
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np
from numba import njit

from mitigate.corruptions.keying import Key, digest, mix, uniform, view_streams
from mitigate.corruptions.record import TEST, VALIDATION, Record
from mitigate.corruptions.unseen.optics import displaced

WOBBLE = 0.05  # maximum shift as a fraction of the image width, at severity 1
WOBBLE_WAVES = (1.0, 2.5)  # minimum and maximum number of waves per frame height
FLICKER = 0.8  # maximum relative change of brightness at severity 1
# These are the minimum and maximum number of bands per frame height.
# The light flickers at 100 Hz, and the sensor reads out a frame in 1/50 to 1/25 s.
BANDS = (2.0, 4.0)
IMPULSES = 0.3  # fraction of the pixels that change at severity 1

_U = np.uint64


def _between(value: int, counter: int, ends: tuple[float, float]) -> float:
    return ends[0] + (ends[1] - ends[0]) * uniform(value, counter)


def wobble(severity: float, key: Key, height: int, width: int) -> np.ndarray:
    """Return the shift of each image row for ``rolling_shutter`` in pixels, float32 [H]."""
    waves = _between(digest(key, "rolling_shutter"), 0, WOBBLE_WAVES)
    phase = uniform(digest(key, "rolling_shutter", frame=True))
    row = (np.arange(height) + 0.5) / height
    aside = WOBBLE * severity * width * np.sin(2.0 * math.pi * (waves * row + phase))
    return aside.astype(np.float32)


def rolling_shutter(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Shift each image row sideways by 0.05 * severity * W * sin(...).

    A camera that vibrates during read-out makes such images.
    """
    _, height, width, _ = views.shape
    right = np.repeat(wobble(severity, key, height, width)[:, None], width, axis=1)
    return displaced(views, np.zeros_like(right), right)


def band_gains(severity: float, key: Key, views: int, height: int) -> np.ndarray:
    """Return the gain of each image row for ``flicker_bands``, int32 [V, H] in units of 1/4096."""
    bands = _between(digest(key, "flicker_bands"), 0, BANDS)
    value = digest(key, "flicker_bands", frame=True)
    phase = np.array([uniform(value, view) for view in range(views)])
    turns = bands * (np.arange(height) + 0.5) / height + phase[:, None]
    share = FLICKER * severity * np.cos(2.0 * math.pi * turns)
    return np.rint(4096.0 * (1.0 + share)).astype(np.int32)


def flicker_bands(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Multiply the brightness of image rows by 1 + 0.8 * severity * cos(...).

    Lamps on mains power cause such bands.
    """
    gain = band_gains(severity, key, *views.shape[:2])[:, :, None, None]
    return np.minimum((views * gain + 2048) >> 12, 255).astype(np.uint8)


@njit(cache=True)
def _strike(views, streams, least, out):
    """Set pixels [V, P, 3] to 0 or 255 per colour if their 32-bit hash is below ``least``."""
    for v in range(views.shape[0]):
        for i in range(views.shape[1]):
            word = mix(streams[v], _U(i))
            struck = (word >> _U(32)) < least
            for c in range(3):
                level = 255 * ((word >> _U(c)) & _U(1))
                out[v, i, c] = level if struck else views[v, i, c]


def impulse_limit(severity: float) -> int:
    """Return the threshold of ``impulse_noise``: pixels with a 32-bit hash below it change."""
    return round(IMPULSES * severity * 2**32)


def impulse_noise(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Set random pixels to 0 or 255, separately per channel.

    The fraction of changed pixels is 0.3 * severity in every frame.
    """
    out, count = np.empty_like(views), len(views)
    least = _U(impulse_limit(severity))
    streams = view_streams(key, "impulse_noise", count)
    _strike(views.reshape(count, -1, 3), streams, least, out.reshape(count, -1, 3))
    return out


_validation = partial(Record.of, "rgb", version="1", half=VALIDATION)
_test = partial(Record.of, "rgb", version="1", half=TEST)
RECORDS = (
    _validation(
        rolling_shutter,
        "rows moved by 0.05 s of the width",
        "Liang et al. 2008",
        episode="frequency f",
        frame="phase p",
    ),
    _validation(
        flicker_bands,
        "bands of 1 +- 0.8 s of the light",
        "Sheinin et al. 2017",
        episode="frequency f",
        frame="phase p, by view",
    ),
    _test(impulse_noise, "0.3 s of the pixels black or white", "ImageNet-C", frame="which pixels"),
)
