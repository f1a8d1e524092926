"""Define patterns for kinds of clauses, and load the phrases with which each style rewrites them.

Templates begin with an infinitive, so that every template fits into a frame such as "you'll want to
{}".
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from mitigate.corruptions.language.clauses import COMMANDS
from mitigate.corruptions.language.words import read_data

BARE_VERB = (
    rf"(?:just |simply |slowly |carefully |immediately |directly )?(?:{COMMANDS}|execute|perform|"
    r"effect|pop|hop|scoot|stroll|wander|cruise|mosey|depart|vacate|withdraw|cease|maintain|transit|"
    r"egress|transition|reorient|reverse|betake|carry)\b"
)
_WALK = (
    r"(?:walk|go|head|proceed|continue|move|travel|advance|come|run|step|keep (?:going|walking)|"
    r"make your way|continue (?:walking|going))"
)
_STAIRS = (
    r"(?P<thing>(?:the |a |these |those |this )?(?:[\w-]+ ){0,3}"
    r"(?:stairs|steps|staircase|stairway))(?P<rest>\b.*)$"
)
_TAIL = (
    r"(?P<rest>|,.*|\s(?:at|into|onto|in|and|through|toward|towards|to|before|after|when|once|past|"
    r"down|up|by|on|out|from|around|again|then|there|until|along|as|just|immediately|across|onto|"
    r"next|where|so|for|between|behind|under|over)\b.*)$"
)


def _pattern(text: str) -> re.Pattern[str]:
    return re.compile(text, re.IGNORECASE | re.DOTALL)


PATTERNS = {
    "around": _pattern(
        r"^(?:turn(?: all the way| completely)? (?:around|back the other way|back)|make a u-turn|"
        r"make a full turn and go back|make a turn and go back|turn 180 degrees|do a 180|"
        r"go back the other way)" + _TAIL.replace("to|", "").replace("into|", "")
    ),
    "turn": _pattern(
        r"^(?:turn|take|make|bear|veer|go|head|hang|walk|move)(?: your)?(?: an?)?"
        r"(?: (?P<how>slight|slightly|sharp|sharply|hard|immediate|quick))?"
        r"(?: turn)?(?: to)?(?: the| your)? (?P<side>left|right)(?: turn)?" + _TAIL
    ),
    "climb": _pattern(rf"^(?:{_WALK}|climb) up {_STAIRS}"),
    "descend": _pattern(rf"^(?:{_WALK}|climb) down {_STAIRS}"),
    "past": _pattern(rf"^(?:{_WALK} (?:right )?past|pass(?: by)?) (?P<rest>(?!through)\S.*)$"),
    "through_to": _pattern(rf"^{_WALK} through to (?P<rest>\S.*)$"),
    "through": _pattern(rf"^(?:{_WALK}|pass) through (?P<rest>(?!to\b)\S.*)$"),
    "enter": _pattern(rf"^(?:enter|{_WALK} (?:into|inside)) (?P<rest>(?!(?:and|to|then)\b)\S.*)$"),
    "exit_by": _pattern(
        rf"^(?:exit|leave|{_WALK} out|{_WALK} outside) (?P<by>through|via|from|by|onto|into|to|"
        r"towards?) (?P<rest>\S.*)$"
    ),
    "exit": _pattern(
        rf"^(?:exit|leave|{_WALK} out of) "
        r"(?P<rest>(?!(?:and|to|through|via|from|out|then|by|onto|into|towards?|at|on|in|when)\b)(?!.*\bout\b)\S.*)$"
    ),
    "ahead": _pattern(
        rf"^{_WALK} (?P<straight>straight ahead|straight forward|straight|forward|ahead)" + _TAIL
    ),
    "toward": _pattern(
        rf"^{_WALK} (?:over |all the way )?(?P<to>to|towards|toward) "
        r"(?P<rest>(?!your|the left|the right)\S.*)$"
    ),
    "along": _pattern(
        rf"^{_WALK} (?P<along>along|across|down|around|between|up|onto|over|beside|behind|under|"
        r"out|in) (?P<rest>\S.*)$"
    ),
    "stop": _pattern(r"^(?:stop|wait|halt|pause)(?: there| here)?(?P<rest>|[ ,].*)$"),
}


@dataclass(frozen=True)
class Voice:
    """The phrases of one style."""

    openers: list[str]  # phrases that can begin the instruction
    frames: dict[str, list[str]]  # phrases such as "Then {}", by position of the clause
    commands: dict[str, list[str]]  # templates that replace a clause, by its kind (PATTERNS)
    closers: list[str]  # phrases that can end the instruction
    nouns: dict[str, str]  # synonyms of nouns


def swap_nouns(text: str, nouns: dict[str, str]) -> str:
    """Replace nouns in ``text`` by the synonyms that a style uses."""
    names = sorted(nouns, key=len, reverse=True)
    return re.sub(rf"\b({'|'.join(names)})\b", lambda m: nouns[m.group()], text)


VOICES = {name: Voice(**entry) for name, entry in read_data("voices.json").items()}
