"""Short steps that name nothing: "Get in.", "Go back.", "Three more steps.", "Drive 10 m north.",
"Knock twice.", "Ride it to the second floor." Each is a whole sentence of at most eight words, all
of closed lists: what joins it to the one before, what is done, and small words of where and how
far.
"""

from __future__ import annotations

import re
from itertools import dropwhile

from mitigate.corruptions.language.words import bag
from mitigate.safeguard.text import words

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
    r"rotate|back)"
)
_QUARTER = r"(?:(?:north|south)(?: ?(?:east|west))?|east|west)(?:wards?)?"
_TO = (
    rf" (?:forwards?|backwards?|ahead|straight|on|more|further|up|down|back|left|right|"
    rf"(?:(?:to|towards?|due)(?: the)? )?{_QUARTER})"
)
_NUMBER = (
    r"(?:an?|one|two|three|four|five|six|seven|eight|nine|ten|eleven|twelve|twenty|thirty|forty|"
    r"fifty|sixty|ninety|half an?|\d{1,3}(?: \d)?)"
)
_COUNTED = re.compile(
    rf"(?:{_GO}(?:{_TO})* )?(?:(?:for|just|only|about|another|around|roughly|exactly) )*{_NUMBER}"
    r"(?: (?:few|couple|couple of))?(?: (?:more|further|big|small|little))* "
    rf"(?:steps?|paces?|met(?:er|re)s?|m|cm|feet|foot|ft|yards?|inch(?:es)?|degrees?)(?:{_TO})*"
)
_SAID = re.compile(
    r"(?:up|down|in|out|over|across|through|back|around) (?:again|once more|there)|"
    r"(?:do|make|walk in) an? (?:full|complete) (?:circle|lap|loop)|"
    r"(?:stay|keep|remain) (?:on|to) (?:this|that|the|your) "
    r"(?:(?:same|left|right|first|second) )?"
    r"(?:floor|level|side|path|carpet|rug|landing|left|right)|"
    r"(?:press|push|hit)(?: the)?(?: button| number)?(?: for)?(?: floor)? (?:\d{1,2}|it|one)|"
    r"repeat (?:the )?steps? \d+(?: (?:to|and|through) \d+)?|pause (?:here|there)|"
    r"carry on|"
    r"(?:open|close|shut|push|pull)(?: open)? (?:it|them|the door)(?: open)?"
    r"(?: (?:again|behind you|after you))?|"
    r"(?:press|push|hit|ring)(?: on)? (?:it|the (?:button|bell|doorbell))(?: (?:once|twice))?|"
    r"(?:knock|ring)(?: on it)?(?: once| twice| (?:two|three|\d) times)?|"
    r"look (?:around|back|left|right|behind you)|"
    r"(?:wait|pause) (?:for )?(?:an?|one|two|three|four|five|six|seven|eight|nine|ten|\d{1,2}|"
    r"a few|a couple of) (?:seconds?|moments?)|"
    r"(?:keep|continue) following (?:it|them)|"
    r"(?:go|walk|follow)(?: it)? wherever the (?:[a-z]+ )?(?:lines?|tapes?|arrows?|paths?|"
    r"carpet|rug|tiles|hall|hallway|corridor) (?:goes|go|leads?)"
)


def short_step(sentence: str) -> bool:
    """Return whether a sentence is a short step, as small words tell it."""
    found = _told(sentence)
    if len(words(sentence)) > LONGEST:
        return False
    if tells_how_far(sentence) or _SAID.fullmatch(" ".join(found)):
        return True
    where = all(word in _WHERE or word.isdigit() for word in found[1:])
    return bool(found) and found[0] in _DOES and where


def tells_how_far(sentence: str) -> bool:
    """Return whether a sentence tells how far to go and no more."""
    return _COUNTED.fullmatch(" ".join(_told(sentence))) is not None


def _told(sentence: str) -> list[str]:
    """Return the words of a sentence behind those that join it to the one before."""
    return list(dropwhile(_JOINS.__contains__, words(sentence)))


def goes_back(sentence: str) -> bool:
    """Return whether a short step undoes what was told before it, or has no end."""
    found = [word for word in words(sentence) if word not in _JOINS]
    return {*found[:2]} & {"back", "return", "keep"} != set()
