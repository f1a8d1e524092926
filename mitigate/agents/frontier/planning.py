"""Where to go on the map: routes over what is free or unknown, frontiers, the object's place."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

from mitigate.agents.frontier.grid import CELL, Grid
from mitigate.core.observation import FORWARD_METRES

RADIUS = 0.2  # metres kept from what is occupied
TIGHT, WIDE = 3.0, 0.4  # cells nearer than WIDE metres to something cost TIGHT times as much
UNKNOWN = 4.0  # cost of a cell that was never seen: depth that fails must not wall the agent in
MARGIN = 12  # cells around what is known that are planned over
SHARE = 0.7  # (ours)
SMALLEST = 4  # cells of a frontier worth going to


@dataclass
class Routes:
    """Costs in metres from the agent over a window of the map: cost [h, w], corner (row, column) of
    the window, and from where each cell is reached: before int [h * w]."""

    cost: np.ndarray
    before: np.ndarray
    corner: tuple[int, int]

    def to(self, cell: np.ndarray) -> np.ndarray:
        """Cells [n, 2] of the map from the agent to ``cell`` [2]."""
        width = self.cost.shape[1]
        here = int((cell[0] - self.corner[0]) * width + cell[1] - self.corner[1])
        found = [here]
        while self.before[found[-1]] >= 0:
            found.append(int(self.before[found[-1]]))
        cells = np.array(found[::-1])
        return np.stack([cells // width, cells % width], 1) + self.corner

    def at(self, cells: np.ndarray) -> np.ndarray:
        """Costs [n] of cells [n, 2] of the map; infinite outside of the window."""
        own = np.asarray(cells) - self.corner
        inside = ((own >= 0) & (own < self.cost.shape)).all(1)
        out = np.full(len(own), np.inf)
        out[inside] = self.cost[own[inside, 0], own[inside, 1]]
        return out


def clearance(grid: Grid) -> np.ndarray:
    """Metres from each cell of the map to the nearest occupied one: float32 [SIDE, SIDE]."""
    free = ((grid.occupied <= 0) & ~grid.blocked).astype(np.uint8)
    return cv2.distanceTransform(free, cv2.DIST_L2, 5) * CELL


def routes(grid: Grid, xy: np.ndarray) -> Routes:
    """Cheapest routes from ``xy`` to all cells around what is known."""
    here = np.array(grid.cell(xy))
    seen = np.argwhere(grid.known)
    low = np.maximum(np.minimum(seen.min(0, initial=10**6), here) - MARGIN, 0)
    high = np.minimum(np.maximum(seen.max(0, initial=0), here) + MARGIN, len(grid.known) - 1) + 1
    window = np.s_[low[0] : high[0], low[1] : high[1]]
    gap, known = clearance(grid)[window], grid.known[window]
    own = here - low
    rows, columns = np.ogrid[: gap.shape[0], : gap.shape[1]]
    around = np.hypot(rows - own[0], columns - own[1]) * CELL
    open_ = (gap > RADIUS) | (around < 2 * RADIUS) & (gap > 0)
    price = np.where(known, 1.0, UNKNOWN) * np.where(gap < WIDE, TIGHT, 1.0)
    start = int(own[0] * gap.shape[1] + own[1])
    cost, before = dijkstra(_graph(open_, price), indices=start, return_predecessors=True)
    return Routes(cost.reshape(gap.shape), before, (int(low[0]), int(low[1])))


def _graph(open_: np.ndarray, price: np.ndarray) -> coo_matrix:
    """8-connected graph over the open cells; an edge costs its metres times the mean price."""
    index = np.arange(open_.size).reshape(open_.shape)
    parts = []
    for di, dj in ((0, 1), (1, 0), (1, 1), (1, -1)):
        a = np.s_[: open_.shape[0] - di, max(0, -dj) : open_.shape[1] - max(0, dj)]
        b = np.s_[di:, max(0, dj) : open_.shape[1] + min(0, dj)]
        both = open_[a] & open_[b]
        metres = CELL * np.hypot(di, dj) * (price[a][both] + price[b][both]) / 2
        parts.append((index[a][both], index[b][both], metres))
    one, two, data = (np.concatenate(column) for column in zip(*parts, strict=True))
    both_ways = (np.concatenate([one, two]), np.concatenate([two, one]))
    return coo_matrix((np.concatenate([data, data]), both_ways), (open_.size, open_.size)).tocsr()


def frontiers(grid: Grid) -> list[np.ndarray]:
    """Groups of known, free cells [n, 2] that touch unknown ones; each at least ``SMALLEST``."""
    free = grid.known & (clearance(grid) > RADIUS)
    unknown = (~grid.known).astype(np.uint8)
    edge = free & (cv2.dilate(unknown, np.ones((3, 3), np.uint8)) > 0)
    count, labels = cv2.connectedComponents(edge.astype(np.uint8), connectivity=8)
    cells = np.argwhere(edge)
    owner = labels[edge]
    groups = [cells[owner == label] for label in range(1, count)]
    return [group for group in groups if len(group) >= SMALLEST]


def object_cells(grid: Grid, least: float) -> np.ndarray:
    """Cells [n, 2] of the group with the most evidence for the object, of those above ``least``
    and above ``SHARE`` of the most that any cell has: more looks narrow it down."""
    likely = grid.evidence > max(least, SHARE * float(grid.evidence.max()))
    if not likely.any():
        return np.zeros((0, 2), int)
    near = cv2.dilate(likely.astype(np.uint8), np.ones((3, 3), np.uint8))
    count, labels = cv2.connectedComponents(near, connectivity=8)
    sums = np.bincount(labels[likely], weights=grid.evidence[likely], minlength=count)
    return np.argwhere(likely & (labels == int(sums.argmax())))


def clear_ahead(grid: Grid, path: np.ndarray, most: float) -> np.ndarray:
    """The last cell of ``path`` [n, 2], at most ``most`` metres away, to which the straight line
    from its first cell keeps ``RADIUS`` from what is occupied. It is at least a step away, if the
    path is: where the agent stands, it may be nearer to things than that."""
    gap, step = clearance(grid), int(np.ceil(FORWARD_METRES / CELL))
    best = min(step, len(path) - 1)
    for k in range(step + 1, min(len(path), int(most / CELL) + 1)):
        line = np.linspace(path[0], path[k], 2 * k + 1).round().astype(int)[2 * step :]
        if (gap[line[:, 0], line[:, 1]] <= RADIUS).any():
            break
        best = k
    return path[best]
