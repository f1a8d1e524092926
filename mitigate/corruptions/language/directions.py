"""Extract from an instruction its directions, numbers, ordinals and distances, each in order.

Directions are left, right, around, straight, up, down and stop. "down the stairs" means down, but
"down the hall" does not. "right before" and "you left the room" are not turns. "wait there" after
"stop" is not a second stop.
"""

from __future__ import annotations

import re

from mitigate.corruptions.language.tagger import SENTENCE_ENDS, Token
from mitigate.corruptions.language.words import WORDS, bag, listed

STOPS = listed("stops")
MOTION = listed("motion")
TURN_VERBS = listed("turn_verbs")
_LEVELS = listed("levels")
_FILLERS = listed("fillers")
_NO_CLIMB = listed("no_climb")
_LEFT = listed("left")
_RIGHT = listed("right")
_STRAIGHT = listed("straight")
_UP = listed("up")
_DOWN = listed("down")
_ADVERB_BEFORE = listed("adverb_before")
_SIDE_AFTER = TURN_VERBS | listed("side_after")
_AROUND = re.compile(
    r"\b(?:turn|turning|spin|spinning|swing|rotate|pivot)(?: all the way| right| completely| fully|"
    r" yourself| straight| back)* (?:around|round|back|180(?: degrees?)?|"
    r"(?:one )?hundred (?:and )?eighty degrees?)"
    r"(?: 180(?: degrees?)?| completely| and go back)?(?: the other way)?"
    r"(?! (?:the|a|this|that|your|into|toward|towards|through|in)\b)"
    r"|\b(?:turn|turning) (?:around|round|back)(?= (?:in|into|toward|towards|so|through)\b)"
    r"|\b(?:full|u|complete|180(?: degree)?) turn(?: and go back)?\b|\bu - turn\b|\babout face\b"
    r"|\b(?:do|make) a 180(?: degree turn)?\b|\bturn and go back\b"
    r"|\bgo back the (?:other way|way you came)\b|\breverse (?:your )?course\b"
)


def about_turns(tokens: list[Token]) -> dict[int, int]:
    """Find the phrases that mean turning around.

    For each phrase, the result maps the index of its first token to the index of its last token.
    """
    text, starts = "", {}
    for index, token in enumerate(tokens):
        starts[len(text)] = index
        text += token.lower + " "
    spans = {}
    for match in _AROUND.finditer(text):
        last = text[: match.end()].count(" ")
        spans[starts.get(match.start(), last)] = last
    return spans


def directions(tokens: list[Token], turned: dict[int, int]) -> list[str]:
    """Return the directions in order.

    A direction that is repeated without a movement in between counts once. ``turned`` is the result
    of :func:`about_turns`.
    """
    names: list[str] = []
    last = skip = -1
    for place, token in enumerate(tokens):
        name = "around" if place in turned else None
        if name is None and place > skip and token.is_word:
            name = _direction(tokens, place)
        if name is None:
            continue
        skip = turned.get(place, skip)
        if not (names and names[-1] == name and _repeats(name, tokens[last + 1 : place])):
            names.append(name)
        last = place
    return names


def _repeats(name: str, between: list[Token]) -> bool:
    if name in ("up", "down"):
        return len(between) <= 2
    moved = any(t.lower in MOTION and t.tag == "VERB" for t in between)
    return name in ("stop", "straight") and not moved


def _direction(tokens: list[Token], place: int) -> str | None:
    word, before, after = tokens[place].lower, at(tokens, place - 1), at(tokens, place + 1)
    if word in _LEFT:
        is_past = before in ("have", "has", "you've") or (
            before == "you" and after in ("the", "your")
        )
        return None if is_past else "left"
    if word in _RIGHT:
        is_emphasis = before not in _SIDE_AFTER and after in _ADVERB_BEFORE
        return None if word == "right" and (is_emphasis or before == "all") else "right"
    if word in _STRAIGHT:
        return None if before == "go" and after in ("and", ",") and word == "ahead" else "straight"
    if word in _UP or word in _DOWN:
        return "up" if word in _UP else "down"
    if word in ("climb", "climbs", "climbing"):
        return None if "down" in (after, at(tokens, place + 2)) else "up"
    if word in ("up", "down"):
        return _vertical(tokens, place, before)
    return "stop" if _stops(tokens, place) else None


