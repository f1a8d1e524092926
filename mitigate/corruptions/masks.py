"""Compute the masks of RGB corruptions: darkness, dirt, glare and a black disk.

Darkness, dirt and glare are blended with ``out = x + (colour - x) * alpha``, where ``alpha`` is a
16-bit opacity mask. Masks are cached by the 64-bit digest of their episode, so a mask is computed
only for the first frame of an episode. Formulas and sources are in docs/corruptions.md. Constants
without a source were chosen by this project.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numba import njit

from mitigate.core import observation
from mitigate.corruptions.keying import cached, field, top_share, uniform

# the mean brightness is between the values of RobustNav (factor 0.57-0.31) and 3DCC (0.24-0.12)
DARK_BASE, DARK_RAMP = 0.60, 0.37
SPATTER_CORRELATION = 0.018  # correlation length as a fraction of min(H, W)
SPATTER_COVER = 0.45  # covered fraction at severity 1; ImageNet-C covers 0.04 to 0.57
SPATTER_EDGE = 0.25  # width of soft edges, as a multiple of the field's standard deviation
SPATTER_COLOURS = ((63, 42, 20), (175, 238, 238))  # mud, water (ImageNet-C)
FLARE_CORE, FLARE_CORE_WIDTH = 0.85, 0.18  # widths are fractions of the image diagonal
FLARE_HALO, FLARE_HALO_WIDTH = 0.30, 0.35
FLARE_TINT = (1.0, 0.96, 0.88)
# range and size of the radial table; neighbouring cells differ by less than 0.04 grey levels
GLOW_REACH, GLOW_CELLS = 1.5, 16384
DISK_RADIUS = 0.5  # radius at severity 1 as a fraction of min(H, W)
NEUTRAL = (1.0, 1.0, 1.0)


@njit(cache=True)
def _expand(share, weight, out):
    """Write min(share * weight of the channel, 1) to ``out`` in units of 1/32768.

    ``share`` is [H, W], and ``out`` is int16 [H, 3 W].
    """
    for y in range(share.shape[0]):
        row, target = share[y], out[y]
        for c in range(3):
            scale = np.float32(weight[c] * 32768.0)
            for x in range(row.size):
                value = min(row[x] * scale + np.float32(0.5), np.float32(32767.0))
                target[3 * x + c] = np.int16(np.int32(value))


def opacity_mask(
    share: np.ndarray, strength: float, tint: tuple[float, float, float]
) -> np.ndarray:
    """Return the opacity mask: the product of ``share``, ``strength`` and ``tint``.

    ``share`` is [H, W], with values of at least 0. The mask is int16 [H, 3 W] in units of 1/32768.
    """
    out = np.empty((share.shape[0], 3 * share.shape[1]), np.int16)
    _expand(share, strength * np.array(tint), out)
    return out


@lru_cache(maxsize=64)
def colour_row(colour: tuple[int, int, int], width: int) -> np.ndarray:
    """Return a colour, repeated for the pixels of an image row, int16 [3 W]."""
    return np.tile(np.array(colour, np.int16), width)


@njit(cache=True)
def cover(views, alpha, colour, out):
    """Blend views (uint8 [V, H, W, 3]) with one colour, and write the result to ``out``.

    ``colour`` (int16 [3 W]) is the result of ``colour_row``; ``alpha`` (int16 [H, 3 W]) is the
    opacity. Two separate loops per row of 16-bit numbers compile to full-width vector code.
    """
    count, height, _, _ = views.shape
    flat, into = views.reshape(count, height, -1), out.reshape(count, height, -1)
    part = np.empty(colour.size, np.int16)
    for v in range(count):
        for y in range(height):
            source, opacity, target = flat[v, y], alpha[y], into[v, y]
            for i in range(part.size):
                gap = np.int16((colour[i] - np.int16(source[i])) << 7)
                part[i] = (np.int32(gap) * np.int32(opacity[i])) >> np.int32(16)
            for i in range(part.size):
                target[i] = source[i] + ((part[i] + 32) >> 6)


def covered(views: np.ndarray, alpha: np.ndarray, colour: np.ndarray) -> np.ndarray:
    """Return the result of ``cover`` as a new array."""
    out = np.empty_like(views)
    cover(views, alpha, colour, out)
    return out


def ramp_terms(value: int, height: int, width: int) -> tuple[np.ndarray, np.ndarray, bool]:
    """Return one term per image row and one per column, from which ``light_ramp`` is computed.

    Returns:
        One term per row (float32 [H]), one term per column (float32 [W]), and a flag. If the flag
        is True, the ramp is the square root of the sum of both terms; otherwise, it is the sum.
    """
    y, x = (np.arange(height) + 0.5) / height, (np.arange(width) + 0.5) / width
    if uniform(value, 0) < 0.5:
        angle = 2.0 * math.pi * uniform(value, 1)
        reach = abs(math.cos(angle)) + abs(math.sin(angle))
        down, right = (y - 0.5) * (math.sin(angle) / reach), (x - 0.5) * (math.cos(angle) / reach)
        return (0.5 + down).astype(np.float32), right.astype(np.float32), False
    u, v = uniform(value, 2), uniform(value, 3)
    far = math.hypot(max(u, 1.0 - u) * width, max(v, 1.0 - v) * height)
    down, right = ((y - v) * (height / far)) ** 2, ((x - u) * (width / far)) ** 2
    return down.astype(np.float32), right.astype(np.float32), True


@cached
def light_ramp(value: int, height: int, width: int) -> np.ndarray:
    """Return a gradient in [0, 1] (float32 [H, W]): a linear ramp, or the distance to a light."""
    down, right, radial = ramp_terms(value, height, width)
    ramp = np.add.outer(down, right)
    return np.sqrt(ramp) if radial else ramp


def light_loss(value: int, severity: float, height: int, width: int) -> np.ndarray:
    """Return the fraction of lost light: severity * (0.60 + 0.37 * ramp), float32 [H, W]."""
    ramp = light_ramp(value, height, width)
    return ramp * np.float32(severity * DARK_RAMP) + np.float32(severity * DARK_BASE)


@cached
def low_light_mask(value: int, severity: float, height: int, width: int) -> np.ndarray:
    """Return the opacity of the dark overlay, int16 [H, 3 W] in units of 1/32768."""
    return opacity_mask(light_loss(value, severity, height, width), 1.0, NEUTRAL)


@cached
def spatter_mask(value: int, severity: float, height: int, width: int) -> np.ndarray:
    """Return the opacity of the dirt, int16 [H, 3 W] in units of 1/32768."""
    smooth, cells = field(value, height, width, SPATTER_CORRELATION)
    level = top_share(cells, SPATTER_COVER * severity)
    share = np.clip((smooth - np.float32(level)) * np.float32(1.0 / SPATTER_EDGE), 0.0, 1.0)
    return opacity_mask(share, 0.5 + 0.5 * severity, NEUTRAL)


def spatter_colour(value: int) -> tuple[int, int, int]:
    """Return the colour of mud or water."""
    return SPATTER_COLOURS[uniform(value) < 0.5]


@lru_cache(maxsize=64)
def flare_centres(
    value: int, views: int, height: int, width: int, heading: float | None
) -> tuple[tuple[float, float] | None, ...]:
    """Return the pixel (x, y) of the light in each view, or None if a view does not show it.

    The direction of the light is fixed in the world. It is sampled as a position in the image of a
    camera with a random yaw: column U(0.1, 0.9) * W and row U(0, 0.5) * H. View number k has the
    yaw ``heading`` - 30 * k degrees and no pitch (``heading`` in radians, counter-clockwise), for
    any number of views. If the heading is unknown, the position is sampled in view 0.
    """
    column, row = 0.1 + 0.8 * uniform(value, 0), 0.5 * uniform(value, 1)
    # focal length in image widths
    focal = 0.5 / math.tan(math.radians(observation.HFOV_DEGREES) / 2.0)
    # angle from the camera's axis to the light, counter-clockwise
    yaw = math.atan2(0.5 - column, focal)
    # tangent of the light's elevation
    tangent = (0.5 - row) * height / width / focal * math.cos(yaw)
    if heading is not None:
        yaw += 2.0 * math.pi * uniform(value, 2) - heading
    centres = []
    for view in range(views):
        turn = yaw + math.radians(observation.VIEW_STEP_DEGREES) * view
        ahead, left = math.cos(turn), math.sin(turn)
        x = 0.5 - focal * left / ahead if ahead > 1e-6 else -1.0
        visible = 0.0 <= x <= 1.0
        y = 0.5 * height - width * focal * tangent / ahead if visible else 0.0
        centres.append((x * width, y) if visible else None)
    return tuple(centres)


@lru_cache(maxsize=1)
def glow_table() -> np.ndarray:
    """Return the glow at severity 1 for distances from 0 to 1.5 image diagonals.

    The table is float32 [GLOW_CELLS + 1].
    """
    r = np.arange(GLOW_CELLS + 1) * (GLOW_REACH / GLOW_CELLS)
    glow = FLARE_CORE * np.exp(-0.5 * (r / FLARE_CORE_WIDTH) ** 2)
    return (glow + FLARE_HALO * np.exp(-r / FLARE_HALO_WIDTH)).astype(np.float32)


@njit(cache=True)
def _look_up(down, right, table, out):
    """Set out[y, x] to the table entry whose index is nearest to sqrt(down[y] + right[x]).

    All arrays are float32.
    """
    for y in range(down.size):
        for x in range(right.size):
            out[y, x] = table[np.int32(np.sqrt(down[y] + right[x]) + np.float32(0.5))]


def glow_terms(x: float, y: float, height: int, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Return squared distances to the pixel (x, y) along each axis.

    The unit of distance is the cell size of ``glow_table``.

    Returns:
        The squared vertical distance of each row (float32 [H]), and the squared horizontal distance
        of each column (float32 [W]).
    """
    cells = GLOW_CELLS / GLOW_REACH / math.hypot(height, width)
    down = ((np.arange(height) + 0.5 - y) * cells) ** 2
    right = ((np.arange(width) + 0.5 - x) * cells) ** 2
    return down.astype(np.float32), right.astype(np.float32)


