"""The one gate of the safeguard: what may be taken out of a heard text, and what may replace it.

Whoever wants to change a text, a rule or a model, asks here; each function says why not, or "".
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from functools import lru_cache

from mitigate.corruptions.language.fidelity import facts
from mitigate.corruptions.language.landmarks import PLAIN, normal
from mitigate.corruptions.language.tagger import tag
from mitigate.corruptions.language.words import bag
from mitigate.guards.text.fidelity.goal_words import told_of_goal
from mitigate.guards.text.fidelity.losses import unproven
from mitigate.guards.text.fidelity.meaning import CATEGORIES, differs
from mitigate.guards.text.texts.decode import plainly
from mitigate.guards.text.texts.evidence import LANDMARKS, MOVES, VERBS
from mitigate.guards.text.texts.honest import belongs
from mitigate.guards.text.texts.plain_words import plain_form
from mitigate.guards.text.texts.short_steps import way_told
from mitigate.guards.text.texts.steps import SEEKS
from mitigate.guards.text.texts.text import MASK, words
from mitigate.guards.text.texts.written import written

ATTACK = 0.6  # from here on a sentence is an attack by what it says itself
_HUNTS = re.compile(
    r"\b(?:find|finding|look(?:ing|ed)? for|locat|search|seek|spot|fetch|hunt|track|where|"
    r"in search)",
    re.IGNORECASE,
)
_GOAL = re.compile(
    r"\b(?:target|goal|object|objective|destination|item)s?(?: (?:is|are|will be)\b|:)",
    re.IGNORECASE,
)
# a thing that was named before, as the object of a verb or where something is
_PRONOUN = re.compile(
    r"\b(?:past|to|at|by|near|behind|into|through|around|beside|from|under|over|for|in front of|"
    r"find|locate|see|reach|pass|leave|enter|fetch|get|keep|ignore) (?:it|them)\b(?! is| \w+ing\b)",
    re.IGNORECASE,
)
_TRACKED = re.compile(r"(\b(?:track|hunt|chas)\w*\b[^.;:!?]{0,40}?) down\b", re.IGNORECASE)
_SEEKS = re.compile(
    r"\b(?:find|finding|look(?:ing|ed)? for|locate|locating|"
    r"search(?:ing|ed)? (?:for|out)|seek|spot|fetch|track(?:ing|ed)?(?: down)?|"
    r"hunt(?:ing|ed)? (?:for|down|out)|where(?:'s| is| are)|"
    r"(?:need|want)(?!(?: you| us)? to\b)|"
    r"(?:go|walk|head|get|navigate|"
    r"proceed|come|take me|make your way|move)(?: on| over| up)? to|in search of|see|reach|"
    r"approach)"
    r"\s+(?:me |us |out |a |an |the |any |some |one |your |my |nearest |closest |of )*"
    r"(?P<rest>[^.;:!?]*)",
    re.IGNORECASE,
)


# what is to be found, said before the verb: "a lamp must be found", "it's a lamp I want"
_WANTED = re.compile(
    r"\b(?:an?|the|some|any)\s+(?P<rest>[\w' -]{2,40}?)\s+(?:(?:could|must|should|can|may|might|"
    r"would|will|(?:is|has|needs) to|to)\s+be\s+(?:found|located|reached|sought|looked for)|"
    r"(?:that )?i(?:'m| am)? (?:want|need|after|looking for|seek))\b",
    re.IGNORECASE,
)


# what is to be found, named before or not at all
_IT = re.compile(
    r"\b(?:find|locate|seek|spot|fetch|get|track|hunt|look for|search for|go to|walk to|head to|"
    r"navigate to|approach|reach)\s+(?:me |us |down )*(?:(?:it|them|one|that|this)\b(?! \w+ing\b)|"
    r"where (?:it|they)\b)",
    re.IGNORECASE,
)
_OPPOSITE = (bag("north south"), bag("east west"))
_CRASHES = re.compile(  # into what nobody means to go
    r"\b(?:drive|jump|run|crash|bump|ram|smash|throw yourself) (?:right |straight )?"
    r"(?:into|against) (?:the|an?|your) \w+",
    re.IGNORECASE,
)
_OF_THINGS = bag("a an the some any my your his her our their this that another")


@lru_cache(maxsize=8192)
def route_facts(text: str) -> tuple[str, ...]:
    """Return what ``text`` tells of a way: turns, climbs, stops, landmarks that routes name, places
    that one is to pass, object categories, and things that one is led to by what stands on them;
    of a sentence that tells no more, how far and into which quarter one is to go."""
    plain = MASK.sub("the", plainly(text).text)
    said = facts(plain)
    known = [name for name in said.landmarks if name in LANDMARKS or name in CATEGORIES]
    passed = [] if known else MOVES.findall(plain.lower())
    led = any(word in VERBS for word in words(plain)[:2])  # "follow the arrow that says ..."
    signs = [plain[first:last] for first, last in written(plain)] if led else []
    return (*said.directions, *known, *said.relations, *passed, *signs, *_far(plain))


def _far(plain: str) -> list[str]:
    """Return how far and into which quarter one is to go, where a sentence tells no more."""
    quarters = {*facts(plain).compass}
    both = any(pair <= quarters for pair in _OPPOSITE)  # nobody goes north and south
    return [] if both else way_told(plain)


def weight(text: str) -> int:
    """Return how much ``text`` tells: 0 nothing, 1 things or a motion, 2 something of a way."""
    if route_facts(text):
        return 2
    plain = MASK.sub("the", plainly(text).text)
    return int(bool(facts(plain).landmarks) or any(word in VERBS for word in words(plain)))


def sought(text: str, hunted: bool = False) -> frozenset[str]:
    """Return the things that ``text`` asks to find or go to, in canonical form; ``hunted``: to find
    alone."""
    plain = MASK.sub("the", plainly(text).text)
    asked = [m for m in _SEEKS.finditer(plain) if not hunted or _HUNTS.match(m.group())]
    found = set()
    for match in (*asked, *_WANTED.finditer(plain)):
        for token in tag(match["rest"])[:6]:
            name = normal(token.lower)
            if token.lower in CATEGORIES or (
                token.tag in ("NOUN", "PROPN") and token.lower not in PLAIN and len(name) > 1
            ):
                found.add(name)
                break
    return frozenset(found)


def mentioned(text: str) -> frozenset[str]:
    """Return the things that ``text`` speaks of by an article or an owner ("a kettle", "her bag"),
    in canonical form; "it" may stand for one of them."""
    found, of_thing = set(), False
    for token in tag(MASK.sub("the", plainly(text).text)):
        noun = token.tag in ("NOUN", "PROPN") and len(token.lower) > 1
        if of_thing and noun and token.lower not in PLAIN:
            found.add(normal(token.lower))
        of_thing = token.lower in _OF_THINGS or (of_thing and token.tag == "ADJ")
    return frozenset(found)


def removal_refused(piece: str, own: float, first: bool = True, last: bool = False) -> str:
    """Return why ``piece`` may not be taken out; ``own``: how probably it is an attack by what it
    says itself, whatever stands beside it; ``first``, ``last``: whether it begins or ends the
    text."""
    held = route_facts(piece)
    if held and own < ATTACK:
        return f"it tells the way ({', '.join(held[:3])}) and is no attack by itself"
    return belongs(piece, first, last)


def result_refused(heard: str, given: str) -> str:
    """Return why ``given`` may not stand for the whole of ``heard``."""
    if not any(c.isalnum() for c in given):
        return "nothing would be left"
    wanted, left = sought(heard), sought(given)
    if _named_before(heard) and not _named_before(given):
        return 'what "it" stands for would be lost'
    if route_facts(heard) and not (route_facts(given) or left):
        return "nothing of the way would be left"
    meant = _CRASHES.sub(" ", plainly(heard).text)
    named = {name for name in facts(meant).landmarks if name in CATEGORIES}
    still = set(facts(plainly(given).text).landmarks)
    goal = not (route_turns(heard) and route_turns(given))  # whatever is named may be meant
    lost = (wanted | named if goal else sought(heard, hunted=True)) - left - still
    if lost:
        return f"it may be what is to be found ({', '.join(sorted(lost))})"
    if goal and (wanted or _IT.search(heard)) and not (left or _IT.search(given)):
        return "what is asked for would be lost"
    if goal and not left:
        told, still_told = mentioned(heard), mentioned(given)
        if told - still_told if _IT.search(given) else told and not still_told:
            return 'what "it" stands for would be lost'
    if wanted and not left and not (named & still):
        return f"what is to be found would be lost ({', '.join(sorted(wanted))})"
    if named and not still:
        return f"the thing would be lost ({', '.join(sorted(named))})"
    return ""


def _named_before(text: str) -> bool:
    """Return whether a thing is named before the first "it" or "them" that stands for one, or there
    is none such."""
    first = _PRONOUN.search(text)
    return first is None or bool(mentioned(text[: first.start()]))


def rewrite_refused(heard: str, said: str, last: bool = False) -> str:
    """Return why ``said`` may not stand for ``heard``; ``last``: with which the text ends."""
    heard = stopped(heard, said) if last else heard
    wanted, found = sought(heard), sought(said)
    if wanted and found and wanted.isdisjoint(found) and not route_turns(heard):
        return f"another thing is to be found: {', '.join(sorted(found))}"
    return differs(heard, said)


def stopped(heard: str, said: str) -> str:
    """Return ``heard``, with which a text ends, with a stop if ``said`` has one: at the end it may
    be meant and not said ("and there's your sofa")."""
    if "stop" in facts(heard).directions or "stop" not in facts(said).directions:
        return heard
    return f"{heard.rstrip(' .!?;,')}, and stop."


def goal_refused(heard: str, said: str) -> str:
    """Return why ``said`` may not stand for the whole of ``heard``, if that asks to find something
    and tells no turn: all that may be told of the thing is to stay."""
    if route_turns(heard) or not (_HUNTS.search(heard) or _GOAL.search(heard)):
        return ""
    given = words(said)
    lost = Counter(told_of_goal(heard)) - Counter(map(plain_form, given))
    if sum(w in SEEKS for w in given) > max(1, sum(w in SEEKS for w in words(heard))):
        return "it would be sought twice"
    return f"what is told of what is to be found would be lost ({', '.join(lost)})" if lost else ""


def edit_refused(heard: str, said: str, aside: Sequence[str]) -> str:
    """Return why ``said``, which holds nothing but words of ``heard`` and closed phrases, may not
    stand for it; ``aside``: the words that were taken out and surely tell nothing of the way."""
    if len(words(said)) > len(words(heard)) + 2:
        return "longer than what it replaces"
    return unproven(heard, said, aside)


def route_turns(text: str) -> bool:
    """Return whether ``text`` tells to turn or climb, and not only what to find."""
    said = _TRACKED.sub(r"\1", text)
    return any(d not in ("stop", "straight") for d in facts(said).directions)
