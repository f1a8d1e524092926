"""Sample the primitives of a composition and their strengths, and compute random maps for
primitives.

A primitive is a function that returns a changed copy of views, of the same shape. Its arguments are
the views, a strength in (0, 1], and two random generators. The generator ``rng`` is for the
episode, and the generator ``now`` is for the frame. Constants without a source were chosen by this
project. At that time, no agent trained with them had been evaluated under unseen corruptions.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import cv2
import numpy as np

from mitigate.corruptions.keying import Key, digest

COUNTS = (0.4, 0.35, 0.25)  # probabilities that one, two or three primitives are applied
LEAST_STRENGTH = 0.35  # the strength of each primitive is at least this fraction of the severity

Primitive = Callable[..., np.ndarray]


def composed(
    views: np.ndarray,
    severity: float,
    key: Key,
    name: str,
    primitives: Sequence[Primitive],
) -> np.ndarray:
    """Apply one to three of ``primitives`` to ``views``; the choice depends on the key's
    episode.
    """
    chosen, rng = drawn(key, name, primitives)
    now = stream(digest(key, name, frame=True))
    for primitive in chosen:
        strength = severity * rng.uniform(LEAST_STRENGTH, 1.0)
        views = primitive(views, strength, rng, now)
    return views


def drawn(
    key: Key, name: str, primitives: Sequence[Primitive]
) -> tuple[list[Primitive], np.random.Generator]:
    """Return the primitives of the key's episode, in order, and a generator for their
    parameters.
    """
    rng = stream(digest(key, name))
    places = rng.permutation(len(primitives))[: 1 + rng.choice(len(COUNTS), p=COUNTS)]
    return [primitives[place] for place in places], rng


def stream(value: int) -> np.random.Generator:
    """Return a random generator that is seeded by a 64-bit digest."""
    return np.random.Generator(np.random.Philox(value))


def field(rng: np.random.Generator, shape: tuple[int, int], cell: float) -> np.ndarray:
    """Return a smooth random map, float32 [H, W], with mean 0 and standard deviation about 1.

    The map is interpolated from a grid of random values with a spacing of ``cell`` times the
    shorter side.
    """
    height, width = shape
    size = max(1.0, cell * min(height, width))
    rows, columns = (2 + round(length / size) for length in (height, width))
    cells = rng.standard_normal((rows, columns)).astype(np.float32)
    smooth = cv2.resize(cells, (width, height), interpolation=cv2.INTER_CUBIC)
    return smooth / max(float(smooth.std()), 0.3)


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    """Sample a number whose logarithm is uniformly distributed."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def shapes(rng: np.random.Generator, shape: tuple[int, int], area: float) -> np.ndarray:
    """Return a mask [H, W] of one to eight random shapes, which together cover about a fraction
    ``area`` of the image.
    """
    height, width = shape
    mask = np.zeros((height, width), np.uint8)
    count = int(rng.integers(1, 9))
    for _ in range(count):
        centre = rng.uniform(0, 1, 2) * (width, height)
        radius = np.sqrt(area * height * width / (np.pi * count)) * rng.uniform(0.7, 1.3)
        long, angle = rng.uniform(1.0, 4.0) ** 0.5, rng.uniform(0, np.pi)
        corners = rng.choice((3, 4, 5, 24))
        turns = np.sort(rng.uniform(0, 2 * np.pi, corners)) if corners < 24 else _CIRCLE
        points = np.stack([np.cos(turns) * long, np.sin(turns) / long], -1) * radius
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        cv2.fillPoly(mask, [np.rint(points @ turn.T + centre).astype(np.int32)], 1)
    return mask.astype(bool)


_CIRCLE = np.linspace(0, 2 * np.pi, 24, endpoint=False)


def displaced(rng: np.random.Generator, shape: tuple[int, int], reach: float) -> tuple:
    """Return the source coordinates x and y of each pixel, float32 [H, W].

    Pixels are displaced by a smooth random map, whose grid spacing is 0.06 to 0.6 times the shorter
    side. In addition, the whole image is rotated, scaled and shifted. The maximum displacement is
    about ``reach`` times the shorter side.
    """
    (height, width), cell = shape, log_uniform(rng, 0.06, 0.6)
    side = min(height, width)
    y, x = np.mgrid[:height, :width].astype(np.float32)
    local = rng.uniform(0.0, 1.0)
    # with a fine grid, large displacements would fold the image
    slope = reach * side * local * min(1.0, 3.0 * cell)
    turn, scale = (1.0 - local) * reach * rng.uniform(-1.5, 1.5, 2)
    shift = (1.0 - local) * reach * side * rng.uniform(-1.0, 1.0, 2)
    right, down = x - (width - 1) / 2, y - (height - 1) / 2
    bent = 0.4 * slope * np.stack([field(rng, shape, cell) for _ in range(2)])
    map_x = x + scale * right - turn * down + shift[0] + bent[0]
    map_y = y + turn * right + scale * down + shift[1] + bent[1]
    return map_x.astype(np.float32), map_y.astype(np.float32)


def pattern(rng: np.random.Generator, shape: tuple[int, int]) -> np.ndarray:
    """Return a periodic map, float32 [H, W] from -1 to 1: stripes, rings or checks with soft or
    sharp edges.

    The period is 0.03 to 0.8 times the shorter side.
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


def torn(
    views: np.ndarray, strength: float, rng: np.random.Generator, now: np.random.Generator
) -> np.ndarray:
    """Shift bands of rows or columns by random distances, or exchange blocks of pixels.

    The bands are the same in all views and frames, or new for each frame.
    """
    height, width = views.shape[1:3]
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


def copied(views: np.ndarray, strength: float, rng: np.random.Generator) -> np.ndarray:
    """Return a shifted or mirrored copy of each view, or the views of other headings."""
    kind, (height, width) = rng.random(), views.shape[1:3]
    if kind < 0.4:
        reach = 0.4 * strength * min(height, width)
        shifts = 1 + (rng.uniform(-1, 1, 2) * reach).astype(int)
        return np.roll(views, shifts, (1, 2))
    if kind < 0.7:
        return views[:, ::-1] if rng.random() < 0.4 else views[:, :, ::-1]
    return np.roll(views, int(rng.integers(1, max(2, len(views)))), 0)
