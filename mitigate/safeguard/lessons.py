"""What the tagger learns from: texts with the edits that make them plain, drawn without end.

Two thirds are speech of the train voices, of one text or parts of several; the others are
templates (:mod:`data`) and plain routes, which are to be kept whole.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from mitigate.core.seeding import generator
from mitigate.corruptions.language.tagger import Token
from mitigate.safeguard.data import draw_pair
from mitigate.safeguard.edits import KEEP, Edit, taught, tokens
from mitigate.safeguard.spoken import Spoken, spoken

Lesson = tuple[list[Token], list[Edit]]  # the tokens of a text, and an edit for each
Parts = tuple[tuple[str, str], ...]
SPOKEN, PLAIN = 0.65, 0.08  # shares of speech, and of the same routes in plain words (ours)
WHOLE, SOME, MIXED = 0.5, 0.25, 0.25  # of speech: whole texts, parts in a row, parts of several
OWN_VOICE = 0.7  # of mixed parts: how often all are of one voice
KINDS = ("identity", "style", "black_box")  # of the pairs of templates


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
            return tokens(pair.source), taught(pair.source, pair.target)


def kept(text: str) -> Lesson:
    """Return the lesson that ``text`` stays as it is."""
    found = tokens(text)
    return found, [Edit(KEEP)] * len(found)


def of_parts(parts: Parts) -> Lesson:
    """Return the lesson of (said, plain) parts in a row."""
    text = " ".join(said for said, _ in parts)
    return tokens(text), [edit for said, plain in parts for edit in _taught(said, plain)]


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
def _taught(said: str, plain: str) -> tuple[Edit, ...]:
    return tuple(taught(said, plain))
