"""Primitive transforms of depth views, and their random composition ``broad_depth``.

Each primitive maps float32 views [V, H, W], divided by the sensor's range, to views of the same
shape. NaN means no reading. Invalid pixels are returned unchanged.
"""

from __future__ import annotations

import cv2
import numpy as np

from mitigate.corruptions.broad.composition import composed, displaced, field, log_uniform, shapes
from mitigate.corruptions.depth_sensor import NEAREST, DepthSensor
from mitigate.corruptions.keying import Key

NAME = "broad_depth"


def curve(views, strength, rng, now):
    """Scale and offset depth, and add a sine wave that is a function of depth."""
    scale, offset = 1.0 + 0.5 * strength * rng.uniform(-1, 1), 0.1 * strength * rng.uniform(-1, 1)
    waves, phase = rng.uniform(1.0, 8.0), rng.uniform(0, 2 * np.pi)
    wave = 0.04 * strength * rng.random() * np.sin(2 * np.pi * waves * views + phase)
    return views * np.float32(scale) + np.float32(offset) * (rng.random() < 0.5) + wave


def uneven(views, strength, rng, now):
    """Add spatially correlated errors, which are independent of depth z or grow with z or z^2."""
    power, amount = rng.choice((0, 1, 2)), strength * rng.uniform(0.02, 0.25)
    error = field(rng, views.shape[1:], log_uniform(rng, 0.02, 0.6))
    moving = rng.random() < 0.5
    out = np.empty_like(views)
    for place, view in enumerate(views):
        shifted = np.roll(error, int((now if moving else rng).integers(view.shape[1])), 1)
        out[place] = view + amount * shifted * view**power * (1.0 if power else 0.3)
    return out


