"""Low light with sensor noise: the ELD model (Wei et al., "Physics-based noise modeling for extreme
low-light photography", IEEE TPAMI 2021), our own code.

D = K Poisson(I) + TukeyLambda + row noise, rounded by the ADC (SUITE section 4). Simplifications:
sRGB is treated as a 2.2 power, noise is drawn per channel without a Bayer pattern, and a row's
draw is common to its three channels. Clipping at 0 brightens deep shadows as real cameras do.

Sampling is two table look-ups a channel: a (signal level x quantile) table of photon counts and a
quantile table of read noise, indexed by the bits of one hash a pixel.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numba import njit

from mitigate.corruptions.keying import Key, digest, mix, normals, unit_normals
from mitigate.corruptions.rgb import light_gain

WHITE = 15583.0  # sensor units at full scale: 14 bits less the black level (Sony A7S2)
DARKEST = 300.0  # exposure ratio at s = 1 (ELD trains on 100-300)
GAMMA = 2.2
LEVELS = 1024  # signal levels of the photon table: quarters of a grey level
PHOTON_BITS = 8
READ_BITS = 12

_U = np.uint64


@dataclass(frozen=True)
class Camera:
    """A calibration of the paper: gain range, and (a, b) of ln sigma = a ln K + b."""

    name: str
    gain: tuple[float, float]
    read: tuple[float, float]
    row: tuple[float, float]


SONY_A7S2 = Camera("Sony A7S2", (0.0939, 6.011), (0.4621, 0.5657), (0.5275, -0.5917))
NIKON_D850 = Camera("Nikon D850", (0.415, 26.56), (0.4774, -0.0904), (0.4483, -1.798))
CANON_5D4 = Camera("Canon 5D4", (0.218, 13.96), (0.6559, 1.0927), (0.4713, -0.8079))


@dataclass(frozen=True)
class Noise:
    """The parameters of one severity: exposure ratio, gain K, Tukey lambda, two widths."""

    ratio: float
    gain: float
    shape: float
    read: float
    row: float


def noise_at(severity: float, camera: Camera = SONY_A7S2) -> Noise:
    """The noise parameters at ``severity``; sigmas in sensor units."""
    low, high = camera.gain
    gain = low * (high / low) ** severity
    read, row = (math.exp(a * math.log(gain) + b) for a, b in (camera.read, camera.row))
    return Noise(DARKEST**severity, gain, 0.13 - 0.27 * severity, read, row)


def tukey_lambda(u: np.ndarray, shape: float) -> np.ndarray:
    """Quantiles (u^l - (1 - u)^l) / l of the Tukey lambda distribution; logistic at l = 0."""
    if abs(shape) < 1e-9:
        return np.log(u / (1.0 - u))
    return (u**shape - (1.0 - u) ** shape) / shape


@njit(cache=True)
def _photon_table(means, points, deviates, out):
    """Poisson quantiles [means, points]: the exact CDF up to 64, Cornish-Fisher above."""
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


@dataclass(frozen=True)
class Tables:
    """photons float32 [LEVELS, 256], read float32 [4096], decode uint8 [D], all in sensor units."""

    photons: np.ndarray
    read: np.ndarray
    decode: np.ndarray
    row: float


@lru_cache(maxsize=16)
def tables(severity: float, camera: Camera = SONY_A7S2) -> Tables:
    """The look-up tables of one severity, about 3 ms to build."""
    noise = noise_at(severity, camera)
    signal = (np.arange(LEVELS) / (LEVELS - 1)) ** GAMMA * WHITE / noise.ratio
    points = (np.arange(1 << PHOTON_BITS) + 0.5) / (1 << PHOTON_BITS)
    photons = np.empty((LEVELS, points.size))
    _photon_table(signal / noise.gain, points, unit_normals(PHOTON_BITS), photons)
    middles = (np.arange(1 << READ_BITS) + 0.5) / (1 << READ_BITS)
    read = noise.read * tukey_lambda(middles, noise.shape)
    top = math.ceil(WHITE / noise.ratio)
    decode = 255.0 * np.minimum(np.arange(top + 1) * noise.ratio / WHITE, 1.0) ** (1.0 / GAMMA)
    return Tables(
        (noise.gain * photons).astype(np.float32),
        read.astype(np.float32),
        np.rint(decode).astype(np.uint8),
        noise.row,
    )


@njit(cache=True)
def _sample(views, gain, streams, rows, photons, read, decode, out):
    count, height, width, _ = views.shape
    top = np.int32(decode.size - 1)
    for v in range(count):
        stream = streams[v]
        for y in range(height):
            shift = rows[v, y] + np.float32(0.5)
            for x in range(width):
                word = mix(stream, _U(y * width + x))
                factor = gain[y, x]
                for c in range(3):
                    bits = word >> _U(20 * c)
                    level = (np.uint32(views[v, y, x, c]) * factor + np.uint32(32768)) >> 16
                    value = photons[level, bits & _U(0xFF)]
                    value += read[(bits >> _U(8)) & _U(0xFFF)] + shift
                    d = np.int32(np.floor(value))
                    out[v, y, x, c] = decode[min(max(d, np.int32(0)), top)]


@lru_cache(maxsize=16)
def _level_gain(key: Key, severity: float, height: int, width: int) -> np.ndarray:
    gain = light_gain(key, severity, height, width) * (LEVELS - 1) / 255.0
    return np.rint(gain * 65536.0).astype(np.uint32)


def low_light_noise(
    views: np.ndarray, severity: float, key: Key, heading=None, camera: Camera = SONY_A7S2
) -> np.ndarray:
    """``low_light`` seen by a noisy sensor: same mask, same mean, uint8 [V, H, W, 3]."""
    count, height, width, _ = views.shape
    table = tables(severity, camera)
    gain = _level_gain(key.still(), severity, height, width)
    names = [digest(key, "low_light_noise", frame=True, view=v) for v in range(count)]
    streams = np.array(names, np.uint64)
    names = [digest(key, "row_noise", frame=True, view=v) for v in range(count)]
    rows = np.float32(table.row) * np.stack([normals(name, height) for name in names])
    out = np.empty_like(views)
    _sample(views, gain, streams, rows, table.photons, table.read, table.decode, out)
    return out
