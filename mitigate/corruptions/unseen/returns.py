"""Unseen depth corruptions of the signal that returns to the sensor: ripple, range limit,
mismatches and glossy floors.

Functions have the same arguments and results as in ``corruptions/depth.py``, and treat invalid
pixels in the same way.
"""

from __future__ import annotations

from functools import partial

import numpy as np
from numba import njit

from mitigate.corruptions.depth_sensor import NEAREST, DepthSensor, is_valid
from mitigate.corruptions.keying import (
    Key,
    digest,
    field,
    mix,
    scramble,
    top_share,
    uniform,
    view_streams,
)
from mitigate.corruptions.record import TEST, VALIDATION, Record
from mitigate.corruptions.unseen.calibration import clip_valid, valid

RIPPLE = 0.06  # amplitude per metre at severity 1; the standard deviation of z is 0.06 z^2
RIPPLE_CORRELATION = 0.04  # correlation length as a fraction of the shorter side
RANGE_LEFT = 0.10  # fraction of z_max that remains at severity 1
WRONG = 0.30  # fraction of pixels with wrong depth at severity 1
SPECKLE = 0.02  # side length of a patch of wrong depth, as a fraction of the shorter side
GLOSS_CORRELATION = 0.08  # correlation length as a fraction of the shorter side
# a pixel is floor if it is farther below the camera than this fraction of the camera's height
FLOOR = 0.92
# This is the ratio of the depth of the mirrored ceiling to the depth of the floor.
# The ceiling is assumed to be twice as high as the camera.
UPSIDE_DOWN = 3.0

_U = np.uint64


def ripple_offsets(key: Key, views: int, height: int, width: int) -> list[tuple[int, int]]:
    """Return the shift (down, right) of the random field in each view, in pixels."""
    return [
        (int(uniform(int(stream), 0) * height), int(uniform(int(stream), 1) * width))
        for stream in view_streams(key, "ripple_offset", views)
    ]


def ripple(views: np.ndarray, severity: float, key: Key, sensor: DepthSensor) -> np.ndarray:
    """Add waves to walls: the error is 0.06 * severity * z^2 * F for a random field F.

    The field is shifted for every view and frame.
    """
    count, height, width = views.shape
    waves = field(digest(key, "ripple"), height, width, RIPPLE_CORRELATION)[0]
    moved = np.where(valid(views), np.minimum(views, np.float32(sensor.z_max)), 0)
    strength = np.float32(RIPPLE * severity)
    for view, offset in enumerate(ripple_offsets(key, count, height, width)):
        shifted = np.roll(waves, offset, axis=(0, 1))
        moved[view] += strength * moved[view] * moved[view] * shifted
    return clip_valid(views, moved, sensor)


def range_limit(views: np.ndarray, severity: float, key: Key, sensor: DepthSensor) -> np.ndarray:
    """Remove depth beyond z_max * 0.1^severity, because too little light returns from there."""
    limit = np.float32(sensor.z_max * RANGE_LEFT**severity)
    near = clip_valid(views, views, sensor)
    return np.where(valid(views) & (near > limit), np.float32(sensor.missing), near)


@njit(cache=True)
def _mismatch(views, streams, cell, least, z_max, out):
    for v in range(views.shape[0]):
        for y in range(views.shape[1]):
            for x in range(views.shape[2]):
                z = views[v, y, x]
                word = mix(streams[v], _U((y // cell) * 65536 + x // cell))
                wrong = np.float32((word >> _U(40)) + _U(1)) * np.float32(1 / 16777216) * z_max
                read = wrong if (word & _U(0xFFFFFFFF)) < least else z
                out[v, y, x] = min(max(read, NEAREST), z_max) if is_valid(z) else z


def speckle_side(height: int, width: int) -> int:
    """Return the side length, in pixels, of the square patches that ``mismatches`` changes."""
    return max(1, round(SPECKLE * min(height, width)))


def mismatches(views: np.ndarray, severity: float, key: Key, sensor: DepthSensor) -> np.ndarray:
    """Set a fraction 0.3 * severity of the pixels to random depths.

    These pixels form square patches with a side length of 0.02 times the shorter side of the image.
    """
    cell = speckle_side(*views.shape[1:])
    streams, out = view_streams(key, "mismatches", len(views)), np.empty_like(views)
    least = _U(round(WRONG * severity * 2**32))
    _mismatch(views, streams, cell, least, np.float32(sensor.z_max), out)
    return out


def gloss_offset(key: Key, view: int, width: int) -> int:
    """Return the number of columns by which the glossy areas are shifted to the right in a view."""
    return int(uniform(scramble(digest(key, "glossy_floor"), view)) * width)


def glossy_floor(views: np.ndarray, severity: float, key: Key, sensor: DepthSensor) -> np.ndarray:
    """Set the depth of a fraction ``severity`` of the floor to the depth of the reflected scene."""
    _, height, width = views.shape
    smooth, cells = field(digest(key, "glossy_floor"), height, width, GLOSS_CORRELATION)
    gloss = smooth >= top_share(cells, severity)
    # If the camera is level, a pixel at depth z shows a point that is z * slope below the camera.
    # The unit of this distance is half the width that the image covers at a depth of one metre.
    slope = ((np.arange(height) + 0.5 - 0.5 * height) / (0.5 * width)).astype(np.float32)
    depth = np.where(valid(views), views, 0) * slope[:, None]
    out = clip_valid(views, views, sensor)
    for view, clean in enumerate(out):
        floor = (depth[view] > 0) & (depth[view] >= FLOOR * depth[view].max())
        floor &= np.roll(gloss, gloss_offset(key, view, width), axis=1)
        wall = np.where(valid(clean), clean, 0).max(axis=0)
        mirrored = np.minimum(np.float32(UPSIDE_DOWN) * clean, wall)
        out[view] = np.where(floor & (mirrored > clean), mirrored, clean)
    return out


_validation = partial(Record.of, "depth", version="1", half=VALIDATION)
_test = partial(Record.of, "depth", version="1", half=TEST)
RECORDS = (
    _validation(
        ripple,
        "waves of sd 0.06 s z^2 metres",
        "Keselman et al. 2017",
        episode="field",
        frame="offset, by view",
    ),
    _test(range_limit, "no reading beyond z_max 0.1^s", "Fankhauser et al. 2015"),
    _test(
        mismatches,
        "0.3 s of the readings are anywhere",
        "Scharstein 2002",
        frame="which, and their depth",
    ),
    _test(
        glossy_floor, "the share s of the floor", "Mirror3D 2021", episode="field, place by view"
    ),
)
