"""Generate floor plans: split an outline into rooms, add doorways, and place furniture.

A piece of furniture consists of a few axis-aligned boxes, and the shape shows its category.
``furniture.json`` holds sizes in metres. A part is ``(x0, x1, y0, y1, z0, z1, paint)`` in the frame
of the object. The x axis runs along the wall, the y axis away from the wall, and the z axis up. The
back of the object is at y = 0. ``paint`` is "main" (the object's colour), a name of ``paints``, or
an RGB triple in [0, 1].
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

_DATA = json.loads(Path(__file__).with_name("furniture.json").read_text(encoding="utf-8"))
Part = tuple[float, float, float, float, float, float, object]


@dataclass(frozen=True)
class Category:
    """A category of furniture.

    ``width`` (along the wall) and ``depth`` (away from the wall) are in metres. If ``solid`` is
    true, the object blocks motion.
    """

    name: str
    width: float
    depth: float
    parts: tuple[Part, ...]
    coloured: bool = True
    solid: bool = True


def _part(part: list[Any]) -> Part:
    *box, paint = part
    paint = _DATA["paints"].get(paint, paint) if isinstance(paint, str) else paint
    return (*box, tuple(paint) if isinstance(paint, list) else paint)


CATALOGUE = {
    name: Category(name, **{**entry, "parts": tuple(map(_part, entry["parts"]))})
    for name, entry in _DATA["categories"].items()
}
CATEGORIES = tuple(CATALOGUE)

# maps a kind of room to its (required, optional) furniture; only chairs may occur more than once
ROOMS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    kind: (tuple(entry["always"]), tuple(entry["choice"])) for kind, entry in _DATA["rooms"].items()
}
ROOM_KINDS = tuple(ROOMS)


WALL = 0.12  # wall thickness in metres
DOOR = 1.0  # clear width of the doorways in metres
HEIGHT = 2.5  # height of the ceiling in metres
LINTEL = 2.05  # height of the doorways in metres
_MIN_SIDE = 2.7
Rect = tuple[float, float, float, float]  # x0, y0, x1, y1


@dataclass(frozen=True)
class Room:
    """A rectangular room of one kind, such as a kitchen."""

    rect: Rect
    kind: str

    def holds(self, x: float, y: float) -> bool:
        x0, y0, x1, y1 = self.rect
        return x0 <= x < x1 and y0 <= y < y1


@dataclass(frozen=True)
class Door:
    """A doorway between two rooms, with its centre at (x, y).

    ``axis`` is the axis of the wall's normal: 0 for x, 1 for y.
    """

    x: float
    y: float
    axis: int
    rooms: tuple[int, int]

    def area(self, across: float, along: float) -> Rect:
        """Return a rectangle around the centre of the doorway.

        It extends ``across`` metres to each side of the wall, and ``along`` metres in both
        directions along the wall.
        """
        dx, dy = (across, along) if self.axis == 0 else (along, across)
        return self.x - dx, self.y - dy, self.x + dx, self.y + dy


@dataclass(frozen=True)
class Furniture:
    """A piece of furniture in a room.

    ``turn`` is the side of the room at which it stands (0: low y, 1: high x, 2: high y, 3: low x).
    """

    category: str
    colour: str | None
    rect: Rect
    turn: int
    room: int

    @property
    def centre(self) -> tuple[float, float]:
        x0, y0, x1, y1 = self.rect
        return (x0 + x1) / 2, (y0 + y1) / 2


def split_rooms(rng: np.random.Generator) -> list[Rect]:
    """Split a random outline (9 to 12 m by 8 to 10 m) recursively into 4 to 8 rectangles."""
    outline = (0.0, 0.0, float(rng.uniform(9.0, 12.0)), float(rng.uniform(8.0, 10.0)))
    rects, target = [outline], int(rng.integers(4, 9))
    while len(rects) < target:
        areas = [(r[2] - r[0]) * (r[3] - r[1]) for r in rects]
        order = np.argsort(areas)[::-1]
        index = next((int(i) for i in order if max(_sides(rects[i])) >= 2 * _MIN_SIDE), None)
        if index is None:
            break
        rects[index : index + 1] = _cut(rects[index], rng)
    return rects


def _sides(rect: Rect) -> tuple[float, float]:
    return rect[2] - rect[0], rect[3] - rect[1]


def _cut(rect: Rect, rng: np.random.Generator) -> list[Rect]:
    x0, y0, x1, y1 = rect
    width, depth = _sides(rect)
    least = max(_MIN_SIDE, 0.38 * max(width, depth))
    if width >= depth:
        x = float(rng.uniform(x0 + least, x1 - least))
        return [(x0, y0, x, y1), (x, y0, x1, y1)]
    y = float(rng.uniform(y0 + least, y1 - least))
    return [(x0, y0, x1, y), (x0, y, x1, y1)]


def shared_wall(a: Rect, b: Rect) -> tuple[int, float, float, float] | None:
    """Return the wall between two rooms, or None if they share no wall.

    The wall is (axis of its normal, coordinate on that axis, lower bound, upper bound).
    """
    for axis in (0, 1):
        other = 1 - axis
        for near, far in ((a, b), (b, a)):
            if abs(near[2 + axis] - far[axis]) < 1e-9:
                low, high = max(a[other], b[other]), min(a[2 + other], b[2 + other])
                if high - low > DOOR + 0.5:
                    return axis, near[2 + axis], low, high
    return None


def place_doors(rects: list[Rect], rng: np.random.Generator) -> list[Door]:
    """Connect the rooms by a random tree, and add more doors with probability 0.3 per wall."""
    pairs = [(i, j) for i in range(len(rects)) for j in range(i) if shared_wall(rects[i], rects[j])]
    rng.shuffle(pairs)
    group = list(range(len(rects)))
    doors = []
    for i, j in pairs:
        joined = group[i] == group[j]
        if joined and rng.random() > 0.3:
            continue
        group = [group[j] if g == group[i] else g for g in group]
        axis, at, low, high = shared_wall(rects[i], rects[j])  # type: ignore[misc]
        along = float(rng.uniform(low + 0.25 + DOOR / 2, high - 0.25 - DOOR / 2))
        x, y = (at, along) if axis == 0 else (along, at)
        doors.append(Door(x, y, axis, (int(i), int(j))))
    return doors


def name_rooms(rects: list[Rect], rng: np.random.Generator) -> list[Room]:
    """Assign each kind of room once, in random order.

    Further rooms become a second bedroom, bathroom or office.
    """
    kinds = list(ROOMS)
    rng.shuffle(kinds)
    kinds += [str(kind) for kind in rng.permutation(["bedroom", "bathroom", "office"])]
    return [Room(rect, kind) for rect, kind in zip(rects, kinds, strict=False)]


def furnish(
    rooms: list[Room], doors: list[Door], colours: tuple[str, ...], rng: np.random.Generator
) -> list[Furniture]:
    """Place the furniture of every room: its required pieces first, then 2 to 4 optional ones."""
    placed: list[Furniture] = []
    for index, room in enumerate(rooms):
        always, choice = ROOMS[room.kind]
        extra = [str(c) for c in rng.permutation(choice)[: int(rng.integers(2, 5))]]
        occupied = [door.area(0.9, 0.65) for door in doors if index in door.rooms]
        for name in [*always, *extra]:
            piece = _place(CATALOGUE[name], room, index, occupied, colours, rng)
            if piece is None:
                continue
            placed.append(piece)
            if CATALOGUE[name].solid:
                occupied.append(grow(piece.rect, 0.05))
    return placed


def _place(
    category: Category,
    room: Room,
    index: int,
    occupied: list[Rect],
    colours: tuple[str, ...],
    rng: np.random.Generator,
) -> Furniture | None:
    colour = str(rng.choice(colours)) if category.coloured else None
    x0, y0, x1, y1 = grow(room.rect, -WALL / 2)
    for _ in range(24):
        turn = int(rng.integers(4))
        w, d = category.width, category.depth
        if turn % 2:
            w, d = d, w
        if w > x1 - x0 - 0.1 or d > y1 - y0 - 0.1:
            continue
        if category.name in ("rug", "table"):
            x = (x0 + x1 - w) / 2 + rng.uniform(-0.3, 0.3)
            y = (y0 + y1 - d) / 2 + rng.uniform(-0.3, 0.3)
        else:
            along_x, along_y = rng.uniform(x0, x1 - w), rng.uniform(y0, y1 - d)
            x, y = [(along_x, y0), (x1 - w, along_y), (along_x, y1 - d), (x0, along_y)][turn]
        rect = (float(x), float(y), float(x + w), float(y + d))
        if category.name == "rug" or not any(_overlap(rect, other) for other in occupied):
            return Furniture(category.name, colour, rect, turn, index)
    return None


def grow(rect: Rect, by: float) -> Rect:
    """Return a rectangle that is larger by ``by`` metres on each side."""
    return rect[0] - by, rect[1] - by, rect[2] + by, rect[3] + by


def gap_to(rect: Rect, xy: np.ndarray) -> np.ndarray:
    """Return the distances in metres from points [n, 2] to a rectangle (0 inside it)."""
    x0, y0, x1, y1 = rect
    return np.hypot(
        np.maximum(np.maximum(x0 - xy[:, 0], xy[:, 0] - x1), 0),
        np.maximum(np.maximum(y0 - xy[:, 1], xy[:, 1] - y1), 0),
    )


def _overlap(a: Rect, b: Rect) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]
