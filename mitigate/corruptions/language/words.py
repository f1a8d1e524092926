"""Words of navigation: their classes, and the words that masks never hide.

All lists are in ``words.json``. This project wrote them for indoor instructions.
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
# words of two classes; the neighbours decide between them
_TWO = {pair: " ".join(lines) for pair, lines in WORDS["two_classes"].items()}

AMBIGUOUS: dict[str, tuple[str, str]] = {
    word: (pair.split()[0], pair.split()[1]) for pair, text in _TWO.items() for word in text.split()
}
TAGS = {word: name for name, text in reversed(_CLASSES.items()) for word in text.split()}
VERBS = bag(_CLASSES["VERB"])
AMBIGUOUS_NOUNS = frozenset(word for word, pair in AMBIGUOUS.items() if "NOUN" in pair)
POSSESSORS = listed("possessors")
# words that general taggers mistag in instructions (turn, exit, left ...); they keep our tag
OVERRIDES = listed("overrides")

# never masked: words for places, directions, identity or negation (and all words in n't)
SPATIAL = (bag(_CLASSES["ADP"]) - bag("of for with like per about during")) | listed("spatial")


def is_kept(word: str) -> bool:
    """Return whether masks never hide ``word`` (lower case, straight apostrophe)."""
    return word in SPATIAL or word.endswith("n't")
