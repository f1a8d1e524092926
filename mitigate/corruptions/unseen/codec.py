"""Unseen RGB corruptions of a compressed video stream: coarse blocks and lost slices.

Functions have the same arguments and results as in ``corruptions/rgb.py``.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import lru_cache, partial

import numpy as np
from numba import njit

from mitigate.corruptions.keying import Key, uniform, view_streams
from mitigate.corruptions.record import TEST, VALIDATION, Record

# possible sides of a block in pixels, as in the transforms of H.264 and H.265
BLOCKS = (4, 8, 16, 32)
BLOCKS_ACROSS = 28  # number of blocks along the shorter side; at 224 px, a block has 8 px
DEAD_ZONE = 0.40  # minimum amplitude, as a fraction of white, of patterns that remain at severity 1
CHROMA = 2.0  # minimum amplitude in the colour channels, relative to the minimum in grey
SLICES = 14  # number of horizontal slices per frame; at a height of 224 px, each has 16 px
LOST = 0.8  # fraction of lost slices at severity 1
NOTHING = 128  # grey level that a decoder shows if there is no earlier frame


@lru_cache(maxsize=4)
def cosines(side: int) -> np.ndarray:
    """Return the orthonormal DCT-II matrix, float32 [side, side], with one frequency per row."""
    places = (2 * np.arange(side) + 1) * np.arange(side)[:, None]
    matrix = np.cos(math.pi * places / (2 * side)) * math.sqrt(2.0 / side)
    matrix[0] = math.sqrt(1.0 / side)
    return matrix.astype(np.float32)


def block_side(height: int, width: int) -> int:
    """Return the side in ``BLOCKS`` that is nearest, by ratio, to 1/28 of the shorter side."""
    target = math.log(min(height, width) / BLOCKS_ACROSS)
    return min(BLOCKS, key=lambda side: abs(math.log(side) - target))


@lru_cache(maxsize=1)
def opponents() -> np.ndarray:
    """Return an orthonormal colour matrix, float32 [3, 3].

    Its rows are grey, red minus blue, and green minus red and blue.
    """
    rows = np.array([[1.0, 1.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 2.0, -1.0]])
    return (rows / np.linalg.norm(rows, axis=1, keepdims=True)).astype(np.float32)


@njit(cache=True)
def _both_ways(matrix, cells, spare):
    """Replace each block in ``cells`` [b, b, n] by matrix @ block @ matrix^T, in place."""
    side, _, count = cells.shape
    for k in range(side):
        for x in range(side):
            row = spare[k, x]
            for i in range(count):
                row[i] = np.float32(0)
            for j in range(side):
                weight, source = matrix[k, j], cells[j, x]
                for i in range(count):
                    row[i] += weight * source[i]
    for y in range(side):
        for k in range(side):
            row = cells[y, k]
            for i in range(count):
                row[i] = np.float32(0)
            for j in range(side):
                weight, source = matrix[k, j], spare[y, j]
                for i in range(count):
                    row[i] += weight * source[i]


@njit(cache=True)
def _lose(cells, least):
    """Set DCT coefficients whose magnitude is below ``least`` to 0, in place, except the mean."""
    mean = cells[0, 0].copy()
    flat = cells.reshape(-1)
    for i in range(flat.size):
        flat[i] = flat[i] if abs(flat[i]) >= least else np.float32(0)
    cells[0, 0] = mean


@njit(cache=True)
def _gather(view, weights, cells):
    """Fill ``cells`` [b, b, n] with the blocks of one opponent colour of ``view``.

    ``view`` is uint8 [H, W, 3]. Blocks that extend beyond the view repeat its edge pixels.
    """
    height, width, _ = view.shape
    side, across = cells.shape[0], -(-width // cells.shape[0])
    for y in range(-(-height // side) * side):
        row = view[min(y, height - 1)]
        for x in range(across * side):
            r, g, b = row[min(x, width - 1)]
            n = (y // side) * across + x // side
            level = weights[0] * np.float32(r) + weights[1] * np.float32(g)
            cells[y % side, x % side, n] = level + weights[2] * np.float32(b)


@njit(cache=True)
def _code(views, colours, matrix, back, least, out):
    count, height, width, _ = views.shape
    side = matrix.shape[0]
    across, blocks = -(-width // side), -(-width // side) * -(-height // side)
    planes = np.empty((3, side, side, blocks), np.float32)
    spare = np.empty((side, side, blocks), np.float32)
    for v in range(count):
        for p in range(3):
            _gather(views[v], colours[p], planes[p])
            _both_ways(matrix, planes[p], spare)
            _lose(planes[p], least[p])
            _both_ways(back, planes[p], spare)
        for y in range(height):
            for x in range(width):
                cell = (y % side, x % side, (y // side) * across + x // side)
                for c in range(3):
                    level = colours[0, c] * planes[0][cell] + colours[1, c] * planes[1][cell]
                    level += colours[2, c] * planes[2][cell] + np.float32(0.5)
                    out[v, y, x, c] = int(min(max(level, np.float32(0)), np.float32(255)))


def dead_zones(severity: float, side: int) -> np.ndarray:
    """Return the smallest magnitude of kept DCT coefficients per opponent colour, float32 [3]."""
    zones = np.array([1.0, CHROMA, CHROMA]) * (DEAD_ZONE * severity * 255.0 * side / 2.0)
    return zones.astype(np.float32)


def compression(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Remove patterns with an amplitude below 0.4 * severity (1 is white) from image blocks.

    The DCT coefficients of these patterns are set to 0. In the two colour channels, the threshold
    is twice as high.
    """
    side = block_side(*views.shape[1:3])
    least = dead_zones(severity, side)
    matrix, out = cosines(side), np.empty_like(views)
    _code(views, opponents(), matrix, np.ascontiguousarray(matrix.T), least, out)
    return out


def lost_parts(
    severity: float, key: Key, views: int, height: int, width: int
) -> Iterator[tuple[int, slice, int]]:
    """Yield each part that ``lost_slices`` removes, as its view, its rows and its first column."""
    edges = np.rint(np.linspace(0, height, SLICES + 1)).astype(int)
    for view, stream in enumerate(view_streams(key, "lost_slices", views)):
        for number in range(SLICES):
            if uniform(int(stream), 2 * number) < LOST * severity:
                start = int(uniform(int(stream), 2 * number + 1) * width)
                yield view, slice(edges[number], edges[number + 1]), start


def lost_slices(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Fill each of the 14 slices of a view with grey, with a probability of 0.8 * severity.

    A slice is filled from a random column to its end.
    """
    out = views.copy()
    for view, rows, start in lost_parts(severity, key, *views.shape[:3]):
        out[view, rows, start:] = NOTHING
    return out


_validation = partial(Record.of, "rgb", version="1", half=VALIDATION)
_test = partial(Record.of, "rgb", version="1", half=TEST)
RECORDS = (
    _validation(
        compression, "patterns of amplitude under 0.4 s are lost", "ImageNet-C, H.264, H.265"
    ),
    _test(lost_slices, "0.8 s of the slices are lost", "Wenger 2003", frame="which, from where"),
)
