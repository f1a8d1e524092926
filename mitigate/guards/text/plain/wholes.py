"""What is told as it was heard or not at all: words that say one thing together ("close to", "stop
inside"), statements ("the stairs are behind you"), what a thing does ("when the hallway ends")."""

from __future__ import annotations

import re
from collections.abc import Sequence

from mitigate.corruptions.language.tagger import Token
from mitigate.guards.text.plain.edits import CLAUSE_ENDS, NUMBER, Edited
from mitigate.guards.text.texts.speech import STOP

_TOGETHER = re.compile(
    r"(?<![^ ])(?:(?:track|hunt)(?:ing|ed)? (?:one|it|that|them|those) down|as far as|in front of|"
    r"(?:above|below|beneath|underneath) (?:it|them|that|those)|"
    r"(?:stop|wait|stay|stand|halt) (?:for an? \w+ )?(?:right |just )?"
    r"(?:inside|outside|in there|out there|(?:on|in|by|under|behind) (?:it|that|them|those))|"
    r"having \w+ed|having (?:left|gone|come|got|gotten|made|taken|found|been)|"
    r"parallel to|adjacent to|prior to|short of|clear of|next to|close to|on top of|out of|"
    r"away from|instead of|one more|once more|"
    r"at the (?:end|top|bottom|foot|head|center|centre) of|to the (?:left|right) of)(?= )"
)
_SKIPPED = r"(?:right |now |just |directly |straight |somewhere )*"
# what is told whole, if a part of it stays
_WHOLE = re.compile(
    r"(?<![^ ])(?:"
    rf"(?:the|a|an|those|these|that|your|my|some) (?:[\w-]+ ){{1,4}}?(?:is|are|should be|will be|"
    rf"would be|must be) {_SKIPPED}(?:behind|in front of|ahead of) you|"
    r"(?:when|once) (?:you're|you are) out|"
    r"(?:when|where|until|till|once) (?:it|(?:the|that|this) (?:\w+ ){1,3}?)(?:ends|stops|begins|"
    r"starts|opens|splits|forks|turns|curves|bends|resumes|finishes)|"
    r"there (?:should|will|may|might|would|must|could) be|"
    r"(?:(?:so )?(?:that )?you(?:'ll| will)? know (?:that )?)?(?:it's|that's|it is|that is|"
    r"this is|you're(?: in| at| on)?|you are(?: in| at| on)?) the "
    r"right (?:one|place|way|track|door|room|spot|path|hallway|direction|area)|"
    r"(?:through|of|in|on|from|by|behind|under|over|at|to|near|beside) which "
    r"(?:(?!and |then )[\w'-]+ )*[\w'-]+|"
    r"(?:identifiable|recogni[sz]able|distinguishable|identified|marked|characteri[sz]ed) by "
    r"(?:(?!and |then )[\w'-]+ )*[\w'-]+"
    r")(?= )"
)
# what stays with the thing before it, if that stays
_OF_THING = re.compile(
    r"(?<![^ ])(?:straight ahead|(?:which|that) (?:leads?|goes|go|runs?|leading) "
    r"(?:up|down|upwards?|downwards?|upstairs|downstairs|out|outside))(?= [.,;!?]|$)"
)
_ALL = re.compile(
    r"(?<![^ ])(?:all the way|in the (?:opposite|other|reverse|same) direction|"
    r"as soon as you(?:'re| are) (?:inside|in|out|outside|through))(?= )"
)
_OF_SIDE = re.compile(r"(?<![^ ])(?:to|on) (?:the|your|its|their) (?:left|right)(?= )")


def together(made: Edited) -> bool:
    """Give back words that are told together, of which a part is left before a thing that stays;
    return whether there were such."""
    text, places = spelled(made.found)
    changed = False
    for match in _TOGETHER.finditer(text):
        span = span_of(match, places)
        if any(made.kept(p) for p in span):
            changed |= not all(made.kept(p) for p in span) and made.give_back(span)
    return changed


def wholes(made: Edited) -> bool:
    """Give back the rest of statements, stops and sides of which a part stays; return whether there
    were such."""
    text, places = spelled(made.found)
    changed = False
    for match in _WHOLE.finditer(text):
        span = span_of(match, places)
        if any(made.kept(p) for p in span):
            changed |= made.give_back(span)
            if match.group().endswith("you"):
                ends = span.stop < len(made.found) and made.found[span.stop].text in CLAUSE_ENDS
                changed |= ends and made.give_back([span.stop])
                _no_phrase(made, span.start - 1)
    for match in STOP.finditer(text):
        if made.kept((span := span_of(match, places))[0]):  # "come to rest"
            again = made.before[span.stop : span.stop + 1] == [NUMBER["stop"]]
            changed |= made.give_back([*span, span.stop] if again else span)
    for match in _ALL.finditer(text):
        changed |= bool(made.kept_words(0)) and made.give_back(span_of(match, places))
    for match in _OF_SIDE.finditer(text):
        span = span_of(match, places)
        if made.kept(span[0]) and made.kept(span[-1]):
            changed |= made.give_back(span)
    for match in _OF_THING.finditer(text + ". "):
        span = span_of(match, places)
        thing = span.start - 1
        if thing >= 0 and made.kept(thing) and made.found[thing].tag == "NOUN":
            changed |= made.give_back(span)
    return changed


def _no_phrase(made: Edited, place: int) -> None:
    """Take back the phrases of the words up to ``place`` that are taken out."""
    while place >= 0 and not made.kept(place):
        made.before[place] = 0
        place -= 1


def spelled(found: Sequence[Token]) -> tuple[str, dict[int, int]]:
    """Return the tokens in lower case with a space between them, and where each begins."""
    text, places = "", {}
    for place, token in enumerate(found):
        places[len(text)] = place
        text += token.lower + " "
    return text, places


def span_of(match: re.Match[str], places: dict[int, int]) -> range:
    """Return the places of the tokens that a match of what is spelled holds."""
    first = places[match.start()]
    return range(first, first + 1 + match.group().count(" "))