@cached
def flare_mask(x: float, y: float, severity: float, height: int, width: int) -> np.ndarray:
    """Return the opacity of the glow around the pixel (x, y).

    The mask is int16 [H, 3 W] in units of 1/32768.
    """
    glow = np.empty((height, width), np.float32)
    _look_up(*glow_terms(x, y, height, width), glow_table(), glow)
    return opacity_mask(glow, severity, FLARE_TINT)


@lru_cache(maxsize=32)
def disk_spans(severity: float, height: int, width: int) -> np.ndarray:
    """Return the span of columns that the disk covers in each row, int64 [H, 2].

    A span is the first column of the disk and the column after its last one.
    """
    radius = DISK_RADIUS * severity * min(height, width)
    reach = radius**2 - (np.arange(height) + 0.5 - 0.5 * height) ** 2
    half = np.sqrt(np.maximum(reach, 0.0))
    first = np.maximum(0, np.ceil(0.5 * width - half - 0.5))
    end = np.minimum(width, np.floor(0.5 * width + half - 0.5) + 1)
    return np.stack([first, np.where(reach < 0.0, first, end)], axis=1).astype(np.int64)


@njit(cache=True)
def blacken(frames, spans):
    """Set the pixels of frames (uint8 [V, H, W, 3]) inside the spans (int64 [H, 2]) to black."""
    count, height, _, _ = frames.shape
    flat = frames.reshape(count, height, -1)
    for v in range(count):
        for y in range(height):
            flat[v, y, 3 * spans[y, 0] : 3 * spans[y, 1]] = 0
