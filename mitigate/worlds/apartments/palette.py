"""Define the colours, textures and seed ranges of the splits, which make the splits look different.

Layouts, palettes and instruction templates of ``train``, ``val_seen`` and ``val_unseen`` never
overlap. Each split has its own range of apartment seeds, and its own random generator for colour
variants and texture parameters.
"""

from __future__ import annotations

import colorsys
from dataclasses import dataclass

import numpy as np

SPLITS = ("train", "val_seen", "val_unseen")
SEED_RANGES = {
    "train": (0, 100_000),
    "val_seen": (100_000, 110_000),
    "val_unseen": (200_000, 210_000),
}
_VARIANTS = {"train": 24, "val_seen": 8, "val_unseen": 8}

# maps a colour name to (hue centre, hue spread, saturation range, value range), all in [0, 1]
COLOURS = {
    "red": (0.99, 0.02, (0.70, 0.95), (0.55, 0.85)),
    "orange": (0.075, 0.012, (0.80, 1.00), (0.85, 1.00)),
    "yellow": (0.15, 0.012, (0.65, 0.95), (0.85, 1.00)),
    "green": (0.34, 0.04, (0.50, 0.85), (0.35, 0.65)),
    "blue": (0.61, 0.03, (0.60, 0.90), (0.50, 0.85)),
    "purple": (0.79, 0.03, (0.40, 0.70), (0.40, 0.70)),
    "brown": (0.065, 0.012, (0.50, 0.70), (0.28, 0.45)),
    "white": (0.12, 0.05, (0.00, 0.06), (0.90, 1.00)),
}
COLOUR_NAMES = tuple(COLOURS)
PATTERNS = ("plain", "noise", "stripes", "checks", "planks", "tiles", "speckle")
TEXTURE_PIXELS = 32


@dataclass(frozen=True)
class Palette:
    """The colour variants of one split. ``colours[name]`` is float32 ``[n, 3]``, with RGB values in
    [0, 1].
    """

    colours: dict[str, np.ndarray]
    walls: np.ndarray
    floors: np.ndarray


def split_of(seed: int) -> str:
    """Return the split of an apartment seed; raise ValueError if no split contains it."""
    for split, (low, high) in SEED_RANGES.items():
        if low <= seed < high:
            return split
    ranges = ", ".join(f"{name} {low}-{high - 1}" for name, (low, high) in SEED_RANGES.items())
    raise ValueError(f"Apartment seed {seed} belongs to no split; allowed seeds: {ranges}.")


def palette(split: str) -> Palette:
    """Return the fixed palette of a split, sampled with its own random generator."""
    rng = np.random.default_rng([2024, SPLITS.index(split)])
    count = _VARIANTS[split]
    colours = {name: _variants(rng, spec, count) for name, spec in COLOURS.items()}
    walls = _variants(rng, (0.12, 0.50, (0.02, 0.22), (0.72, 0.97)), 2 * count)
    floors = _variants(rng, (0.08, 0.05, (0.10, 0.45), (0.40, 0.80)), 2 * count)
    return Palette(colours, walls, floors)


def _variants(rng: np.random.Generator, spec: tuple, count: int) -> np.ndarray:
    hue, spread, saturation, value = spec
    hues = (hue + rng.uniform(-spread, spread, count)) % 1.0
    ranges = [rng.uniform(low, high, count) for low, high in (saturation, value)]
    rows = zip(hues, *ranges, strict=True)
    return np.array([colorsys.hsv_to_rgb(*row) for row in rows], np.float32)


def texture(pattern: str) -> np.ndarray:
    """Return a grey texture as uint8 [32, 32], with values mostly from 200 to 255.

    Vertex colours tint it.
    """
    rng = np.random.default_rng([7, PATTERNS.index(pattern), 0])
    n = TEXTURE_PIXELS
    y, x = np.mgrid[0:n, 0:n]
    base = np.full((n, n), 250.0)
    if pattern == "noise":
        base -= rng.uniform(0, 45, (n, n))
    elif pattern == "stripes":
        base -= 55.0 * ((x // int(rng.choice([2, 4, 8]))) % 2)
    elif pattern == "checks":
        cell = int(rng.choice([4, 8]))
        base -= 60.0 * ((x // cell + y // cell) % 2)
    elif pattern == "planks":
        planks = rng.uniform(0, 60, n // 8)[y // 8]
        base -= planks + 40.0 * (y % 8 == 0) + rng.uniform(0, 15, (n, n))
    elif pattern == "tiles":
        cell = int(rng.choice([8, 16]))
        base -= 90.0 * ((x % cell == 0) | (y % cell == 0))
    elif pattern == "speckle":
        base -= 110.0 * (rng.random((n, n)) < 0.12)
    return np.clip(base, 0, 255).astype(np.uint8)
