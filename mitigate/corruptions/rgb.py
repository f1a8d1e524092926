"""The eight RGB corruptions of uint8 panoramas [V, H, W, 3].

Every public function takes (views, severity in (0, 1], key, heading) and returns a new array of the
same shape. Lengths are fractions of the frame. Formulas and sources: SUITE section 2; constants
without a source were chosen by this project.

Darkening, dirt and glare are one operation, ``out = x gain + offset``, with a mask kept in 16-bit
fixed point.
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
BLUR_ANGLE = 10.0  # degrees either side of horizontal: yaw turns dominate
DARK_BASE, DARK_RAMP = 0.60, 0.37  # between RobustNav (0.57-0.31 of the mean) and 3DCC (0.24-0.12)
SPATTER_CORRELATION = 0.018  # of min(H, W)
SPATTER_COVER = 0.45  # ImageNet-C covers 0.04-0.57 of the frame
SPATTER_EDGE = 0.25  # of the field's standard deviation
SPATTER_COLOURS = ((63, 42, 20), (175, 238, 238))  # mud, water (ImageNet-C)
FLARE_CORE, FLARE_CORE_WIDTH = 0.85, 0.18  # width over the image diagonal
FLARE_HALO, FLARE_HALO_WIDTH = 0.30, 0.35
FLARE_TINT = (1.0, 0.96, 0.88)
DEFOCUS_SIGMA = 5.0 / 224.0  # of min(H, W); ImageNet-C disks have radii 3-10 px at 224
DEFOCUS_SPREAD = 0.2
DEFOCUS_LEAST = 0.15  # px: a narrower Gaussian changes nothing
DISK_RADIUS = 0.5  # of min(H, W)


# ---------------------------------------------------------------------------------- masks


def _fixed(gain: np.ndarray, offset: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Gain in [0, 1] and offset in [0, 255] as uint16 fixed point; the rounding half is inside."""
    wide = np.minimum(np.rint(gain * 65536.0), 65535).astype(np.uint16)
    return wide.ravel(), (np.rint(offset * 256.0) + 128).astype(np.uint16).ravel()


@njit(cache=True)
def _affine(views, gain, offset, out):
    """out = views gain + offset on flat uint8 [V, N] with uint16 masks [N]."""
    for v in range(views.shape[0]):
        source, target = views[v], out[v]
        for i in range(source.size):
            product = (np.uint32(source[i]) << np.uint32(8)) * np.uint32(gain[i])
            target[i] = ((product >> np.uint32(16)) + np.uint32(offset[i])) >> np.uint32(8)


def _apply(views: np.ndarray, gain: np.ndarray, offset: np.ndarray) -> np.ndarray:
    out = np.empty_like(views)
    count = views.shape[0]
    _affine(views.reshape(count, -1), gain, offset, out.reshape(count, -1))
    return out


# ---------------------------------------------------------------------------------- the eight


@lru_cache(maxsize=64)
def line_taps(length: float, angle: float, mix: float) -> tuple:
    """Taps (dy, dx, weights) of (1 - mix) identity + mix line(length px, angle rad).

    Each column of the line weighs what the segment covers of it, shared between the two nearest
    rows. Weights are uint32 and add up to 65536.
    """
    half = 0.5 * length * math.cos(angle)
    taps = {(0, 0): (1.0 - mix) * 65536.0}
    reach = math.ceil(half - 0.5)
    for x in range(-reach, reach + 1):
        cover = max(0.0, min(x + 0.5, half) - max(x - 0.5, -half))
        weight = 65536.0 * mix * cover / (2.0 * half)
        y = x * math.tan(angle)
        low = math.floor(y)
        for row, share in ((low, 1.0 - (y - low)), (low + 1, y - low)):
            taps[row, x] = taps.get((row, x), 0.0) + weight * share
    rounded = {at: round(weight) for at, weight in taps.items() if round(weight) > 0}
    rounded[0, 0] = rounded.get((0, 0), 0) + 65536 - sum(rounded.values())
    places = np.array(list(rounded), np.int64)
    weights = np.array(list(rounded.values()), np.uint32)
    return places[:, 0].copy(), places[:, 1].copy(), weights


