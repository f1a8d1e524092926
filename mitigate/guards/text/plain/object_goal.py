"""Requests for one thing, in plain words: "Hey, could you find me a chair? Thanks!" is "Look for a
chair.".

A text is such a request only if each of its words is known to say nothing of the way, but for one
thing and what it is like, which stay as they were heard. Whatever else is told (a turn, a second
thing, where it stands, a denial, a number) leaves the text as it is.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise

from mitigate.corruptions.language.fidelity import facts
from mitigate.corruptions.language.tagger import Token, tag
from mitigate.corruptions.language.words import bag
from mitigate.guards.text.fidelity import gate
from mitigate.guards.text.fidelity.goal_words import (
    ACTS,
    KNOWN,
    MANNERED,
    PLAIN_SAYINGS,
    SAYINGS,
    STAYS,
    TELLS_NOTHING,
    VERBS,
)
from mitigate.guards.text.fidelity.meaning import CATEGORIES
from mitigate.guards.text.texts.steps import HALTS, MOVES, SEEKS
from mitigate.guards.text.texts.text import words

LONGEST = 5  # words of a thing and what it is like ("a small round wooden side table")
_MASK = "[mask]"
_BESIDE_IT = re.compile(
    r"\b(?:(?:right|directly|just|close) )?(?:beside|next to|near|by|in front of|before|"
    r"close to|adjacent to|facing|opposite) it\b"
)
_DETERMINERS = bag(
    """
    a an the my your our his her any some this that those these another one
    """
)
_BEFORE = bag(
    """
    to for at by near towards toward upon me us out up over track find need want is are
    """
)
_ONLY = bag("first last only next same other")
_NOUNS_BEHIND = HALTS | bag(
    "unit area station object item items objects position place space sweep"
)
_SOUGHT = SEEKS | bag("locating need needs want wants require get see where")
# what is done to a thing, or in a room, if nothing stands between ("move the chair", "search the
# bedroom"), and is neither to go there nor to look for it
_DOES_TO = (MOVES - bag("get gets getting")) | bag("search searching sweep scan explore survey")
_ASKS_FOR = _DETERMINERS | _BEFORE | VERBS | {_MASK, ":"}  # may stand before a thing
# who tells of an order and does not give it: "So, you find a bed."
_YOU = re.compile(
    r"(?:^|[.!?,:] )(?:(?:so|now|and|then),? )*you (?:\w+ly |just )?(?!are\b|can\b)\w+"
)
# what is told beside a thing: denials, conditions, where it stands, what is over or begins there
_TELLS = re.compile(
    r"\b(?:not|no|never|n't|without|except|instead|avoid|ignore|unless|if|\w+n't|look(?:ing)? at|"
    r"(?:in|on|over|up|down|out|off|along|with|within|away|around|about|of|as|like|than|till|"
    r"until|before|after|when|while|once|where|or|but) (?:it|them|that|the|an?|this|these|those|my|"
    r"your|our|his|her|any|some|another)|"
    r"(?:until|till|before|after|when|while|once|if) (?:i|we|he|she|they|someone|told|further)|"
    r"(?:that|which) (?:is|are|stands?|lies)|"
    r"(?:stop|cease|quit|finish|done|terminate|end)s? \w+ing|(?:is|are) over|and back|"
    r"(?:let|tell) (?:me|us)(?: know)? (?:when|once|if|as soon as)|"
    r"(?:has|have|had) been|was|were|(?:start|begin)\w* (?:at|near))\b"
    r"|[\"“”()<>{}\[\]/\\|=#*`]"
)


def object_goal(heard: str, restyled: bool = False) -> str | None:
    """Return ``heard`` in plain words, if it asks for one thing and tells nothing else; else None.

    "Look for a chair." or "Go to the chair.", and where to stop if that is told ("and stop next to
    it."); the thing, what it is like and its determiner are as they were heard. None also for what
    is shorter already, and for what is plain: that holds no mask and no word of a manner, unless
    some went before (``restyled``).
    """
    text = heard.lower().replace("’", "'")
    if len(text) != len(heard):
        return None
    stops = "stop" in facts(heard).directions or bool(STAYS.search(text))
    mannered = restyled or _MASK in text or bool(SAYINGS.search(text) or _YOU.search(text))
    for sayings in (SAYINGS, PLAIN_SAYINGS):
        text = sayings.sub(lambda saying: " " * len(saying.group()), text)
    if _TELLS.search(text.replace(_MASK, " ")) or gate.route_turns(heard):
        return None
    found = tag(text)
    things = _things(found)
    mannered = mannered or any(token.lower in MANNERED for token in found)
    if not mannered or not things or not any(token.lower in VERBS for token in found):
        return None
    named = [[token.lower for token in found[thing.start : thing.stop]] for thing in things]
    longest = max(range(len(things)), key=lambda n: len(named[n]))
    if any(named[longest][-len(name) :] != name for name in named):
        return None
    thing = things[longest]
    if _acts(found[thing.stop :]):
        return None  # something else is to be done then
    asked = heard[found[thing.start].start : found[thing.stop - 1].end]
    before = _before(found, thing.start)
    seeks = SEEKS if stops else _SOUGHT  # "you need to go to the bed and stop" seeks nothing
    if any(token.lower in seeks for token in found):
        given = f"Look for {before if before in _DETERMINERS else _article(asked)} {asked}"
    else:
        given = f"Go to {before if before in _DETERMINERS else 'the'} {asked}"
    given += f" and stop{_where(heard[found[thing.stop - 1].end :])}." if stops else "."
    shorter = _MASK not in text and len(words(given)) > len(words(heard))
    if shorter or gate.result_refused(heard, given):
        return None
    return given


def _acts(behind: Sequence[Token]) -> bool:
    """Return whether something is told to be done but to seek or stop ("and bring it to me")."""
    told = [token.lower for token in behind if token.is_word] + [""]
    return any(one in ACTS and other not in SEEKS | {"for"} for one, other in pairwise(told))


def _where(behind: str) -> str:
    """Return where one is told to stop, as heard ("next to it"), with a space before it."""
    told = _BESIDE_IT.search(behind.lower())
    return f" {told.group()}" if told else ""


def _things(found: Sequence[Token]) -> list[range]:
    """Return the places of what is named; none if something else is told."""
    other = [p for p, t in enumerate(found) if _is_told(t)]
    runs: list[range] = []
    for place in other:
        if runs and runs[-1].stop == place:
            runs[-1] = range(runs[-1].start, place + 1)
        else:
            runs.append(range(place, place + 1))
    return runs if all(_is_thing(found, run) for run in runs) else []


def _is_told(token: Token) -> bool:
    return token.is_word and token.lower not in KNOWN


def _is_thing(found: Sequence[Token], run: range) -> bool:
    """Return whether the words at ``run`` can be a thing and what it is like, asked for as one."""
    last = found[run[-1]]
    thing = last.tag in ("NOUN", "PROPN") or last.lower in CATEGORIES
    if not thing or len(run) > LONGEST or any(found[p].tag == "NUM" for p in run):
        return False
    if run.stop < len(found) and found[run.stop].lower in _NOUNS_BEHIND:
        return False
    return _before(found, run.start) in _ASKS_FOR and not _done_to(found, run.start)


def _done_to(found: Sequence[Token], place: int) -> bool:
    """Return whether a verb takes the thing at ``place`` itself, with no more between than what it
    is of ("take the shorter")."""
    told = [token.lower for token in found[:place] if token.is_word and token.lower != _MASK]
    while told and (told[-1] in _DETERMINERS or told[-1] in TELLS_NOTHING):
        told.pop()
    return bool(told) and told[-1] in _DOES_TO


def _before(found: Sequence[Token], place: int) -> str:
    """Return the word before ``place``, but for those that tell nothing of a thing; "" for none."""
    before = (token.lower for token in reversed(found[:place]))
    return next((word for word in before if word not in TELLS_NOTHING), "")


def _article(thing: str) -> str:
    first = thing.split()[0].lower()
    if first in _ONLY or (first.endswith("est") and len(first) > 5):  # "nearest", not "chest"
        return "the"
    return "an" if first[0] in "aeiou" else "a"
