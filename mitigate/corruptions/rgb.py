"""The eight RGB corruptions of the standard suite, for uint8 panoramas [V, H, W, 3].

Every public function takes (views, severity in (0, 1], key, heading) and returns a new array of the
same shape. Lengths are defined as fractions of the frame size. Formulas and sources are in
docs/corruptions.md. Constants without a source were chosen by this project. Masks are defined in
``masks``, and compiled blurs in ``blur``.
"""

from __future__ import annotations

import math
from functools import lru_cache, partial

import numpy as np

from mitigate.corruptions import blur, masks
from mitigate.corruptions.eld import low_light_noise
from mitigate.corruptions.keying import Key, digest, uniform, view_streams
from mitigate.corruptions.record import Record

BLUR_LENGTH = 0.10  # length at severity 1 as a fraction of W; ImageNet-C kernels are 3 to 14 % of W
LONG_BLUR = 12.0  # lines of at least this length in px have taps only in every second column
# maximum angle to the horizontal in degrees; it is small, because robots mostly turn in yaw
BLUR_ANGLE = 10.0
# sigma at severity 1 as a fraction of min(H, W)
# For comparison, the blur disks of ImageNet-C have radii of 3 to 10 px in images of 224 px.
DEFOCUS_SIGMA = 5.0 / 224.0
DEFOCUS_SPREAD = 0.2
DEFOCUS_LEAST = 0.15  # minimum sigma in px; a narrower Gaussian has no effect
# If taps are more than one pixel apart, sigma is at least this multiple of the distance.
# The mean error of the blur is then below 0.4 grey levels.
LEAST_TAP_SIGMA = 1.15
BLACK, WHITE = (0, 0, 0), (255, 255, 255)


@lru_cache(maxsize=64)
def line_taps(length: float, angle: float, step: int = 1) -> tuple:
    """Return the taps (dy, dx, weights) of a line with a length in px and an angle in radians.

    The number of taps is a multiple of four. Only every ``step``-th column has taps; each of these
    columns represents a strip of ``step`` pixels. The weight of a strip is proportional to the part
    of its width that the line covers. This weight is split between the two rows that are nearest to
    the line. Weights are small integers. A fully covered strip has the weight ``step * LINE_UNITS /
    length``, rounded down, but at least 2.
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
        # rows are computed for abs(x) and abs(angle), because the line is symmetric
        sign = 1 if x * angle >= 0 else -1
        for row, share in ((low, weight - upper), (low + 1, upper)):
            if share > 0:
                taps[sign * row, x] = share
    places = np.array(list(taps) + [(0, 0)] * (-len(taps) % 4), np.int64)
    weights = np.zeros(len(places), np.int16)
    weights[: len(taps)] = list(taps.values())
    return places[:, 0].copy(), places[:, 1].copy(), weights


def blur_line(severity: float, key: Key, width: int) -> tuple[float, float]:
    """Return the length in pixels and the angle in radians of the line of ``motion_blur``."""
    angle = math.radians(BLUR_ANGLE * (2.0 * uniform(digest(key, "motion_blur")) - 1.0))
    return BLUR_LENGTH * severity * width, angle


def tap_step(length: float) -> int:
    """Return the distance along x, in pixels, between the taps of a line of ``length`` pixels."""
    return 1 if length < LONG_BLUR else 2


def motion_blur(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Blend with a nearly horizontal line blur of length 0.10 * severity * W.

    Lengths below 1 px have no effect.
    """
    length, angle = blur_line(severity, key, views.shape[2])
    if length < 1.0:
        return views.copy()
    step = tap_step(length)
    out = np.empty_like(views)
    dy, dx, weights = line_taps(length, angle, step)
    blur.line(views, dy, dx, weights, step, 0.5 + 0.5 * severity, out)
    return out


