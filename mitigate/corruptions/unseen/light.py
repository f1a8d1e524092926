"""Unseen RGB corruptions of light and colour: white balance, overexposure, haze and hue.

Functions have the same arguments and results as in ``corruptions/rgb.py``.
"""

from __future__ import annotations

import math
from functools import lru_cache, partial

import numpy as np

from mitigate.corruptions import masks
from mitigate.corruptions.eld import GAMMA
from mitigate.corruptions.keying import Key, cached, digest, field, scramble, sign, uniform
from mitigate.corruptions.record import TEST, VALIDATION, Record

STOPS, STOPS_SPREAD = 2.0, 0.2  # stops of exposure at severity 1, and their relative spread
# maximum difference between red and blue at severity 1, in stops
# Afifi & Brown 2019 vary the colour temperature from 2800 to 10000 K.
CAST = 2.0
# maximum difference between green and the mean of red and blue, as a fraction of CAST
TINT = 0.5
HAZE_DEPTH = 1.5  # optical depth of haze with mean density, at severity 1
# pairs of a correlation length (as a fraction of the shorter side) and a weight
HAZE_OCTAVES = ((0.16, 1.0), (0.08, 0.5), (0.04, 0.25))
HAZE_UNEVEN = 0.4  # standard deviation of the density of haze, relative to its mean
HAZE_THIN, HAZE_THICK = 0.25, 2.5  # minimum and maximum density of haze, relative to its mean
HAZE_COLOUR = (205, 208, 212)
HUE_DEGREES = 180.0  # rotation of the hue at severity 1


def _by_table(views: np.ndarray, tables: list[np.ndarray]) -> np.ndarray:
    """Map each colour channel of views (uint8 [V, H, W, 3]) by its own table (uint8 [256])."""
    return np.stack([table[views[..., c]] for c, table in enumerate(tables)], axis=-1)


def _amplified(stops: float) -> np.ndarray:
    """Return a table (uint8 [256]) that adds ``stops`` of light to grey levels, up to white."""
    return np.rint(np.minimum(np.arange(256) * 2.0 ** (stops / GAMMA), 255.0)).astype(np.uint8)


def balance_tables(severity: float, key: Key) -> list[np.ndarray]:
    """Return three tables (uint8 [256]) of ``white_balance``, for red, green and blue."""
    angle = 2.0 * math.pi * uniform(digest(key, "white_balance"))
    warm, green = 0.5 * CAST * math.cos(angle), 0.5 * CAST * TINT * math.sin(angle)
    stops = (warm - green, green, -warm - green)
    return [_amplified(severity * each) for each in stops]


def white_balance(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Multiply red, green and blue by wrong gains, which are fixed per episode."""
    return _by_table(views, balance_tables(severity, key))


def exposure_tables(severity: float, key: Key) -> list[np.ndarray]:
    """Return three equal tables (uint8 [256]) of ``overexposure``, one per colour."""
    spread = 1.0 + STOPS_SPREAD * (2.0 * uniform(digest(key, "overexposure")) - 1.0)
    return [_amplified(STOPS * spread * severity)] * 3


def overexposure(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Multiply light by 2^(2 * severity * u), and clip it at white; u ~ U(0.8, 1.2) per episode."""
    return _by_table(views, exposure_tables(severity, key))


@cached
def haze_density(value: int, height: int, width: int) -> np.ndarray:
    """Return the density of the haze relative to its mean, a fractal field (float32 [H, W])."""
    parts = [
        weight * field(scramble(value, octave), height, width, correlation)[0]
        for octave, (correlation, weight) in enumerate(HAZE_OCTAVES)
    ]
    spread = HAZE_UNEVEN / math.hypot(*(weight for _, weight in HAZE_OCTAVES))
    density = np.float32(1.0) + np.float32(spread) * np.sum(parts, axis=0, dtype=np.float32)
    return np.clip(density, np.float32(HAZE_THIN), np.float32(HAZE_THICK))


@cached
def haze_mask(value: int, severity: float, height: int, width: int) -> np.ndarray:
    """Return the opacity of the haze, int16 [H, 3 W] in units of 1/32768."""
    lost = np.exp(-HAZE_DEPTH * severity * haze_density(value, height, width).astype(np.float64))
    return masks.opacity_mask((1.0 - lost).astype(np.float32), 1.0, masks.NEUTRAL)


def haze_offset(key: Key, view: int, width: int) -> int:
    """Return the number of columns by which the haze is shifted to the right in a view."""
    return int(uniform(scramble(digest(key, "haze"), view)) * width)


def haze(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Blend each view x with haze, as from smoke: out = x * t + A * (1 - t).

    The views show different parts of the random field.
    """
    count, height, width, _ = views.shape
    out = np.empty_like(views)
    mask = haze_mask(digest(key, "haze"), severity, height, width)
    grey = masks.colour_row(HAZE_COLOUR, width)
    for view in range(count):
        shifted = np.roll(mask, 3 * haze_offset(key, view, width), axis=1)
        masks.cover(views[view : view + 1], shifted, grey, out[view : view + 1])
    return out


def hue_degrees(severity: float, key: Key) -> float:
    """Return the angle in degrees by which ``hue_shift`` rotates hues."""
    return sign(key, "hue_shift") * HUE_DEGREES * severity


@lru_cache(maxsize=32)
def hue_matrix(degrees: float) -> np.ndarray:
    """Return the matrix that rotates colours about the grey axis (Rodrigues' formula).

    The matrix is int32 [3, 3] in units of 1/4096.
    """
    angle = math.radians(degrees)
    third, cross = np.full((3, 3), 1.0 / 3.0), np.zeros((3, 3))
    cross[[0, 1, 2], [2, 0, 1]], cross[[0, 1, 2], [1, 2, 0]] = 1.0, -1.0
    turn = math.cos(angle) * np.eye(3) + (1.0 - math.cos(angle)) * third
    return np.rint(4096.0 * (turn + math.sin(angle) / math.sqrt(3.0) * cross)).astype(np.int32)


def hue_shift(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Rotate all hues by +-180 * severity degrees, with a sign that is fixed per episode.

    Grey does not change.
    """
    matrix = hue_matrix(hue_degrees(severity, key))
    colours = [views[..., c].astype(np.int32) for c in range(3)]
    out = np.empty_like(views)
    for c, row in enumerate(matrix):  # faster than an integer matrix product
        level = sum(colour * weight for colour, weight in zip(colours, row, strict=True))
        out[..., c] = np.clip((level + 2048) >> 12, 0, 255)
    return out


_validation = partial(Record.of, "rgb", version="1", half=VALIDATION)
_test = partial(Record.of, "rgb", version="1", half=TEST)
RECORDS = (
    _validation(
        white_balance,
        "2 s stops between red and blue",
        "Afifi & Brown 2019",
        episode="direction",
    ),
    _validation(
        haze, f"optical depth {HAZE_DEPTH:g} s", "3DCC, ImageNet-C", episode="field, place by view"
    ),
    _test(overexposure, "2 s stops too much light", "ImageNet-C, 3DCC", episode="stops, +- 20 %"),
    _test(
        hue_shift, "hues turned by 180 s degrees", "after ImageNet-C's saturate", episode="sense"
    ),
)
