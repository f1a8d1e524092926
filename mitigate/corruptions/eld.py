"""Simulate low light with sensor noise, using the ELD model.

Source: Wei et al., "Physics-based noise modeling for extreme low-light photography", IEEE TPAMI
2021. The noise model is D = K * Poisson(I) + TukeyLambda + row noise, rounded by the ADC.
Simplifications: sRGB is approximated by an exponent of 2.2, noise is sampled per channel without a
Bayer pattern, and the three channels of a row have the same row noise. Negative values are clipped
to 0, which brightens dark areas, as in real cameras.

Sampling a channel needs two table look-ups. One table contains photon counts by signal level and
quantile; the other one contains quantiles of read noise. One hash is computed per pixel. Its bits
select the quantiles for all three channels.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numba import njit

from mitigate.corruptions.keying import Key, digest, mix, normal_table, unit_normals, view_streams
from mitigate.corruptions.masks import low_light_mask

# full scale in sensor units: 2^14 - 1 minus the black level of 800 (Sony A7S2)
WHITE = 15583.0
DARKEST = 300.0  # exposure ratio at severity 1; ELD trains with ratios of 100 to 300
GAMMA = 2.2
# The calibration of the camera is from the paper: GAINS is the range of the gain K.
# READ and ROW are the numbers (a, b) in ln(sigma) = a * ln(K) + b for read noise and row noise.
GAINS = (0.0939, 6.011)
READ = (0.4621, 0.5657)
ROW = (0.5275, -0.5917)
LEVELS = 4 * 255 + 1  # signal levels in the photon table: grey levels 0 to 255 in steps of 1/4
PHOTON_BITS = 8
READ_BITS = 12

_U = np.uint64


@dataclass(frozen=True)
class Noise:
    """Noise parameters at one severity."""

    ratio: float  # exposure ratio
    gain: float  # K
    shape: float  # Tukey lambda
    read: float  # sigma of the read noise
    row: float  # sigma of the row noise


def noise_at(severity: float) -> Noise:
    """Return the noise parameters at ``severity``; sigmas are in sensor units."""
    low, high = GAINS
    gain = low * (high / low) ** severity
    read, row = (math.exp(a * math.log(gain) + b) for a, b in (READ, ROW))
    return Noise(DARKEST**severity, gain, 0.13 - 0.27 * severity, read, row)


def tukey_lambda(u: np.ndarray, shape: float) -> np.ndarray:
    """Return quantiles (u^l - (1 - u)^l) / l of the Tukey lambda distribution (l = ``shape``).

    For l = 0, this is the logistic distribution.
    """
    if abs(shape) < 1e-9:
        return np.log(u / (1.0 - u))
    return (u**shape - (1.0 - u) ** shape) / shape


@njit(cache=True)
def _photon_table(means, points, deviates, out):
    """Compute Poisson quantiles [means, points].

    They are exact for means up to 64. For larger means, the Cornish-Fisher expansion approximates
    them.
    """
    for level in range(means.size):
        mean = means[level]
        if mean > 64.0:
            root = math.sqrt(mean)
            for q in range(points.size):
                z = deviates[q]
                count = mean + root * z + (z * z - 1.0) / 6.0 + (z - z * z * z) / (72.0 * root)
                out[level, q] = max(0.0, math.floor(count + 0.5))
            continue
        count, mass = 0, math.exp(-mean)
        total = mass
        for q in range(points.size):
            while total < points[q] and count < 1000:
                count += 1
                mass *= mean / count
                total += mass
            out[level, q] = count


class Tables(NamedTuple):
    """The look-up tables of one severity; int32 values are in units of 1/256 of a sensor unit.

    ``photons`` is int32 [LEVELS * 256]; ``read`` and ``row`` are int32 [4096]. ``decode`` (uint8
    [D]) maps the sum of the three values and ``offset``, in whole sensor units, to a grey level.
    """

    photons: np.ndarray
    read: np.ndarray
    row: np.ndarray
    decode: np.ndarray
    offset: int


@lru_cache(maxsize=16)
def tables(severity: float) -> Tables:
    """Return the look-up tables of one severity; building them takes about 3 ms."""
    noise = noise_at(severity)
    signal = (np.arange(LEVELS) / (LEVELS - 1)) ** GAMMA * WHITE / noise.ratio
    points = (np.arange(1 << PHOTON_BITS) + 0.5) / (1 << PHOTON_BITS)
    counts = np.empty((LEVELS, points.size))
    _photon_table(signal / noise.gain, points, unit_normals(PHOTON_BITS), counts)
    middles = (np.arange(1 << READ_BITS) + 0.5) / (1 << READ_BITS)
    parts = noise.gain * counts, noise.read * tukey_lambda(middles, noise.shape)
    photons, read = (np.rint(256.0 * part).astype(np.int32) for part in parts)
    row = np.rint(256.0 * noise.row * normal_table().astype(np.float64)).astype(np.int32)
    lowest, highest = (int(f(read) + f(row) + f(photons)) // 256 for f in (np.min, np.max))
    digital = np.clip(np.arange(lowest - 1, highest + 2), 0, WHITE / noise.ratio)
    decode = np.rint(255.0 * (digital * noise.ratio / WHITE) ** (1.0 / GAMMA)).astype(np.uint8)
    return Tables(photons.ravel(), read, row, decode, 1 - lowest)


@njit(cache=True)
def _levels(source, opacity, part, out):
    """Darken one row like ``low_light``, but with a resolution of a quarter of a grey level."""
    for i in range(part.size):
        gap = np.int16(np.int16(-np.int16(source[i])) << 7)
        part[i] = (np.int32(gap) * np.int32(opacity[i])) >> np.int32(16)
    for i in range(part.size):
        out[i] = np.int16(np.int16(np.int16(source[i]) << 6) + part[i] + 8) >> 4


@njit(cache=True)
def _sample(views, opacity, streams, row_streams, photons, read, row, decode, offset, out):
    """Sample noisy frames (uint8 [V, H, W, 3]).

    Unsigned indices avoid numba's check for negative indices.
    """
    count, height, width, _ = views.shape
    size = 3 * width
    flat, into = views.reshape(count, height, size), out.reshape(count, height, size)
    part, levels = np.empty(size, np.int16), np.empty(size, np.uint32)
    words = np.empty(width, np.uint64)
    for v in range(count):
        for y in range(height):
            target, first = into[v, y], _U(y * words.size)
            _levels(flat[v, y], opacity[y], part, levels)
            for x in range(words.size):
                words[x] = mix(streams[v], first + _U(x))
            shift = row[mix(row_streams[v], _U(y)) >> _U(52)] + np.int32(256 * offset + 128)
            for x in range(words.size):
                word, start = words[x], _U(3 * x)
                for c in range(3):
                    i, bits = start + _U(c), word >> _U(20 * c)
                    d = photons[(_U(levels[i]) << _U(8)) | (bits & _U(0xFF))] + shift
                    d += read[(bits >> _U(8)) & _U(0xFFF)]
                    target[i] = decode[_U(np.uint32(d) >> np.uint32(8))]


def low_light_noise(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Darken views (uint8 [V, H, W, 3]) like ``low_light`` and add sensor noise.

    The frame is darkened with the same mask as in ``low_light``. Up to severity 0.6, the mean
    brightness is within 1 % of the brightness under ``low_light``. At higher severities, noise is
    clipped at 0, which brightens the frame, so that severity 1 is not darker than severity 0.8.
    """
    count, height, width, _ = views.shape
    mask = low_light_mask(digest(key, "low_light"), severity, height, width)
    streams = view_streams(key, "low_light_noise", count)
    row_streams = view_streams(key, "row_noise", count)
    out = np.empty_like(views)
    _sample(views, mask, streams, row_streams, *tables(severity), out)
    return out
