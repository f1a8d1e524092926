"""What honest routes say in words that attacks use, too: what a place is, to stay at the end, to
turn around, to keep to a room. Each is a whole sentence, or a whole part of one, of closed words
around a place, and holds nothing about orders, the text, the agent or all cases.
"""

from __future__ import annotations

import re

from mitigate.corruptions.language.fidelity import ATTRIBUTES
from mitigate.corruptions.language.words import bag
from mitigate.guards.text.texts.evidence import VERBS
from mitigate.guards.text.texts.lexicon import GROUPS, places
from mitigate.guards.text.texts.short_steps import goes_back, short_step, tells_how_far
from mitigate.guards.text.texts.text import words
from mitigate.guards.text.texts.written import without_written

_ATTACKS = frozenset().union(
    *(GROUPS[name] for name in ("orders", "text", "annul", "invert", "case", "machine", "authority",
      "haste", "not", "me", "past", "time"))
) | bag("so because but if who that unless than though")  # fmt: skip
_ALSO = (
    r"(?:(?:and|now|then|here|so|once (?:there|inside)|(?:up)?on (?:arrival|arriving)|thereafter|"
    r"subsequently|please|kindly|finally|next|first|to (?:finish|end|conclude)(?: off| up)?|"
    r"(?:(?:up)?on|when|once|after)(?: you(?:'ve| have)?)? (?:reach|arriv|gett?)(?:ing|ed?)?"
    r"(?: (?:at|to))? (?:it|there|that|(?:the|your) [\w-]+(?: of the [\w-]+)?)|"
    r"you(?:'ll| can| may| should| could| must| will)),? )*"
)
_A = r"(?:a|an|the|your|another|one|what)"
_AT = r"(?:in|at|on|inside|into|near|by|to)"
_OF_PLACE = rf"(?P<place>(?:{_AT} )?{_A} .+|room (?:no\.? ?)?\d+.*)"
_WILL = r"(?:(?:'s|'ll|'re|'ve| will| should| would| is| are| have| has| can| now| then| also) ?)*"
_IS = r"(?:'s| is| will be| should be| must be| (?:appears|seems) to be| looks like)"
_COME = r"(?:end(?:ed)? up|find yourself|(?<=l |d )be|come out|emerge|arrive|enter(?:ed)?)"
_LOOKS = (
    r"(?:labell?ed|marked|called|named|titled|numbered|lined|covered|decorated|tiled|panell?ed|"
    r"carpeted)"
)
# how a place looks; none that says it cannot be used
_LIKE = rf"(?:{'|'.join(sorted(ATTRIBUTES - bag('closed')))}|lit|dark|bright|huge|tiny)"
# where one is and what one notices there, beside what routes name
_SEEN = bag(
    "floor floors ceiling light lights path paths garden church chapel museum coffee food music "
    "water"
)
_SHOWS = (
    rf"you{_WILL} ?{_COME} {_OF_PLACE}",
    rf"(?:this|that|it){_WILL} ?(?:put|bring|lead|take|get)s? you (?:right |out )?{_OF_PLACE}",
    rf"(?:this|that|it){_IS} {_OF_PLACE}",
    rf"(?P<place>(?:{_A}|this|that) .+?) (?:is|are|will be|should be|has been) (?:\w+ )?"
    rf"{_LOOKS} ?.*",
    rf"(?:you|we)(?:'re| are)(?: now)? (?P<place>(?:in|inside) {_A} [\w-]+(?: [\w-]+){{0,2}})",
    rf"you{_WILL} ?(?:smell|hear) (?P<place>(?:(?:the|a|an|some) )?[\w-]+)",
    rf"(?P<place>(?:the|this|that|these|those) [\w-]+(?: [\w-]+)?) (?:is|are|will be|should be) "
    rf"{_LIKE}",
    r"(?P<place>(?:the|these|those) (?:[\w-]+ )?(?:lights?|lamps?|tv)) (?:is|are|will be) "
    r"(?:on|off)",
    r"(?P<place>(?:this|that|these|those|both) [\w-]+ (?:leads?|goes|go|opens?) "
    rf"(?:(?:up|down|out) )?(?:to|into|onto) {_A} [\w-]+(?: [\w-]+)?)",
)
_STAY = (
    r"(?:(?:stop|wait|remain|stay|stand|halt|end|finish|pause|rest|hold)(?:ing)?"
    r"(?: (?:and|wait|stop|stand|remain|standing|there|here|right|in place|at this point|still|put|"
    r"where you (?:are|stand|started|began)))*"
    r"(?: and (?:do not|don't) move)?"
    r"(?: for| to await| and await)?(?: for (?:me|us)| for a (?:moment|breather|rest))?|await)"
    r"(?: (?:(?:your|any|the|my) )*(?:further|more|next|"
    r"additional|new) (?:instructions?|orders?|directions?|guidance|commands?)"
    r"| until (?:you hear|told|you are told|further notice|instructed)(?: otherwise)?)?"
    r"(?: (?:right |just |around )?(?:there|here)| (?:in|at|inside) this (?:[\w-]+ )?[\w-]+)?"
)
_HOLD = (
    r"(?:hold|keep|maintain) (?:your |this |that )?position|"
    r"(?:cease|stop|end|halt) (?:all |your |any )?(?:movement|motion|moving|walking)"
)
_TO_ME = r"(?:return|come|go|walk|head)(?: back)? to (?:me|us)"
_GOAL = (
    r"(?:(?:your|the) (?:(?:final|last) )?(?:destination|end ?point|goal|target|stop|"
    r"stopping (?:point|place))|the end(?: of (?:the|your) (?:route|path|way|journey|walk|trip))?)"
)
_ARRIVED = (
    r"you(?:(?: have|'ve) (?:now |finally )?(?:arrived(?: at your destination)?|made it|"
    rf"reached (?:it|{_GOAL}))|(?:'re| are) (?:now |all )?(?:there|done|finished))|"
    rf"that(?:'s| is) it|(?:that|this|it)(?:'s| is| will be| should be) {_GOAL}"
)
_NO_FURTHER = (
    r"go no (?:further|farther)|"
    r"(?:do not|don't) (?:go|walk|move|proceed|continue|head) (?:on )?(?:any )?"
    r"(?:further|farther|past (?:it|this|that|there))(?: than (?:this|that))?"
)
_THANKS = r"(?:,? (?:and )?(?:thanks|thank you)(?: (?:so|very|much|again|a lot|for your help))*)?"
_ENDS = re.compile(rf"{_ALSO}(?:{_STAY}|{_HOLD}|{_ARRIVED}|{_NO_FURTHER}|{_TO_ME}){_THANKS}")
_NEED_NOT = re.compile(
    r"(?:do not|don't) (?:make|take) any (?:sharp|hard|big) turns?|"
    rf"{_ALSO}you (?:don't|do not|won't|needn't|need not)(?: (?:need|have) to)? "
    r"(?:go|walk|head|step|enter|climb|turn)(?: (?:in|into|inside|through|up|down|out|there|it|"
    r"that far|all the way))*"
)
_BE = r"(?:do not|don't|never) "
_LEAVES_BE = re.compile(  # what is not to be done to the thing
    rf"{_BE}(?:touch|move|open|close|enter|use|wake|disturb|take|pick up|sit on|lie on|step on|"
    r"lean on|knock over|bump into|go (?:in|inside|into|near))"
    r"(?: (?:it|them|there)|(?<=touch|.move|.wake) the [\w-]+)?"
    rf"(?:,? (?:and|or) {_BE}(?:go in|enter|touch|move|use|wake|open)(?: (?:it|them|there))?)?"
    r"(?: if (?:somebody|someone|anybody|anyone|it|they|the door) (?:is|are|'s) [\w ]{2,20})?"
)
_ELSE = re.compile(  # where else to look
    r"if (?:there(?:'s| is| are)|you (?:see|find)) (?:none|nothing|no [\w-]+)(?: there)?,? "
    r"(?:then )?(?:look|search|check|try) (?:in|on|under|behind|inside|near|beside|by) "
    r"(?P<rest>(?:a|an|the) [\w-]+(?: [\w-]+)?)"
)
_TOO_FAR = re.compile(
    r"if you(?:'ve| have)? (?:hit|reach(?:ed)?|pass(?:ed)?|see|get to|come to|end up (?:in|at)) "
    r"(?P<place>(?:the|a|an) [\w-]+(?: [\w-]+){0,3}?),? (?:then )?"
    r"you(?:'ve| have) (?:gone|walked) (?:a bit |a little )?(?:too far|past it)"
)
_OF_IT = re.compile(
    r"(?:it|they)(?: also)? (?!will\b|would\b|must\b|should\b|can\b)\w+(?: \w+){0,2}"
)
_GOES_ON = re.compile(
    rf"{_ALSO}(?:keep|continue)(?: on)? (?:walking|going|moving|straight|forward)"
    r"(?: (?:straight|forward|ahead|on))*"
)
_ALL_THE_WAY = re.compile(
    r"(?:but )?(?:not )?all the way(?: (?:up|down|in|out|through|across|around))*"
)
_AROUND = re.compile(
    rf"{_ALSO}revers(?:e|ing) (?:your )?(?:current )?(?:direction|course|heading|orientation)"
    r"(?: of (?:travel|movement|motion))?\b(?! of\b)(?P<rest>.*)"
)
_KEEPS = re.compile(
    r"(?:while )?(?:remaining|staying|keeping) "
    r"(?:within|in|inside|on|near|close to|next to|along) (?:the|this|your) (?:[\w-]+ ){0,2}[\w-]+"
)
_WHEN = re.compile(
    r"(?:as|when|once|after|before|until|while) you(?:'re|'ve| are| have)? (?P<rest>.+)"
)
_SHOWN = tuple(re.compile(_ALSO + pattern) for pattern in _SHOWS)


