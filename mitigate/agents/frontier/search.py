"""What to search for, and in which rooms it is likely: the agent's common sense.

L3MVN asks a language model which room an object is in; here it is a table.
"""

from __future__ import annotations

import re

import numpy as np

from mitigate.agents.concepts import CONCEPTS, NEAR, ROOM_NAMES, THING_NAMES

LIKELY = {
    "bedroom": ("bed", "wardrobe", "lamp", "rug"),
    "bathroom": ("toilet", "bathtub", "sink", "washing machine"),
    "kitchen": ("fridge", "stove", "sink", "cabinet", "table"),
    "living room": ("sofa", "armchair", "tv", "bookshelf", "plant", "painting", "rug", "lamp"),
    "office": ("desk", "chair", "bookshelf", "lamp"),
    "dining room": ("table", "chair", "cabinet", "painting"),
}
ROOM_SHARE = 0.3  # what a likely room counts against the object itself (ours)
_ROOMS = slice(len(CONCEPTS) - len(ROOM_NAMES), len(CONCEPTS))


def named(text: str) -> int | None:
    """The index of the thing that is named last in ``text``, of ``THING_NAMES``; None if none is.
    A route ends at what is named last; a plain "find a chair" names one thing alone."""
    ends = [
        (match.end(), len(name), i)
        for i, name in enumerate(THING_NAMES)
        for match in _finds(name, text)
    ]
    return max(ends)[2] if ends else None


def _finds(name: str, text: str) -> list[re.Match]:
    return list(re.finditer(rf"\b{re.escape(name)}s?\b", text.lower()))


def seen(concepts: np.ndarray, thing: int) -> np.ndarray:
    """Of the probabilities [n, C] of what columns show, those of ``thing`` and of it near."""
    return concepts[:, [thing, NEAR.start + thing]]


def worth(concepts: np.ndarray, thing: int | None) -> np.ndarray:
    """How likely the thing is where columns look: [n], from it and from the rooms that show."""
    if thing is None:
        return np.zeros(len(concepts), np.float32)
    name = THING_NAMES[thing]
    rooms = np.array([float(name in LIKELY[room]) for room in ROOM_NAMES], np.float32)
    return np.maximum(concepts[:, thing], ROOM_SHARE * (concepts[:, _ROOMS] * rooms).max(1))
