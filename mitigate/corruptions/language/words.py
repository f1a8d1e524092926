"""Define the classes of navigation words, the words that are never masked, and landmarks.

All word lists are in ``words.json``. They were written for this project and for indoor
instructions.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any


def bag(text: str) -> frozenset[str]:
    """Return the set of words in ``text``."""
    return frozenset(text.split())


def read_data(name: str) -> Any:
    """Return the content of a JSON file of this folder."""
    return json.loads((Path(__file__).parent / name).read_text(encoding="utf-8"))


WORDS = read_data("words.json")


def listed(name: str) -> frozenset[str]:
    """Return the words in the list ``name`` of ``words.json``."""
    return bag(" ".join(WORDS["lists"][name]))


_CLASSES = {name: " ".join(lines) for name, lines in WORDS["classes"].items()}
# words that may belong to two classes; the neighbouring words decide which one
_TWO = {pair: " ".join(lines) for pair, lines in WORDS["two_classes"].items()}

AMBIGUOUS: dict[str, tuple[str, str]] = {
    word: (pair.split()[0], pair.split()[1]) for pair, text in _TWO.items() for word in text.split()
}
TAGS = {word: name for name, text in reversed(_CLASSES.items()) for word in text.split()}
VERBS = bag(_CLASSES["VERB"])
AMBIGUOUS_NOUNS = frozenset(word for word, pair in AMBIGUOUS.items() if "NOUN" in pair)
POSSESSORS = listed("possessors")
# General taggers often tag these words wrongly in instructions (turn, exit, left ...).
# The words keep the tag of the built-in tagger.
OVERRIDES = listed("overrides")

# words that are never masked: words for places, directions, identity and negation
SPATIAL = (bag(_CLASSES["ADP"]) - bag("of for with like per about during")) | listed("spatial")


def is_kept(word: str) -> bool:
    """Return whether a word (lower case, straight apostrophe) must not be masked."""
    return word in SPATIAL or word.endswith("n't")


# Landmarks are nouns for visible things. This dict maps the canonical name of a landmark to its
# synonyms. Phrases are matched before single nouns.
SYNONYMS: dict[str, list[str]] = WORDS["landmarks"]
# nouns that are not landmarks, such as parts of a route and words in polite phrases
PLAIN = listed("no_landmarks")

CANONICAL = {form: name for name, forms in SYNONYMS.items() for form in forms if " " not in form}
PHRASES = {
    tuple(form.split()): name
    for name, forms in SYNONYMS.items()
    for form in (name, *forms)
    if " " in form
}
LONGEST = max(map(len, PHRASES))
_KEEP_S = ("ss", "us", "is", "as", "os")


def normal(noun: str) -> str:
    """Return the canonical name of a noun, in lower case and singular.

    The canonical name is the main word of the noun's synonym group.
    """
    word = noun.lower().removesuffix("'s").removesuffix("s'")
    if word in CANONICAL or word in SYNONYMS:
        return CANONICAL.get(word, word)
    single = _singular(word)
    return CANONICAL.get(single, single)


def _singular(word: str) -> str:
    if len(word) < 4 or not word.endswith("s") or word.endswith(_KEEP_S):
        return word
    if word.endswith("ies"):
        return word[:-3] + "y"
    if word.endswith(("ches", "shes", "sses", "xes", "zes")):
        return word[:-2]
    if word.endswith("lves"):
        return word[:-3] + "f"
    return word[:-1]