def motion_blur(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Blend with a line blur of length 0.10 s W, close to horizontal; under 1 px the identity."""
    length = BLUR_LENGTH * severity * views.shape[2]
    if length < 1.0:
        return views.copy()
    angle = math.radians(BLUR_ANGLE * (2.0 * uniform(digest(key, "motion_blur")) - 1.0))
    dy, dx, weights = line_taps(length, angle, 0.5 + 0.5 * severity)
    out = np.empty_like(views)
    blur.convolve_taps(views, dy, dx, weights, out)
    return out


@lru_cache(maxsize=32)
def light_ramp(value: int, height: int, width: int) -> np.ndarray:
    """float64 [H, W] in [0, 1]: a linear ramp along an angle, or the distance to one light."""
    y = (np.arange(height)[:, None] + 0.5) / height
    x = (np.arange(width)[None, :] + 0.5) / width
    if uniform(value, 0) < 0.5:
        angle = 2.0 * math.pi * uniform(value, 1)
        along = (x - 0.5) * math.cos(angle) + (y - 0.5) * math.sin(angle)
        return 0.5 + along / (abs(math.cos(angle)) + abs(math.sin(angle)))
    u, v = uniform(value, 2), uniform(value, 3)
    far = math.hypot(max(u, 1.0 - u) * width, max(v, 1.0 - v) * height)
    return np.sqrt(((x - u) * width) ** 2 + ((y - v) * height) ** 2) / far


def light_gain(key: Key, severity: float, height: int, width: int) -> np.ndarray:
    """float64 [H, W]: the share of light left, 1 - s (0.60 + 0.37 t)."""
    ramp = light_ramp(digest(key, "low_light"), height, width)
    return 1.0 - severity * (DARK_BASE + DARK_RAMP * ramp)


@lru_cache(maxsize=16)
def _low_light_mask(key: Key, severity: float, height: int, width: int) -> tuple:
    gain = np.repeat(light_gain(key, severity, height, width)[..., None], 3, axis=2)
    return _fixed(gain, np.zeros_like(gain))


def low_light(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Darken by a gradient mask that all views of the episode share."""
    _, height, width, _ = views.shape
    return _apply(views, *_low_light_mask(key.still(), severity, height, width))


@lru_cache(maxsize=16)
def _spatter_mask(key: Key, severity: float, height: int, width: int) -> tuple:
    smooth, ordered = field(digest(key, "spatter"), height, width, SPATTER_CORRELATION)
    level = top_share(ordered, SPATTER_COVER * severity)
    if math.isinf(level):
        alpha = np.zeros((height, width, 1))
    else:
        cover = np.clip((smooth.astype(np.float64) - level) / SPATTER_EDGE, 0.0, 1.0)
        alpha = ((0.5 + 0.5 * severity) * cover)[..., None]
    colour = np.array(SPATTER_COLOURS[uniform(digest(key, "spatter_colour")) < 0.5], float)
    return _fixed(np.repeat(1.0 - alpha, 3, axis=2), alpha * colour)


def spatter(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Cover the top 0.45 s of a random field with mud or water; the lens is dirty all episode."""
    _, height, width, _ = views.shape
    return _apply(views, *_spatter_mask(key.still(), severity, height, width))


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


@lru_cache(maxsize=64)
def _flare_mask(x: float, y: float, severity: float, height: int, width: int) -> tuple:
    dy, dx = np.arange(height)[:, None] + 0.5 - y, np.arange(width)[None, :] + 0.5 - x
    r = np.sqrt(dx**2 + dy**2) / math.hypot(height, width)
    glow = FLARE_CORE * np.exp(-0.5 * (r / FLARE_CORE_WIDTH) ** 2)
    glow += FLARE_HALO * np.exp(-r / FLARE_HALO_WIDTH)
    light = np.minimum(severity * glow[..., None] * np.array(FLARE_TINT), 1.0)
    return _fixed(1.0 - light, 255.0 * light)


def flare(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Screen blend with a radial glow from a fixed direction in the world, where a view sees it."""
    count, height, width, _ = views.shape
    out = views.copy()
    for view, centre in enumerate(flare_centres(key, count, height, width, heading)):
        if centre is not None:
            mask = _flare_mask(*centre, severity, height, width)
            out[view] = _apply(views[view : view + 1], *mask)[0]
    return out


@lru_cache(maxsize=64)
def gaussian_weights(sigma: float) -> np.ndarray:
    """float32 [r + 1]: one side of a normalised Gaussian, centre first, cut at 3 sigma."""
    weights = np.exp(-0.5 * (np.arange(math.ceil(3.0 * sigma) + 1) / sigma) ** 2)
    return (weights / (2.0 * weights.sum() - weights[0])).astype(np.float32)


def defocus(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Gaussian blur, sigma = 5 s u min(H, W) / 224 with u ~ U(0.8, 1.2) for the episode."""
    spread = 1.0 + DEFOCUS_SPREAD * (2.0 * uniform(digest(key, "defocus")) - 1.0)
    sigma = DEFOCUS_SIGMA * severity * spread * min(views.shape[1:3])
    if sigma < DEFOCUS_LEAST:
        return views.copy()
    out = np.empty_like(views)
    blur.gaussian(views, gaussian_weights(sigma), out)
    return out


@lru_cache(maxsize=32)
def disk_spans(severity: float, height: int, width: int) -> tuple:
    """The rows of the disk: (y, first x, end x)."""
    radius = DISK_RADIUS * severity * min(height, width)
    spans = []
    for y in range(height):
        reach = radius**2 - (y + 0.5 - 0.5 * height) ** 2
        if reach >= 0.0:
            half = math.sqrt(reach)
            first = max(0, math.ceil(0.5 * width - half - 0.5))
            end = min(width, math.floor(0.5 * width + half - 0.5) + 1)
            spans.append((y, first, end))
    return tuple(spans)


def foreign_object(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """A black disk of radius 0.5 s min(H, W) at the centre."""
    out = views.copy()
    for y, first, end in disk_spans(severity, *views.shape[1:3]):
        out[:, y, first:end] = 0
    return out


def black_out(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Each view of each frame is black with probability s."""
    out = views.copy()
    for view in range(views.shape[0]):
        if uniform(digest(key, "black_out", frame=True, view=view)) < severity:
            out[view] = 0
    return out
