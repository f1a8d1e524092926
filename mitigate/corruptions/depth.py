"""The four depth corruptions of the standard suite, for float32 panoramas [V, H, W] in metres.

A pixel is invalid if its depth is 0, negative, NaN or infinite. Invalid pixels are returned
unchanged and do not affect their neighbours. Only ``missing_data`` makes valid pixels invalid. All
other valid depth is clipped to [0.001, z_max]. Formulas and sources: docs/corruptions.md.
"""

from __future__ import annotations

import math
from functools import lru_cache, partial

import numpy as np
from numba import njit

from mitigate.corruptions.depth_sensor import LIGHT_SPEED, NEAREST, DepthSensor, is_valid
from mitigate.corruptions.keying import (
    Key,
    cached,
    digest,
    field,
    mix,
    normal_table,
    top_share,
    view_streams,
)
from mitigate.corruptions.record import Record

# half the side length of the square in which an echo is searched for, as a fraction of min(H, W)
ECHO_REACH = 0.03
ECHO_GAP = 2.5  # metres
ECHO_STRENGTH = 0.9
ECHO_HERTZ = 20e6


def echo_shift(gap: np.ndarray, severity: float) -> np.ndarray:
    """Return the error in metres at an edge whose background is ``gap`` metres farther away.

    The value is computed from the phasor sum of two light paths.
    """
    scale = LIGHT_SPEED / (4.0 * math.pi * ECHO_HERTZ)
    beta, phase = ECHO_STRENGTH * severity, gap / scale
    return scale * np.arctan2(beta * np.sin(phase), 1.0 + beta * np.cos(phase))


@lru_cache(maxsize=32)
def echo_polynomial(severity: float) -> np.ndarray:
    """Return the coefficients of a polynomial p with echo_shift(gap) = gap * p(gap).

    The coefficients are float32 [8], lowest power first. The error is at most 0.01 mm.

    The polynomial interpolates the shift at the Chebyshev nodes of [0, 2.5] m, where the shift is
    smooth. The compiler can vectorise a polynomial, but not table look-ups.
    """
    degree = 7
    nodes = 0.5 * ECHO_GAP * (1.0 + np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1)))
    share = echo_shift(nodes, severity) / nodes
    fit = np.polynomial.Polynomial.fit(nodes, share, degree, domain=[0.0, ECHO_GAP])
    return fit.convert().coef.astype(np.float32)


@njit(cache=True)
def larger(row, other):
    """Compute row = max(row, other) in place, float32; the two arrays must not overlap."""
    for x in range(row.size):
        row[x] = row[x] if row[x] > other[x] else other[x]


@njit(cache=True)
def farthest_along(row, spare, reach):
    """Replace row[i] by the maximum of row[i] to row[i + 2 * reach].

    The window is doubled repeatedly.
    """
    have, want, size = 1, 2 * reach + 1, row.size
    while have < want:
        step = min(have, want - have)
        for x in range(size):
            spare[x] = row[x]
        larger(row[: size - step], spare[step:])
        have += step


@njit(cache=True)
def extremes(view, reach, sign, out):
    """Write to ``out`` [H, W] the maximum of sign * z in a square around each pixel.

    The side of the square is 2 * reach + 1. Invalid pixels are ignored. The result is -inf if no
    pixel in the square is valid.
    """
    height, width = view.shape
    rows = height + 2 * reach
    wide = np.full((rows, width + 2 * reach), np.float32(-np.inf), np.float32)
    spare = np.empty(width + 2 * reach, np.float32)
    for y in range(height):
        for x in range(width):
            z = view[y, x]
            wide[y + reach, x + reach] = sign * z if is_valid(z) else np.float32(-np.inf)
        farthest_along(wide[y + reach], spare, reach)
    have, want = 1, 2 * reach + 1
    while have < want:
        step = min(have, want - have)
        rows -= step
        for y in range(rows):
            larger(wide[y, :width], wide[y + step, :width])
        have += step
    out[:] = wide[:height, :width]


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
    far = np.empty_like(views[0])
    for v in range(views.shape[0]):
        extremes(views[v], reach, np.float32(1), far)
        for y in range(views.shape[1]):
            _add_echo(views[v, y], far[y], polynomial, z_max, out[v, y])


def echo_reach(height: int, width: int) -> int:
    """Return half the side length, in pixels, of the square that ``multipath`` searches."""
    return max(1, round(ECHO_REACH * min(height, width)))


def multipath(views: np.ndarray, severity: float, key: Key, sensor: DepthSensor) -> np.ndarray:
    """Overestimate depth next to farther surfaces, as if light took a second path."""
    reach, out = echo_reach(*views.shape[1:]), np.empty_like(views)
    _echo(views, reach, echo_polynomial(severity), np.float32(sensor.z_max), out)
    return out


# the RMS error grows with z^2, as in a D435; severity 0.1 is similar to a Kinect
NOISE_BASE, NOISE_SQUARE = 0.02, 0.02
HOLE_CORRELATION = 0.025  # as a fraction of min(H, W)
# This is the fraction of missing pixels at severity 1.
# Indoors, often more than half of the pixels are missing (Zhang & Funkhouser 2018).
HOLE_SHARE = 0.5
FAR_SHARE = 0.25  # fraction of the holes that have the value z_max ("incorrectly large")
HOLE_FRAMES = 5  # number of frames after which holes move
STEP = 0.5  # step of quantization in metres at severity 1
# minimum step in metres; dividing depth by a smaller step would overflow float32
STEP_LEAST = 1e-30

