"""Use rules to repair instructions with words in capitals or masked words."""

from __future__ import annotations

import re
from collections import Counter
from functools import lru_cache
from typing import Any

from mitigate.core.seeding import generator
from mitigate.corruptions.language.directions import MOTION, STOPS, TURN_VERBS
from mitigate.corruptions.language.words import CANONICAL, bag
from mitigate.guards.text.learning.routes import draw_route

MASK = re.compile(r"\[(?:MASK|UNK|mask)\]|<(?:mask|unk)>")
KEPT_CAPITALS = bag("TV TVS DVD BBQ AC PC")
# Words in capitals are converted to lower case only if enough of them are known words.
# SHOUTS is the minimum number of such words, and SHOUTED their minimum fraction of all words.
# A text with only a few words in capitals may quote a sign.
SHOUTS, SHOUTED = 2, 0.15
# number of generated routes whose words are counted; this takes about one second per process
ROUTES = 4000
SMALL = bag(
    "a an the and then your you of to in on at by is are it that there will so now just with next "
    "some this its be been have has from into for or as when once where which slight"
)
_SHOUT = re.compile(r"(?<![\[<])\b[A-Z][A-Z'’]+\b")
_VERBS = MOTION | STOPS | TURN_VERBS
_NOUNS = frozenset(CANONICAL) | frozenset(CANONICAL.values())
_ROOMS = bag("dining living sitting waiting landing ceiling building opening railing painting")
# Words that may follow a noun. If such a word follows a mask, the mask may hide a noun.
_BEHIND = SMALL | bag(
    "beside behind under between before past down up through across opposite towards toward "
    "but without not again until facing leading closest nearest along around near above below out "
    "inside outside over against off beyond within during since because if while about after my "
    "his her our their these those any each every no both all he she they we i me him them us"
)
# A function word cannot replace these masks.
# They hide part of a word or the direction of a turn.
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
_RUN = re.compile(r"\[mask\](?:\s*\[mask\])+")
_TOKEN = re.compile(r"\[mask\]|[A-Za-z]+(?:['’][a-z]+)?|\d+|[.,;!?]")


def lower_capitals(text: str, known: frozenset[str]) -> str:
    """Convert words in capitals to lower case, except the first letter of a sentence.

    ``known`` contains common words. If the text has only a few known words in capitals, they may be
    names or the text of a sign, and nothing is changed.
    """
    shouted = [m.group().lower() for m in _SHOUT.finditer(text) if m.group() not in KEPT_CAPITALS]
    count = sum(word in known for word in shouted)
    if count < max(SHOUTS, SHOUTED * len(text.split())):
        return text

    def lowered(match: re.Match[str]) -> str:
        word = match.group()
        if word in KEPT_CAPITALS:
            return word
        before = text[: match.start()].rstrip()
        return word.capitalize() if not before or before[-1] in ".!?" else word.lower()

    return _SHOUT.sub(lowered, text)


def fill_masks(text: str) -> str:
    """Replace each sequence of masks in ``text`` by the function word that fits best.

    A mask is kept if it seems to hide a noun, a turn or part of a word. A mask is removed if it
    seems to hide an adjective before a noun.
    """
    if not re.search(r"[A-Za-z]", MASK.sub(" ", text)):
        return text
    text = _STAYS.sub(lambda m: m.group().replace("[mask]", "[MASK]"), MASK.sub("[mask]", text))
    text = _WHICH.sub(_hidden_adjective, _RUN.sub("[mask]", text))
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
            word = _best(left, right)
            tokens[index] = word.capitalize() if left in ".!?" else word
    pieces[1::2] = tokens
    return re.sub(r"\s+([.,;!?])", r"\1", " ".join(("".join(pieces) + text[at:]).split()))


def _hidden_adjective(match: re.Match[str]) -> str:
    """Return the replacement for a match of ``_WHICH``, such as "the [mask]" or "first [mask]".

    If a noun follows the mask, the mask is removed. If a verb follows, and the word before the mask
    is not "your", the match is returned unchanged. Otherwise the mask hides a noun and is kept.
    """
    which, behind = match["which"], match["next"].lower()
    doing = behind.endswith("ing") and behind not in _NOUNS | _ROOMS
    if not behind or behind in _BEHIND or doing:
        return f"{which} [MASK]{match['gap']}"
    if behind in _VERBS:
        return f"{which} [MASK]{match['gap']}" if which.lower() == "your" else match[0]
    if which.lower() in ("a", "an"):
        which = which[0] + "n" * (behind[0] in "aeiou")
    return f"{which} "


@lru_cache(maxsize=4096)
def _best(left: str, right: str) -> str:
    both, before, after, plain = _counts()
    scores = {}
    for word in SMALL:
        if word in (left, right):
            continue
        follows = (before[left, word] + 0.01) * (after[word, right] + 0.01) / (plain[word] + 10.0)
        scores[word] = 20.0 * both[left, word, right] + follows
    return max(sorted(scores), key=scores.__getitem__)


@lru_cache(maxsize=1)
def _counts() -> tuple[Counter, ...]:
    both, before, after, plain = (Counter[Any]() for _ in range(4))
    for index in range(ROUTES):
        tokens = _TOKEN.findall(draw_route(generator(0, "masks", index)).lower())
        tokens = [".", *tokens, "."]
        for left, word, right in zip(tokens, tokens[1:], tokens[2:], strict=False):
            if word in SMALL:
                both[left, word, right] += 1
                before[left, word] += 1
                after[word, right] += 1
                plain[word] += 1
    return both, before, after, plain