def low_light(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Darken with a gradient mask, which is the same for all views of the episode."""
    height, width = views.shape[1:3]
    mask = masks.low_light_mask(digest(key, "low_light"), severity, height, width)
    return masks.covered(views, mask, masks.colour_row(BLACK, width))


def spatter(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Cover a fraction 0.45 * severity of the image with mud or water.

    A random field, which is fixed per episode, is highest at the covered pixels.
    """
    height, width = views.shape[1:3]
    mask = masks.spatter_mask(digest(key, "spatter"), severity, height, width)
    colour = masks.spatter_colour(digest(key, "spatter_colour"))
    return masks.covered(views, mask, masks.colour_row(colour, width))


def flare(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Add the glow of a light, by screen blending, to the views that show the light.

    The direction of the light is fixed in the world if the heading is known.
    """
    count, height, width, _ = views.shape
    out, white = np.empty_like(views), masks.colour_row(WHITE, width)
    centres = masks.flare_centres(digest(key, "flare"), count, height, width, heading)
    for view, centre in enumerate(centres):
        if centre is None:
            out[view] = views[view]
        else:
            mask = masks.flare_mask(*centre, severity, height, width)
            masks.cover(views[view : view + 1], mask, white, out[view : view + 1])
    return out


@lru_cache(maxsize=64)
def gaussian_weights(sigma: float) -> tuple[np.ndarray, int]:
    """Return the arguments ``weights`` and ``levels`` of ``blur.gaussian`` for ``sigma`` px.

    The kernel ends at 3 sigma. Smoothing by (1 2 1)/4 with a step of h pixels adds the variance h^2
    / 2. The weighted taps add the remaining variance. Smoothing is repeated as long as the
    remaining sigma is at least LEAST_TAP_SIGMA times the distance between taps.
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


def defocus_sigma(severity: float, key: Key, height: int, width: int) -> float:
    """Return the sigma of the Gaussian blur of ``defocus`` in pixels."""
    spread = 1.0 + DEFOCUS_SPREAD * (2.0 * uniform(digest(key, "defocus")) - 1.0)
    return DEFOCUS_SIGMA * severity * spread * min(height, width)


def defocus(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Blur with sigma = 5 * severity * u * min(H, W) / 224, with u ~ U(0.8, 1.2) per episode."""
    sigma = defocus_sigma(severity, key, *views.shape[1:3])
    if sigma < DEFOCUS_LEAST:
        return views.copy()
    out = np.empty_like(views)
    weights, levels = gaussian_weights(sigma)
    blur.gaussian(views, weights, levels, out)
    return out


def foreign_object(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Draw a black disk of radius 0.5 * severity * min(H, W) at the centre."""
    out = views.copy()
    masks.blacken(out, masks.disk_spans(severity, *views.shape[1:3]))
    return out


def black_out(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Make each view of each frame black with probability ``severity``."""
    out = np.empty_like(views)
    for view, stream in enumerate(view_streams(key, "black_out", len(views))):
        out[view] = 0 if uniform(int(stream)) < severity else views[view]
    return out


_record = partial(Record.of, "rgb")
RECORDS = (
    _record(
        motion_blur,
        "line of 0.10 s of the width, blended 0.5 + 0.5 s",
        "ImageNet-C, NavTrust",
        episode="direction",
    ),
    _record(
        low_light,
        "loses s (0.60 to 0.97) of the light",
        "NavTrust, RobustNav, 3DCC",
        label="L-L w/o noise",
        episode="gradient",
    ),
    _record(
        low_light_noise,
        "low_light, then light / 300^s and gain",
        "ELD, TPAMI 2021",
        label="L-L w/ noise",
        episode="gradient",
        frame="noise",
    ),
    _record(
        spatter,
        "covers 0.45 s of the frame, opacity 0.5 + 0.5 s",
        "ImageNet-C",
        episode="mask, mud or water",
    ),
    _record(flare, "brightness of the glow", "NavTrust", episode="place, at a world yaw"),
    _record(
        defocus,
        "Gaussian, sigma 5 s px at 224 px",
        "NavTrust, ImageNet-C",
        episode="width, +- 20 %",
    ),
    _record(foreign_object, "disk of radius 0.5 s of the short side", "NavTrust"),
    _record(
        black_out,
        "probability that a view is black",
        "NavTrust",
        label="Black-out",
        frame="which views",
    ),
)
