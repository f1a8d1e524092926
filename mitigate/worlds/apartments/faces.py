"""Build the surfaces of an apartment from rectangles with colours, textures and baked shading."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mitigate.worlds.apartments.layout import (
    CATALOGUE,
    CATEGORIES,
    DOOR,
    HEIGHT,
    LINTEL,
    WALL,
    Door,
    Furniture,
)
from mitigate.worlds.apartments.palette import PATTERNS, Palette, palette

if TYPE_CHECKING:
    from mitigate.worlds.apartments.apartment import Apartment

STRUCTURE = -1  # category number that walls, floors and ceilings have


@dataclass(frozen=True)
class Faces:
    """The faces of an apartment: n axis-aligned rectangles. All arrays have the first dimension n.

    ``corners`` is float32 [n, 4, 3] in metres. ``plane`` is float32 [n, 2]: the axis of the normal
    (0 to 2) and the coordinate of the plane on that axis in metres. ``colour`` is float32 [n, 4,
    3], one RGB colour per corner. ``pattern`` is int [n], and ``repeat`` (float32 [n, 2]) is the
    number of texture repeats. ``category``, ``room`` and ``instance`` are int16 [n]: the semantic
    label (``STRUCTURE`` for walls, floors and ceilings), the index of the room and the index of the
    piece of furniture.
    """

    corners: np.ndarray
    plane: np.ndarray
    colour: np.ndarray
    pattern: np.ndarray
    repeat: np.ndarray
    category: np.ndarray
    room: np.ndarray
    instance: np.ndarray


class FaceBuilder:
    """Collect the faces of an apartment, with baked shading."""

    # axis: (brightness of faces towards its negative side, towards its positive side)
    _SHADE = {0: (0.84, 0.92), 1: (0.97, 0.79), 2: (0.82, 1.0)}

    def __init__(self, apartment: Apartment) -> None:
        self.apartment = apartment
        self.paint: Palette = palette(apartment.split)
        self.rng = np.random.default_rng([apartment.seed, 77])
        self.light = self.rng.uniform(0.88, 1.08, len(apartment.rooms))
        self.kinds: list[tuple[int, ...]] = []
        self.places: list[tuple[float, ...]] = []
        self.colours: list[np.ndarray] = []

    def build(self) -> Faces:
        for index in range(len(self.apartment.rooms)):
            self._room(index)
        for door in self.apartment.doors:
            self._frame(door)
        for instance, piece in enumerate(self.apartment.furniture):
            self._piece(instance, piece)
        axis, sign, pattern, room, category, instance = np.array(self.kinds).T
        at, *span = np.array(self.places, float).T
        low, high = np.stack(span[:2], 1), np.stack(span[2:], 1)
        corners = _corners(axis, sign, at, low, high)
        return Faces(
            corners,
            np.stack([axis, at], 1).astype(np.float32),
            self._tints(axis, sign, room, corners),
            pattern.astype(np.int16),
            (high - low).astype(np.float32),
            category.astype(np.int16),
            room.astype(np.int16),
            instance.astype(np.int16),
        )

    def _tints(
        self, axis: np.ndarray, sign: np.ndarray, room: np.ndarray, corners: np.ndarray
    ) -> np.ndarray:
        """Return the colours, shaded by the direction of the face and by the room.

        Vertical faces get darker towards the floor.
        """
        sides = np.array([self._SHADE[k] for k in range(3)])
        shade = sides[axis, (sign > 0).astype(int)] * self.light[room]
        dim = (0.82 + 0.18 * np.clip(corners[..., 2:] / 1.2, 0, 1)).astype(float)
        dim[axis == 2] = 1.0
        lit = np.array(self.colours)[:, None] * shade[:, None, None] * dim
        return np.clip(lit, 0, 1).astype(np.float32)

    def _add(
        self,
        axis: int,
        sign: int,
        at: float,
        low: tuple[float, float],
        high: tuple[float, float],
        colour: np.ndarray,
        pattern: int,
        room: int,
        category: int = STRUCTURE,
        instance: int = -1,
    ) -> None:
        """Add a rectangle that is perpendicular to ``axis`` and lies at the coordinate ``at``.

        The sign of its normal is ``sign``. Its bounds on the other two axes are ``low`` and
        ``high``.
        """
        self.kinds.append((axis, sign, pattern, room, category, instance))
        self.places.append((at, *low, *high))
        self.colours.append(colour)

    def _room(self, index: int) -> None:
        room, rng, paint = self.apartment.rooms[index], self.rng, self.paint
        x0, y0, x1, y1 = room.rect
        walls = paint.walls[rng.integers(len(paint.walls))]
        floors = paint.floors[rng.integers(len(paint.floors))]
        wet = room.kind in ("bathroom", "kitchen")
        wall_choice = ["tiles", "plain"] if wet else ["plain", "noise", "stripes"]
        wall_pattern = PATTERNS.index(str(rng.choice(wall_choice)))
        floor_choice = ["tiles", "checks"] if wet else ["planks", "noise", "speckle"]
        floor_pattern = PATTERNS.index(str(rng.choice(floor_choice)))
        self._add(2, 1, 0.0, (x0, y0), (x1, y1), floors, floor_pattern, index)
        self._add(2, -1, HEIGHT, (x0, y0), (x1, y1), np.ones(3), PATTERNS.index("plain"), index)
        for axis, sign, at in ((0, 1, x0), (0, -1, x1), (1, 1, y0), (1, -1, y1)):
            at += sign * WALL / 2
            low, high = (y0, y1) if axis == 0 else (x0, x1)
            gaps = sorted(self._gaps(index, axis, at))
            edges = [low, *(e for gap in gaps for e in gap), high]
            for a, b in zip(edges[::2], edges[1::2], strict=True):
                self._add(axis, sign, at, (a, 0.0), (b, HEIGHT), walls, wall_pattern, index)
            for a, b in gaps:
                self._add(axis, sign, at, (a, LINTEL), (b, HEIGHT), walls, wall_pattern, index)

    def _gaps(self, room: int, axis: int, at: float) -> list[tuple[float, float]]:
        places = [(d.x, d.y) for d in self.apartment.doors if room in d.rooms and d.axis == axis]
        middles = [place[1 - axis] for place in places if abs(place[axis] - at) < WALL]
        return [(middle - DOOR / 2, middle + DOOR / 2) for middle in middles]

    def _frame(self, door: Door) -> None:
        """Add the two sides and the top of a door frame."""
        style = (np.array((0.50, 0.36, 0.24)), PATTERNS.index("plain"), door.rooms[0])
        axis, along = door.axis, 1 - door.axis
        centre, middle = (door.x, door.y)[axis], (door.x, door.y)[along]
        low = {axis: centre - WALL / 2, along: middle - DOOR / 2}
        high = {axis: centre + WALL / 2, along: middle + DOOR / 2}
        for sign, at in ((1, low[along]), (-1, high[along])):
            self._add(along, sign, at, (low[axis], 0.0), (high[axis], LINTEL), *style)
        self._add(2, -1, LINTEL, (low[0], low[1]), (high[0], high[1]), *style)

    def _piece(self, instance: int, piece: Furniture) -> None:
        category = CATALOGUE[piece.category]
        label = CATEGORIES.index(piece.category)
        variants = self.paint.colours[piece.colour] if piece.colour else None
        main = np.ones(3) if variants is None else variants[self.rng.integers(len(variants))]
        pattern = PATTERNS.index("noise" if self.rng.random() < 0.5 else "plain")
        for part in category.parts:
            low, high = _turned(part, piece)
            colour = main if part[6] == "main" else np.array(part[6])
            for axis in range(3):
                others = [k for k in range(3) if k != axis]
                span = (low[others[0]], low[others[1]]), (high[others[0]], high[others[1]])
                for sign, at in ((-1, low[axis]), (1, high[axis])):
                    if axis == 2 and sign < 0 and low[2] < 0.3:
                        continue
                    self._add(axis, sign, at, *span, colour, pattern, piece.room, label, instance)


def texture_coordinates(faces: Faces, chosen: np.ndarray) -> np.ndarray:
    """Return the texture coordinates of the corners of n chosen faces, as float32 [4 * n, 2]."""
    corners = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], np.float32)
    return (corners[None] * faces.repeat[chosen][:, None]).reshape(-1, 2)


def _corners(
    axis: np.ndarray, sign: np.ndarray, at: np.ndarray, low: np.ndarray, high: np.ndarray
) -> np.ndarray:
    """Return the corners of n rectangles, float32 [n, 4, 3].

    The arguments are those of ``FaceBuilder._add``, as arrays with the first dimension n. The order
    of the corners depends on ``sign``.
    """
    n = len(axis)
    others = np.array([[1, 2], [0, 2], [0, 1]])[axis]
    corners, every = np.zeros((n, 4, 3), np.float32), np.arange(n)
    corners[every, :, axis] = at[:, None]
    corners[every, :, others[:, 0]] = np.stack([low[:, 0], high[:, 0], high[:, 0], low[:, 0]], 1)
    corners[every, :, others[:, 1]] = np.stack([low[:, 1], low[:, 1], high[:, 1], high[:, 1]], 1)
    flipped = (sign > 0) == (axis == 1)
    corners[flipped] = corners[flipped, ::-1]
    return corners


def _turned(part: tuple, piece: Furniture) -> tuple[tuple, tuple]:
    """Return the two corners of a part's box in plan coordinates (see :class:`Furniture`)."""
    px0, px1, py0, py1, z0, z1, _ = part
    x0, y0, x1, y1 = piece.rect
    low_x, low_y, high_x, high_y = (
        (x0 + px0, y0 + py0, x0 + px1, y0 + py1),
        (x1 - py1, y0 + px0, x1 - py0, y0 + px1),
        (x1 - px1, y1 - py1, x1 - px0, y1 - py0),
        (x0 + py0, y1 - px1, x0 + py1, y1 - px0),
    )[piece.turn]
    return (low_x, low_y, z0), (high_x, high_y, z1)
