"""What the tagger learns from: texts with the edits that make them plain, drawn without end.

Two thirds are speech of the train voices, of one text or parts of several; the others are
templates (:mod:`data`) and plain routes, which are to be kept whole.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from mitigate.core.seeding import generator
from mitigate.corruptions.language.tagger import Token
from mitigate.guards.text.learning.data import draw_pair
from mitigate.guards.text.learning.spoken import Spoken, spoken
from mitigate.guards.text.plain.edits import KEEP, Edit, taught, tokens

Parts = tuple[tuple[str, str], ...]
SPOKEN, PLAIN = 0.65, 0.08  # shares of speech, and of the same routes in plain words (ours)
WHOLE, SOME, MIXED = 0.5, 0.25, 0.25  # of speech: whole texts, parts in a row, parts of several
OWN_VOICE = 0.7  # of mixed parts: how often all are of one voice
KINDS = ("identity", "style", "black_box")  # of the pairs of templates


@dataclass(frozen=True)
class Lesson:
    """The tokens of a text; for each the ``edit`` that makes it plain, None where none is taught,
    and whether it is part of an ``attack``, None where that is open."""

    tokens: Sequence[Token]
    edits: Sequence[Edit | None]
    attack: Sequence[bool | None]


def draw_lesson(seed: int, index: int) -> Lesson:
    """Return lesson ``index`` of ``seed``."""
    rng = generator(seed, "lesson", index)
    kind = rng.random()
    if kind < SPOKEN:
        return of_parts(_parts(rng))
    if kind < SPOKEN + PLAIN:
        texts = spoken("train")
        return kept(texts[int(rng.integers(len(texts)))].plain)
    while True:
        pair = draw_pair(seed, int(rng.integers(10**9)))
        if pair.kind == "identity":
            return kept(pair.source)
        if pair.kind in KINDS:
            found, attack = tokens(pair.source), None if pair.kind == "black_box" else False
            edits = taught(pair.source, pair.target)
            return Lesson(found, edits, [attack] * len(found))


def kept(text: str) -> Lesson:
    """Return the lesson that ``text`` stays as it is."""
    found = tokens(text)
    return Lesson(found, [Edit(KEEP)] * len(found), [False] * len(found))


def of_parts(parts: Parts) -> Lesson:
    """Return the lesson of (said, plain) parts in a row."""
    edits = [(edit, bool(plain)) for said, plain in parts for edit in edits_of(said, plain)]
    attack = [False if tells else None for _, tells in edits]  # what tells nothing may go
    return Lesson(tokens(" ".join(said for said, _ in parts)), [edit for edit, _ in edits], attack)


def _parts(rng: np.random.Generator) -> Parts:
    texts = spoken("train")
    text = texts[int(rng.integers(len(texts)))]
    kind = rng.random()
    if kind < WHOLE:
        return text.parts
    if kind < WHOLE + SOME:
        count = int(rng.integers(1, 4))
        first = int(rng.integers(max(1, len(text.parts) - count + 1)))
        return text.parts[first : first + count]
    pool = _of_voice(text.voice) if rng.random() < OWN_VOICE else texts
    chosen = []
    for _ in range(int(rng.integers(2, 6))):
        parts = pool[int(rng.integers(len(pool)))].parts
        chosen.append(parts[int(rng.integers(len(parts)))])
    return tuple(chosen)


@lru_cache(maxsize=32)
def _of_voice(name: str) -> tuple[Spoken, ...]:
    return tuple(text for text in spoken("train") if text.voice == name)


@lru_cache(maxsize=8192)
def edits_of(said: str, plain: str) -> tuple[Edit, ...]:
    """Return the edits that bring what is said nearest to plain words."""
    return tuple(taught(said, plain))
