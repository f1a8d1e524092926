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

    @property
    def graph(self) -> csr_matrix:
        """The graph of the free cells, in which each cell is connected to its 8 neighbours. Edge
        weights are in metres.

        Paths along this graph may cut the corner of a blocked cell by at most 0.06 m. On average,
        these paths are 5 % longer than exact shortest paths (docs/agents.md).
        """
        return _graph_of(self)

    def cell_of(self, xy: np.ndarray | tuple[float, float]) -> int:
        """Return the index of the free cell that is nearest to a plan position in metres."""
        return int(self.nearest[self._place(xy)])

    def _place(self, xy: np.ndarray | tuple[float, float]) -> tuple[int, int]:
        """Return the index (i, j) of the grid cell that contains a plan position, or of the nearest
        cell if the position is outside the grid.
        """
        i = min(max(int(xy[1] / CELL), 0), self.free.shape[0] - 1)
        j = min(max(int(xy[0] / CELL), 0), self.free.shape[1] - 1)
        return i, j

    def stand(self, xy: np.ndarray) -> np.ndarray:
        """Return a position where an agent can stand, float [2] in metres.

        The position is ``xy`` if the cell of ``xy`` is free, and otherwise the centre of the
        nearest free cell.
        """
        return xy if self.free[self._place(xy)] else self.centre(self.cell_of(xy))

    def centre(self, cell: int) -> np.ndarray:
        """Return the plan position (metres) of the centre of a free cell."""
        return (self.cells[cell][::-1] + 0.5) * CELL

    def distances(self, targets: list[int]) -> np.ndarray:
        """Return the geodesic distance in metres from every free cell to the nearest target cell,
        as float32 [n].
        """
        return dijkstra(self.graph, indices=targets, min_only=True).astype(np.float32)

    def shortest_path(self, start: int, field: np.ndarray) -> np.ndarray:
        """Return the cell centres ``[n, 2]`` on the shortest path from the cell ``start`` to the
        nearest target of ``field`` (see :meth:`distances`).
        """
        path, graph = [start], self.graph
        while field[path[-1]] > 1e-6:
            near = slice(graph.indptr[path[-1]], graph.indptr[path[-1] + 1])
            row, cost = graph.indices[near], graph.data[near]
            path.append(int(row[np.argmin(field[row] + cost)]))
        return (self.cells[path][:, ::-1] + 0.5) * CELL

    def move(self, xy: np.ndarray, heading: float, metres: float) -> tuple[np.ndarray, bool]:
        """Move straight ahead and slide along walls, as agents do in the R2R task of VLN-CE. Return
        the new position and whether the agent collided.
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
        """Return the free distance in metres along ``count`` evenly spaced headings,
        counter-clockwise from heading 0. Distances are limited to ``reach``.
        """
        return _rays(self.free, float(xy[0]), float(xy[1]), count, reach)


@lru_cache(maxsize=GRAPHS)
def _graph_of(space: FreeSpace) -> csr_matrix:
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


@njit(cache=True)
def _march(free, x, y, dx, dy, length):
    """Return the free distance in metres from (x, y) in the direction (dx, dy), at most
    ``length``.
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
