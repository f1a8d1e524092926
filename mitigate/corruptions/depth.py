"""The four depth corruptions of float32 panoramas [V, H, W] in metres.

A pixel is invalid where z <= 0, NaN or infinite: it comes back as it was and takes no part in a
neighbourhood. Valid depth becomes invalid only through missing data; the rest is clipped to
[0.001, z_max]. Formulas and sources: SUITE section 3.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numba import njit

from mitigate import keys
from mitigate.corruptions.keying import (
    Key,
    digest,
    field,
    mix,
    normal_table,
    scramble,
    top_share,
)

NEAREST = np.float32(1e-3)  # metres: valid depth never falls below
NOISE_BASE, NOISE_SQUARE = 0.02, 0.02  # D435: RMS grows with z^2; s = 0.1 is about a Kinect
HOLE_CORRELATION = 0.025  # of min(H, W)
HOLE_SHARE = 0.5  # of the pixels at s = 1 (Zhang & Funkhouser 2018: often over half indoors)
FAR_SHARE = 0.25  # of the holes read z_max ("incorrectly large")
HOLE_FRAMES = 5  # frames between two placements of the holes
ECHO_REACH = 0.03  # of min(H, W): half side of the square in which an echo is found
ECHO_GAP = 2.5  # metres
ECHO_STRENGTH = 0.9
ECHO_HERTZ = 20e6
LIGHT_SPEED = 299_792_458.0  # metres a second
STEP = 0.5  # metres at s = 1
ECHO_CELLS = 1024  # of the phase table

_U = np.uint64


@dataclass(frozen=True)
class DepthSensor:
    """A depth camera that normalises: range in metres and the value that means "no reading".

    ``missing`` is what missing data writes, in metres, and it is part of the contract with the
    agent: R2R-CE agents read 0 as a hole; VLFM reads it as far and L3MVN as the column maximum.
    """

    z_min: float = 0.0
    z_max: float = keys.Z_MAX
    missing: float = 0.0

    def to_metres(self, normalised: np.ndarray) -> np.ndarray:
        """[0, 1] float to metres; the sentinel 0 (no reading) stays 0."""
        metres = self.z_min + normalised * np.float32(self.z_max - self.z_min)
        return np.where(normalised == 0, 0, metres).astype(np.float32)

    def from_metres(self, metres: np.ndarray) -> np.ndarray:
        """Metres to [0, 1] float; the sentinel 0 (no reading) stays 0."""
        unit = (metres - self.z_min) / np.float32(self.z_max - self.z_min)
        return np.where(metres == 0, 0, np.clip(unit, 0, 1)).astype(np.float32)


@njit(inline="always")
def _valid(z):
    return z > np.float32(0) and z < np.float32(np.inf)


@njit(cache=True)
def _add_noise(views, streams, base, square, z_max, table, out):
    for v in range(views.shape[0]):
        stream, source, target = streams[v], views[v], out[v]
        for i in range(source.size):
            word = mix(stream, _U(i >> 2))
            n = table[(word >> _U((i & 3) << 4)) & _U(0xFFFF)]
            z = source[i]
            moved = z + (base + square * z * z) * n
            target[i] = min(max(moved, NEAREST), z_max) if _valid(z) else z


def _flat(views: np.ndarray) -> np.ndarray:
    return views.reshape(views.shape[0], -1)


def gaussian_noise(views: np.ndarray, severity: float, key: Key, sensor: DepthSensor) -> np.ndarray:
    """z + s (0.02 + 0.02 z^2) n, n ~ N(0, 1) for each pixel of each frame."""
    names = [digest(key, "gaussian_noise", frame=True, view=v) for v in range(views.shape[0])]
    base, square = np.float32(severity * NOISE_BASE), np.float32(severity * NOISE_SQUARE)
    out = np.empty_like(views)
    streams, z_max = np.array(names, np.uint64), np.float32(sensor.z_max)
    _add_noise(_flat(views), streams, base, square, z_max, normal_table(), _flat(out))
    return out


@lru_cache(maxsize=16)
def hole_map(value: int, severity: float, height: int, width: int) -> np.ndarray:
    """uint8 [H, W]: 0 kept, 1 no reading, 2 reads z_max."""
    smooth, ordered = field(value, height, width, HOLE_CORRELATION)
    holes = smooth >= top_share(ordered, HOLE_SHARE * severity)
    far = smooth >= top_share(ordered, HOLE_SHARE * FAR_SHARE * severity)
    return holes.astype(np.uint8) + far


@njit(cache=True)
def _drop(views, holes, down, right, missing, z_max, out):
    count, height, width = views.shape
    for v in range(count):
        shift = right[v]
        for y in range(height):
            source, target, row = views[v, y], out[v, y], holes[(y + down[v]) % height]
            for part in range(2):
                start, end, offset = 0, width - shift, shift
                if part == 1:
                    start, end, offset = width - shift, width, shift - width
                for x in range(start, end):
                    z, hole = source[x], row[x + offset]
                    read = missing if hole == 1 else z_max
                    kept = min(max(z, NEAREST), z_max)
                    target[x] = (read if hole > 0 else kept) if _valid(z) else z


def missing_data(views: np.ndarray, severity: float, key: Key, sensor: DepthSensor) -> np.ndarray:
    """Lose the top 0.5 s of a random field; a quarter of it reads z_max. Moves every 5 frames."""
    count, height, width = views.shape
    holes = hole_map(digest(key, "missing_data"), severity, height, width)
    still = Key(key.seed, key.episode, key.frame // HOLE_FRAMES)
    names = [digest(still, "missing_offset", frame=True, view=v) for v in range(count)]
    down = np.array([scramble(name, 0) % height for name in names])
    right = np.array([scramble(name, 1) % width for name in names])
    out = np.empty_like(views)
    missing, z_max = np.float32(sensor.missing), np.float32(sensor.z_max)
    _drop(views, holes, down, right, missing, z_max, out)
    return out


@lru_cache(maxsize=32)
def echo_table(severity: float) -> np.ndarray:
    """float32 [1026]: over-estimation in metres for gaps 0 .. 2.5 m (two-path phasor sum)."""
    gap = np.arange(ECHO_CELLS + 2) * (ECHO_GAP / ECHO_CELLS)
    scale = LIGHT_SPEED / (4.0 * math.pi * ECHO_HERTZ)
    beta, phase = ECHO_STRENGTH * severity, gap / scale
    shift = scale * np.arctan2(beta * np.sin(phase), 1.0 + beta * np.cos(phase))
    return np.maximum(shift, 0.0).astype(np.float32)


@njit(cache=True)
def _farthest(clean, reach):
    """In place: maximum over the (2 reach + 1)^2 square whose first corner is the pixel."""
    rows, cols = clean.shape
    have, want = 1, 2 * reach + 1
    while have < want:
        step = min(have, want - have)
        for y in range(rows - step):
            row, other = clean[y], clean[y + step]
            for x in range(cols):
                row[x] = max(row[x], other[x])
        for y in range(rows):
            row = clean[y]
            for x in range(cols - step):
                row[x] = max(row[x], row[x + step])
        have += step


@njit(cache=True)
def _echo(views, reach, table, z_max, out):
    count, height, width = views.shape
    clean = np.empty((height + 2 * reach, width + 2 * reach), np.float32)
    per_metre = np.float32(ECHO_CELLS / ECHO_GAP)
    for v in range(count):
        clean[:] = 0
        for y in range(height):
            source, row = views[v, y], clean[y + reach, reach : reach + width]
            for x in range(width):
                row[x] = source[x] if _valid(source[x]) else np.float32(0)
        _farthest(clean, reach)
        for y in range(height):
            source, target, far = views[v, y], out[v, y], clean[y]
            for x in range(width):
                z = source[x]
                gap = max(far[x] - z, np.float32(0)) if _valid(z) else np.float32(0)
                place = min(gap * per_metre, np.float32(ECHO_CELLS))
                cell = np.int32(place)
                dz = table[cell] + (place - np.float32(cell)) * (table[cell + 1] - table[cell])
                target[x] = min(max(z + dz, NEAREST), z_max) if _valid(z) else z


def multipath(views: np.ndarray, severity: float, key: Key, sensor: DepthSensor) -> np.ndarray:
    """Over-estimate depth beside farther surfaces, as a second light path does."""
    reach = max(1, round(ECHO_REACH * min(views.shape[1:])))
    out = np.empty_like(views)
    _echo(views, reach, echo_table(severity), np.float32(sensor.z_max), out)
    return out


@njit(cache=True)
def _round_off(views, step, z_max, out):
    for i in range(views.size):
        z = views[i]
        stepped = np.rint(z / step) * step
        out[i] = min(max(stepped, NEAREST), z_max) if _valid(z) else z


def quantization(views: np.ndarray, severity: float, key: Key, sensor: DepthSensor) -> np.ndarray:
    """Round to steps of 0.5 s metres."""
    out = np.empty_like(views)
    step, z_max = np.float32(STEP * severity), np.float32(sensor.z_max)
    _round_off(views.reshape(-1), step, z_max, out.reshape(-1))
    return out
