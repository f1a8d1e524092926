"""Short steps that name nothing: "Get in.", "Go back.", "Three more steps.", "Drive 10 m north.",
"Knock twice.", "Ride it to the second floor." Each is a whole sentence of at most eight words, all
of closed lists: what joins it to the one before, what is done, and small words of where and how
far.
"""

from __future__ import annotations

import re
from itertools import dropwhile

from mitigate.corruptions.language.words import bag
from mitigate.guards.text.texts.text import words

LONGEST = 8  # words (ours)
_JOINS = bag("and now then here so next finally first again please kindly just")
_DOES = bag(
    "go come get step walk move hop pop run head climb back circle ride return turn push pull "
    "press face take cross follow continue proceed keep"
)
_WHERE = bag(
    """
    in out on off up down back around round across through over past under inside outside indoors
    outdoors aside closer nearer further farther forward ahead upstairs downstairs left right again
    open twice once it them there to a an the this that of little bit few couple more some step
    steps pace paces meter meters metre metres foot feet full complete first second third fourth
    fifth next last top bottom end floor level circle lap going walking straight way with
    one two three four five six seven eight nine ten
    """
)
_GO = (
    r"(?:go|walk|move|step|proceed|advance|travel|continue|drive|roll|ride|run|jog|head|take|turn|"
    r"rotate|back|bear|veer|face|facing|(?:keep|continue) (?:going|walking|moving|heading))"
)
_QUARTER = r"(?:(?:north|south)(?: ?(?:east|west))?|east|west)(?:wards?)?"
_TO = (
    rf" (?:forwards?|backwards?|ahead|straight|on|more|further|up|down|back|left|right|"
    rf"(?:(?:to|towards?|due)(?: the)? )?{_QUARTER})"
)
_NUMBER = (
    r"(?:an?|one|two|three|four|five|six|seven|eight|nine|ten|eleven|twelve|twenty|thirty|forty|"
    r"fifty|sixty|ninety|half an?|\d{1,3}(?: \d{1,2})?)"
)
_COUNTED = re.compile(
    rf"(?P<moves>{_GO}(?:{_TO})* )?(?:(?:for|just|only|about|another|around|roughly|exactly) )*"
    rf"(?P<far>(?P<number>{_NUMBER})"
    r"(?: (?:few|couple|couple of))?(?: (?:more|further|big|small|little))* "
    r"(?P<unit>steps?|paces?|met(?:er|re)s?|m|cm|feet|foot|ft|yards?|inch(?:es)?|degrees?))"
    rf"(?:{_TO})*"
)
_HEADS = re.compile(rf"(?P<moves>{_GO})(?:{_TO})*?(?P<far> (?:(?:to|towards?|due)(?: the)? )?"
                    rf"{_QUARTER})(?:{_TO})*")  # fmt: skip
# metres that a route's step has at most (R2R's whole paths have below 30), and of each unit, by the
# first letters of its name; of what is round, any (ours)
FARTHEST = 50
_METRES = {"m": 1.0, "cm": 0.01, "f": 0.3, "y": 0.9, "i": 0.025, "p": 0.7, "s": 0.7, "d": 0.0}
_LARGE = {"sixty": 60, "ninety": 90}
_AND = re.compile(r"[,;]|\b(?:and|then)\b", re.IGNORECASE)
_BACK = bag("back backward backwards 360")
_ON = re.compile(  # on and on, without an end
    r"carry on|(?:keep|continue) following (?:it|them)|"
    r"(?:go|walk|follow)(?: it)? wherever the (?:[a-z]+ )?(?:lines?|tapes?|arrows?|paths?|"
    r"carpet|rug|tiles|hall|hallway|corridor) (?:goes|go|leads?)"
)
_SAID = re.compile(
    r"(?:up|down|in|out|over|across|through|back|around) (?:again|once more|there)|"
    r"(?:do|make|walk in) an? (?:full|complete) (?:circle|lap|loop)|"
    r"(?:stay|keep|remain) (?:on|to) (?:this|that|the|your) "
    r"(?:(?:same|left|right|first|second) )?"
    r"(?:floor|level|side|path|carpet|rug|landing|left|right)|"
    r"(?:press|push|hit)(?: the)?(?: button| number)?(?: for)?(?: floor)? (?:\d{1,2}|it|one)|"
    r"repeat (?:the )?steps? \d+(?: (?:to|and|through) \d+)?|pause (?:here|there)|"
    r"(?:open|close|shut|push|pull)(?: open)? (?:it|them|the door)(?: open)?"
    r"(?: (?:again|behind you|after you))?|"
    r"(?:press|push|hit|ring)(?: on)? (?:it|the (?:button|bell|doorbell))(?: (?:once|twice))?|"
    r"(?:knock|ring)(?: on it)?(?: once| twice| (?:two|three|\d) times)?|"
    r"look (?:around|back|left|right|behind you)|"
    r"(?:wait|pause) (?:for )?(?:an?|one|two|three|four|five|six|seven|eight|nine|ten|\d{1,2}|"
    r"a few|a couple of) (?:seconds?|moments?)"
)


def short_step(sentence: str) -> bool:
    """Return whether a sentence is a short step, as small words tell it."""
    found = _told(sentence)
    if len(words(sentence)) > LONGEST:
        return False
    said = " ".join(found)
    if tells_how_far(sentence) or _SAID.fullmatch(said) or _ON.fullmatch(said):
        return True
    where = all(word in _WHERE or word.isdigit() for word in found[1:])
    return bool(found) and found[0] in _DOES and where


def tells_how_far(sentence: str) -> bool:
    """Return whether a sentence tells how far to go and no more, and not too far for a step."""
    return _counted(sentence) is not None


def way_told(sentence: str) -> list[str]:
    """Return how far and into which quarter a sentence tells one to go ("10 m", "north"), if it
    begins with a motion, tells no more, and does not go back."""
    told: list[str] = []
    for part in filter(str.strip, _AND.split(sentence)):
        match = _counted(part) or _HEADS.fullmatch(" ".join(_told(part)))
        if match is None or not (told or match["moves"]):
            return []
        told.append(match["far"].strip())
    return [] if goes_back(sentence) else told


def goes_on(sentence: str) -> bool:
    """Return whether a sentence moves one and names nothing that one moves to."""
    return bool(way_told(sentence)) or _ON.fullmatch(" ".join(_told(sentence))) is not None


def _counted(sentence: str) -> re.Match[str] | None:
    """Return the match of a sentence that tells how far to go, if that is no farther than
    ``FARTHEST``."""
    match = _COUNTED.fullmatch(" ".join(_told(sentence)))
    if match is None:
        return None
    number, unit = match["number"].split()[0], match["unit"]
    count = int(number) if number.isdigit() else _LARGE.get(number, 1)
    return match if count * _METRES["cm" if unit == "cm" else unit[0]] <= FARTHEST else None


def _told(sentence: str) -> list[str]:
    """Return the words of a sentence behind those that join it to the one before."""
    return list(dropwhile(_JOINS.__contains__, words(sentence)))


def goes_back(sentence: str) -> bool:
    """Return whether a short step undoes what was told before it, leads round to where it began,
    or has no end."""
    found = [word for word in words(sentence) if word not in _JOINS]
    if {*found[:2]} & {"back", "return", "keep"}:
        return True
    return tells_how_far(sentence) and not _BACK.isdisjoint(found)
