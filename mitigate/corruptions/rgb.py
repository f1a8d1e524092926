"""The eight RGB corruptions of uint8 panoramas [V, H, W, 3].

Every public function takes (views, severity in (0, 1], key, heading) and returns a new array of the
same shape. Lengths are fractions of the frame. Formulas and sources: SUITE section 2; constants
without a source were chosen by this project.

Darkening, dirt and glare are one operation, ``out = x + (colour - x) alpha``, with an opacity mask
of 16 bits that is kept for the episode.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numba import njit

from mitigate import keys
from mitigate.corruptions import blur
from mitigate.corruptions.keying import Key, digest, field, top_share, uniform

BLUR_LENGTH = 0.10  # of W at s = 1; ImageNet-C kernels are 3-14 % of W
LONG_BLUR = 12.0  # px: from here every second column is enough
BLUR_ANGLE = 10.0  # degrees either side of horizontal: yaw turns dominate
DARK_BASE, DARK_RAMP = 0.60, 0.37  # between RobustNav (0.57-0.31 of the mean) and 3DCC (0.24-0.12)
SPATTER_CORRELATION = 0.018  # of min(H, W)
SPATTER_COVER = 0.45  # ImageNet-C covers 0.04-0.57 of the frame
SPATTER_EDGE = 0.25  # of the field's standard deviation
SPATTER_COLOURS = ((63, 42, 20), (175, 238, 238))  # mud, water (ImageNet-C)
FLARE_CORE, FLARE_CORE_WIDTH = 0.85, 0.18  # width over the image diagonal
FLARE_HALO, FLARE_HALO_WIDTH = 0.30, 0.35
FLARE_TINT = (1.0, 0.96, 0.88)
GLOW_REACH, GLOW_CELLS = 1.5, 16384  # of the radial table: less than 0.04 grey levels a cell
DEFOCUS_SIGMA = 5.0 / 224.0  # of min(H, W); ImageNet-C disks have radii 3-10 px at 224
DEFOCUS_SPREAD = 0.2
DEFOCUS_LEAST = 0.15  # px: a narrower Gaussian changes nothing
LEAST_TAP_SIGMA = 1.15  # of the distance of two taps: keeps the mean error under 0.4 grey levels
DISK_RADIUS = 0.5  # of min(H, W)
NEUTRAL = (1.0, 1.0, 1.0)
BLACK, WHITE = (0, 0, 0), (255, 255, 255)


# ---------------------------------------------------------------------------------- masks


@njit(cache=True)
def _expand(share, weight, out):
    """out int16 [H, 3 W] = min(share [H, W] times weight of the channel, 1) in 1/32768."""
    for y in range(share.shape[0]):
        row, target = share[y], out[y]
        for c in range(3):
            scale = np.float32(weight[c] * 32768.0)
            for x in range(row.size):
                value = min(row[x] * scale + np.float32(0.5), np.float32(32767.0))
                target[3 * x + c] = np.int16(np.int32(value))


def _opacity(share: np.ndarray, strength: float, tint: tuple[float, float, float]) -> np.ndarray:
    """Opacity mask int16 [H, 3 W] of the float32 [H, W] shares >= 0, times strength and tint."""
    out = np.empty((share.shape[0], 3 * share.shape[1]), np.int16)
    _expand(share, strength * np.array(tint), out)
    return out


@njit(cache=True)
def _cover(views, alpha, colour, out):
    """out = x + (colour - x) alpha for uint8 [V, H, 3 W]; int16 alpha [H, 3 W], colour [3 W].

    Two loops over a row of 16-bit numbers, which is what compiles to full-width vector code.
    """
    part = np.empty(colour.size, np.int16)
    for v in range(views.shape[0]):
        for y in range(views.shape[1]):
            source, opacity, target = views[v, y], alpha[y], out[v, y]
            for i in range(part.size):
                gap = np.int16((colour[i] - np.int16(source[i])) << 7)
                part[i] = (np.int32(gap) * np.int32(opacity[i])) >> np.int32(16)
            for i in range(part.size):
                target[i] = source[i] + ((part[i] + 32) >> 6)


@lru_cache(maxsize=64)
def _colour_row(colour: tuple[int, int, int], width: int) -> np.ndarray:
    return np.tile(np.array(colour, np.int16), width)


def flat_rows(views: np.ndarray) -> np.ndarray:
    """The same memory as [V, H, 3 W]."""
    return views.reshape(views.shape[0], views.shape[1], -1)


def _cover_into(views, alpha, colour: tuple[int, int, int], out: np.ndarray) -> np.ndarray:
    _cover(flat_rows(views), alpha, _colour_row(colour, views.shape[2]), flat_rows(out))
    return out


def _covered(views: np.ndarray, alpha: np.ndarray, colour: tuple[int, int, int]) -> np.ndarray:
    return _cover_into(views, alpha, colour, np.empty_like(views))


# ---------------------------------------------------------------------------------- the eight


@lru_cache(maxsize=64)
def line_taps(length: float, angle: float, step: int = 1) -> tuple:
    """Taps (dy, dx, weights) of a line of ``length`` px at ``angle`` rad; a multiple of four.

    Every ``step``-th column of the line weighs what the segment covers of it, shared between the
    two nearest rows, in small integers: full columns weigh step LINE_UNITS / length, at least 2.
    """
    half = 0.5 * length * math.cos(angle)
    units = max(2.0, math.floor(step * blur.LINE_UNITS / length)) / step
    taps: dict[tuple[int, int], int] = {}
    reach = math.ceil(half / step - 0.5) * step
    for x in range(-reach, reach + 1, step):
        weight = round(units * max(0.0, min(x + 0.5 * step, half) - max(x - 0.5 * step, -half)))
        y = abs(x) * math.tan(abs(angle))
        low = math.floor(y)
        upper = round(weight * (y - low))
        sign = 1 if x * angle >= 0 else -1  # a line is the same seen from either end
        for row, share in ((low, weight - upper), (low + 1, upper)):
            if share > 0:
                taps[sign * row, x] = share
    places = np.array(list(taps) + [(0, 0)] * (-len(taps) % 4), np.int64)
    weights = np.zeros(len(places), np.int16)
    weights[: len(taps)] = list(taps.values())
    return places[:, 0].copy(), places[:, 1].copy(), weights


def motion_blur(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Blend with a line blur of length 0.10 s W, close to horizontal; under 1 px the identity."""
    length = BLUR_LENGTH * severity * views.shape[2]
    if length < 1.0:
        return views.copy()
    angle = math.radians(BLUR_ANGLE * (2.0 * uniform(digest(key, "motion_blur")) - 1.0))
    step = 1 if length < LONG_BLUR else 2
    out = np.empty_like(views)
    dy, dx, weights = line_taps(length, angle, step)
    blur.line(views, dy, dx, weights, step, 0.5 + 0.5 * severity, out)
    return out


