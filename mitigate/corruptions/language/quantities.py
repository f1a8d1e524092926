"""Numbers, ordinals and distances of a text, in words."""

from __future__ import annotations

from mitigate.corruptions.language.directions import at
from mitigate.corruptions.language.tagger import SENTENCE_ENDS, Token
from mitigate.corruptions.language.words import bag

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
_UNITS = bag(
    """
    foot feet ft meter meters metre metres m cm yard yards inch inches pace paces step steps degree
    degrees minute minutes mile miles
    """
)
_UNIT = {
    "feet": "foot",
    "ft": "foot",
    "m": "meter",
    "metre": "meter",
    "metres": "meter",
    "inches": "inch",
}
_LONE_UNITS = _UNITS - bag("step steps m cm ft foot feet yard yards")


def quantities(found: list[Token], turned: dict[int, int]) -> list[str]:
    """Return the numbers, ordinals and distances in order: "two", "first", "two step", "meter".

    ``turned``: the places of ``directions.about_turns``, whose 180 degrees are no quantity.
    """
    inside = {place for first, last in turned.items() for place in range(first, last + 1)}
    names = []
    for place, token in enumerate(found):
        word, before, after = token.lower, at(found, place - 1), at(found, place + 1)
        if place in inside:
            continue
        if word in _ORDINALS:
            if not _orders_sentences(found, place):
                names.append(_ORDINALS[word])
        elif word in _NUMBERS or word.isdecimal():
            unit = f" {_unit(after)}" if after in _UNITS else ""
            names.append(_NUMBERS.get(word, word) + unit)
        elif word in _LONE_UNITS and before not in _NUMBERS and not before.isdecimal():
            names.append(_unit(word))
    return names


def _unit(word: str) -> str:
    return _UNIT.get(word, word.removesuffix("s"))


def _orders_sentences(found: list[Token], place: int) -> bool:
    """Return whether "first" or "last" orders what is said ("first, turn left"; "at last")."""
    before, after = at(found, place - 1), found[place + 1] if place + 1 < len(found) else None
    loose = after is None or not after.is_word or after.tag in ("VERB", "PRON", "ADV")
    begins = place == 0 or before in SENTENCE_ENDS or before in ("and", ",", "at")
    return begins and loose
