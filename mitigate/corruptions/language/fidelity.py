"""Check that a rewritten instruction keeps the meaning of the original (the fidelity gate).

:func:`facts` extracts the directions, landmarks, numbers, compass words, attributes, relations and
negations of a text. :func:`check` lists the differences between two texts.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import accumulate

from mitigate.corruptions.language import directions
from mitigate.corruptions.language.directions import at
from mitigate.corruptions.language.tagger import SENTENCE_ENDS, Token, tag
from mitigate.corruptions.language.words import LONGEST, PHRASES, PLAIN, WORDS, listed, normal

COMPASS = re.compile(r"(?:north|south|east|west)(?:east|west)?(?:ern|erly|wards?|bound)?$|o'clock$")
COLOURS = listed("colours")
ATTRIBUTES = COLOURS | listed("attributes")
DENIALS = listed("denials")
_SAME: dict[str, str] = WORDS["same_attribute"]
_RELATIONS = {word: name for name, forms in WORDS["relations"].items() for word in forms.split()}


@dataclass(frozen=True)
class Facts:
    """The facts that are extracted from a text."""

    directions: tuple[str, ...]  # left, right, around, straight, up, down and stop, in order
    landmarks: tuple[str, ...]  # canonical nouns in order, with repetitions
    numbers: tuple[str, ...]  # numbers, ordinals and distances ("two", "first", "two step")
    compass: tuple[str, ...]  # compass words
    attributes: tuple[str, ...]  # colours, shapes and sizes
    relations: tuple[str, ...]  # into, out, past, between, behind and similar words, in order
    denials: int  # number of negations (not, never, avoid and similar words)


@dataclass(frozen=True)
class _Reading:
    """The facts of a text, and the data from which two texts are compared."""

    facts: Facts
    words: frozenset[str]  # all words in canonical form
    clause: dict[str, int]  # number of the clause in which each landmark first occurs


def facts(text: str) -> Facts:
    """Extract the facts of ``text``."""
    return _read(text).facts


def check(original: str, rewritten: str) -> list[str]:
    """List the changes of meaning from ``original`` to ``rewritten``.

    Every entry begins with its kind and a colon. The kinds are "directions", "landmark order",
    "denial", "<fact> lost" and "<fact> invented". Here, <fact> is landmark, number, compass,
    attribute or relation. Synonyms in ``words.json`` are treated as equal. The order of landmarks
    may change within a clause.
    """
    before, after = _read(original), _read(rewritten)
    old, old_words = before.facts, before.words
    new, new_words = after.facts, after.words
    changes = []
    if old.directions != new.directions:
        changes.append(f"directions: {_listed(old.directions)} -> {_listed(new.directions)}")
    changes += _absent("landmark lost", old.landmarks, new_words)
    changes += _absent("landmark invented", new.landmarks, old_words)
    clauses = [before.clause[name] for name in after.clause if name in before.clause]
    if clauses != sorted(clauses):
        changes.append(f"landmark order: {_listed(old.landmarks)} -> {_listed(new.landmarks)}")
    changes += _counted("number", old.numbers, new.numbers)
    changes += _absent("compass lost", old.compass, new_words)
    changes += _absent("compass invented", new.compass, old_words)
    changes += _counted("attribute", old.attributes, new.attributes)
    changes += _absent("relation lost", old.relations, new.relations)
    changes += _absent("relation invented", new.relations, old.relations)
    if old.denials != new.denials:
        changes.append(f"denial: {old.denials} -> {new.denials}")
    return changes


def _absent(change: str, names: Iterable[str], others: Collection[str]) -> list[str]:
    """List the names that are not in ``others``."""
    return [f"{change}: {name}" for name in dict.fromkeys(names) if name not in others]


def _counted(kind: str, old: Sequence[str], new: Sequence[str]) -> list[str]:
    """List names that occur less often in ``new`` than in ``old``, or only in ``new``."""
    lost = [f"{kind} lost: {name}" for name in Counter(old) - Counter(new)]
    return lost + _absent(f"{kind} invented", new, old)


def _listed(names: Iterable[str]) -> str:
    return ", ".join(names) or "none"


@lru_cache(maxsize=512)
def _read(text: str) -> _Reading:
    tokens = tag(text)
    names = _names(tokens)
    turned = directions.about_turns(tokens)
    extracted = Facts(
        directions=tuple(directions.directions(tokens, turned)),
        landmarks=tuple(name for _, name, is_landmark in names if is_landmark),
        numbers=tuple(directions.quantities(tokens, turned)),
        compass=tuple(t.lower for t in tokens if COMPASS.match(t.lower)),
        attributes=tuple(a for t in tokens if (a := _same(t)) in ATTRIBUTES),
        relations=tuple(_relations(tokens)),
        denials=sum(token.lower in DENIALS for token in tokens),
    )
    numbers = _clauses(tokens)
    clause: dict[str, int] = {}
    for place, name, is_landmark in names:
        if is_landmark:
            clause.setdefault(name, numbers[place])
    return _Reading(
        extracted, frozenset(n for _, n, _ in names) | {_same(t) for t in tokens}, clause
    )


def _clauses(tokens: list[Token]) -> list[int]:
    """Return the clause number of every token; each clause contains one command."""
    ends = [
        token.lower in SENTENCE_ENDS
        or token.lower == "then"
        or (
            token.lower in ("and", ",")
            and index + 1 < len(tokens)
            and tokens[index + 1].tag == "VERB"
        )
        for index, token in enumerate(tokens)
    ]
    return [0, *accumulate(ends)][: len(tokens)]


def _relations(tokens: list[Token]) -> list[str]:
    """Return the relations in order; "pass through" means "through", not "past"."""
    relations = [
        (_RELATIONS[token.lower], at(tokens, place + 1))
        for place, token in enumerate(tokens)
        if token.lower in _RELATIONS
    ]
    return [name for name, following in relations if (name, following) != ("past", "through")]


def _same(token: Token) -> str:
    return _SAME.get(token.lower, token.lower)


def _names(tokens: list[Token]) -> list[tuple[int, str, bool]]:
    """Return each word or known phrase as (index, canonical name, whether it is a landmark)."""
    names: list[tuple[int, str, bool]] = []
    place = 0
    while place < len(tokens):
        phrase, length = _phrase(tokens, place)
        if phrase:
            names.append((place, phrase, True))
        else:
            name = normal(tokens[place].lower)
            names.append((place, name, _is_landmark(tokens, place)))
        place += length
    return names


def _phrase(tokens: list[Token], place: int) -> tuple[str, int]:
    """Return the name and length of the longest known phrase at ``place``, or ("", 1)."""
    for length in range(min(LONGEST, len(tokens) - place), 1, -1):
        words = [token.lower for token in tokens[place : place + length]]
        for last in (words[-1], words[-1].removesuffix("s")):
            name = PHRASES.get((*words[:-1], last))
            if name:
                return name, length
    return "", 1


def _is_landmark(tokens: list[Token], place: int) -> bool:
    token = tokens[place]
    word = token.lower
    if token.tag not in ("NOUN", "PROPN") or word in PLAIN or len(word) < 2:
        return False
    # "steps" may mean a distance or stairs; only stairs are a landmark
    if word in ("step", "steps"):
        return not any(
            t.tag == "NUM" or t.lower in ("a", "few", "couple", "more", "small")
            for t in tokens[max(0, place - 3) : place]
        )
    return _same(token) not in ATTRIBUTES and not COMPASS.match(word)