@lru_cache(maxsize=32)
def light_ramp(value: int, height: int, width: int) -> np.ndarray:
    """float32 [H, W] in [0, 1]: a linear ramp along an angle, or the distance to one light."""
    y, x = (np.arange(height) + 0.5) / height, (np.arange(width) + 0.5) / width
    if uniform(value, 0) < 0.5:
        angle = 2.0 * math.pi * uniform(value, 1)
        reach = abs(math.cos(angle)) + abs(math.sin(angle))
        down, right = (y - 0.5) * (math.sin(angle) / reach), (x - 0.5) * (math.cos(angle) / reach)
        return np.add.outer((0.5 + down).astype(np.float32), right.astype(np.float32))
    u, v = uniform(value, 2), uniform(value, 3)
    far = math.hypot(max(u, 1.0 - u) * width, max(v, 1.0 - v) * height)
    down, right = ((y - v) * (height / far)) ** 2, ((x - u) * (width / far)) ** 2
    return np.sqrt(np.add.outer(down.astype(np.float32), right.astype(np.float32)))


def light_loss(key: Key, severity: float, height: int, width: int) -> np.ndarray:
    """float32 [H, W]: the share of light taken away, s (0.60 + 0.37 t)."""
    ramp = light_ramp(digest(key, "low_light"), height, width)
    return ramp * np.float32(severity * DARK_RAMP) + np.float32(severity * DARK_BASE)


