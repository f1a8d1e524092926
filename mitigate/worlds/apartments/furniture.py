"""The furniture catalogue: each category is a few axis-aligned boxes, recognisable by its shape.

Sizes are metres. A part is ``(x0, x1, y0, y1, z0, z1, paint)`` in the object's own frame: x along
the wall, y away from it (the back of the object is y = 0), z up. ``paint`` is ``"main"`` (the
object's colour) or a fixed RGB triple in [0, 1].
"""

from __future__ import annotations

from dataclasses import dataclass

WOOD, DARK, STEEL, PORCELAIN = (
    (0.55, 0.38, 0.22),
    (0.07, 0.07, 0.08),
    (0.62, 0.66, 0.70),
    (0.95, 0.95, 0.97),
)
LEAF, LINEN, GLASS, SOIL = (
    (0.16, 0.50, 0.15),
    (0.93, 0.92, 0.88),
    (0.20, 0.25, 0.35),
    (0.60, 0.30, 0.18),
)

Part = tuple[float, float, float, float, float, float, object]


@dataclass(frozen=True)
class Category:
    """``width`` along the wall and ``depth`` away from it in metres; ``solid`` blocks motion."""

    name: str
    width: float
    depth: float
    parts: tuple[Part, ...]
    coloured: bool = True
    solid: bool = True


def _legs(w: float, d: float, h: float, paint: object, t: float = 0.07) -> list[Part]:
    corners = [(0, 0), (w - t, 0), (0, d - t), (w - t, d - t)]
    return [(x, x + t, y, y + t, 0, h, paint) for x, y in corners]


def _slats(w: float, d: float, levels: int, height: float) -> list[Part]:
    """Rows of coloured book spines between shelves."""
    paints = [(0.75, 0.2, 0.15), (0.15, 0.3, 0.6), (0.85, 0.75, 0.3), (0.2, 0.45, 0.25)]
    rows: list[Part] = []
    for level in range(levels):
        z = 0.12 + level * (height - 0.1) / levels
        for i in range(4):
            x = 0.06 + i * (w - 0.12) / 4
            rows.append(
                (x, x + (w - 0.16) / 4, 0.05, d + 0.01, z, z + 0.24, paints[(i + level) % 4])
            )
    return rows


