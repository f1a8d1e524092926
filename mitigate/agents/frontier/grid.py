"""Define the map of one episode, and functions that plan on this map.

``Grid`` holds square cells around the start position, aligned with the axes of the world. Each cell
stores free space, a value, and evidence for the object. Each depth frame updates the log-odds that
cells are occupied (Moravec and Elfes 1985). The output of the RGB encoder is projected onto the
cells that are visible in each column of the view. The functions plan routes over free and unknown
cells, and find frontiers and the cells of the object.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numba import njit
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

from mitigate.core.observation import FORWARD_METRES

CELL = 0.1  # metres
SIDE = 320  # cells: 32 m
REACH = 5.0  # maximum depth in metres that is used (as in VLFM)
LOW, HIGH = 0.15, 1.5  # surfaces between these heights in metres are obstacles
# surfaces between these heights in metres can belong to objects
THINGS_LOW, THINGS_HIGH = 0.05, 2.3
# Observing an occupied cell adds HIT to its log-odds, and observing a free cell subtracts MISS.
# The absolute value of the sum is at most MOST.
HIT, MISS, MOST = 0.9, 0.4, 3.5
NEAR = 2.0  # distance in metres up to which training labels call an object near (agents/text.py)
SLACK = 0.3  # tolerance in metres for the distance NEAR (heuristic)
SURE = 40.0  # bound of the evidence for the object, a sum of log-odds

RADIUS = 0.2  # distance in metres that the agent keeps from occupied cells
TIGHT, WIDE = 3.0, 0.4  # cells less than WIDE metres from an obstacle cost TIGHT times as much
# cost factor of unknown cells; it is finite, so that missing depth cannot enclose the agent
UNKNOWN = 4.0
MARGIN = 12  # planning includes a margin of this many cells around the known area
# minimum evidence of the object's cells, as a fraction of the highest evidence (heuristic)
SHARE = 0.7
SMALLEST = 4  # minimum number of cells of a frontier


class Grid:
    """Map of one episode. All arrays have the shape [SIDE, SIDE], and rows run along y.

    Args:
        start: pose [3] of the first observation.
        eye: height of the camera above the floor in metres.

    Attributes:
        occupied: log-odds that a cell is occupied.
        known: bool, cells that were observed.
        blocked: bool, cells that the agent collided with.
        value: 0 to 1, the likelihood that the object lies in the direction of a cell.
        trust: weight of ``value``, which depends on how well the cell was seen.
        evidence: sum of log-odds that the object is in a cell.
    """

    def __init__(self, start: np.ndarray, eye: float) -> None:
        self.origin = np.asarray(start[:2], np.float64) - SIDE * CELL / 2
        self.eye = eye
        maps = np.zeros((4, SIDE, SIDE), np.float32)
        self.occupied, self.value, self.trust, self.evidence = maps
        self.known, self.blocked = np.zeros((2, SIDE, SIDE), np.bool_)
        self._stamp = np.zeros((SIDE, SIDE), np.int32)
        self._looks = 0

    def cell(self, xy: np.ndarray) -> tuple[int, int]:
        """Return row and column of a position, clipped to the map."""
        j, i = np.clip((np.asarray(xy) - self.origin) / CELL, 0, SIDE - 1).astype(int)
        return int(i), int(j)

    def place(self, cells: np.ndarray) -> np.ndarray:
        """Return the centres [n, 2] of cells [n, 2] in metres."""
        return self.origin + (np.asarray(cells)[:, ::-1] + 0.5) * CELL

    def add(self, depth: np.ndarray, pose: np.ndarray, seen: np.ndarray, worth: np.ndarray) -> None:
        """Add one observation.

        Args:
            depth: float32 [H, W] metres, of a forward view of 90 degrees.
            pose: [3].
            seen: [n, 2], for each column from left to right, the probability that the object is
                visible and the probability that it is visible within 2 m.
            worth: [n], the likelihood that the object lies in the direction of each column.
        """
        self._looks += 1
        camera = (*map(float, pose[:2] - self.origin), float(pose[2]), float(self.eye))
        odds = np.clip(_logit(seen), -3, 3).astype(np.float32)
        columns = (odds, seen.astype(np.float32), worth.astype(np.float32))
        free = (self.occupied, self.known, self.value, self.trust)
        depth = np.ascontiguousarray(depth, np.float32)
        _scan(depth, camera, columns, free, (self.evidence, self._stamp, self._looks))

    def block(self, pose: np.ndarray) -> None:
        """Mark the cells ahead of a pose [3] as blocked, whatever depth shows."""
        ahead = np.array([-np.sin(pose[2]), np.cos(pose[2])])
        aside = np.array([ahead[1], -ahead[0]])
        for offset in (-2 * CELL, -CELL, 0.0, CELL, 2 * CELL):
            i, j = self.cell(pose[:2] + FORWARD_METRES * ahead + offset * aside)
            self.blocked[i, j] = self.known[i, j] = True

    def settle(self, cell: np.ndarray) -> None:
        """Mark all cells within 0.5 m of ``cell`` as known, so that no frontier remains there."""
        reach = int(0.5 / CELL)
        i, j = np.maximum(cell - reach, 0)
        self.known[i : i + 2 * reach + 1, j : j + 2 * reach + 1] = True

    def doubt(self, cells: np.ndarray) -> None:
        """Set the evidence at and around ``cells`` [n, 2] to its minimum."""
        here = np.zeros(self.evidence.shape, np.uint8)
        here[cells[:, 0], cells[:, 1]] = 1
        self.evidence[cv2.dilate(here, np.ones((5, 5), np.uint8)) > 0] = -SURE


def _logit(p: np.ndarray) -> np.ndarray:
    p = np.clip(p, 1e-3, 1 - 1e-3)
    return np.log(p / (1 - p))


@njit(cache=True)
def _scan(depth, camera, columns, free, things):
    """Update the map with one observation; see :meth:`Grid.add`."""
    x, y, heading, eye = camera
    odds, seen, worth = columns
    occupied, known, value, trust = free
    height, width = depth.shape
    for j in range(width):
        right = (2 * j + 1) / width - 1
        column = min(int(j * len(worth) / width), len(worth) - 1)
        stretch = math.hypot(1.0, right)
        angle = heading - math.atan(right)
        dx, dy = -math.sin(angle), math.cos(angle)
        first = second = REACH + 1
        floor = 0.0
        for i in range(height):
            z = depth[i, j]
            if not z > 0 or not z < 100:
                continue
            up = eye + (1 - (2 * i + 1) / height) * z
            r = z * stretch
            if LOW < up < HIGH:
                if r < first:
                    first, second = r, first
                elif r < second:
                    second = r
            elif up <= LOW:
                floor = max(floor, r)
            if THINGS_LOW < up < THINGS_HIGH and r < REACH:
                _witness(x + dx * r, y + dy * r, r, odds[column], seen[column], things)
        met = second <= REACH  # two readings are needed, because one may be noise
        end = second if met else min(floor, REACH)
        # as in VLFM, the square of the cosine of the angle from the view's centre
        conf = 1 / stretch**2
        for k in range(int(end / CELL)):
            i, c = int((y + dy * k * CELL) / CELL), int((x + dx * k * CELL) / CELL)
            if i < 0 or c < 0 or i >= occupied.shape[0] or c >= occupied.shape[1]:
                break
            known[i, c] = True
            occupied[i, c] = max(occupied[i, c] - MISS, -MOST)
            total = trust[i, c] + conf
            value[i, c] = (value[i, c] * trust[i, c] + worth[column] * conf) / total
            trust[i, c] = min(total, 8.0)
        if met:
            i, c = int((y + dy * end) / CELL), int((x + dx * end) / CELL)
            if 0 <= i < occupied.shape[0] and 0 <= c < occupied.shape[1]:
                known[i, c] = True
                occupied[i, c] = min(occupied[i, c] + HIT + MISS, MOST)


@njit(cache=True)
def _witness(x, y, r, odds, seen, things):
    """Update the evidence of the cell at (x, y), where a surface was seen ``r`` metres away."""
    evidence, stamp, look = things
    i, j = int(y / CELL), int(x / CELL)
    if i < 0 or j < 0 or i >= evidence.shape[0] or j >= evidence.shape[1] or stamp[i, j] == look:
        return
    stamp[i, j] = look
    weight = odds[0]
    if seen[0] > 0.5 and (
        (seen[1] > 0.6 and r > NEAR + SLACK) or (seen[1] < 0.3 and r < NEAR - SLACK)
    ):
        # the object is visible in this column, but it is closer or farther than this surface
        weight = -0.5
    evidence[i, j] = min(max(evidence[i, j] + weight, -SURE), SURE)


@dataclass
class Routes:
    """Costs of the paths from the agent to all cells in a window of the map."""

    cost: np.ndarray  # float [h, w] in metres
    before: np.ndarray  # int [h * w], the predecessor of each cell on its path
    corner: tuple[int, int]  # row and column of the window's first cell

    def to(self, cell: np.ndarray) -> np.ndarray:
        """Return the cells [n, 2] of the path from the agent to ``cell`` [2]."""
        width = self.cost.shape[1]
        path = [int((cell[0] - self.corner[0]) * width + cell[1] - self.corner[1])]
        while self.before[path[-1]] >= 0:
            path.append(int(self.before[path[-1]]))
        cells = np.array(path[::-1])
        return np.stack([cells // width, cells % width], 1) + self.corner

    def at(self, cells: np.ndarray) -> np.ndarray:
        """Return the path costs [n] of cells [n, 2], infinite outside the window."""
        local = np.asarray(cells) - self.corner
        inside = ((local >= 0) & (local < self.cost.shape)).all(1)
        out = np.full(len(local), np.inf)
        out[inside] = self.cost[local[inside, 0], local[inside, 1]]
        return out


def clearance(grid: Grid) -> np.ndarray:
    """Return each cell's distance in metres to the nearest occupied cell, float32 [SIDE, SIDE]."""
    free = ((grid.occupied <= 0) & ~grid.blocked).astype(np.uint8)
    return cv2.distanceTransform(free, cv2.DIST_L2, 5) * CELL


