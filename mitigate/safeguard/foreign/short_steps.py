"""Short steps that name nothing: "Get in.", "Go back.", "Three more steps.", "Ride it to the second
floor." Each is a whole sentence of at most eight words, all of closed lists: what joins it to the
one before, what is done, and small words of where and how far.
"""

from __future__ import annotations

import re

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
_COUNTED = re.compile(
    r"(?:(?:just|only|about|another) )*"
    r"(?:an?|one|two|three|four|five|six|seven|eight|nine|ten|\d{1,2})"
    r"(?: (?:few|couple|couple of))?(?: (?:more|further|big|small|little))* "
    r"(?:steps?|paces?|met(?:er|re)s?|feet|foot)(?: (?:more|further|forward|ahead|up|down|back))*"
)
_SAID = re.compile(
    r"(?:up|down|in|out|over|across|through|back|around) (?:again|once more|there)|"
    r"(?:do|make|walk in) an? (?:full|complete) (?:circle|lap|loop)|"
    r"(?:stay|keep|remain) (?:on|to) (?:this|that|the|your) "
    r"(?:(?:same|left|right|first|second) )?"
    r"(?:floor|level|side|path|carpet|rug|landing|left|right)|"
    r"(?:press|push|hit)(?: the)?(?: button| number)?(?: for)?(?: floor)? (?:\d{1,2}|it|one)|"
    r"repeat (?:the )?steps? \d+(?: (?:to|and|through) \d+)?|pause (?:here|there)"
)


def short_step(sentence: str) -> bool:
    """Return whether a sentence is a short step, as small words tell it."""
    found = words(sentence)
    if len(found) > LONGEST:
        return False
    while found and found[0] in _JOINS:
        found = found[1:]
    said = " ".join(found)
    if _COUNTED.fullmatch(said) or _SAID.fullmatch(said):
        return True
    where = all(word in _WHERE or word.isdigit() for word in found[1:])
    return bool(found) and found[0] in _DOES and where


def goes_back(sentence: str) -> bool:
    """Return whether a short step undoes what was told before it, or has no end."""
    found = [word for word in words(sentence) if word not in _JOINS]
    return {*found[:2]} & {"back", "return", "keep"} != set()
