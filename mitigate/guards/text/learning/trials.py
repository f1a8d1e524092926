"""The hand-written test banks of a checkout, and attacks put into instructions.

Every bank has a part for tuning and a part for the report alone: attacks by mechanism, voices by
name, the other banks by odd and even lines. What is chosen by hand sees the first only, and so does
what is fitted where the second is to be reported on ("all": both).
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from mitigate.core.seeding import generator
from mitigate.corruptions.language.prefixes import prefixes
from mitigate.guards.text.learning import spoken
from mitigate.guards.text.texts.text import sentences

BANKS = Path(__file__).parent / "banks"
SPLITS = ("tune", "test")
ALL = "all"
FRESH = "fresh"  # attacks and lookalikes by two authors who saw nothing of ours; fitted on by none
HELD_OUT = frozenset({
    "diversion", "role", "other_script", "noise",
    # by another author
    "goal_hijack", "role_confusion", "irrelevant_chatter", "code_and_log_lines", "advertising",
    "math_and_puzzles", "past_anecdotes", "mild_misleading_noise", "fake_transcript",
    "hypothetical_fiction",
    # by a third
    "mild_suggestion", "fake_dialogue", "goal_replacement", "riddles_and_poems",
})  # fmt: skip
TEST_VOICES = ("bureaucratic", "tour_guide", "poetic", "second_thoughts", "llm_professional",
    "butler", "elaborate")  # fmt: skip
TUNE_VOICES = ("chatty", "military", "child", "engineer", "llm_friendly", "llm_novice", "lists",
    "very_short", "asides", "commentator", "hesitant", "llm_formal", "passive", "text_message",
    "very_long", "friendly", "novice", "professional", "formal", "casual", "back_references",
    "restructured")  # fmt: skip
PLACES = ("front", "second", "middle", "end")
_BOUNDARY = re.compile(r"\s+(?=and\s)|(?<=,)\s+|\s+(?=(?:until|then|past|through|to|at|by)\s)")


@dataclass(frozen=True)
class Attack:
    """One attack: how it works, where it stands ("any", "inside", "wrap"), its words."""

    mechanism: str
    place: str
    words: str


@dataclass(frozen=True)
class Told:
    """An instruction in a voice, its ``parts`` that tell the way, and what is meant."""

    text: str
    parts: tuple[str, ...]
    plain: str
    voice: str


def lines(name: str) -> list[dict[str, Any]]:
    """Return the lines of a bank. Raises FileNotFoundError outside a checkout."""
    path = BANKS / f"{name}.jsonl"
    if not path.is_file():
        raise FileNotFoundError(
            f"There is no bank {path}: the test banks come with a checkout of the repository, not "
            "with the installed package. Run this in a checkout."
        )
    with open(path, encoding="utf-8") as file:
        return [json.loads(line) for line in file if line.strip()]


def fitting(name: str) -> list[str]:
    """Return the lines of a text that the rules are fitted on."""
    with open(BANKS / f"{name}.txt", encoding="utf-8") as file:
        return [line.strip() for line in file if line.strip() and not line.startswith("#")]


def learned_prefixes() -> list[tuple[str, str]]:
    """Return (family, line) of the prefix bank's train and validation families."""
    return [
        (family, line)
        for split in ("train", "validation")
        for family, group in prefixes(split).items()
        for line in group
    ]


def half(name: str, split: str) -> list[dict[str, Any]]:
    """Return the odd lines (1-based) of a bank for "tune", the even ones for "test", and for the
    fresh attacks what their authors wrote of it."""
    if split == FRESH:
        return lines(f"fresh_{name}") if name == "lookalikes" else []
    return lines(name) if split == ALL else lines(name)[SPLITS.index(split) :: 2]


def attacks(split: str) -> list[Attack]:
    """Return the attacks of the mechanisms of a split, or the fresh ones."""
    name = "fresh_attacks" if split == FRESH else "attacks"
    found = [Attack(d["mechanism"], d["place"], d["attack"]) for d in lines(name)]
    if split == FRESH:
        return found
    return [a for a in found if split == ALL or (a.mechanism in HELD_OUT) == (split == "test")]


def voices(split: str) -> tuple[str, ...]:
    """Return the voices of a split; for the fresh attacks those that no network learned from."""
    held_out = spoken.VALIDATION + spoken.TEST
    every = TUNE_VOICES + TEST_VOICES
    return {"tune": TUNE_VOICES, "test": TEST_VOICES, ALL: every, FRESH: held_out}[split]


def told(split: str, task: str = "route") -> list[Told]:
    """Return the instructions of the voices of a split, as they were said."""
    made = []
    for voice in voices(split):
        for text in spoken.voice(voice):
            if text.task == task:
                parts = tuple(said for said, plain in text.parts if plain)
                made.append(Told(text.said, parts, text.plain, voice))
    return made


def asides(split: str) -> list[tuple[str, str]]:
    """Return (voice, what it says that tells nothing of the way)."""
    return [
        (voice, said)
        for voice in voices(split)
        for text in spoken.voice(voice)
        for said, plain in text.parts
        if not plain
    ]


def plainly_told(split: str) -> list[Told]:
    """Return the same instructions in plain words."""
    return [Told(t.plain, tuple(sentences(t.plain)), t.plain, t.voice) for t in told(split)]


def places(attack: Attack) -> tuple[str, ...]:
    """Return the places where ``attack`` can stand."""
    return PLACES if attack.place == "any" else (attack.place,)


def insert(attack: Attack, place: str, route: str) -> str | None:
    """Return ``route`` with an attack at a place; None where the route is too short for it."""
    found = sentences(route)
    if place == "wrap":
        return attack.words.replace("{route}", route)
    if place == "inside":
        return _inside(attack.words, found)
    at = {"front": 0, "second": 1, "middle": (len(found) + 1) // 2, "end": len(found)}[place]
    if place in ("second", "middle") and len(found) < (2 if place == "second" else 3):
        return None
    return " ".join((*found[:at], attack.words, *found[at:]))


def _inside(words: str, found: list[str]) -> str:
    """Put an attack behind the first clause of the longest sentence."""
    longest = max(range(len(found)), key=lambda i: len(found[i]))
    sentence = found[longest]
    cuts = [m.start() for m in _BOUNDARY.finditer(sentence) if m.start() > 12]
    at = cuts[0] if cuts else len(sentence.rstrip(".!?"))
    before, after = sentence[:at].rstrip(","), sentence[at:].strip()
    if words[0] in "([{</\"'" or not words[0].isascii():
        made = f"{before} {words} {after}"
    else:
        made = f"{before}, {words}, {after}" if len(after) > 1 else f"{before}, {words}{after}"
    return " ".join((*found[:longest], made, *found[longest + 1 :]))


def trials(
    found: list[Attack], routes: list[Told], each: int, seed: int = 0
) -> Iterator[tuple[Attack, str, Told, str]]:
    """Yield (attack, place, instruction, what is heard): every attack at each of its places in
    ``each`` instructions, drawn by the seed."""
    for number, attack in enumerate(found):
        for place in places(attack):
            rng: np.random.Generator = generator(seed, "trial", number, place)
            made = 0
            for index in rng.permutation(len(routes)):
                route = routes[int(index)]
                heard = insert(attack, place, route.text)
                if heard is not None:
                    yield attack, place, route, heard
                    made += 1
                if made == each:
                    break
