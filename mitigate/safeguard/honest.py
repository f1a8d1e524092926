"""What honest routes say in words that attacks use, too: what a place is, to stay at the end, to
turn around, to keep to a room. Each is a whole sentence, or a whole part of one, of closed words
around a place, and holds nothing about orders, the text, the agent or all cases.
"""

from __future__ import annotations

import re

from mitigate.corruptions.language.words import bag
from mitigate.safeguard.evidence import VERBS
from mitigate.safeguard.lexicon import GROUPS, places
from mitigate.safeguard.text import words
from mitigate.safeguard.written import without_written

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
_SHOWS = (
    rf"you{_WILL} ?{_COME} {_OF_PLACE}",
    rf"(?:this|that|it){_WILL} ?(?:put|bring|lead|take|get)s? you (?:right |out )?{_OF_PLACE}",
    rf"(?:this|that|it){_IS} {_OF_PLACE}",
    rf"(?P<place>(?:{_A}|this|that) .+?) (?:is|are|will be|should be|has been) (?:\w+ )?"
    rf"{_LOOKS} ?.*",
)
_STAY = (
    r"(?:(?:stop|wait|remain|stay|stand|halt|end|pause|rest|hold)(?:ing)?"
    r"(?: (?:and|wait|stop|stand|remain|standing|there|here|right|in place|at this point))*"
    r"(?: for| to await| and await)?(?: for (?:me|us)| for a (?:moment|breather|rest))?|await)"
    r"(?: (?:(?:your|any|the|my) )*(?:further|more|next|"
    r"additional|new) (?:instructions?|orders?|directions?|guidance|commands?)"
    r"| until (?:you hear|told|you are told|further notice|instructed)(?: otherwise)?)?"
    r"(?: (?:right |just |around )?(?:there|here)| (?:in|at|inside) this (?:[\w-]+ )?[\w-]+)?"
)
_ARRIVED = (
    r"you(?:(?: have|'ve) (?:now )?(?:arrived|reached (?:it|your destination))|"
    r"(?:'re| are) (?:there|done))"
)
_NO_FURTHER = (
    r"(?:do not|don't) (?:go|walk|move|proceed|continue|head) (?:on )?(?:any )?"
    r"(?:further|farther|past (?:it|this|that|there))(?: than (?:this|that))?"
)
_THANKS = r"(?:,? (?:and )?(?:thanks|thank you)(?: (?:so|very|much|again|a lot|for your help))*)?"
_ENDS = re.compile(rf"{_ALSO}(?:{_STAY}|{_ARRIVED}|{_NO_FURTHER}){_THANKS}")
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
    if not first and (shows_place(sentence) or _KEEPS.fullmatch(said) and not _attacks(said)):
        return "it tells what a place is"
    if not first and _NEED_NOT.fullmatch(said):
        return "it tells where not to go"
    if not first and _LEAVES_BE.fullmatch(said):
        return "it tells what to leave as it is"
    if not first and _OF_IT.fullmatch(said) and not (_attacks(said) or _moves(said)):
        return "it tells what a thing is like"
    if not (first or last) and _GOES_ON.fullmatch(said):
        return "it tells to go on"
    if last and not first and _ENDS.fullmatch(said):
        return "it tells to stay at the end"
    return ""


def belongs_inside(part: str) -> bool:
    """Return whether a part of a sentence belongs to the way that its rest tells."""
    said = _plain(part)
    when = _WHEN.fullmatch(said)
    if when and not _attacks(when["rest"]) and _names_place(when["rest"]):
        return True
    kept = bool(_KEEPS.fullmatch(said)) and not _attacks(said)
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
            return named and not _attacks(f"{place} {rest}") and not _moves(place)
    return False


def _around(said: str) -> bool:
    match = _AROUND.fullmatch(said)
    return match is not None and not _attacks(match["rest"]) and "turns" not in match["rest"]


def _plain(sentence: str) -> str:
    """Return a sentence in lower case, without what stands on things and the marks at its ends."""
    said = " ".join(without_written(sentence).lower().replace("’", "'").split())
    return said.strip(" .,;:!-–—")


def _attacks(said: str) -> bool:
    return any(word in _ATTACKS for word in words(said))


def _moves(said: str) -> bool:
    return any(word in VERBS for word in words(said))


def _names_place(said: str) -> bool:
    return any(word in places() for word in words(said))
