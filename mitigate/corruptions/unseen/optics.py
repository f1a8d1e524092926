"""Unseen RGB corruptions from objects in front of the sensor: window panes, drops and scratches.

Functions have the same arguments and results as in ``corruptions/rgb.py``.
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np
from numba import njit

from mitigate.corruptions import masks
from mitigate.corruptions.keying import Key, cached, digest, field, uniform
from mitigate.corruptions.record import TEST, VALIDATION, Record

GHOST = 0.5  # weight of the ghost image at severity 1
# The ghost image is moved sideways by a fraction GHOST_NEAR to GHOST_FAR of the width.
# It is moved up or down by at most a fraction GHOST_DOWN of the height.
GHOST_NEAR, GHOST_FAR, GHOST_DOWN = 0.06, 0.16, 0.04
DROPS = 0.06  # correlation length of the wet surface as a fraction of the shorter side
BEND = 0.045  # rms displacement as a fraction of the shorter side, at severity 1
SCRATCHES = 14  # number of scratches at severity 1
SCRATCH_CORE, SCRATCH_GLOW = 0.006, 0.035  # widths as fractions of the shorter side
SCRATCH_OPACITY, GLOW_OPACITY = 0.9, 0.45
SCRATCH_PARTS = ((SCRATCH_CORE, SCRATCH_OPACITY), (SCRATCH_GLOW, GLOW_OPACITY))
SCRATCH_LONG = (0.3, 1.0)  # minimum and maximum length as fractions of the shorter side
SCRATCH_COLOUR = (226, 226, 222)


def ghost_offset(key: Key, height: int, width: int) -> tuple[int, int]:
    """Return the offset (down, right), in pixels, from a ghost pixel to its source pixel."""
    value = digest(key, "ghosting")
    away = GHOST_NEAR + (GHOST_FAR - GHOST_NEAR) * uniform(value, 0)
    across = round(away * width * (1 if uniform(value, 1) < 0.5 else -1))
    return round(GHOST_DOWN * height * (2.0 * uniform(value, 2) - 1.0)), across


def ghost_weight(severity: float) -> int:
    """Return the weight of the ghost image, in units of 1/65536."""
    return round(65536 * GHOST * severity)


def shifted(views: np.ndarray, down: int, right: int) -> np.ndarray:
    """Return the pixels of views [V, H, W, ...] at (y + down, x + right), with edges repeated."""
    height, width = views.shape[1:3]
    rows = np.clip(np.arange(height) + down, 0, height - 1)
    columns = np.clip(np.arange(width) + right, 0, width - 1)
    return np.take(np.take(views, rows, axis=1), columns, axis=2)


def ghosting(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Blend each view x with a shifted copy x' of itself: out = (1 - a) * x + a * x'.

    Here, a = 0.5 * severity. The copy has repeated edges.
    """
    gap = shifted(views, *ghost_offset(key, *views.shape[1:3])).astype(np.int32) - views
    return (views + ((gap * ghost_weight(severity) + 32768) >> 16)).astype(np.uint8)


@njit(cache=True)
def _displace(view, down, right, out):
    """Set out[y, x] to view (uint8 [H, W, 3]) at (y + down, x + right), interpolated bilinearly.

    Edges are repeated. Displacements (float32 [H, W], pixels) are rounded down to 1/256 pixel.
    """
    height, width, _ = view.shape
    for y in range(height):
        for x in range(width):
            v = min(max(y * 256 + int(np.floor(down[y, x] * 256)), 0), (height - 1) * 256)
            u = min(max(x * 256 + int(np.floor(right[y, x] * 256)), 0), (width - 1) * 256)
            top, left, b, a = v >> 8, u >> 8, v & 255, u & 255
            below, beside = min(top + 1, height - 1), min(left + 1, width - 1)
            for c in range(3):
                upper = view[top, left, c] * (256 - a) + view[top, beside, c] * a
                lower = view[below, left, c] * (256 - a) + view[below, beside, c] * a
                out[y, x, c] = (upper * (256 - b) + lower * b + 32768) >> 16


def displaced(views: np.ndarray, down: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Displace all views by the same offsets in pixels, float32 [H, W]."""
    out = np.empty_like(views)
    for view, into in zip(views, out, strict=True):
        _displace(view, down, right, into)
    return out


@cached
def slopes(value: int, height: int, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the vertical and horizontal slopes of a random surface, both float32 [H, W].

    Their joint rms is 1.
    """
    surface = field(value, height, width, DROPS)[0].astype(np.float64)
    down, right = (np.roll(surface, -1, axis) - np.roll(surface, 1, axis) for axis in (0, 1))
    scale = 1.0 / max(math.sqrt(np.mean(down**2 + right**2)), 1e-9)
    return (down * scale).astype(np.float32), (right * scale).astype(np.float32)


def refraction(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Displace pixels by the slope of a wet pane's surface.

    The rms displacement is 0.045 * severity times the shorter side.
    """
    _, height, width, _ = views.shape
    reach = np.float32(BEND * severity * min(height, width))
    down, right = slopes(digest(key, "refraction"), height, width)
    return displaced(views, down * reach, right * reach)


def scratch_strength(severity: float, number: int) -> float:
    """Return the visibility of a scratch as a number in [0, 1]."""
    return min(max(SCRATCHES * severity - number, 0.0), 1.0)


def scratch_line(value: int, number: int) -> tuple[float, float, float, float]:
    """Return the centre of a scratch (row and column as fractions of the image size), its angle in
    radians, and half its length as a fraction of the shorter side.
    """
    draw = [uniform(value, 5 * number + part) for part in range(4)]
    half = 0.5 * (SCRATCH_LONG[0] + (SCRATCH_LONG[1] - SCRATCH_LONG[0]) * draw[3])
    return draw[0], draw[1], math.pi * draw[2], half


@cached
def scratch_mask(value: int, severity: float, height: int, width: int) -> np.ndarray:
    """Return the opacity of the scratches, int16 [H, 3 W] in units of 1/32768."""
    clear, side = np.ones((height, width)), min(height, width)
    for number in range(SCRATCHES):
        strength = scratch_strength(severity, number)
        if strength > 0.0:
            row, column, angle, half = scratch_line(value, number)
            y = ((np.arange(height) + 0.5 - row * height) / side)[:, None]
            x = (np.arange(width) + 0.5 - column * width) / side
            along = x * math.cos(angle) + y * math.sin(angle)
            across = y * math.cos(angle) - x * math.sin(angle)
            # distance to the line, as a fraction of the shorter side
            far = np.hypot(across, np.maximum(np.abs(along) - half, 0.0))
            for reach, most in SCRATCH_PARTS:
                clear *= 1.0 - strength * most * np.exp(-0.5 * (far / reach) ** 2)
    return masks.opacity_mask((1.0 - clear).astype(np.float32), 1.0, masks.NEUTRAL)


def scratches(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Draw the first 14 * severity scratches of the episode as bright lines with a glow."""
    height, width = views.shape[1:3]
    mask = scratch_mask(digest(key, "scratches"), severity, height, width)
    return masks.covered(views, mask, masks.colour_row(SCRATCH_COLOUR, width))


_validation = partial(Record.of, "rgb", version="1", half=VALIDATION)
_test = partial(Record.of, "rgb", version="1", half=TEST)
RECORDS = (
    _validation(
        ghosting, "a second picture of opacity 0.5 s", "Shih et al. 2015", episode="displacement"
    ),
    _test(refraction, "displaced by 0.045 s side, rms", "ImageNet-C-bar", episode="surface"),
    _test(scratches, f"the first {SCRATCHES} s scratches", "RobustNav", episode="where they are"),
)
