"""Multipath: over-estimated depth beside farther surfaces, as by the echo of a second light path.

The sources of the constants stand in the record, in ``depth.py``.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numba import njit

from mitigate.corruptions.depth_sensor import LIGHT_SPEED, NEAREST, DepthSensor, is_valid
from mitigate.corruptions.keying import Key

ECHO_REACH = 0.03  # of min(H, W): half side of the square in which an echo is found
ECHO_GAP = 2.5  # metres
ECHO_STRENGTH = 0.9
ECHO_HERTZ = 20e6


def echo_shift(gap: np.ndarray, severity: float) -> np.ndarray:
    """Over-estimation in metres for ``gap`` metres to the farther surface (two-path phasor sum)."""
    scale = LIGHT_SPEED / (4.0 * math.pi * ECHO_HERTZ)
    beta, phase = ECHO_STRENGTH * severity, gap / scale
    return scale * np.arctan2(beta * np.sin(phase), 1.0 + beta * np.cos(phase))


@lru_cache(maxsize=32)
def echo_polynomial(severity: float) -> np.ndarray:
    """float32 [8]: p with echo_shift = gap p(gap) up to 0.01 mm, lowest power first.

    It is the interpolation at Chebyshev's nodes of [0, 2.5] m, where the shift is smooth: a kernel
    without table look-ups runs in vectors.
    """
    degree = 7
    nodes = 0.5 * ECHO_GAP * (1.0 + np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1)))
    share = echo_shift(nodes, severity) / nodes
    fit = np.polynomial.Polynomial.fit(nodes, share, degree, domain=[0.0, ECHO_GAP])
    return fit.convert().coef.astype(np.float32)


@njit(cache=True)
def larger(row, other):
    """In place: row = max(row, other), float32; the two do not overlap."""
    for x in range(row.size):
        row[x] = row[x] if row[x] > other[x] else other[x]


@njit(cache=True)
def farthest_along(row, spare, reach):
    """In place: maximum over the 2 reach + 1 entries from each on (van Herk's doubling)."""
    have, want, size = 1, 2 * reach + 1, row.size
    while have < want:
        step = min(have, want - have)
        for x in range(size):
            spare[x] = row[x]
        larger(row[: size - step], spare[step:])
        have += step


@njit(cache=True)
def _keep_valid(source, target):
    for x in range(source.size):
        z = source[x]
        target[x] = z if is_valid(z) else np.float32(0)


@njit(cache=True)
def _add_echo(source, far, p, z_max, target):
    for x in range(source.size):
        z = source[x]
        gap = min(max(far[x] - z, np.float32(0)), np.float32(ECHO_GAP))
        share = ((p[7] * gap + p[6]) * gap + p[5]) * gap + p[4]
        share = (((share * gap + p[3]) * gap + p[2]) * gap + p[1]) * gap + p[0]
        moved = min(max(z + max(share * gap, np.float32(0)), NEAREST), z_max)
        target[x] = moved if is_valid(z) else z


@njit(cache=True)
def _echo(views, reach, polynomial, z_max, out):
    count, height, width = views.shape
    far = np.empty((height + 2 * reach, width + 2 * reach), np.float32)
    spare = np.empty(width + 2 * reach, np.float32)
    for v in range(count):
        for y in range(height + 2 * reach):
            row = far[y]
            for x in range(row.size):
                row[x] = np.float32(0)
        for y in range(height):
            row = far[y + reach]
            _keep_valid(views[v, y], row[reach : reach + width])
            farthest_along(row, spare, reach)
        have, want, rows = 1, 2 * reach + 1, height + 2 * reach
        while have < want:
            step = min(have, want - have)
            rows -= step
            for y in range(rows):
                larger(far[y, :width], far[y + step, :width])
            have += step
        for y in range(height):
            _add_echo(views[v, y], far[y, :width], polynomial, z_max, out[v, y])


def multipath(views: np.ndarray, severity: float, key: Key, sensor: DepthSensor) -> np.ndarray:
    """Over-estimate depth beside farther surfaces, as a second light path does."""
    reach = max(1, round(ECHO_REACH * min(views.shape[1:])))
    out = np.empty_like(views)
    _echo(views, reach, echo_polynomial(severity), np.float32(sensor.z_max), out)
    return out
