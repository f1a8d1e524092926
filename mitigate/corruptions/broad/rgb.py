"""Primitive transforms of RGB views, and their random composition ``broad_rgb``.

Each primitive maps float32 views [V, H, W, 3] in [0, 1] to views of the same shape.
"""

from __future__ import annotations

import cv2
import numpy as np

from mitigate.corruptions.broad.composition import composed, displaced, field, log_uniform, shapes
from mitigate.corruptions.keying import Key

NAME = "broad_rgb"
STOPS = (-4.0, 2.5)  # range of brightness changes at strength 1, in stops
GAMMA = 2.2  # display gamma: light is proportional to (stored level)^GAMMA


def exposure(views, strength, rng, now):
    """Change the brightness uniformly or by a smooth random map.

    The change is the same in all frames of an episode, or differs between frames.
    """
    stops = strength * rng.uniform(*STOPS)
    if rng.random() < 0.3:
        stops = stops * now.uniform(0.0, 1.0)
    if rng.random() < 0.4:
        uneven = field(rng, views.shape[1:3], rng.uniform(0.3, 1.0))
        stops = stops * (1.0 + 0.5 * uneven)[..., None]
    return np.clip(views * np.exp2(np.asarray(stops, np.float32) / GAMMA), 0.0, 1.0)


def tone(views, strength, rng, now):
    """Add the sum of the waves b_n sin(pi n x) to each level x, with random b_n (PRIME).

    The three colours share one curve, or each colour gets its own curve.
    """
    levels = np.linspace(0.0, 1.0, 256, dtype=np.float32)
    most = int(rng.integers(1, 6))
    colours = 3 if rng.random() < 0.5 else 1
    weights = rng.standard_normal((colours, most)) / np.sqrt(most)
    waves = np.sin(np.pi * np.arange(1, most + 1)[:, None] * levels)
    tables = np.clip(levels + 0.5 * strength * (weights @ waves), 0.0, 1.0).astype(np.float32)
    places = np.rint(views * 255).astype(np.uint8)
    out = np.empty_like(views)
    for colour in range(3):
        out[..., colour] = tables[colour % colours][places[..., colour]]
    return out


def colour_mix(views, strength, rng, now):
    """Mix the three colours by a random matrix that is near the identity or near grey."""
    matrix = np.eye(3) + 0.6 * strength * rng.standard_normal((3, 3))
    if rng.random() < 0.3:
        matrix = (1.0 - strength) * np.eye(3) + strength / 3.0
    elif rng.random() < 0.5:  # grey stays grey
        matrix /= np.where(abs(matrix.sum(1)) < 0.3, 1.0, matrix.sum(1))[:, None]
    return np.clip(views @ matrix.T.astype(np.float32), 0.0, 1.0)


def contrast(views, strength, rng, now):
    """Increase contrast, or reduce it towards a uniform colour."""
    share, colour = strength * rng.uniform(0.3, 0.95), _colour(rng)
    if rng.random() < 0.25:
        return np.clip(views + 2.0 * share * (views - np.float32(0.5)), 0.0, 1.0)
    return views + (colour - views) * np.float32(share)


