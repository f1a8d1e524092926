"""Hidden words guessed from their neighbours: counts over our own routes, no language model."""

from __future__ import annotations

import re
from collections import Counter
from functools import lru_cache
from itertools import takewhile

from mitigate.core.seeding import generator
from mitigate.corruptions.language.words import bag
from mitigate.guards.text.learning.routes import draw_route
from mitigate.guards.text.texts.evidence import LANDMARKS, VERBS
from mitigate.guards.text.texts.lexicon import FUNCTION
from mitigate.guards.text.texts.text import MASK, words

ROUTES = 4000  # counted, about one second once (ours)
SMALL = bag(
    "a an the and then your you of to in on at by is are it that there will so now just with next "
    "some this its be been have has from into for or as when once where which slight"
)
_STAYS = re.compile(
    r"(?<=[a-z])\[mask\]|\[mask\](?=[a-z])|"
    r"(?<!\ba )(?<!\bthe )\b(?:turn|turning|bear|veer|rotate|swing)\s+\[mask\](?:\s*\[mask\])*"
    r"(?=\s*(?:[,.;!?]|$|(?:at|in|into|past|by|near|before|after|when|onto|and|then)\b))",
    re.IGNORECASE,
)
_WHICH = re.compile(
    r"(?P<which>\b(?:[Aa]n?|[Tt]he|[Yy]our|nearest|closest|first|second|third))\s+\[mask\]"
    r"(?P<gap>\s*)(?=(?P<next>[A-Za-z]*))"
)
_ROOMS = bag("dining living sitting waiting landing ceiling building opening railing painting")
# what may follow a thing that is hidden
_BEHIND = (
    SMALL
    | FUNCTION
    | bag(
        """
    beside behind under between before past down up through across opposite towards toward without
    but not again until facing leading closest nearest along around near next above below inside
    outside over against off out beyond within during since because if while
    """
    )
)
_RUN = re.compile(r"\[mask\](?:\s*\[mask\])+")
_PART = re.compile(r"\[mask\]|[\w'’-]+|[^\w\s]", re.IGNORECASE)
_TOKEN = re.compile(r"\[mask\]|[A-Za-z]+(?:['’][a-z]+)?|\d+|[.,;!?]")


def fill(text: str) -> str:
    """Return ``text`` with every run of masks replaced by the one small word that fits best between
    its neighbours; at the start of a sentence it gets a capital. What no small word can be stays
    hidden: a part of a word, a thing, where to turn, a text that is hidden as a whole. What tells
    which thing is left out."""
    if not words(MASK.sub(" ", text)):
        return text
    text = _STAYS.sub(lambda m: m.group().replace("[mask]", "[MASK]"), MASK.sub("[mask]", text))
    text = _RUN.sub("[mask]", text)
    text = _WHICH.sub(_which, text)
    pieces: list[str] = []
    at = 0
    for match in _TOKEN.finditer(text):
        pieces += [text[at : match.start()], match.group()]
        at = match.end()
    tokens = pieces[1::2]
    for index, token in enumerate(tokens):
        if token == "[mask]":
            left = tokens[index - 1].lower() if index else "."
            right = tokens[index + 1].lower() if index + 1 < len(tokens) else "."
            word = _best(left if left else ".", right)
            tokens[index] = word.capitalize() if left in ".!?" else word
    pieces[1::2] = tokens
    return re.sub(r"\s+([.,;!?])", r"\1", " ".join(("".join(pieces) + text[at:]).split()))


def _which(match: re.Match[str]) -> str:
    """Return what stands for a hidden word behind "the": nothing, if a thing follows and so it told
    which; a mask, if it was the thing; itself, if a verb follows."""
    which, behind = match["which"], match["next"].lower()
    doing = behind.endswith("ing") and behind not in LANDMARKS | _ROOMS
    if not behind or behind in _BEHIND or doing:
        return f"{which} [MASK]{match['gap']}"
    if behind in VERBS:
        return f"{which} [MASK]{match['gap']}" if which.lower() == "your" else match[0]
    if which.lower() in ("a", "an"):
        which = which[0] + "n" * (behind[0] in "aeiou")
    return f"{which} "


def filled(masked: str, answer: str) -> list[str] | None:
    """Return what ``answer`` has in place of each mask of ``masked``, up to three words for one, as
    many as fit for the first; None if anything else differs, but for case and marks at the ends."""
    hidden, said = _tokens(MASK.sub(" [mask] ", masked)), _tokens(answer)
    rest = [[False] * (len(said) + 1) for _ in range(len(hidden) + 1)]  # hidden[i:] fits said[j:]
    rest[-1][-1] = True
    for i in reversed(range(len(hidden))):
        for j in range(len(said) + 1):
            ends = _ends(hidden[i], said, j)
            rest[i][j] = any(rest[i + 1][end] for end in ends)
    if not rest[0][0]:
        return None
    found, at = [], 0
    for i, token in enumerate(hidden):
        start, at = at, max(end for end in _ends(token, said, at) if rest[i + 1][end])
        if token == "[mask]":
            found.append(" ".join(said[start:at]))
    return found


def _tokens(text: str) -> list[str]:
    return _PART.findall(text.strip(" ."))


def _ends(token: str, said: list[str], start: int) -> list[int]:
    """Where what ``token`` stands for may end in ``said``, if it begins at ``start``."""
    if token != "[mask]":
        same = start < len(said) and said[start].lower() == token.lower()
        return [start + 1] if same else []
    run = takewhile(lambda part: part[0].isalnum(), said[start : start + 3])
    return [start + n for n in range(sum(1 for _ in run) + 1)]


@lru_cache(maxsize=4096)
def _best(left: str, right: str) -> str:
    both, before, after, plain = _counts()
    scores = {}
    for word in SMALL:
        if word in (left, right):
            continue
        seen = 20.0 * both[left, word, right]
        follows = (before[left, word] + 0.01) * (after[word, right] + 0.01) / (plain[word] + 10.0)
        scores[word] = seen + follows
    return max(sorted(scores), key=scores.__getitem__)


@lru_cache(maxsize=1)
def _counts() -> tuple[Counter, Counter, Counter, Counter]:
    both: Counter = Counter()
    before: Counter = Counter()
    after: Counter = Counter()
    plain: Counter = Counter()
    for index in range(ROUTES):
        found = _TOKEN.findall(draw_route(generator(0, "masks", index)).lower())
        found = [".", *found, "."]
        for left, word, right in zip(found, found[1:], found[2:], strict=False):
            if word in SMALL:
                both[left, word, right] += 1
                before[left, word] += 1
                after[word, right] += 1
                plain[word] += 1
    return both, before, after, plain
