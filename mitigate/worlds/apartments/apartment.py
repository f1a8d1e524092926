"""Generate the rooms, the furniture, the surfaces and the free space of an apartment from a
seed.
"""

from __future__ import annotations

from functools import cached_property, lru_cache

import numpy as np

from mitigate.worlds.apartments.faces import FaceBuilder, Faces
from mitigate.worlds.apartments.layout import (
    CATALOGUE,
    DOOR,
    WALL,
    Door,
    Furniture,
    Rect,
    Room,
    furnish,
    grow,
    name_rooms,
    place_doors,
    split_rooms,
)
from mitigate.worlds.apartments.navigation import CELL, FreeSpace
from mitigate.worlds.apartments.palette import COLOUR_NAMES, split_of

_ATTEMPTS = 60


class Apartment:
    """The rooms, doors and furniture of one apartment. Its seed determines the split."""

    def __init__(self, seed: int) -> None:
        self.seed, self.split = int(seed), split_of(int(seed))
        for attempt in range(_ATTEMPTS):
            rng = np.random.default_rng([seed, attempt])
            rects = split_rooms(rng)
            self.doors: list[Door] = place_doors(rects, rng)
            self.rooms: list[Room] = name_rooms(rects, rng)
            self.furniture: list[Furniture] = furnish(self.rooms, self.doors, COLOUR_NAMES, rng)
            self.space = FreeSpace(self._blocked())
            if self._walkable():
                return
        raise RuntimeError(f"No walkable apartment for seed {seed} in {_ATTEMPTS} attempts.")

    @property
    def scene_id(self) -> str:
        return f"apartments/{self.split}/{self.seed:06d}"

    @property
    def extent(self) -> tuple[float, float]:
        """Width and depth in metres."""
        return max(r.rect[2] for r in self.rooms), max(r.rect[3] for r in self.rooms)

    def room_at(self, xy: np.ndarray) -> int:
        """Return the index of the room at a plan position, or of the nearest room."""
        for index, room in enumerate(self.rooms):
            if room.holds(xy[0], xy[1]):
                return index
        rects = np.array([room.rect for room in self.rooms])
        centres = (rects[:, :2] + rects[:, 2:]) / 2
        return int(np.argmin(((centres - xy) ** 2).sum(1)))

    @cached_property
    def faces(self) -> Faces:
        return FaceBuilder(self).build()

    def _walkable(self) -> bool:
        """Return whether an agent can reach all rooms.

        The largest connected free area must contain all doors, parts of all rooms and most
        free cells.
        """
        cells = [self.space.index[int(d.y / CELL), int(d.x / CELL)] for d in self.doors]
        reached = {self.room_at(self.space.centre(c)) for c in range(0, len(self.space.cells), 7)}
        return min(cells) >= 0 and self.space.share > 0.8 and len(reached) == len(self.rooms)

    def _blocked(self) -> np.ndarray:
        width, depth = self.extent
        blocked = np.zeros((int(np.ceil(depth / CELL)), int(np.ceil(width / CELL))), bool)
        for room in self.rooms:
            x0, y0, x1, y1 = room.rect
            for rect in ((x0, y0, x1, y0), (x0, y1, x1, y1), (x0, y0, x0, y1), (x1, y0, x1, y1)):
                _fill(blocked, grow(rect, WALL / 2), True)
        for door in self.doors:
            _fill(blocked, door.area(WALL, DOOR / 2), False)
        for piece in self.furniture:
            if CATALOGUE[piece.category].solid:
                _fill(blocked, piece.rect, True)
        return np.pad(blocked[1:-1, 1:-1], 1, constant_values=True)


@lru_cache(maxsize=512)  # number of cached apartments; each takes 0.3 MB and 8 ms to build
def apartment_of(scene_id: str) -> Apartment:
    """Return the apartment of a scene id "apartments/<split>/<seed>".

    Raises ValueError if the id is malformed, or if its seed belongs to a different split.
    """
    parts = scene_id.split("/")
    if len(parts) != 3 or parts[0] != "apartments" or not parts[2].isdigit():
        raise ValueError(
            f"Scene {scene_id!r} is not an apartment; expected 'apartments/<split>/<seed>'. "
            "Episodes of Matterport3D scans need the Habitat simulator."
        )
    apartment = Apartment(int(parts[2]))
    if apartment.split != parts[1]:
        raise ValueError(
            f"Scene {scene_id!r}: seed {parts[2]} belongs to split {apartment.split!r}."
        )
    return apartment


def _fill(grid: np.ndarray, rect: Rect, value: bool) -> None:
    """Set the cells whose centres lie in the rectangle to ``value``."""
    x0, y0, x1, y1 = (max(0, int(round(v / CELL))) for v in rect)
    grid[y0 : max(y1, y0 + 1), x0 : max(x1, x0 + 1)] = value
