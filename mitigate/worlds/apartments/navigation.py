"""Compute where an agent can stand in an apartment, geodesic distances, and straight-line moves."""

from __future__ import annotations

from functools import lru_cache

import cv2
import numpy as np
from numba import njit
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

CELL = 0.1  # width of a grid cell in metres
RADIUS = 0.18  # radius of the agent in metres (0.1 to 0.2 for the LoCoBot-like agent of VLN-CE)
# number of cached graphs (heuristic); a graph uses 0.5 MB, and building it takes 1.3 ms
GRAPHS = 32
_OUTSIDE = 1e-6  # distance in cells from a blocked cell to the corner point that represents it
# two crossings of grid lines closer than this, as a fraction of the line, are one crossing
_TOUCH = 1e-9
# distance in metres between the points of a straight move that are checked for collisions
_SAMPLE = 0.04


class FreeSpace:
    """The grid cells, ``CELL`` metres wide, in which the centre of an agent may be.

    ``free`` is a bool array ``[ny, nx]``. Cell (i, j) covers x from j * CELL to (j + 1) * CELL,
    and y from i * CELL to (i + 1) * CELL.
    """

    def __init__(self, blocked: np.ndarray) -> None:
        open_cells = (~blocked).astype(np.uint8)
        distance = cv2.distanceTransform(open_cells, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
        free = distance * CELL > RADIUS + CELL / 2
        _, labels = cv2.connectedComponents(free.astype(np.uint8), connectivity=4)
        sizes = np.bincount(labels.ravel())
        sizes[0] = 0
        self.share = float(sizes.max() / max(1, free.sum()))
        self.free = labels == int(sizes.argmax())
        self.index: np.ndarray = np.full(free.shape, -1, np.int32)
        self.cells = np.argwhere(self.free)
        self.index[self.free] = np.arange(len(self.cells))
        _, nearest = cv2.distanceTransformWithLabels(
            (~self.free).astype(np.uint8), cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL
        )
        table = np.zeros(int(nearest.max()) + 1, np.int32)
        table[nearest[self.free]] = self.index[self.free]
        self.nearest = table[nearest]

    def cell_of(self, xy: np.ndarray | tuple[float, float]) -> int:
        """Return the index of the free cell that is nearest to a plan position in metres."""
        return int(self.nearest[self._place(xy)])

    def _place(self, xy: np.ndarray | tuple[float, float]) -> tuple[int, int]:
        """Return the index (i, j) of the grid cell nearest to a plan position."""
        i = min(max(int(xy[1] / CELL), 0), self.free.shape[0] - 1)
        j = min(max(int(xy[0] / CELL), 0), self.free.shape[1] - 1)
        return i, j

    def stand(self, xy: np.ndarray) -> np.ndarray:
        """Return ``xy`` if its cell is free, and otherwise the centre of the nearest free cell."""
        return xy if self.free[self._place(xy)] else self.centre(self.cell_of(xy))

    def centre(self, cell: int) -> np.ndarray:
        """Return the plan position (metres) of the centre of a free cell."""
        return (self.cells[cell][::-1] + 0.5) * CELL

    def distances(self, targets: list[int]) -> np.ndarray:
        """Return the geodesic distance in metres from each free cell to the nearest target cell.

        The result is float32 [n].
        """
        return dijkstra(_graph_of(self), indices=targets, min_only=True).astype(np.float32)

    def shortest_path(self, start: int, field: np.ndarray) -> np.ndarray:
        """Return the cell centres [n, 2] on the shortest path from the cell ``start``.

        The path leads to the nearest target of ``field`` (see :meth:`distances`).
        """
        path = [start]
        graph = _graph_of(self)
        while field[path[-1]] > 1e-6:
            near = slice(graph.indptr[path[-1]], graph.indptr[path[-1] + 1])
            row, cost = graph.indices[near], graph.data[near]
            path.append(int(row[np.argmin(field[row] + cost)]))
        return (self.cells[path][:, ::-1] + 0.5) * CELL

    def shortest_length(self, xy: np.ndarray, targets: list[int]) -> float:
        """Return the length in metres of the shortest path to the nearest centre of a target cell.

        The path starts at the plan position ``xy`` [2], which must be in a free cell. The path may
        have any direction. It only bends at corners of blocked cells, so Dijkstra's algorithm runs
        on the visibility graph of these corners (Lozano-Perez and Wesley, 1979).
        """
        corners, between = _corners_of(self)
        start = np.asarray(xy, float)[None] / CELL
        ends = self.cells[targets][:, ::-1] + 0.5
        points = np.concatenate([start, corners])
        graph = np.zeros((len(points), len(points)))
        graph[1:, 1:] = between
        graph[:1, 1:] = _visible_lengths(self.free, start, corners)
        to_points = dijkstra(graph, indices=0)
        last = _visible_lengths(self.free, points, ends)
        return float(np.min(to_points[:, None] + last) * CELL)

    def move(self, xy: np.ndarray, heading: float, metres: float) -> tuple[np.ndarray, bool]:
        """Move straight ahead and slide along walls, as agents do in the R2R task of VLN-CE.

        Return the new position and whether the agent collided.
        """
        dx, dy = -np.sin(heading), np.cos(heading)
        distance = _march(self.free, xy[0], xy[1], dx, dy, metres)
        new = np.array([xy[0] + dx * distance, xy[1] + dy * distance])
        if metres - distance < 1e-6:
            return new, False
        rest = metres - distance
        slides = [(np.sign(dx), 0.0, abs(dx) * rest), (0.0, np.sign(dy), abs(dy) * rest)]
        moved = [_march(self.free, new[0], new[1], sx, sy, length) for sx, sy, length in slides]
        best = int(np.argmax(moved))
        return new + np.array(slides[best][:2]) * moved[best], True

    def rays(self, xy: np.ndarray, count: int, reach: float) -> np.ndarray:
        """Return the free distances in metres along ``count`` evenly spaced headings.

        Headings run counter-clockwise from 0. Distances are limited to ``reach``.
        """
        return _rays(self.free, float(xy[0]), float(xy[1]), count, reach)


@lru_cache(maxsize=GRAPHS)
def _graph_of(space: FreeSpace) -> csr_matrix:
    """Return the graph in which each free cell is connected to its 8 neighbours.

    Edge weights are in metres. Paths along this graph have eight directions. On average, they are
    5 % longer than paths in any direction (:meth:`FreeSpace.shortest_length`).
    """
    rows, cols, data = [], [], []
    height, width = space.index.shape
    for di, dj in ((0, 1), (1, 0), (1, 1), (1, -1)):
        a = space.index[: height - di, max(0, -dj) : width - max(0, dj)]
        b = space.index[di:, max(0, dj) : width + min(0, dj)]
        both = (a >= 0) & (b >= 0)
        rows += [a[both], b[both]]
        cols += [b[both], a[both]]
        data += [np.full(2 * int(both.sum()), CELL * np.hypot(di, dj))]
    n = len(space.cells)
    return csr_matrix((np.concatenate(data), (np.concatenate(rows), np.concatenate(cols))), (n, n))


@lru_cache(maxsize=GRAPHS)
def _corners_of(space: FreeSpace) -> tuple[np.ndarray, np.ndarray]:
    """Return the corners at which a path can bend, and the free distances between them.

    The corners are float [n, 2] (x, y). The distances are the lengths of straight lines, float
    [n, n] (inf: the line is not free). The unit is one cell.
    """
    free, corners = space.free, []
    rows, columns = np.arange(1, free.shape[0] - 1), np.arange(1, free.shape[1] - 1)
    for di in (-1, 1):
        for dj in (-1, 1):
            # The cell is blocked, and the three cells around this corner of it are free.
            beside = free[np.ix_(rows + di, columns)] & free[np.ix_(rows, columns + dj)]
            corner = beside & free[np.ix_(rows + di, columns + dj)] & ~free[1:-1, 1:-1]
            i, j = np.nonzero(corner)
            # The point is just outside the cell, so that lines along the walls are free.
            step = 0.5 + _OUTSIDE
            corners.append(np.stack([j + 1.5 + dj * step, i + 1.5 + di * step], axis=1))
    points = np.concatenate(corners)
    return points, _visible_lengths(free, points, points)


@njit(cache=True)
def _visible_lengths(free, starts, ends):
    """Return the lengths of the straight lines from ``starts`` [n, 2] to ``ends`` [m, 2].

    The lengths are float [n, m] in cells (inf: the line is not free).
    """
    lengths = np.full((len(starts), len(ends)), np.inf)
    for a in range(len(starts)):
        for b in range(len(ends)):
            x, y = starts[a]
            dx, dy = ends[b, 0] - x, ends[b, 1] - y
            if _line_is_free(free, x, y, dx, dy):
                lengths[a, b] = np.hypot(dx, dy)
    return lengths


@njit(cache=True)
def _line_is_free(free, x, y, dx, dy):
    """Return whether the line from (x, y) to (x + dx, y + dy) crosses free cells only.

    The algorithm is that of Amanatides and Woo (1987).
    """
    i, j = int(np.floor(y)), int(np.floor(x))
    last_i, last_j = int(np.floor(y + dy)), int(np.floor(x + dx))
    step_i, step_j = (1 if dy > 0 else -1), (1 if dx > 0 else -1)
    # fractions of the line at which it enters the next row and the next column
    next_i = (i + (dy > 0) - y) / dy if dy else np.inf
    next_j = (j + (dx > 0) - x) / dx if dx else np.inf
    while True:
        if i < 0 or j < 0 or i >= free.shape[0] or j >= free.shape[1] or not free[i, j]:
            return False
        if i == last_i and j == last_j:
            return True
        if abs(next_i - next_j) < _TOUCH:  # the line may touch the corners of blocked cells
            i, j = i + step_i, j + step_j
            next_i, next_j = next_i + abs(1 / dy), next_j + abs(1 / dx)
        elif next_i < next_j:
            i, next_i = i + step_i, next_i + abs(1 / dy)
        else:
            j, next_j = j + step_j, next_j + abs(1 / dx)


@njit(cache=True)
def _march(free, x, y, dx, dy, length):
    """Return the free distance in metres from (x, y) in the direction (dx, dy).

    The distance is at most ``length``.
    """
    norm = np.hypot(dx, dy)
    if norm < 1e-9 or length <= 0:
        return length
    ux, uy = dx / norm, dy / norm
    steps = int(np.ceil(length / _SAMPLE))
    distance = 0.0
    for k in range(1, steps + 1):
        t = length * k / steps
        i, j = int((y + uy * t) / CELL), int((x + ux * t) / CELL)
        if i < 0 or j < 0 or i >= free.shape[0] or j >= free.shape[1] or not free[i, j]:
            return distance
        distance = t
    return length


@njit(cache=True)
def _rays(free, x, y, count, reach):
    out = np.empty(count, np.float32)
    for a in range(count):
        angle = 2 * np.pi * a / count
        out[a] = _march(free, x, y, -np.sin(angle), np.cos(angle), reach)
    return out
