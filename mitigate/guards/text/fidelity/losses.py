"""What a text that was made by taking words out of another does not tell any more, fact by fact."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable

from mitigate.corruptions.language.directions import MOTION
from mitigate.corruptions.language.fidelity import ATTRIBUTES, facts
from mitigate.corruptions.language.landmarks import normal
from mitigate.corruptions.language.tagger import tag
from mitigate.corruptions.language.words import bag
from mitigate.guards.text.fidelity.meaning import Meaning, meaning, missing, moved
from mitigate.guards.text.texts.plain_words import plain_form
from mitigate.guards.text.texts.steps import steps

# words by which one may mean to stop without saying so
_ENDS = bag(
    "remain remains rest rests hold await destination goal target arrive arrives arrived reached "
    "concluded halt stand stay stays park"
)
_STEP = re.compile(
    rf"\b(?:{'|'.join(sorted(MOTION))}|step|get)\b(?: \w+){{0,2}} (?:in|out|through|inside|outside|"
    r"across|past|between|behind|over|under|around|round|back|beyond|along|off|up|down)\b"
    r"|\b(?:gone|went|walked|go) too far\b"
    r"|\b(?:past|behind|through|into|under|around|between|beside|across|over|along|before|beyond) "
    r"(?:it|them|that|those|this|there)\b"
)
# where one is to keep to, and the words behind which that is said of a place
_KEEPS = re.compile(
    r"\b(?:stay|remain|keep)(?:ing)? (?P<at>on|in|near|within|by|inside|along|close to|next to) "
    r"(?:(?:the|this|that|your|a|an) )?(?:(?:same|left|right) )?(?P<place>\w+)"
)
_KEPT = (
    r"\b(?:stay|remain|keep|stop|wait|stand|halt|go|walk|continue|proceed|move|head|follow)"
    r"(?:ing)? "
)
_NOT_WHOLLY = re.compile(
    r"\bnot (?:all|the whole) (?:the )?(?:way|length)\b|\b(?:half|part) ?way\b"
)


def unproven(heard: str, said: str, aside: Iterable[str]) -> str:
    """Return a fact of ``heard`` that is not in ``said``, or one of ``said`` that was not heard; ""
    if there is none.

    A turn, a climb, a stop, a denial, how sharp a turn is and which way one goes by a thing that
    stays must be in both. Things, numbers, colours and other attributes may go with the words that
    are ``aside``: in lower case, those that surely tell nothing of the way.
    """
    old, new = meaning(heard), meaning(said)
    gone = set(aside)
    problem = _turns(old, new) or _read(heard, said) or _counted(old, new, gone)
    if problem:
        return problem
    if _NOT_WHOLLY.search(heard.lower()) and not _NOT_WHOLLY.search(said.lower()):
        return "how far one goes lost"
    for kept in _KEEPS.finditer(heard.lower()):
        stays = re.search(rf"\b{kept['place']}\b", said.lower())
        if stays and not re.search(rf"{_KEPT}{kept['at']}\b", said.lower()):
            return f"where one stays lost: {kept.group()}"
    if not said:
        if step := _STEP.search(heard.lower()):
            return f"a step lost: {step.group()}"
        found = tag(heard)
        for told in steps(found):
            return f"a step lost: {' '.join(t.lower for t in found[told.first : told.last + 1])}"
    named = {normal(plain_form(word)) for word in gone}
    for name in missing(old, new, speech=True):
        if name not in named:
            return f"landmark lost: {name}"
    for name, way in old.ways.items():
        if way and name in new.ways and not new.ways[name]:
            return f"way lost: {', '.join(sorted(way))} {name}"
    added = next(iter(missing(new, old, every=True)), "")
    return f"landmark invented: {added}" if added else moved(old, new)


def _turns(old: Meaning, new: Meaning) -> str:
    before, after = (Counter([d for d, _ in m.turns] + list(m.levels)) for m in (old, new))
    for name, count in (after - before).items():
        if name != "stop" or not before["stop"] and not old.words & _ENDS:
            return f"directions: {count} {name} more"
    for name, count in (before - after).items():
        if name != "stop" or not after["stop"]:
            return f"directions: {count} {name} less"
    if old.sharpness != new.sharpness:
        return "sharpness changed"
    if bool(old.denied) != bool(new.denied):  # what is left may be the contrary
        return f"denials: {old.denied} -> {new.denied}"
    return ""


def _read(heard: str, said: str) -> str:
    """Return a turn that ``said`` has for who reads it word by word, or that one goes straight on
    or turns around in ``heard`` alone; "" if there is none."""
    before, after = (
        Counter(d for d in facts(text).directions if d != "stop") for text in (heard, said)
    )
    if after - before:
        return f"directions: {', '.join(after - before)} more"
    for name in ("straight", "around"):
        if before[name] and not after[name]:
            return f"directions: {name} less"
    return ""


def _counted(old: Meaning, new: Meaning, gone: set[str]) -> str:
    known = {plain_form(word) for word in gone} | gone
    counted = [(kind, getattr(old, kind), getattr(new, kind)) for kind in ("numbers", "colours",
        "compass")]  # fmt: skip
    counted.append(("attributes", old.words & ATTRIBUTES, new.words & ATTRIBUTES))
    for kind, before, after in counted:
        if added := set(after) - set(before):
            return f"{kind}: {', '.join(sorted(added))} more"
        if lost := set(before) - set(after) - known:
            return f"{kind}: {', '.join(sorted(lost))} less"
    return ""