def routes(grid: Grid, xy: np.ndarray) -> Routes:
    """Return the cheapest routes from ``xy`` to all cells in and around the known area."""
    here = np.array(grid.cell(xy))
    seen = np.argwhere(grid.known)
    low = np.maximum(np.minimum(seen.min(0, initial=10**6), here) - MARGIN, 0)
    high = np.minimum(np.maximum(seen.max(0, initial=0), here) + MARGIN, len(grid.known) - 1) + 1
    window = np.s_[low[0] : high[0], low[1] : high[1]]
    gap, known = clearance(grid)[window], grid.known[window]
    start_cell = here - low
    rows, columns = np.ogrid[: gap.shape[0], : gap.shape[1]]
    around = np.hypot(rows - start_cell[0], columns - start_cell[1]) * CELL
    open_ = (gap > RADIUS) | (around < 2 * RADIUS) & (gap > 0)
    price = np.where(known, 1.0, UNKNOWN) * np.where(gap < WIDE, TIGHT, 1.0)
    start = int(start_cell[0] * gap.shape[1] + start_cell[1])
    cost, before = dijkstra(_graph(open_, price), indices=start, return_predecessors=True)
    return Routes(cost.reshape(gap.shape), before, (int(low[0]), int(low[1])))


def _graph(open_: np.ndarray, price: np.ndarray) -> coo_matrix:
    """Return the 8-connected graph of open cells.

    ``price`` is the cost per metre in each cell. The cost of an edge is its length times the mean
    ``price`` of its two cells.
    """
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
    """Return groups of at least ``SMALLEST`` known free cells [n, 2] next to unknown cells."""
    free = grid.known & (clearance(grid) > RADIUS)
    unknown = (~grid.known).astype(np.uint8)
    edge = free & (cv2.dilate(unknown, np.ones((3, 3), np.uint8)) > 0)
    count, labels = cv2.connectedComponents(edge.astype(np.uint8), connectivity=8)
    cells = np.argwhere(edge)
    owner = labels[edge]
    groups = [cells[owner == label] for label in range(1, count)]
    return [group for group in groups if len(group) >= SMALLEST]