def _vertical(tokens: list[Token], place: int, before: str) -> str | None:
    """Return "up" or "down" if the word means another floor, else None ("up to the wall")."""
    if before in _NO_CLIMB:
        return None
    for token in tokens[place + 1 : place + 7]:
        if token.lower in _LEVELS:
            return tokens[place].lower
        if token.lower not in _FILLERS and token.tag != "ADJ":
            along = token.is_word and token.tag != "VERB" and token.lower not in ("and", "then")
            return None if along else tokens[place].lower
    return tokens[place].lower


def _stops(tokens: list[Token], place: int) -> bool:
    word, before = tokens[place].lower, [t.lower for t in tokens[max(0, place - 3) : place]]
    if word in ("done", "arrived", "finished"):
        return not bag("you you're you've are").isdisjoint(before)
    return word in STOPS or (word == "rest" and before[-2:] == ["come", "to"])


def at(tokens: list[Token], place: int) -> str:
    """Return the word at an index in lower case, or "" if the index is outside the text."""
    return tokens[place].lower if 0 <= place < len(tokens) else ""


_COUNTED = ("two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")
_NUMBERS = {str(number): word for number, word in enumerate(_COUNTED, 2)} | {
    word: word
    for word in (
        *_COUNTED,
        *bag("eleven twelve twenty thirty forty fifty sixty ninety hundred half twice"),
    )
}
_NUMBERS |= {"couple": "two", "11": "eleven", "12": "twelve", "20": "twenty", "90": "ninety"}
_ORDINALS = {
    word: word for word in bag("first second third fourth fifth sixth seventh eighth last")
} | {"1st": "first", "2nd": "second", "3rd": "third", "4th": "fourth", "5th": "fifth"}
_UNITS = listed("units")
_UNIT: dict[str, str] = WORDS["units"]
_LONE_UNITS = _UNITS - bag("step steps m cm ft foot feet yard yards")


def quantities(tokens: list[Token], turned: dict[int, int]) -> list[str]:
    """Return numbers, ordinals and distances in order: "two", "first", "two step", "meter".

    ``turned`` is the result of :func:`about_turns`. Numbers in these phrases, such as 180 degrees,
    are skipped.
    """
    inside = {place for first, last in turned.items() for place in range(first, last + 1)}
    names = []
    for place, token in enumerate(tokens):
        word, before, after = token.lower, at(tokens, place - 1), at(tokens, place + 1)
        if place in inside:
            continue
        if word in _ORDINALS:
            if not _orders_sentences(tokens, place):
                names.append(_ORDINALS[word])
        elif word in _NUMBERS or word.isdecimal():
            unit = f" {_unit(after)}" if after in _UNITS else ""
            names.append(_NUMBERS.get(word, word) + unit)
        elif word in _LONE_UNITS and before not in _NUMBERS and not before.isdecimal():
            names.append(_unit(word))
    return names


def _unit(word: str) -> str:
    return _UNIT.get(word, word.removesuffix("s"))


def _orders_sentences(tokens: list[Token], place: int) -> bool:
    """Return whether an ordinal orders steps ("first, turn left") instead of objects."""
    before, after = at(tokens, place - 1), tokens[place + 1] if place + 1 < len(tokens) else None
    loose = after is None or not after.is_word or after.tag in ("VERB", "PRON", "ADV")
    begins = place == 0 or before in SENTENCE_ENDS or before in ("and", ",", "at")
    return begins and loose
