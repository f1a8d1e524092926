"""Generate routes in random styles: with random subjects, verbs, phrases and conjunctions.

These routes teach the classifier that unusual words alone are not an attack. The sentences need not
sound natural. The words are read from a checkout: ``tools/safeguard/data/styler.json``.
"""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from mitigate.core.files import find
from mitigate.core.seeding import pick
from mitigate.guards.text.learning.routes import WORDS

FILE = "tools/safeguard/data/styler.json"
_THIRD = ("he", "she", "it", "the robot", "our hero", "the unit", "one", "the machine", "ROBOT")


@lru_cache(maxsize=1)
def _words() -> dict[str, list[str]]:
    return json.loads(find(FILE).read_text(encoding="utf-8"))


def draw_styled(rng: np.random.Generator) -> str:
    """Return one route in a random style."""
    lists = _words()

    def one(options: Sequence[str]) -> str:
        return pick(options, rng)

    article = one(("the", "the", "the", "that", "a", "this", "yon", "your", "", "them", "the wee"))
    subject, subjects = one(lists["subjects"]), rng.random()
    verbs = {"go": one(lists["go"]), "turn": one(lists["turn"]), "stop": one(lists["stop"])}

    def thing() -> str:
        look = f"{one(WORDS['looks'])} " if rng.random() < 0.25 else ""
        return f"{article} {look}{one(WORDS['things' if rng.random() < 0.6 else 'rooms'])}".strip()

    def clause(kind: str, first: bool) -> str:
        verb = verbs[kind] if rng.random() < 0.6 else one(lists[kind])
        who = subject if first or subjects < 0.3 else ""
        if who in _THIRD:
            verb = re.sub(r"^\w+", lambda m: m[0] + ("es" if m[0][-1] in "so" else "s"), verb)
            verb = re.sub(r"^(\w+[sc]h)s\b", r"\1es", verb)
        if kind == "go":
            sentence = f"{verb} {one(lists['pass'])} {thing()}"
        elif kind == "turn":
            sentence = f"{verb} {one(('left', 'right'))}"
            sentence += f" {one(lists['at'])} {thing()}" if rng.random() < 0.6 else ""
        else:
            sentence = f"{verb} {one(lists['at'])} {thing()}"
        if rng.random() < 0.08:
            sentence = f"don't {one(lists['go'])} into {thing()}, {sentence}"
        return f"{who} {sentence}".strip()

    kinds = [*rng.choice(["go", "go", "turn"], int(rng.integers(1, 5))), "stop"]
    join = one(lists["joins"])
    text = join.join(clause(kind, place == 0) for place, kind in enumerate(kinds))
    opener, closer = one(lists["openers"]), one(lists["closers"])
    text = f"{opener}{one((', ', '! ', '. ', ': ', '... '))}{text}" if opener else text
    text = f"{text}{one((', ', '. ', '! ', ' '))}{closer}" if closer else text
    if could_ask := subject.startswith(("could", "would", "can", "might", "why", "how")):
        text += "?"
    text = re.sub(r"(^|[.!?]\s+)([a-z])", lambda m: m[1] + m[2].upper(), text)
    text += "" if could_ask or rng.random() < 0.15 else one((".", ".", ".", "!"))
    return _typed(text, rng.random(), rng)


def _typed(text: str, draw: float, rng: np.random.Generator) -> str:
    """Imitate telegrams, chat messages or careless writing."""
    if draw < 0.08:
        return text.upper()
    if draw < 0.2:
        return text.lower()
    if draw < 0.26:  # leave out vowels in some words
        return re.sub(
            r"\b(\w)(\w{2,})\b",
            lambda m: m[1] + re.sub(r"[aeiou]", "", m[2]) if rng.random() < 0.5 else m[0],
            text,
        )
    if draw < 0.32:  # write "in'" for "ing" and sometimes "d" for "th"
        return re.sub(
            r"ing\b", "in'", re.sub(r"\bth", lambda m: "d" if rng.random() < 0.3 else m[0], text)
        )
    if draw < 0.36:
        parts = re.split(r"(?<=[.!?])\s+", text)
        return " ".join(f"{i}. {part}" for i, part in enumerate(parts, 1))
    return text
