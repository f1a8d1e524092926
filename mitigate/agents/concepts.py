"""What a view can show, in words: the shared vocabulary of RGB features and instructions.

The RGB encoder predicts, for the central 36 degrees of each view, which concepts are there; the
planner turns the probabilities into text embeddings of the concepts' words, so that views and
instructions live in one space from the start.
"""

from __future__ import annotations

THING_NAMES = (
    *("bed", "wardrobe", "sofa", "armchair", "tv", "bookshelf", "lamp", "plant", "painting"),
    *("rug", "fridge", "stove", "sink", "toilet", "bathtub", "washing machine", "desk", "table"),
    *("chair", "cabinet"),
)
COLOUR_NAMES = ("red", "orange", "yellow", "green", "blue", "purple", "brown", "white")
ROOM_NAMES = ("bedroom", "bathroom", "kitchen", "living room", "office", "dining room")
# visible things, things nearer than 2 m, colours of coloured things, kinds of the rooms seen
CONCEPTS = (
    *THING_NAMES,
    *(f"near {name}" for name in THING_NAMES),
    *COLOUR_NAMES,
    *ROOM_NAMES,
)
THINGS = slice(0, len(THING_NAMES))
NEAR = slice(len(THING_NAMES), 2 * len(THING_NAMES))