def filtered(views, strength, rng, now):
    """Convolve with a random kernel (PRIME), or blur along a random direction."""
    side = min(views.shape[1:3])
    size = 1 + 2 * max(1, round(0.5 * strength * rng.uniform(0.04, 0.2) * side))
    if rng.random() < 0.4:
        kernel = rng.standard_normal((size, size))
        kernel = kernel / np.abs(kernel).sum() * 1.5
        kernel[size // 2, size // 2] += 1.0 - kernel.sum()
    else:
        y, x = np.mgrid[:size, :size] - size // 2
        angle, long = rng.uniform(0, np.pi), rng.uniform(0.15, 1.0)
        along, across = x * np.cos(angle) + y * np.sin(angle), y * np.cos(angle) - x * np.sin(angle)
        width = size / 4
        kernel = np.exp(-0.5 * ((along / width) ** 2 + (across / (long * width + 0.3)) ** 2))
        kernel /= kernel.sum()
    return _each(views, lambda view: cv2.filter2D(view, -1, kernel.astype(np.float32)))


def coarse(views, strength, rng, now):
    """Reduce the resolution, the number of levels, or both."""
    height, width = views.shape[1:3]
    if rng.random() < 0.7:
        factor = 1.0 + strength * rng.uniform(0.5, 1.0) * 0.12 * min(height, width)
        small = (max(2, round(width / factor)), max(2, round(height / factor)))
        up = cv2.INTER_NEAREST if rng.random() < 0.5 else cv2.INTER_LINEAR
        shrink = cv2.INTER_AREA
        views = _each(
            views,
            lambda view: cv2.resize(
                cv2.resize(view, small, interpolation=shrink), (width, height), interpolation=up
            ),
        )
        if rng.random() < 0.6:
            return views
    steps = round(max(2.0, 2.0 ** (7.0 - 6.0 * strength)))
    return np.rint(views * steps) / np.float32(steps)


def warped(views, strength, rng, now):
    """Displace pixels by a smooth random map (PRIME), and rotate, scale and shift the image."""
    source = now if rng.random() < 0.3 else rng
    map_x, map_y = displaced(source, views.shape[1:3], 0.12 * strength)
    border = cv2.BORDER_REPLICATE
    return _each(
        views, lambda view: cv2.remap(view, map_x, map_y, cv2.INTER_LINEAR, borderMode=border)
    )


def noisy(views, strength, rng, now):
    """Add noise, or multiply by noise, of random grain size, distribution and colour.

    The noise may form bands.
    """
    height, width = views.shape[1:3]
    colours, amount = 3 if rng.random() < 0.5 else 1, 0.35 * strength * rng.uniform(0.3, 1.0)
    grain = rng.choice((1, 1, 2, 4)) * max(1, min(height, width) // 128)
    rows, columns = -(-height // grain), -(-width // grain)
    banded = rng.random()
    rows, columns = 1 if banded < 0.1 else rows, 1 if banded > 0.9 else columns
    heavy = rng.random() < 0.3
    shape = (len(views), rows, columns, colours)
    drawn = now.standard_t(2.0, shape) * 0.5 if heavy else now.standard_normal(shape)
    noise = np.repeat(np.repeat(drawn, -(-height // rows), 1), -(-width // columns), 2)
    noise = amount * noise[:, :height, :width].astype(np.float32)
    return np.clip(views * (1 + noise) if rng.random() < 0.3 else views + noise, 0.0, 1.0)


def covered(views, strength, rng, now):
    """Blend views with a random colour.

    The opacity is a random map, whose structures are fine in some episodes and coarse in others.
    """
    height, width = views.shape[1:3]
    soft, colour = log_uniform(rng, 0.1, 3.0), _colour(rng)
    level = rng.uniform(-0.3, 1.5) + (1.0 - strength)
    is_shifted, most = rng.random() < 0.3, (0.4 + 0.6 * rng.random()) * min(1.0, 1.5 * strength)
    cover = field(rng, (height, width), log_uniform(rng, 0.02, 0.8))
    opacity = most * np.clip((cover - level) / soft + 0.5, 0.0, 1.0)
    out = np.empty_like(views)
    for place, view in enumerate(views):
        alpha = np.roll(opacity, int(rng.integers(width)), 1) if is_shifted else opacity
        out[place] = view + (colour - view) * alpha[..., None]
    return out


def hidden(views, strength, rng, now):
    """Fill random shapes with a colour, noise or other parts of the image.

    The shapes are the same in all views, or differ between views.
    """
    height, width = views.shape[1:3]
    area, kind, alike = 0.6 * strength * rng.uniform(0.1, 1.0), rng.random(), rng.random() < 0.7
    mask, colour, out = shapes(rng, (height, width), area), _colour(rng), views.copy()
    for view in out:
        mask = mask if alike else shapes(now, (height, width), area)
        if kind < 0.6:
            view[mask] = colour
        elif kind < 0.8:
            view[mask] = now.random((int(mask.sum()), 3))
        else:
            other = np.roll(views[int(now.integers(len(views)))], width // 3, 1)
            view[mask] = other[mask]
    return out


def lost(views, strength, rng, now):
    """Remove each view, or a part of it, with probability 0.8 * strength.

    The removed pixels are filled with a constant grey level, noise or pixels of another view.
    """
    height, width = views.shape[1:3]
    out, kind, level = views.copy(), rng.random(), rng.choice((0.0, 0.0, 0.5, 1.0))
    part = rng.random() < 0.3
    for place in np.flatnonzero(now.random(len(views)) < 0.8 * strength):
        start = now.uniform(0.0, 0.8)
        top, left = (int(start * height), 0) if now.random() < 0.5 else (0, int(start * width))
        where = np.s_[place, top:, left:] if part else np.s_[place]
        if kind < 0.6:
            out[where] = level
        elif kind < 0.8:
            out[where] = now.random(out[where].shape)
        else:
            out[where] = views[now.integers(len(views)), top * part :, left * part :]
    return out


def _colour(rng: np.random.Generator) -> np.ndarray:
    """Sample a colour: black, white, a grey level or any other colour."""
    kind = rng.random()
    grey = np.repeat(0.0 if kind < 0.3 else 1.0 if kind < 0.4 else rng.random(), 3)
    return (grey if kind < 0.6 else rng.random(3)).astype(np.float32)


def _each(views, change) -> np.ndarray:
    return np.stack([change(view) for view in views]).clip(0.0, 1.0)


PRIMITIVES = (
    exposure,
    tone,
    colour_mix,
    contrast,
    filtered,
    coarse,
    warped,
    noisy,
    covered,
    hidden,
    lost,
)


def compose(views: np.ndarray, severity: float, key: Key) -> np.ndarray:
    """Apply one to three primitives with random strengths up to ``severity``.

    The choice of primitives is fixed per episode.
    """
    changed = composed(views.astype(np.float32) / 255.0, severity, key, NAME, PRIMITIVES)
    return np.rint(np.clip(changed, 0.0, 1.0) * 255.0).astype(np.uint8)