def noisy(views, strength, rng, now):
    """Add noise of random grain size; the noise is independent of depth z or grows with z^2."""
    grain = rng.choice((1, 1, 2, 4)) * max(1, min(views.shape[1:]) // 128)
    height, width = views.shape[1:]
    shape = (len(views), -(-height // grain), -(-width // grain))
    noise = now.standard_normal(shape).repeat(grain, 1).repeat(grain, 2)[:, :height, :width]
    amount = strength * rng.uniform(0.01, 0.1)
    growth = 1.0 + 6.0 * views**2 * (rng.random() < 0.5)
    return views + (amount * noise * growth).astype(np.float32)


def smooth(views, strength, rng, now):
    """Apply a median or mean filter."""
    size = 1 + 2 * max(1, round(0.06 * strength * rng.uniform(0.3, 1.0) * min(views.shape[1:])))
    if rng.random() < 0.4:
        return _each(views, lambda view: cv2.medianBlur(view, min(5, size)))
    return _each(views, lambda view: cv2.blur(view, (size, size)))


def steps(views, strength, rng, now):
    """Round depth to a few levels that are evenly spaced in distance or in disparity."""
    if rng.random() < 0.5:
        step = np.float32(strength * rng.uniform(0.02, 0.15))
        return np.rint(views / step) * step
    step = np.float32(strength * rng.uniform(0.1, 0.8))
    return 1.0 / np.maximum(np.rint(1.0 / np.maximum(views, 0.01) / step) * step, 0.5)


def warped(views, strength, rng, now):
    """Displace pixels by a smooth random map, and rotate, scale and shift the image."""
    map_x, map_y = displaced(rng, views.shape[1:], 0.12 * strength)
    border = cv2.BORDER_REPLICATE
    return _each(
        views, lambda view: cv2.remap(view, map_x, map_y, cv2.INTER_NEAREST, borderMode=border)
    )


def swapped(views, strength, rng, now):
    """Replace random pixels by other pixels nearby."""
    reach = max(1, round(0.15 * rng.uniform(0.2, 1.0) * min(views.shape[1:])))
    out, share = views.copy(), 0.6 * strength * rng.random()
    for view, clean in zip(out, views, strict=True):
        y, x = np.nonzero(now.random(view.shape) < share)
        dy, dx = now.integers(-reach, reach + 1, (2, len(y)))
        height, width = view.shape
        view[y, x] = clean[np.clip(y + dy, 0, height - 1), np.clip(x + dx, 0, width - 1)]
    return out


def holes(views, strength, rng, now):
    """Remove or replace at most a fraction 0.7 * strength of the pixels.

    A random mixture of four criteria selects the pixels: a smooth random map, independent noise,
    distance and edges.
    """
    weights = rng.dirichlet(np.full(4, 0.5)) * (1, 1, rng.choice((-1, 1)), 1)
    place = field(rng, views.shape[1:], log_uniform(rng, 0.02, 0.5))
    share, fill, out = 0.7 * strength * rng.random(), _fill(rng), views.copy()
    for view in out:
        edges = np.abs(cv2.Laplacian(np.nan_to_num(view), cv2.CV_32F, ksize=3))
        chance = now.standard_normal(view.shape)
        maps = (place, chance, 6.0 * (np.nan_to_num(view) - 0.3), np.minimum(8.0 * edges, 3.0))
        score = sum(weight * each for weight, each in zip(weights, maps, strict=True))
        view[score > np.quantile(score, 1.0 - share)] = fill
    return out


def hidden(views, strength, rng, now):
    """Remove or replace depth within random shapes, which may differ between views."""
    area, fill, alike = 0.5 * strength * rng.uniform(0.1, 1.0), _fill(rng), rng.random() < 0.6
    mask, out = shapes(rng, views.shape[1:], area), views.copy()
    for view in out:
        mask = mask if alike else shapes(now, views.shape[1:], area)
        view[mask] = fill
    return out


def lost(views, strength, rng, now):
    """Set all pixels of some views, or of all views, to no reading or to the maximum range.

    All views are lost with probability 0.6 * strength; otherwise, each view is lost with
    probability 0.5 * strength.
    """
    share = 1.0 if rng.random() < 0.6 * strength else 0.5 * strength
    out = views.copy()
    out[now.random(len(views)) < share] = rng.choice((np.nan, np.nan, 1.0))
    return out


def patterned(views, strength, rng, now):
    """Add errors in stripes, rings or checks, which are independent of depth or grow with it."""
    wave = _pattern(rng, views.shape[1:])
    if rng.random() < 0.4:
        wave = np.roll(wave, int(now.integers(views.shape[1])), 0)
    amount = np.float32(strength * rng.uniform(0.03, 0.4))
    if rng.random() < 0.3:
        return np.where(wave > 1.0 - 1.5 * amount, np.float32(_fill(rng)), views)
    return views + amount * wave * (views if rng.random() < 0.6 else np.float32(0.3))


def tilted(views, strength, rng, now):
    """Scale depth by a factor that changes linearly over the image or differs between views."""
    height, width = views.shape[1:]
    y, x = np.mgrid[-1 : 1 : height * 1j, -1 : 1 : width * 1j].astype(np.float32)
    if rng.random() < 0.3:
        factors = 0.4 * strength * rng.standard_normal((len(views), 1, 1))
    else:
        factors = strength * (rng.uniform(-0.4, 0.4) * x + rng.uniform(-0.4, 0.4) * y)
    return views * (1.0 + np.clip(factors, -0.7, 0.7)).astype(np.float32)


def wrapped(views, strength, rng, now):
    """Fold distances beyond a random limit back to short distances, in all or some places."""
    limit = _limit(views, strength, rng)
    where = views > limit
    if rng.random() < 0.5:
        where &= field(rng, views.shape[1:], log_uniform(rng, 0.05, 0.6)) < rng.uniform(-1, 1)
    return np.where(where, views - limit * np.floor(views / limit), views)


def ranged(views, strength, rng, now):
    """Replace distances above a random limit, or below one."""
    fill, limit = np.float32(_fill(rng)), _limit(views, strength, rng)
    if rng.random() < 0.3:
        return np.where(views < 0.4 * limit, fill, views)
    return np.where(views > limit, fill, views)


def spread(views, strength, rng, now):
    """Let near or far objects grow in the image."""
    size = 1 + 2 * max(1, round(0.06 * strength * rng.uniform(0.3, 1.0) * min(views.shape[1:])))
    kernel = np.ones((size, size), np.uint8)
    change = cv2.erode if rng.random() < 0.6 else cv2.dilate
    return _each(views, lambda view: change(view, kernel))


def torn(views, strength, rng, now):
    """Shift bands of rows or columns by random distances, or exchange blocks of pixels.

    The changes are the same in all frames of an episode, or new for each frame.
    """
    source = now if rng.random() < 0.5 else rng
    if rng.random() < 0.3:
        return _exchanged(views, strength, source, int(rng.integers(3, 9)))
    axis = int(rng.integers(1, 3))
    bands, reach = int(rng.integers(2, 25)), 0.3 * strength * views.shape[3 - axis]
    out = views.copy()
    cuts = np.sort(source.integers(0, views.shape[axis], bands))
    for start, stop in zip((0, *cuts), (*cuts, views.shape[axis]), strict=True):
        if source.random() < 0.3 + 0.5 * strength:
            band = (slice(None),) * axis + (slice(start, stop),)
            out[band] = np.roll(views[band], int(source.uniform(-reach, reach)), 3 - axis)
    return out


def ghost(views, strength, rng, now):
    """Mix depth with shifted or mirrored copies, or with depth of other headings.

    Pixels get the smaller value, the mean, or the copy within a random map.
    """
    other, kind = _copied(views, strength, rng), rng.random()
    if kind < 0.3:
        return np.fmin(views, other)
    if kind < 0.5:
        return views + np.float32(0.6 * strength * rng.random()) * (other - views)
    place = field(rng, views.shape[1:], log_uniform(rng, 0.05, 0.5))
    return np.where(place > 1.5 - 2.0 * strength * rng.random(), other, views)


def _pattern(rng: np.random.Generator, shape: tuple[int, int]) -> np.ndarray:
    """Return a periodic map of stripes, rings or checks, float32 [H, W] from -1 to 1.

    Edges are soft or sharp. The period is 0.03 to 0.8 times the shorter side.
    """
    (height, width), side = shape, min(shape)
    y, x = np.mgrid[:height, :width].astype(np.float32) / side
    waves, angle = 2 * np.pi / log_uniform(rng, 0.03, 0.8), rng.uniform(0, np.pi)
    if rng.random() < 0.4:  # along rows or columns, as readout errors and blinds are
        angle = rng.choice((0.0, np.pi / 2))
    phases = rng.uniform(0, 2 * np.pi, 2)
    along, across = (x * np.cos(turn) + y * np.sin(turn) for turn in (angle, angle + np.pi / 2))
    kind = rng.random()
    if kind < 0.25:
        along = np.hypot(x - rng.uniform(0, width / side), y - rng.uniform(0, height / side))
    wave = np.sin(waves * along + phases[0])
    if kind > 0.75:
        wave = wave * np.sin(waves * across + phases[1])
    sharp = log_uniform(rng, 1.0, 20.0)
    return (np.tanh(sharp * wave) / np.tanh(sharp)).astype(np.float32)


def _exchanged(views, strength, source, blocks: int) -> np.ndarray:
    """Exchange up to a third of ``blocks`` x ``blocks`` blocks of each view."""
    high, wide = views.shape[1] // blocks, views.shape[2] // blocks
    places = source.permutation(blocks * blocks)[: 2 + round(0.3 * strength * blocks * blocks)]
    out = views.copy()
    for place, other in zip(places, np.roll(places, 1), strict=True):
        (row, column), (down, right) = divmod(int(place), blocks), divmod(int(other), blocks)
        block = np.s_[:, row * high : (row + 1) * high, column * wide : (column + 1) * wide]
        out[block] = views[:, down * high : (down + 1) * high, right * wide : (right + 1) * wide]
    return out


def _copied(views: np.ndarray, strength: float, rng: np.random.Generator) -> np.ndarray:
    """Return a shifted or mirrored copy of each view, or the views of other headings."""
    kind = rng.random()
    if kind < 0.4:
        reach = 0.4 * strength * min(views.shape[1:])
        shifts = 1 + (rng.uniform(-1, 1, 2) * reach).astype(int)
        return np.roll(views, shifts, (1, 2))
    if kind < 0.7:
        return views[:, ::-1] if rng.random() < 0.4 else views[:, :, ::-1]
    return np.roll(views, int(rng.integers(1, max(2, len(views)))), 0)


def _limit(views, strength, rng) -> np.float32:
    """Sample a distance that is less than that of the farthest reading."""
    farthest = np.fmax.reduce(views, axis=None)
    return np.float32(farthest * log_uniform(rng, 0.7 - 0.6 * strength, 0.9))


def _fill(rng: np.random.Generator) -> float:
    """Sample the value that replaces depth.

    It is NaN (no reading) with probability 0.6, and otherwise a fraction of the sensor's range.
    """
    return float("nan") if rng.random() < 0.6 else float(rng.choice((1.0, rng.random())))


def _each(views, change) -> np.ndarray:
    """Apply ``change`` to each view.

    Before the change, holes are filled with the maximum range. After it, they are holes again.
    """
    holes = np.isnan(views)
    out = np.stack([change(view) for view in np.where(holes, np.float32(1.0), views)])
    return np.where(holes, np.float32(np.nan), out)


PRIMITIVES = (
    curve,
    uneven,
    noisy,
    smooth,
    steps,
    warped,
    swapped,
    holes,
    hidden,
    lost,
    patterned,
    tilted,
    wrapped,
    ranged,
    spread,
    torn,
    ghost,
)


def compose(views: np.ndarray, severity: float, key: Key, sensor: DepthSensor) -> np.ndarray:
    """Apply one to three primitives with random strengths up to ``severity``.

    The choice of primitives is fixed per episode.
    """
    valid = (views > 0) & np.isfinite(views)
    z_max = np.float32(sensor.z_max)
    shares = np.where(valid, np.minimum(views, z_max) / z_max, np.float32(np.nan))
    changed = composed(shares, severity, key, NAME, PRIMITIVES) * z_max
    metres = np.clip(changed, NEAREST, z_max)
    metres = np.where(np.isnan(changed), np.float32(sensor.missing), metres).astype(np.float32)
    return np.where(valid, metres, views)
