"""Draw the floor plan of an apartment."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from mitigate.worlds.apartments.apartment import Apartment
from mitigate.worlds.apartments.layout import CATALOGUE, DOOR, Rect
from mitigate.worlds.apartments.palette import palette

_ROOMS = {
    "bedroom": "#e8ecf8",
    "bathroom": "#e0f4f4",
    "kitchen": "#fbeedd",
    "living room": "#eef6e4",
    "office": "#f3e9f6",
    "dining room": "#faf6da",
}

STEPS = 17  # number of candidate positions of a room's name between two opposite walls
NAME_WIDTH = 1.6  # approximate width of a room's name in metres


def draw_plan(axes: Any, apartment: Apartment) -> None:
    """Draw rooms, doorways and furniture from above on matplotlib axes, in metres."""
    centred = {"ha": "center", "va": "center"}
    for room in apartment.rooms:
        _draw_box(axes, room.rect, fc=_ROOMS[room.kind], ec="#333333", lw=2.5)
        place = _free_place(room.rect, apartment.furniture)
        axes.text(*place, room.kind, fontsize=10, color="#333333", zorder=4, **centred)
    for door in apartment.doors:
        _draw_box(axes, door.area(0.07, DOOR / 2), fc="white", ec="none", zorder=2)
    paint = palette(apartment.split)
    label_box = {"fc": "white", "ec": "none", "alpha": 0.6, "pad": 0.4}
    for piece in apartment.furniture:
        colour = paint.colours[piece.colour].mean(0) if piece.colour else (0.62, 0.62, 0.64)
        alpha = 0.9 if CATALOGUE[piece.category].solid else 0.45
        x0, y0, x1, y1 = piece.rect
        rect = (x0, y0, x1, max(y1, y0 + 0.05))
        _draw_box(axes, rect, fc=colour, ec="#222222", lw=0.7, alpha=alpha, zorder=3)
        axes.text(*piece.centre, piece.category, fontsize=6, zorder=5, bbox=label_box, **centred)
    width, depth = apartment.extent
    axes.set_xlim(-0.2, width + 0.2)
    axes.set_ylim(-0.2, depth + 0.2)
    axes.set_aspect("equal")
    axes.axis("off")


def _free_place(rect: Rect, furniture: Sequence[Any]) -> tuple[float, float]:
    """Return the position (in metres) at which a room's name is farthest from the furniture."""
    x0, y0, x1, y1 = rect
    places = [
        (x, y)
        for y in np.linspace(y0, y1, STEPS)[2:-2]
        for x in (x0 + (x1 - x0) * np.array([0.5, 0.4, 0.6]))
    ]
    return max(places, key=lambda place: min((_gap(place, p.rect) for p in furniture), default=0))


def _gap(place: tuple[float, float], rect: Rect) -> float:
    """Return the distance in metres between a room's name at ``place`` and a piece of furniture."""
    x0, y0, x1, y1 = rect
    across = max(x0 - place[0], place[0] - x1, 0.0)
    along = max(y0 - place[1], place[1] - y1, 0.0)
    return max(across - NAME_WIDTH / 2, 0.0) + along


def _draw_box(axes: Any, rect: Rect, **style: Any) -> None:
    from matplotlib.patches import Rectangle

    x0, y0, x1, y1 = rect
    axes.add_patch(Rectangle((x0, y0), x1 - x0, y1 - y0, **style))
