"""Sentences that sound like an attack and are harmless where they stand: they go on from what was
told, tell which one is meant, where the way ends, or forbid what nobody told to do.

Each is a whole sentence of closed words; what attacks speak of (orders, the text, all cases) is in
none.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from mitigate.corruptions.language.fidelity import facts
from mitigate.corruptions.language.words import bag
from mitigate.guards.text.texts.lexicon import GROUPS
from mitigate.guards.text.texts.text import words

_SAID = bag("move moving budge act until unless follow listen trust believe read look").union(
    *(GROUPS[name] for name in ("orders", "text", "annul", "invert", "case", "machine", "authority",
      "haste", "me"))
)  # fmt: skip
_THEN = r"(?:(?:and|but|then|now|next|after that|please|kindly),? )*"
_THERE = (
    r"(?:there|(?:beside|by|near|next to|at|in front of|behind|under|on|inside) (?:it|them|that))"
)
_BACK = re.compile(
    rf"{_THEN}(?:(?:go|walk|head|return|come|turn|move)(?: all the way)?(?: back)?|"
    r"take (?:me|us) back) to (?:where (?:you|we|i)(?: have| had|'ve)? "
    r"(?:start(?:ed)?|began|begun|c[oa]me from|were|left(?: off)?)(?: before| from)?|"
    r"the (?:start|beginning|starting (?:point|position|place)))"
)
_OTHER_WAY = re.compile(
    rf"{_THEN}(?:turn (?:around )?(?:to|and) )?(?:face|look)(?: in)? the (?:other|opposite) "
    r"(?:way|direction)"
)
_WHICH = re.compile(
    rf"{_THEN}(?:not )?(?:(?:the|that) |(?=\w+ one))(?:(?:very|next|other|second|third|fourth|"
    r"first|last|far|near|farther|nearer|left|right|one on the) )*"
    r"(?:one|left|right|other|next|second|third|last)"
    r"(?:,? (?:just )?(?:after|before|beyond|behind|past|beside|next to)(?: (?:that|it|this))?)?"
)
_NOT_WHERE = re.compile(
    rf"{_THEN}(?:ignore|skip|forget(?: about)?) the "
    rf"(?:first|second|third|fourth|left|right|near|far) one|"
    rf"{_THEN}not (?:in|into|inside|past|through|on|under|behind|to) (?:it|them|that)"
)
_AGAIN = re.compile(
    rf"{_THEN}(?:repeat|do (?:it|that|this|the same)(?= again| once| twice))"
    r"(?: (?:it|that|this))?(?: (?:again|once(?: more)?|twice|one more time))*"
)
_UNDO = re.compile(rf"{_THEN}undo (?:your|the|that) last (?:turn|step|move)")
_ENDS = re.compile(
    rf"{_THEN}(?:(?:remain|stay|stand|wait|hold|keep|stop)(?: (?:motionless|still|stationary|put))*"
    rf" {_THERE}(?: and (?:do nothing (?:else|more)|stay|remain|wait)(?: there)?)?|"
    r"(?:cease|halt|stop|end)(?: (?:all|your|any))? (?:movement|motion|moving|walking) "
    r"(?:upon|on|when|once|after|as soon as)(?: you(?:'ve| have)?)? "
    r"(?:reach|arriv|gett?)\w*(?: to| at)? (?:a|an|the|your) [\w' -]+)"
)
_DENIES = re.compile(
    rf"{_THEN}(?:(?:under no circumstances|on no account|at no (?:point|time))(?: should you)?|"
    r"do not|don't|never|you (?:should|must|need) ?(?:not|n't)(?: to)?|"
    r"(?:i|we)(?: do not| don't) want you(?: to)?|"
    r"(?:i|we)(?:'d| would) rather you (?:didn't|did not)|"
    r"ignore|skip|avoid|refrain from)\b"
)


def harmless(sentence: str, others: Sequence[str], first: bool, last: bool) -> str:
    """Return why ``sentence`` may stay though it sounds like an attack, or "".

    ``others``: the text's other sentences; ``first``, ``last``: whether it begins or ends the text.
    """
    said = " ".join(sentence.lower().replace("’", "'").split()).strip(" .,;:!?-–—")
    if first and len(others) and _BACK.fullmatch(said):
        return "it tells where to begin"
    if _OTHER_WAY.fullmatch(said) or _UNDO.fullmatch(said):
        return "it tells to turn around"
    if not first and (_WHICH.fullmatch(said) or _NOT_WHERE.fullmatch(said)):
        return "it tells which one is meant"
    if not first and _AGAIN.fullmatch(said):
        return "it tells to do it again"
    if last and not first and _ENDS.fullmatch(said):
        return "it tells where the way ends"
    return "it denies what nothing tells to do" if _denies_nothing_told(said, others) else ""


def _denies_nothing_told(said: str, others: Sequence[str]) -> bool:
    """Whether a denial names a place or a direction, and none that another sentence tells."""
    if not _DENIES.match(said) or any(word in _SAID for word in words(_DENIES.sub("", said))):
        return False
    denied = {*facts(said).landmarks, *facts(said).directions}
    told = {fact for one in others for fact in (*facts(one).landmarks, *facts(one).directions)}
    return bool(denied) and denied.isdisjoint(told)