def belongs(sentence: str, first: bool, last: bool) -> str:
    """Return why a sentence belongs to a route though it sounds like an attack, or ""; ``first``,
    ``last``: of the text."""
    said = _plain(sentence)
    if _around(said):
        return "it tells to turn around"
    if not first and (shows_place(sentence) or _KEEPS.fullmatch(said) and not attacks(said)):
        return "it tells what a place is"
    if not first and _NEED_NOT.fullmatch(said):
        return "it tells where not to go"
    if not first and _LEAVES_BE.fullmatch(said):
        return "it tells what to leave as it is"
    if not first and _OF_IT.fullmatch(said) and not (attacks(said) or _moves(said)):
        return "it tells what a thing is like"
    if not (first or last) and _GOES_ON.fullmatch(said):
        return "it tells to go on"
    other = _ELSE.fullmatch(said)
    if not first and other and not attacks(other["rest"]):
        return "it tells where else to look"
    passed = _TOO_FAR.fullmatch(said)
    if not first and passed and not attacks(passed["place"]):
        return "it tells what lies behind the end"
    ends = (first or last) and goes_back(sentence)
    if (not first or tells_how_far(sentence)) and short_step(sentence) and not ends:
        return "it tells a short step"
    if last and not first and _ENDS.fullmatch(said):
        return "it tells to stay at the end"
    return ""


