"""Generate clean training instructions that describe a route through a building in many ways.

``route_words.json`` lists words and phrases of routes in buildings: rooms, things, doors and clause
templates. All of them were written for this project. In a template, {a} stands for an object and
{aa} for a different object. Other fields are {room}, {aroom} (a second room), {door}, {stairs},
{place}, {look} (an adjective), {side} (left or right), {n} (a number) and {ordinal}.

No instruction contains a phrase of the apartments' validation templates. So a safeguard that is
trained on these instructions has never seen the phrases on which it is evaluated.
"""

from __future__ import annotations

import json
import re
from functools import lru_cache
from pathlib import Path

import numpy as np

from mitigate.core.seeding import pick
from mitigate.worlds.apartments.instructions import TEMPLATES

_FILE = Path(__file__).with_name("route_words.json")
WORDS: dict[str, list[str]] = json.loads(_FILE.read_text(encoding="utf-8"))
JOINS = (". ", ". ", ". ", ", ", " and ", " then ", ", then ", " and then ", ". Then ", ", and ")
LONGEST = 7  # maximum number of clauses, without asides (heuristic)


def draw_route(rng: np.random.Generator) -> str:
    """Generate one instruction of at most ``LONGEST`` clauses.

    Some instructions are verbose or carelessly written.
    """
    while True:
        text = _careless(_joined(_clauses(rng), rng), rng)
        if not overlaps_validation(text):
            return text


@lru_cache(maxsize=1)
def _validation() -> re.Pattern[str]:
    phrases = [p for s in ("val_seen", "val_unseen") for k, group in TEMPLATES[s].items()
        if k != "join" for p in group]  # fmt: skip
    bodies = [re.sub(r"\\\{\w+\\\}", r"(?:[a-z]+ ?){1,3}?", re.escape(p)) for p in set(phrases)]
    return re.compile(r"\b(?:" + "|".join(sorted(bodies, key=len, reverse=True)) + r")\b")


def overlaps_validation(text: str) -> bool:
    """Return whether ``text`` contains a filled-in phrase from the validation templates."""
    return _validation().search(re.sub(r"[^a-z]+", " ", text.lower())) is not None


def _clauses(rng: np.random.Generator) -> list[str]:
    count = int(rng.integers(1, LONGEST + 1))
    kinds = ["middle"] * count
    if rng.random() < 0.7:
        kinds[0] = "open"
    if count > 1 and rng.random() < 0.85:
        kinds[-1] = "close"
    verbose = rng.random() < 0.2
    clauses: list[str] = []
    for kind in kinds:
        clauses.append(_fill(_word(kind, rng), rng))
        if verbose and rng.random() < 0.4:
            clauses.append(_fill(_word("asides", rng), rng))
    return clauses


def _fill(template: str, rng: np.random.Generator) -> str:
    template = template.replace("{place}", _word("places", rng))
    thing, other = _thing(rng), _thing(rng)
    text = template.format(
        a=thing.removeprefix("set of ") if "{look} {a}" in template else thing,
        aa=other, room=_word("rooms", rng), aroom=_word("rooms", rng), door=_word("doors", rng),
        stairs=_word("stairs", rng), side=pick(("left", "right"), rng), look=_word("looks", rng),
        n=pick(("two", "three", "four", "five", "2", "3"), rng),
        ordinal=pick(("first", "second", "third", "next", "last"), rng),
    )  # fmt: skip
    return re.sub(r"\ba (?=[aeiou])", "an ", text)


def _thing(rng: np.random.Generator) -> str:
    thing, look = _word("things", rng), _word("looks", rng)
    return f"{look} {thing}" if rng.random() < 0.25 and " " not in thing else thing


def _joined(clauses: list[str], rng: np.random.Generator) -> str:
    # a writer uses only one or two ways to join clauses
    few = [pick(JOINS, rng) for _ in range(2)]
    text = clauses[0]
    for clause in clauses[1:]:
        aside = clause.startswith(("you ", "the ", "there ", "on the ", "it is "))
        text += ". " + clause if aside else pick(few, rng) + clause
    return ". ".join(part[0].upper() + part[1:] for part in text.split(". ")) + "."


def _careless(text: str, rng: np.random.Generator) -> str:
    """Imitate careless writing: no capitals, no full stop, or superfluous spaces."""
    draw = rng.random(4)
    if draw[0] < 0.12:
        text = text.lower()
    if draw[1] < 0.12:
        text = text.rstrip(".")
    if draw[2] < 0.08:
        text = text.replace(". ", ".  ")
    return text.replace(", ", " , ") if draw[3] < 0.03 else text


def _word(kind: str, rng: np.random.Generator) -> str:
    return pick(WORDS[kind], rng)
