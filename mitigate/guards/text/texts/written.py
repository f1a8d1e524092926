"""Words that stand on a thing, in quotes ("the sign that says "Mind the gap."", "an "exit" sign"):
they belong to the thing, whatever they say, unless they are many and tell one what to do.
"""

from __future__ import annotations

import re
from functools import lru_cache

from mitigate.corruptions.language.directions import MOTION, STOPS
from mitigate.corruptions.language.fidelity import facts
from mitigate.corruptions.language.words import bag
from mitigate.guards.text.texts.lexicon import GROUPS
from mitigate.guards.text.texts.text import words

TITLE = 4  # words in quotes that may stand on a sign though they tell one what to do (ours)
_QUOTED = re.compile(
    r"\"[^\"\n]*\"|“[^”\n]*”|«[^»\n]*»|‘[^’\n]*’(?!\w)"
    r"|(?<!\w)'[^'\n]*(?:\w'\w[^'\n]*)*'(?!\w)"
)
# what says that a thing bears the words that follow
BEARER = 120  # characters before quotes in which it is said what they stand on (ours)
_BEARS = re.compile(
    r"(?:(?:\b(?:that|which|it)\s+|\bwhere\s+(?:a|an|the|one|some)\s+\w+\s+)?\b(?:says|said|reads?|"
    r"saying|reading|stating|states|labell?ed|labell?ing|label|marked|named|called|titled|entitled|"
    r"inscribed|written|printed|lettered|painted|bearing|numbered)"
    r"(?:\s+(?:as|with|on (?:it|them)|by|the|words?|title|name|sign|letters?|text)){0,4}"
    r"|\bwith\s+(?:the\s+)?(?:words?|title|name|text|letters?|lettering|writing|inscription)"
    r"|\b(?:sign|signs|signage|label|plaque|sticker))[\s:,]*$",
    re.IGNORECASE,
)
_BORNE = re.compile(
    r"\s+(?:\w+\s+)?(?:signs?|labels?|plaques?|stickers?|posters?|placards?|banners?|logos?|"
    r"lettering|doors?|buttons?|rooms?|suites?|mats?|doormats?|boards?|pictures?|paintings?|boxes|"
    r"box|exits?|entrances?|office|lights?|words?|text|symbols?)\b",
    re.IGNORECASE,
)
_ONE = re.compile(r"\b(?:(?:the|an?)\s+)?ones?\s+$", re.IGNORECASE)
_ORDERS = (
    MOTION - bag("take make come pass follow") | STOPS | bag("ignore stay keep do don't not back")
    | GROUPS["orders"] | GROUPS["annul"] | GROUPS["invert"] | GROUPS["machine"]
)  # fmt: skip


@lru_cache(maxsize=64)
def quotes(text: str) -> tuple[tuple[int, int, int, int], ...]:
    """Return the place of each text in quotes on a thing: where what belongs to it begins ("that
    says"), the quotes begin and end, and what belongs to it ends ("sign")."""
    found = []
    for match in _QUOTED.finditer(text):
        before = _BEARS.search(text, max(0, match.start() - BEARER), match.start())
        behind = _BORNE.match(text, match.end())
        if before or behind:
            first = before.start() if before else match.start()
            last = behind.end() if behind else match.end()
            found.append((first, match.start(), match.end(), last))
    return tuple(found)


def written(text: str) -> list[tuple[int, int]]:
    """Return the places of what stands on things, with the words around it that say so; none of
    many words that tell one what to do."""
    return [
        (len(_ONE.sub("", text[:first])), last)
        for first, a, b, last in quotes(text)
        if not tells_to_do(text[a:b])
    ]


def without_written(text: str) -> str:
    """Return a text without what stands on things: "follow the arrow labelled"."""
    for first, last in reversed(written(text)):
        text = f"{text[:first]}labelled{text[last:]}"
    return text


def tells_to_do(quoted: str) -> bool:
    """Return whether words in quotes are too many for a sign, and tell one what to do."""
    said = words(quoted)
    told = any(word in _ORDERS for word in said) or bool(facts(quoted).directions)
    return len(said) > TITLE and told


def quoted(part: str) -> bool:
    """Return whether a part of a sentence stands in quotes."""
    return part[:1] in "\"'“«‘"


def with_bearer(text: str, start: int, end: int) -> int:
    """Return where to begin to take out quotes at ``start``, so that no "that says" is left."""
    return next((first for first, a, b, _ in quotes(text) if (a, b) == (start, end)), start)