def belongs_inside(part: str) -> bool:
    """Return whether a part of a sentence belongs to the way that its rest tells."""
    said = _plain(part)
    when = _WHEN.fullmatch(said)
    if when and not attacks(when["rest"]) and _names_place(when["rest"]):
        return True
    kept = bool(_KEEPS.fullmatch(said)) and not attacks(said)
    awaits = bool(_ENDS.fullmatch(said)) and ("await" in said or "further" in said)
    return kept or _around(said) or awaits or bool(_ALL_THE_WAY.fullmatch(said))


def shows_place(sentence: str) -> bool:
    """Return whether a sentence tells where one ends up, or what a place is or bears."""
    said = _plain(sentence)
    for pattern in _SHOWN:
        match = pattern.fullmatch(said)
        if match:
            place, rest = match["place"], said[match.end("place") :]
            named = _names_place(place) or place.startswith("room ")
            return named and not attacks(f"{place} {rest}") and not _moves(place)
    return False


def _around(said: str) -> bool:
    match = _AROUND.fullmatch(said)
    return match is not None and not attacks(match["rest"]) and "turns" not in match["rest"]


def _plain(sentence: str) -> str:
    """Return a sentence in lower case, without what stands on things and the marks at its ends."""
    said = " ".join(without_written(sentence).lower().replace("’", "'").split())
    return said.strip(" .,;:!-–—")


def attacks(said: str) -> bool:
    """Return whether a text holds a word of orders, the text, the agent, all cases and the like."""
    return any(word in _ATTACKS for word in words(said))


def _moves(said: str) -> bool:
    return any(word in VERBS for word in words(said))


def _names_place(said: str) -> bool:
    return any(word in places() or word in _SEEN for word in words(said))