_U = np.uint64


@njit(cache=True)
def _add_noise(views, streams, base, square, z_max, table, out):
    """Add noise in blocks of 256 pixels.

    For each block, a first loop reads normal random numbers from the table. The arithmetic is in a
    second loop, because the compiler can vectorise it only without table look-ups.
    """
    draws = np.empty(256, np.float32)
    for v in range(views.shape[0]):
        stream = streams[v]
        for start in range(0, views.shape[1], 256):
            source, target = views[v, start : start + 256], out[v, start : start + 256]
            for i in range(64):
                word = mix(stream, _U((start >> 2) + i))
                for j in range(4):
                    draws[4 * i + j] = table[(word >> _U(16 * j + 4)) & _U(0xFFF)]
            for i in range(source.size):
                z = min(source[i], z_max)
                moved = min(max(z + (base + square * z * z) * draws[i], NEAREST), z_max)
                target[i] = moved if is_valid(source[i]) else source[i]


def gaussian_noise(views: np.ndarray, severity: float, key: Key, sensor: DepthSensor) -> np.ndarray:
    """Add severity * (0.02 + 0.02 z^2) * N(0, 1) to each pixel; z is limited to z_max."""
    base, square = np.float32(severity * NOISE_BASE), np.float32(severity * NOISE_SQUARE)
    out = np.empty_like(views)
    streams, z_max = view_streams(key, "gaussian_noise", len(views)), np.float32(sensor.z_max)
    pixels, into = (each.reshape(len(views), -1) for each in (views, out))
    _add_noise(pixels, streams, base, square, z_max, normal_table(), into)
    return out


@cached
def hole_map(value: int, severity: float, height: int, width: int) -> np.ndarray:
    """Return a code per pixel, uint8 [H, 2 W]: 0 keeps depth, 1 removes it, 2 sets it to z_max.

    The map is stored twice, side by side, so that a shifted row is one contiguous slice.
    """
    smooth, cells = field(value, height, width, HOLE_CORRELATION)
    holes = smooth >= top_share(cells, HOLE_SHARE * severity)
    far = smooth >= top_share(cells, HOLE_SHARE * FAR_SHARE * severity)
    return np.tile(holes.astype(np.uint8) + far, 2)


@lru_cache(maxsize=64)  # several frames have the same holes
def _hole_streams(seed: int, episode: str, placement: int, views: int) -> np.ndarray:
    return view_streams(Key(seed, episode, placement), "missing_offset", views)


def hole_streams(key: Key, views: int) -> np.ndarray:
    """Return the digest that determines the offset of ``hole_map`` in each view, uint64 [views]."""
    return _hole_streams(int(key.seed), str(key.episode), int(key.frame) // HOLE_FRAMES, views)


@njit(cache=True)
def _drop_row(source, holes, missing, z_max, target):
    for x in range(source.size):
        z, hole = source[x], holes[x]
        read = missing if hole == 1 else z_max
        changed = read if hole > 0 else min(max(z, NEAREST), z_max)
        target[x] = changed if is_valid(z) else z


@njit(cache=True)
def _drop(views, holes, streams, missing, z_max, out):
    count, height, width = views.shape
    for v in range(count):
        down = np.int64(mix(streams[v], _U(0)) % _U(height))
        shift = np.int64(mix(streams[v], _U(1)) % _U(width))
        for y in range(height):
            row = holes[(y + down) % height, shift : shift + width]
            _drop_row(views[v, y], row, missing, z_max, out[v, y])


def missing_data(views: np.ndarray, severity: float, key: Key, sensor: DepthSensor) -> np.ndarray:
    """Replace the depth of the pixels where a random field is highest.

    These pixels are a fraction 0.5 * severity of each view. A quarter of them become z_max, and the
    others become missing. The field moves every 5 frames.
    """
    count, height, width = views.shape
    holes = hole_map(digest(key, "missing_data"), severity, height, width)
    streams = hole_streams(key, count)
    out = np.empty_like(views)
    missing, z_max = np.float32(sensor.missing), np.float32(sensor.z_max)
    _drop(views, holes, streams, missing, z_max, out)
    return out


@njit(cache=True)
def _round_off(views, step, z_max, out):
    for i in range(views.size):
        z = views[i]
        stepped = np.rint(z / step) * step
        out[i] = min(max(stepped, NEAREST), z_max) if is_valid(z) else z


def depth_step(severity: float) -> float:
    """Return the step in metres to which ``quantization`` rounds."""
    return max(STEP * severity, STEP_LEAST)


def quantization(views: np.ndarray, severity: float, key: Key, sensor: DepthSensor) -> np.ndarray:
    """Round depth to multiples of 0.5 * severity metres."""
    out = np.empty_like(views)
    step, z_max = np.float32(depth_step(severity)), np.float32(sensor.z_max)
    _round_off(views.reshape(-1), step, z_max, out.reshape(-1))
    return out


_record = partial(Record.of, "depth")
RECORDS = (
    _record(gaussian_noise, "sd s (0.02 + 0.02 z^2) metres", "D435 error model", frame="noise"),
    _record(
        missing_data,
        "loses 0.5 s of the pixels, a quarter reads far",
        "NavTrust, Zhang & Funkhouser 2018",
        episode="field",
        frame="offset, every 5 frames",
    ),
    _record(multipath, "strength 0.9 s of the echo beside edges", "Fuchs 2010, Jimenez 2014"),
    _record(quantization, "steps of 0.5 s metres", "NavTrust, Ideses 2007, Wei 2013"),
)
