"""Sample the primitives of a composition and their strengths, and random maps for primitives.

A primitive returns a changed copy of views, of the same shape. Its arguments are the views, a
strength in (0, 1], and two random generators: ``rng`` for the episode, ``now`` for the frame.
Constants without a source were chosen by this project. At that time, no agent trained with them had
been evaluated under unseen corruptions.
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
    """Apply one to three of ``primitives``; the choice depends on the key's episode."""
    chosen, rng = drawn(key, name, primitives)
    now = stream(digest(key, name, frame=True))
    for primitive in chosen:
        strength = severity * rng.uniform(LEAST_STRENGTH, 1.0)
        views = primitive(views, strength, rng, now)
    return views


def drawn(
    key: Key, name: str, primitives: Sequence[Primitive]
) -> tuple[list[Primitive], np.random.Generator]:
    """Return the episode's primitives, in order, and a generator for their parameters."""
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
    """Return a mask [H, W] of one to eight random shapes.

    Together, the shapes cover about a fraction ``area`` of the image.
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

    A smooth random map displaces pixels by up to about ``reach`` times the shorter side. In
    addition, the whole image is rotated, scaled and shifted.
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
