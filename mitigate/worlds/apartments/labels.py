"""Compute labels that describe what is visible in a panorama, from the renderer's face ids.

Labels of a panorama describe the central 36 degrees of each view. Neighbouring views are 30 degrees
apart, so their labels hardly overlap. The view of a single camera is divided into ``COLUMNS``
columns, and each column has its own labels.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
from numba import njit

from mitigate.core.observation import HFOV_DEGREES, VIEWS
from mitigate.worlds.apartments.apartment import Apartment
from mitigate.worlds.apartments.layout import CATEGORIES, ROOM_KINDS
from mitigate.worlds.apartments.navigation import FreeSpace
from mitigate.worlds.apartments.palette import COLOUR_NAMES

# concepts: visible furniture, furniture nearer than 2 m, its colours, kinds of visible rooms
NEAR = tuple(f"near {name}" for name in CATEGORIES)
CONCEPTS = (*CATEGORIES, *NEAR, *COLOUR_NAMES, *ROOM_KINDS)
_HALF_ANGLE = np.radians(18.0)
# number of angle bins and of distance bins of the free-space labels, and metres per distance bin
ANGLES, DISTANCES, STEP = 120, 12, 0.25
COLUMNS = 4  # number of columns into which a view is divided; their widths in pixels are equal
# direction of each angle bin in radians, positive to the right
YAWS = np.radians(360.0 / ANGLES * (np.arange(ANGLES) + 0.5) - 180.0 / VIEWS)


def free_directions(space: FreeSpace, xy: np.ndarray, heading: float) -> np.ndarray:
    """Return a mask, float32 [120, 12], that is 1 where the straight path from a pose is free.

    Angle bin ``10 * k + i`` is ``30 * k - 15 + 3 * (i + 0.5)`` degrees to the right of the heading.
    The second axis is the distance in steps of 0.25 m.
    """
    fine = space.rays(xy, 4 * ANGLES, STEP * DISTANCES)
    world = (np.round((heading - YAWS) / (2 * np.pi) * 4 * ANGLES).astype(int)) % (4 * ANGLES)
    return (fine[world][:, None] >= STEP * (np.arange(DISTANCES) + 1) - 1e-3).astype(np.float32)


def pose_labels(
    apartment: Apartment, xy: np.ndarray, heading: float, ids: np.ndarray, depth: np.ndarray
) -> dict[str, np.ndarray]:
    """Return the labels "concepts", "seen" and "free" of ``ApartmentsWorld.truth`` at a pose.

    Args:
        apartment: The apartment.
        xy: Plan position [2] in metres.
        heading: Heading in radians.
        ids: Face ids, int32 [V, H, W]. V is 12 for a panorama and 1 for a single camera.
        depth: Depth in metres, float32 [V, H, W, 1].
    """
    free = free_directions(apartment.space, xy, heading)
    width = ids.shape[2]
    if len(ids) == VIEWS:
        middle = width / 2
        half = np.tan(_HALF_ANGLE) * middle
        concepts, seen = _within(apartment, ids, depth, round(middle - half), round(middle + half))
    else:
        edges = np.linspace(0, width, COLUMNS + 1).round().astype(int).tolist()
        columns = [_within(apartment, ids, depth, low, high) for low, high in pairwise(edges)]
        concepts = np.concatenate([column[0] for column in columns])
        seen = np.concatenate([column[1] for column in columns])
        half_view = round(ANGLES * HFOV_DEGREES / 720)
        # the heading is this many bins to the right of the left edge of bin 0
        heading_bin = round(ANGLES / VIEWS / 2)
        # the view covers the angles from left to right
        free = np.roll(free, half_view - heading_bin, 0)[: 2 * half_view]
    return {"concepts": concepts, "seen": seen, "free": free}


def _within(
    apartment: Apartment, ids: np.ndarray, depth: np.ndarray, low: int, high: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return "concepts" and "seen" of each view in the pixel columns from ``low`` to ``high``."""
    sizes = (len(CATEGORIES), len(COLOUR_NAMES), len(CONCEPTS))
    arguments: Any = (ids, depth[..., 0], low, high, *_tables(apartment), *sizes)
    return _label(*arguments)


@lru_cache(maxsize=64)  # the cache size is limited because each entry keeps its apartment in memory
def _tables(apartment: Apartment) -> tuple[np.ndarray, ...]:
    furniture = apartment.furniture
    category = [CATEGORIES.index(p.category) for p in furniture]
    colours = [COLOUR_NAMES.index(p.colour) if p.colour else -1 for p in furniture]
    kind = [ROOM_KINDS.index(r.kind) for r in apartment.rooms]
    faces = apartment.faces
    arrays = (faces.instance, faces.room, category, colours, kind)
    return tuple(np.asarray(array, np.int64) for array in arrays)


@njit(cache=True)
def _label(
    ids, depth, low, high, instance, room, category, colour, kind, things, colours, concepts
):
    views, rows = ids.shape[0], ids.shape[1]
    out = np.zeros((views, concepts), np.float32)
    seen = np.zeros((views, category.shape[0]), np.bool_)
    total = (high - low) * rows
    for v in range(views):
        count, close = np.zeros(category.shape[0]), np.zeros(category.shape[0])
        rooms = np.zeros(kind.shape[0])
        for i in range(rows):
            for j in range(low, high):
                face = ids[v, i, j]
                if face < 0 or face >= room.shape[0]:
                    continue
                rooms[room[face]] += 1
                thing = instance[face]
                if thing >= 0:
                    count[thing] += 1
                    close[thing] += depth[v, i, j] < 2.0
        for thing in range(category.shape[0]):
            if count[thing] >= 0.010 * total:
                seen[v, thing] = True
                out[v, category[thing]] = 1
                if close[thing] > 0.5 * count[thing]:
                    out[v, things + category[thing]] = 1
                if colour[thing] >= 0:
                    out[v, 2 * things + colour[thing]] = 1
        for r in range(kind.shape[0]):
            if rooms[r] >= 0.05 * total:
                out[v, 2 * things + colours + kind[r]] = 1
    return out, seen
