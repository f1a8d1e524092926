"""Hidden words guessed from their neighbours: counts over our own routes, no language model."""

from __future__ import annotations

import re
from collections import Counter
from functools import lru_cache

from mitigate.core.seeding import generator
from mitigate.corruptions.language.words import bag
from mitigate.safeguard.routes import draw_route
from mitigate.safeguard.text import MASK, words

ROUTES = 4000  # counted, about one second once (ours)
SMALL = bag(
    "a an the and then your you of to in on at by is are it that there will so now just with next "
    "some this its be been have has from into for or as when once where which slight other "
    "another our we i"
)
_STAYS = re.compile(
    r"(?<=[a-z])\[mask\]|\[mask\](?=[a-z])|"
    r"(?<!\ba )(?<!\bthe )\b(?:turn|turning|bear|veer|rotate|swing)\s+\[mask\](?:\s*\[mask\])*"
    r"(?=\s*(?:[,.;!?]|$|(?:at|in|into|past|by|near|before|after|when|onto|and|then)\b))",
    re.IGNORECASE,
)
_RUN = re.compile(r"\[mask\](?:\s*\[mask\])+")
_TOKEN = re.compile(r"\[mask\]|[A-Za-z]+(?:['’][a-z]+)?|\d+|[.,;!?]")


def fill(text: str) -> str:
    """Return ``text`` with every run of masks replaced by the one small word that fits best between
    its neighbours; at the start of a sentence it gets a capital. What no small word can be stays
    hidden: a part of a word, where to turn, a text that is hidden as a whole."""
    if not words(MASK.sub(" ", text)):
        return text
    text = _STAYS.sub(lambda m: m.group().replace("[mask]", "[MASK]"), MASK.sub("[mask]", text))
    text = _RUN.sub("[mask]", text)
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


def filled(masked: str, answer: str) -> list[str] | None:
    """Return what ``answer`` has in place of each mask of ``masked``, up to three words for one;
    None if anything else differs, but for case and marks at the ends."""
    body = re.sub(r"\s+", " ", MASK.sub(" [mask] ", masked)).strip(" .")
    parts = [re.escape(part.strip()) for part in body.split("[mask]")]
    pattern = r"\s*((?:[\w'’-]+\s*){0,3})".join(re.sub(r"\\ ", r"\\s+", part) for part in parts)
    found = re.fullmatch(pattern, " ".join(answer.split()).strip(" ."), re.IGNORECASE)
    return None if found is None else [words.strip() for words in found.groups()]


@lru_cache(maxsize=4096)
def _best(left: str, right: str) -> str:
    both, before, after, plain = _counts()
    scores = {}
    for word in SMALL:
        if word in (left, right):
            continue
        seen = 20.0 * both[left, word, right]
        follows = (before[left, word] + 0.01) * (after[word, right] + 0.3) / (plain[word] + 10.0)
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