_ALL = (
    Category("bed", 1.6, 2.0, (
        (0, 1.6, 0, 2.0, 0.1, 0.5, "main"), (0, 1.6, 0, 0.12, 0, 1.05, WOOD),
        (0.1, 0.75, 0.15, 0.6, 0.5, 0.66, LINEN), (0.85, 1.5, 0.15, 0.6, 0.5, 0.66, LINEN))),
    Category("wardrobe", 1.4, 0.6, (
        (0, 1.4, 0, 0.6, 0, 2.05, "main"), (0.69, 0.71, 0.6, 0.61, 0.1, 2.0, DARK),
        (0.60, 0.64, 0.6, 0.64, 0.9, 1.15, STEEL), (0.76, 0.80, 0.6, 0.64, 0.9, 1.15, STEEL))),
    Category("sofa", 2.0, 0.9, (
        (0, 2.0, 0, 0.9, 0.08, 0.45, "main"), (0, 2.0, 0, 0.25, 0.45, 0.95, "main"),
        (0, 0.22, 0.25, 0.9, 0.45, 0.68, "main"), (1.78, 2.0, 0.25, 0.9, 0.45, 0.68, "main"))),
    Category("armchair", 0.85, 0.85, (
        (0, 0.85, 0, 0.85, 0.08, 0.45, "main"), (0, 0.85, 0, 0.22, 0.45, 1.1, "main"),
        (0, 0.18, 0.22, 0.85, 0.45, 0.68, "main"), (0.67, 0.85, 0.22, 0.85, 0.45, 0.68, "main"))),
    Category("tv", 1.5, 0.45, (
        (0, 1.5, 0, 0.45, 0, 0.5, WOOD), (0.05, 1.45, 0.12, 0.2, 0.6, 1.45, DARK),
        (0.12, 1.38, 0.2, 0.21, 0.67, 1.38, (0.12, 0.18, 0.30)),
        (0.65, 0.85, 0.1, 0.25, 0.5, 0.6, DARK)), False),
    Category("bookshelf", 1.2, 0.35, (
        (0, 1.2, 0, 0.05, 0, 2.0, WOOD), (0, 0.05, 0, 0.35, 0, 2.0, WOOD),
        (1.15, 1.2, 0, 0.35, 0, 2.0, WOOD), (0, 1.2, 0, 0.35, 1.95, 2.0, WOOD),
        *_slats(1.2, 0.3, 4, 1.9)), False),
    Category("lamp", 0.5, 0.5, (
        (0.1, 0.4, 0.1, 0.4, 0, 0.05, DARK), (0.22, 0.28, 0.22, 0.28, 0.05, 1.2, DARK),
        (0.02, 0.48, 0.02, 0.48, 1.2, 1.65, "main"))),
    Category("plant", 0.7, 0.7, (
        (0.2, 0.5, 0.2, 0.5, 0, 0.4, SOIL), (0.05, 0.65, 0.05, 0.65, 0.5, 0.9, LEAF),
        (0.15, 0.55, 0.15, 0.55, 0.9, 1.3, (0.22, 0.58, 0.18)),
        (0.25, 0.45, 0.25, 0.45, 0.4, 1.55, LEAF)), False),
    Category("painting", 1.2, 0.06, (
        (0, 1.2, 0, 0.04, 1.0, 1.9, WOOD), (0.08, 1.12, 0.04, 0.05, 1.08, 1.82, "main"),
        (0.35, 0.7, 0.05, 0.06, 1.25, 1.6, LINEN)), True, False),
    Category("rug", 2.0, 1.4, (
        (0, 2.0, 0, 1.4, 0.0, 0.02, "main"), (0.2, 1.8, 0.2, 1.2, 0.02, 0.04, LINEN),
        (0.35, 1.65, 0.35, 1.05, 0.04, 0.06, "main")), True, False),
    Category("fridge", 0.8, 0.7, (
        (0, 0.8, 0, 0.7, 0, 1.9, STEEL), (0, 0.8, 0.7, 0.71, 1.20, 1.23, DARK),
        (0.66, 0.71, 0.7, 0.75, 0.7, 1.15, DARK), (0.66, 0.71, 0.7, 0.75, 1.28, 1.7, DARK)), False),
    Category("stove", 0.8, 0.65, (
        (0, 0.8, 0, 0.65, 0, 0.9, PORCELAIN), (0.1, 0.7, 0.65, 0.66, 0.2, 0.65, DARK),
        (0.05, 0.75, 0.08, 0.6, 0.9, 0.93, DARK), (0.1, 0.7, 0.0, 0.35, 1.55, 1.8, STEEL),
        (0.3, 0.5, 0, 0.2, 1.8, 2.4, STEEL)), False),
    Category("sink", 0.9, 0.5, (
        (0, 0.9, 0, 0.5, 0, 0.8, WOOD), (0, 0.9, 0, 0.55, 0.8, 0.92, PORCELAIN),
        (0.1, 0.8, 0.0, 0.03, 1.15, 1.95, (0.70, 0.85, 0.92)),
        (0.42, 0.48, 0.05, 0.2, 0.92, 1.1, STEEL)), False),
    Category("toilet", 0.55, 0.75, (
        (0, 0.55, 0, 0.22, 0.35, 0.95, PORCELAIN), (0.1, 0.45, 0.15, 0.6, 0, 0.38, PORCELAIN),
        (0.04, 0.51, 0.2, 0.75, 0.38, 0.48, PORCELAIN),
        (0.14, 0.41, 0.32, 0.66, 0.48, 0.485, GLASS)), False),
    Category("bathtub", 1.7, 0.8, (
        (0, 1.7, 0, 0.1, 0, 0.6, PORCELAIN), (0, 1.7, 0.7, 0.8, 0, 0.6, PORCELAIN),
        (0, 0.1, 0, 0.8, 0, 0.6, PORCELAIN), (1.6, 1.7, 0, 0.8, 0, 0.6, PORCELAIN),
        (0.1, 1.6, 0.1, 0.7, 0, 0.42, (0.45, 0.75, 0.90))), False),
    Category("washing machine", 0.7, 0.65, (
        (0, 0.7, 0, 0.65, 0, 0.95, PORCELAIN), (0.15, 0.55, 0.65, 0.67, 0.2, 0.65, GLASS),
        (0.05, 0.65, 0.65, 0.66, 0.78, 0.9, STEEL)), False),
    Category("desk", 1.4, 0.7, (
        (0, 1.4, 0, 0.7, 0.7, 0.76, WOOD), (0, 0.4, 0, 0.65, 0, 0.7, WOOD),
        (1.33, 1.4, 0, 0.65, 0, 0.7, WOOD), (0.55, 1.15, 0.15, 0.2, 0.85, 1.25, DARK),
        (0.58, 1.12, 0.2, 0.21, 0.88, 1.22, (0.55, 0.75, 0.95)),
        (0.75, 0.95, 0.1, 0.3, 0.76, 0.85, DARK)), False),
    Category("table", 1.6, 0.9, (
        (0, 1.6, 0, 0.9, 0.72, 0.78, "main"), *_legs(1.6, 0.9, 0.72, "main"))),
    Category("chair", 0.5, 0.5, (
        (0, 0.5, 0, 0.5, 0.42, 0.5, "main"), (0, 0.5, 0, 0.07, 0.5, 1.0, "main"),
        *_legs(0.5, 0.5, 0.42, DARK, 0.05))),
    Category("cabinet", 1.2, 0.5, (
        (0, 1.2, 0, 0.5, 0, 0.95, "main"), (0.05, 0.58, 0.5, 0.51, 0.1, 0.45, DARK),
        (0.62, 1.15, 0.5, 0.51, 0.1, 0.45, DARK), (0.05, 0.58, 0.5, 0.51, 0.52, 0.85, DARK),
        (0.62, 1.15, 0.5, 0.51, 0.52, 0.85, DARK))),
)  # fmt: skip
CATALOGUE = {category.name: category for category in _ALL}
CATEGORIES = tuple(CATALOGUE)

# room kind -> (always present, chosen from); at most one of a category in a room except chairs
ROOMS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "bedroom": (
        ("bed", "wardrobe"),
        ("lamp", "plant", "painting", "rug", "desk", "armchair", "tv"),
    ),
    "bathroom": (("toilet", "bathtub"), ("sink", "washing machine", "plant", "cabinet")),
    "kitchen": (("fridge", "stove"), ("sink", "cabinet", "table", "chair", "painting")),
    "living room": (("sofa", "tv"), ("armchair", "bookshelf", "plant", "lamp", "rug", "painting")),
    "office": (("desk", "bookshelf"), ("chair", "plant", "lamp", "painting", "cabinet", "rug")),
    "dining room": (("table", "chair"), ("plant", "painting", "cabinet", "lamp", "rug")),
}
ROOM_KINDS = tuple(ROOMS)