@lru_cache(maxsize=16)
def low_light_mask(key: Key, severity: float, height: int, width: int) -> np.ndarray:
    """int16 [H, 3 W]: the opacity of the dark, in 1/32768; ``key`` is that of the episode."""
    return _opacity(light_loss(key, severity, height, width), 1.0, NEUTRAL)


def low_light(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Darken by a gradient mask that all views of the episode share."""
    mask = low_light_mask(key.still(), severity, *views.shape[1:3])
    return _covered(views, mask, BLACK)


@lru_cache(maxsize=16)
def _spatter_mask(key: Key, severity: float, height: int, width: int) -> np.ndarray:
    smooth, cells = field(digest(key, "spatter"), height, width, SPATTER_CORRELATION)
    level = top_share(cells, SPATTER_COVER * severity)
    cover = np.clip((smooth - np.float32(level)) * np.float32(1.0 / SPATTER_EDGE), 0.0, 1.0)
    return _opacity(cover, 0.5 + 0.5 * severity, NEUTRAL)


def spatter(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Cover the top 0.45 s of a random field with mud or water; the lens is dirty all episode."""
    still = key.still()
    mask = _spatter_mask(still, severity, *views.shape[1:3])
    return _covered(views, mask, _spatter_colour(still))


@lru_cache(maxsize=16)
def _spatter_colour(key: Key) -> tuple[int, int, int]:
    return SPATTER_COLOURS[uniform(digest(key, "spatter_colour")) < 0.5]


def flare_centres(key: Key, views: int, height: int, width: int, heading) -> list:
    """Where the light falls in each view: (x, y) in pixels, or None where it is not in the view.

    The light has a fixed direction in the world: column U(0.1, 0.9) W, row U(0, 0.5) H of a camera
    at a random world yaw. ``heading`` (rad, counter-clockwise) turns with the agent and view k
    looks at heading - 30 k degrees. Without a heading that camera is view 0.
    """
    value = digest(key, "flare")
    column, row = 0.1 + 0.8 * uniform(value, 0), 0.5 * uniform(value, 1)
    focal = 0.5 / math.tan(math.radians(keys.HFOV_DEGREES) / 2.0)  # over the width
    yaw = math.atan2(0.5 - column, focal)  # from the camera, counter-clockwise
    tangent = (0.5 - row) * height / width / focal * math.cos(yaw)  # of the elevation
    if heading is not None:
        yaw += 2.0 * math.pi * uniform(value, 2) - float(heading)
    centres = []
    for view in range(views):
        turn = yaw + math.radians(keys.VIEW_STEP_DEGREES) * view
        ahead, left = math.cos(turn), math.sin(turn)
        x = 0.5 - focal * left / ahead if ahead > 1e-6 else -1.0
        seen = 0.0 <= x <= 1.0
        y = 0.5 * height - width * focal * tangent / ahead if seen else 0.0
        centres.append((x * width, y) if seen else None)
    return centres


@lru_cache(maxsize=1)
def _glow_table() -> np.ndarray:
    """float32 [GLOW_CELLS + 1]: the light at r = 0 .. 1.5 image diagonals, before severity."""
    r = np.arange(GLOW_CELLS + 1) * (GLOW_REACH / GLOW_CELLS)
    glow = FLARE_CORE * np.exp(-0.5 * (r / FLARE_CORE_WIDTH) ** 2)
    return (glow + FLARE_HALO * np.exp(-r / FLARE_HALO_WIDTH)).astype(np.float32)


@njit(cache=True)
def _look_up(down, right, table, out):
    """out[y, x] = table at the nearest cell to sqrt(down[y] + right[x]), all float32."""
    for y in range(down.size):
        for x in range(right.size):
            out[y, x] = table[np.int32(np.sqrt(down[y] + right[x]) + np.float32(0.5))]


@lru_cache(maxsize=64)
def _flare_mask(x: float, y: float, severity: float, height: int, width: int) -> np.ndarray:
    cells = GLOW_CELLS / GLOW_REACH / math.hypot(height, width)
    down = ((np.arange(height) + 0.5 - y) * cells) ** 2
    right = ((np.arange(width) + 0.5 - x) * cells) ** 2
    glow = np.empty((height, width), np.float32)
    _look_up(down.astype(np.float32), right.astype(np.float32), _glow_table(), glow)
    return _opacity(glow, severity, FLARE_TINT)


def flare(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Screen blend with a radial glow from a fixed direction in the world, where a view sees it."""
    count, height, width, _ = views.shape
    out = np.empty_like(views)
    for view, centre in enumerate(flare_centres(key, count, height, width, heading)):
        if centre is None:
            out[view] = views[view]
        else:
            mask = _flare_mask(*centre, severity, height, width)
            _cover_into(views[view : view + 1], mask, WHITE, out[view : view + 1])
    return out


@lru_cache(maxsize=64)
def gaussian_weights(sigma: float) -> tuple[np.ndarray, int]:
    """The arguments ``weights, levels`` of ``blur.gaussian`` for ``sigma`` px, cut at 3 sigma.

    Smoothing by (1 2 1)/4 with a step of h pixels has variance h^2 / 2; the taps add the rest. They
    keep a sigma of at least LEAST_TAP_SIGMA of their distance.
    """
    levels, variance = 0, sigma**2
    while variance - 0.5 * 4**levels >= (LEAST_TAP_SIGMA * 2 ** (levels + 1)) ** 2:
        variance -= 0.5 * 4**levels
        levels += 1
    spread = math.sqrt(variance) / 2**levels
    r = max(2, 2 * math.ceil(1.5 * spread))
    weights = np.exp(-0.5 * (np.arange(r + 1) / spread) ** 2)
    weights = np.rint(weights * (65536.0 / (2.0 * weights.sum() - weights[0])))
    weights[0] = min(32768.0 - weights[1:].sum(), 32767.0)
    return weights.astype(np.int16), levels


def defocus(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Gaussian blur, sigma = 5 s u min(H, W) / 224 with u ~ U(0.8, 1.2) for the episode."""
    spread = 1.0 + DEFOCUS_SPREAD * (2.0 * uniform(digest(key, "defocus")) - 1.0)
    sigma = DEFOCUS_SIGMA * severity * spread * min(views.shape[1:3])
    if sigma < DEFOCUS_LEAST:
        return views.copy()
    out = np.empty_like(views)
    weights, levels = gaussian_weights(sigma)
    blur.gaussian(views, weights, levels, out)
    return out


@lru_cache(maxsize=32)
def disk_spans(severity: float, height: int, width: int) -> np.ndarray:
    """int64 [H, 2]: the first and end column of the disk in each row."""
    radius = DISK_RADIUS * severity * min(height, width)
    reach = radius**2 - (np.arange(height) + 0.5 - 0.5 * height) ** 2
    half = np.sqrt(np.maximum(reach, 0.0))
    first = np.maximum(0, np.ceil(0.5 * width - half - 0.5))
    end = np.minimum(width, np.floor(0.5 * width + half - 0.5) + 1)
    return np.stack([first, np.where(reach < 0.0, first, end)], axis=1).astype(np.int64)


@njit(cache=True)
def _blacken(frames, spans):
    """In place: uint8 [V, H, 3 W] is black inside the spans."""
    for v in range(frames.shape[0]):
        for y in range(frames.shape[1]):
            row = frames[v, y]
            for i in range(3 * spans[y, 0], 3 * spans[y, 1]):
                row[i] = 0


def foreign_object(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """A black disk of radius 0.5 s min(H, W) at the centre."""
    out = views.copy()
    _blacken(flat_rows(out), disk_spans(severity, *views.shape[1:3]))
    return out


def black_out(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Each view of each frame is black with probability s."""
    out = views.copy()
    for view in range(views.shape[0]):
        if uniform(digest(key, "black_out", frame=True, view=view)) < severity:
            out[view] = 0
    return out
