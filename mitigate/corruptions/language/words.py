"""Words of navigation: their classes, and what must never be masked.

All lists are in ``words.json``. They are ours, written with the vocabulary of indoor instructions
in mind.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any


def bag(text: str) -> frozenset[str]:
    """Return the words of ``text``."""
    return frozenset(text.split())


def read_data(name: str) -> Any:
    """Return the content of a JSON file of this folder."""
    return json.loads((Path(__file__).parent / name).read_text(encoding="utf-8"))


WORDS = read_data("words.json")


def listed(name: str) -> frozenset[str]:
    """Return the words of a list of ``words.json``."""
    return bag(" ".join(WORDS["lists"][name]))


_CLASSES = {name: " ".join(lines) for name, lines in WORDS["classes"].items()}
# words of two classes; which of them is decided by the neighbours
_TWO = {pair: " ".join(lines) for pair, lines in WORDS["two_classes"].items()}

AMBIGUOUS: dict[str, tuple[str, str]] = {
    word: (pair.split()[0], pair.split()[1]) for pair, text in _TWO.items() for word in text.split()
}
TAGS = {word: name for name, text in reversed(_CLASSES.items()) for word in text.split()}
VERBS = bag(_CLASSES["VERB"])
AMBIGUOUS_NOUNS = frozenset(word for word, pair in AMBIGUOUS.items() if "NOUN" in pair)
POSSESSORS = listed("possessors")
# what general taggers misread in instructions (turn, exit, left ...): our tag is kept there
OVERRIDES = listed("overrides")

# never masked: words that say where, which way or which one, or that deny (and all in n't)
SPATIAL = (bag(_CLASSES["ADP"]) - bag("of for with like per about during")) | listed("spatial")


def is_kept(word: str) -> bool:
    """Return whether masks never hide ``word``, in lower case with a straight apostrophe."""
    return word in SPATIAL or word.endswith("n't")
