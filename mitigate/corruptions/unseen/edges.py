"""Unseen depth corruptions at edges: fattening, flying pixels and projector shadows.

Functions have the same arguments and results as in ``corruptions/depth.py``, and treat invalid
pixels in the same way.
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np
from numba import njit

from mitigate.core.observation import HFOV_DEGREES
from mitigate.corruptions.depth import extremes
from mitigate.corruptions.depth_sensor import NEAREST, DepthSensor, is_valid
from mitigate.corruptions.keying import Key, digest, mix, uniform, view_streams
from mitigate.corruptions.record import TEST, VALIDATION, Record

FATTENING = 0.08  # reach as a fraction of the shorter side, at severity 1
# A flying pixel gets a depth between the nearest and the farthest depth in a square around it.
# This is half the side length of that square, as a fraction of the shorter side of the frame.
FOOTPRINT = 0.03
# baseline in metres at severity 1; the baseline of a Kinect is 0.075, the baseline of a ZED 0.12
BASELINE = 0.50

_U = np.uint64


@njit(cache=True)
def _fatten(views, reach, share, z_max, out):
    near, nearer = np.empty_like(views[0]), np.empty_like(views[0])
    for v in range(views.shape[0]):
        extremes(views[v], reach, np.float32(-1), near)
        extremes(views[v], reach + 1, np.float32(-1), nearer)
        for y in range(views.shape[1]):
            for x in range(views.shape[2]):
                z = views[v, y, x]
                least = -(near[y, x] + share * (nearer[y, x] - near[y, x]))
                out[v, y, x] = min(max(least, NEAREST), z_max) if is_valid(z) else z


def fattening(views: np.ndarray, severity: float, key: Key, sensor: DepthSensor) -> np.ndarray:
    """Set each pixel to the smallest depth in a square around it.

    Window-based stereo matching makes this error. Half the side length of the square is 0.08 *
    severity times the shorter side of the frame.
    """
    reach = FATTENING * severity * min(views.shape[1:])
    out, whole = np.empty_like(views), math.floor(reach)
    _fatten(views, whole, np.float32(reach - whole), np.float32(sensor.z_max), out)
    return out


@njit(cache=True)
def _fly(views, streams, reach, least, z_max, out):
    near, far = np.empty_like(views[0]), np.empty_like(views[0])
    for v in range(views.shape[0]):
        extremes(views[v], reach, np.float32(-1), near)
        extremes(views[v], reach, np.float32(1), far)
        for y in range(views.shape[1]):
            for x in range(views.shape[2]):
                z = views[v, y, x]
                word = mix(streams[v], _U(y * views.shape[2] + x))
                share = np.float32(word >> _U(48)) * np.float32(1 / 65536)
                mixed = -near[y, x] + share * (far[y, x] + near[y, x])
                moved = mixed if (word & _U(0xFFFFFFFF)) < least else z
                out[v, y, x] = min(max(moved, NEAREST), z_max) if is_valid(z) else z


def footprint(height: int, width: int) -> int:
    """Return half the side length, in pixels, of the square that ``flying_pixels`` searches."""
    return max(1, round(FOOTPRINT * min(height, width)))


def flying_pixels(views: np.ndarray, severity: float, key: Key, sensor: DepthSensor) -> np.ndarray:
    """Set a fraction ``severity`` of the pixels to a random depth.

    The depth is between the nearest and the farthest depth around the pixel.
    """
    reach = footprint(*views.shape[1:])
    streams, out = view_streams(key, "flying_pixels", len(views)), np.empty_like(views)
    _fly(views, streams, reach, _U(round(severity * 2**32)), np.float32(sensor.z_max), out)
    return out


@njit(cache=True)
def _shade(views, offset, side, missing, z_max, out):
    """Remove pixels that no projector ray reaches.

    Columns are counted from the side of the projector. The ray that hits column x at depth z
    leaves the projector at column x + offset / z. A pixel is lit if the projector column of its ray
    is greater than those of all previous pixels in the row.
    """
    width = views.shape[2]
    for v in range(views.shape[0]):
        for y in range(views.shape[1]):
            reached = np.float32(-np.inf)
            for i in range(width):
                x = i if side > 0 else width - 1 - i
                z = views[v, y, x]
                if not is_valid(z):
                    out[v, y, x] = z
                    continue
                at = np.float32(i) + offset / max(z, NEAREST)
                lit = at > reached
                reached = max(reached, at)
                out[v, y, x] = min(max(z, NEAREST), z_max) if lit else missing


def projector(severity: float, key: Key, width: int) -> tuple[float, int]:
    """Return the offset of the projector for ``edge_shadow``, and its side (1 or -1).

    The offset is in pixels at a depth of one metre.
    """
    focal = 0.5 * width / math.tan(math.radians(HFOV_DEGREES) / 2.0)
    return BASELINE * severity * focal, 1 if uniform(digest(key, "edge_shadow")) < 0.5 else -1


def edge_shadow(views: np.ndarray, severity: float, key: Key, sensor: DepthSensor) -> np.ndarray:
    """Remove pixels in the shadow of nearer surfaces.

    The projector is 0.5 * severity metres to the side of the camera.
    """
    offset, side = projector(severity, key, views.shape[2])
    missing, z_max, out = np.float32(sensor.missing), np.float32(sensor.z_max), np.empty_like(views)
    _shade(views, np.float32(offset), side, missing, z_max, out)
    return out


_validation = partial(Record.of, "depth", version="1", half=VALIDATION)
_test = partial(Record.of, "depth", version="1", half=TEST)
RECORDS = (
    _validation(fattening, "near surfaces grow by 0.08 s side", "Kanade & Okutomi 1994"),
    _validation(
        edge_shadow,
        "the projector is 0.5 s metres aside",
        "Khoshelham & Elberink 2012",
        episode="side",
    ),
    _test(
        flying_pixels,
        "the share s of the pixels beside edges",
        "Reynolds et al. 2011",
        frame="which, and their depth",
    ),
)