def object_cells(grid: Grid, least: float) -> np.ndarray:
    """Return the group of cells [n, 2] with the most evidence for the object.

    A cell is in the group if its evidence is above both ``least`` and ``SHARE`` times the highest
    evidence. So each observation that confirms earlier observations makes the group smaller.
    """
    likely = grid.evidence > max(least, SHARE * float(grid.evidence.max()))
    if not likely.any():
        return np.zeros((0, 2), int)
    near = cv2.dilate(likely.astype(np.uint8), np.ones((3, 3), np.uint8))
    count, labels = cv2.connectedComponents(near, connectivity=8)
    sums = np.bincount(labels[likely], weights=grid.evidence[likely], minlength=count)
    return np.argwhere(likely & (labels == int(sums.argmax())))


def clear_ahead(grid: Grid, path: np.ndarray, most: float) -> np.ndarray:
    """Return the farthest cell of ``path`` [n, 2] that can be reached in a straight line.

    The line keeps a distance of ``RADIUS`` from occupied cells and is at most ``most`` metres long.
    The first step is not checked, because the agent may already be closer to an obstacle.
    """
    gap, step = clearance(grid), int(np.ceil(FORWARD_METRES / CELL))
    best = min(step, len(path) - 1)
    for k in range(step + 1, min(len(path), int(most / CELL) + 1)):
        line = np.linspace(path[0], path[k], 2 * k + 1).round().astype(int)[2 * step :]
        if (gap[line[:, 0], line[:, 1]] <= RADIUS).any():
            break
        best = k
    return path[best]
