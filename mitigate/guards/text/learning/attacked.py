"""Lessons about attacks: routes with attacks in front, between, behind and inside their sentences.

The attacks are of the prefix bank's train and validation families and of the test banks, which come
with a checkout alone; the routes are ours, in plain words and as people say them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from mitigate.core.seeding import generator
from mitigate.guards.text.learning import routes, trials
from mitigate.guards.text.learning.data import vary
from mitigate.guards.text.learning.lessons import Lesson, draw_lesson, edits_of
from mitigate.guards.text.learning.spoken import spoken
from mitigate.guards.text.learning.trials import Attack
from mitigate.guards.text.plain.edits import DROP, KEEP, Edit, tokens
from mitigate.guards.text.texts.text import sentences

# shares (ours): routes as they are said, in plain words of the same people, sentences of routes
# that look like attacks, the rest drawn; attacks that are varied, those put inside a sentence
SAID, MEANT, ALIKE = 0.4, 0.15, 0.2
VARIED, INSIDE, FRONT = 0.1, 0.25, 0.4
COUNTS = (0.15, 0.45, 0.2, 0.12, 0.08)  # of 0, 1, 2 ... attacks in a text
LOWER, BARE, SHOUTED = 0.12, 0.08, 0.04  # attacks in lower case, without their end mark, shouted
SHORT, ROOM = 11, 7  # words of an attack that goes inside, tokens of a segment that takes one
_JOINTS = frozenset({"and", "then", "until", "past", "through", "to", "at", "by"})


@dataclass(frozen=True)
class Segment:
    """A part of a text, with an edit for each of its tokens; ``attack`` as in a lesson."""

    text: str
    edits: Sequence[Edit | None]
    attack: bool | None


def draw_attacked(seed: int, index: int, split: str) -> Lesson:
    """Return lesson ``index`` of ``seed``, with the attacks of a split of the banks. Raises
    FileNotFoundError outside a checkout."""
    rng = generator(seed, "attacked", index)
    found = _route(rng, split)
    pool = attacks(split)
    in_front = rng.random() < FRONT
    for _ in range(int(rng.choice(len(COUNTS), p=COUNTS))):
        attack = pool[int(rng.integers(len(pool)))]
        if rng.random() < VARIED:
            attack = Attack("varied", "any", vary(rng))
        found = _put(rng, found, attack, in_front)
    return _lesson(found) or draw_lesson(seed, index)


@lru_cache(maxsize=2)
def attacks(split: str) -> tuple[Attack, ...]:
    """Return what is learned from: the attacks of a split of the banks and of the prefix bank."""
    prefixes = [line for _, line in trials.learned_prefixes()]
    lines = [*prefixes, *trials.fitting("fit_attacks")]
    return (*trials.attacks(split), *(Attack("line", "any", line) for line in lines))


@lru_cache(maxsize=2)
def _alike(split: str) -> tuple[str, ...]:
    banks = [line["text"] for name in ("near_misses", "lookalikes", "odd_routes")
        for line in trials.half(name, split)]  # fmt: skip
    return (*banks, *trials.fitting("fit_routes"))


def _route(rng: np.random.Generator, split: str) -> list[Segment]:
    kind = rng.random()
    if kind < SAID + MEANT:
        texts = spoken("train")
        text = texts[int(rng.integers(len(texts)))]
        if kind < SAID:
            return [Segment(s, edits_of(s, p), False if p else None) for s, p in text.parts]
        return [_kept(s) for s in sentences(text.plain)]
    if kind < SAID + MEANT + ALIKE:
        lines = _alike(split)
        heard = sentences(lines[int(rng.integers(len(lines)))])
        return [Segment(s, [None] * len(tokens(s)), False) for s in heard]
    return [_kept(s) for s in sentences(routes.draw_route(rng))]


def _kept(text: str) -> Segment:
    return Segment(text, [Edit(KEEP)] * len(tokens(text)), False)


def _gone(text: str) -> Segment:
    return Segment(text, [Edit(DROP)] * len(tokens(text)), True)


def _put(
    rng: np.random.Generator, found: list[Segment], attack: Attack, in_front: bool
) -> list[Segment]:
    if attack.place == "wrap":
        before, _, after = (part.strip() for part in attack.words.partition("{route}"))
        return [*map(_gone, filter(None, [before])), *found, *map(_gone, filter(None, [after]))]
    said = _carelessly(rng, attack.words)
    if attack.place == "inside" or (len(said.split()) < SHORT and rng.random() < INSIDE):
        return _inside(rng, found, said)
    at = 0 if in_front else int(rng.integers(len(found) + 1))
    return [*found[:at], _gone(said), *found[at:]]


def _inside(rng: np.random.Generator, found: list[Segment], said: str) -> list[Segment]:
    """Put words between two clauses of a segment, if it has room."""
    number = int(rng.integers(len(found)))
    segment = found[number]
    marks = tokens(segment.text)
    if segment.attack is not False or len(marks) < ROOM:
        return found
    joints = [i for i in range(2, len(marks) - 2)
        if marks[i].lower in _JOINTS or marks[i - 1].text == ","]  # fmt: skip
    at = int(rng.integers(2, len(marks) - 2))
    if joints and rng.random() < 0.7:
        at = joints[int(rng.integers(len(joints)))]
    before, after = segment.text[: marks[at].start].rstrip(), segment.text[marks[at].start :]
    said = said.strip(" ,." if rng.random() < 0.5 else " ,")
    if said[:1].isalnum() and rng.random() < 0.6:
        said = f", {said[0].lower()}{said[1:]}{',' if after[:1].isalnum() else ''}"
    parts = [Segment(before, segment.edits[:at], False), _gone(said),
        Segment(after, segment.edits[at:], False)]  # fmt: skip
    return [*found[:number], *parts, *found[number + 1 :]]


def _carelessly(rng: np.random.Generator, said: str) -> str:
    draw = rng.random()
    if draw < LOWER:
        return said.lower()
    if draw < LOWER + BARE:
        return said.rstrip(".!") or said
    return said.upper() if draw < LOWER + BARE + SHOUTED else said


def _lesson(found: Sequence[Segment]) -> Lesson | None:
    """Return segments as one lesson; None where their tokens run together when they are joined."""
    text = ""
    for segment in found:
        text += (" " if text and not segment.text.startswith(",") else "") + segment.text
    read = tokens(text)
    edits = [edit for segment in found for edit in segment.edits]
    attack = [segment.attack for segment in found for _ in segment.edits]
    return Lesson(read, edits, attack) if len(read) == len(edits) else None
