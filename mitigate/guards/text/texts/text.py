"""Texts as the safeguard sees them: clean of control characters, in sentences, in passages."""

from __future__ import annotations

import re
import unicodedata

MASK = re.compile(r"\[(?:MASK|UNK|mask)\]|<(?:mask|unk)>")
_VARIATION = frozenset(map(chr, range(0xFE00, 0xFE10)))  # selectors that follow an emoji
_END = re.compile(r"(?<=[.!?])\s+|(?<=[a-z)]\.)(?=[A-Z])|\n+")


def tidy(text: str) -> str:
    """Return ``text`` in NFKC, without control characters and emoji, with single spaces."""
    text = unicodedata.normalize("NFKC", text)
    kept = (" " if unicodedata.category(c) in ("Cc", "Zl", "Zp") else c for c in text)
    dropped = ("Cf", "Cs", "Co", "Cn", "So", "Sk")
    words_only = (c for c in kept if unicodedata.category(c) not in dropped and c not in _VARIATION)
    return " ".join("".join(words_only).split())


def sentences(text: str) -> list[str]:
    """Return the sentences of ``text``, their end marks with them."""
    return [part.strip() for part in _END.split(text) if part and part.strip()]


def words(text: str) -> list[str]:
    """Return the words in lower case; a mask is one word, "[mask]"."""
    return re.findall(r"\[mask\]|[a-z]+(?:['’][a-z]+)?|\d+", MASK.sub("[mask]", text).lower())


def passages(text: str, longest: int) -> list[str]:
    """Return ``text`` cut at sentence ends into passages of about ``longest`` words at most."""
    found: list[str] = []
    for sentence in sentences(text):
        if found and len(found[-1].split()) + len(sentence.split()) <= longest:
            found[-1] += " " + sentence
        else:
            found.append(sentence)
    return found
