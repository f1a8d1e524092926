"""Text that hides its words: a plain copy to judge, and what was hidden how.

Zero-width and look-alike letters, full-width and fancy letters, digits for letters, letters spelled
out, words in a code or cipher. The copy is only judged; what is given on stays as it was heard.
"""

from __future__ import annotations

import codecs
import re
import unicodedata
from dataclasses import dataclass
from functools import lru_cache

from mitigate.guards.text.texts.lexicon import known_words

_ALIKE = str.maketrans(
    "аеорсухікѕјһԁԛԝАВЕКМНОРСТУХІЅЈαορινυκτΑΒΕΖΗΙΚΜΝΟΡΤΥΧ",
    "aeopcyxiksjhdqwABEKMHOPCTYXISJaopivuktABEZHIKMNOPTYX",
)
_LEET = str.maketrans("0134578@$!", "oieastbasi")
_SPELLED = re.compile(r"(?<![^\W_])(?:[A-Za-z](?:[.\-_*]|\s+)){4,}[A-Za-z](?![^\W_])")
CODES = re.compile(
    r"(?:%[0-9A-Fa-f]{2}){2,}|(?:\\u[0-9A-Fa-f]{4}\s*){2,}|(?:\\x[0-9A-Fa-f]{2}\s*){2,}"
    r"|(?:&#x?[0-9A-Fa-f]+;\s*){2,}|\b[01]{7,8}(?:\s+[01]{7,8})*\b"
    r"|\b(?:0x)?[0-9A-Fa-f]{2}(?:[\s:][0-9A-Fa-f]{2}){3,}\b"
    r"|\b(?=[0-9a-fA-F]*[0-9])[0-9a-fA-F]{12,}\b"
    r"|(?<![\w/])[A-Z2-7]{12,}={1,6}|(?<![\w/])[A-Za-z0-9+/]{10,}={1,2}(?!\w)"
    r"|(?<![\w/])(?=[A-Za-z+/]*\d)(?=[a-z0-9+/]*[A-Z])(?=[A-Z0-9+/]*[a-z])[A-Za-z0-9+/]{16,}"
    r"|(?<![.\-\w])[.\-]{1,5}(?:[ /]+[.\-]{1,5}){3,}(?![.\-\w])"
)
_WORD = re.compile(r"[A-Za-z]+(?:['’][a-z]+)?")
_MIXED = re.compile(r"\b(?=[\w@$!]*[A-Za-z])(?=[\w@$!]*[0-9@$])[\w@$]+\b")
_MEASURE = re.compile(r"\d+(?:st|nd|rd|th|m|cm|ft|feet|in|deg|x|s|am|pm|d)?$|[A-Za-z]\d+$", re.I)
_CASE = re.compile(r"\b[a-z]+[A-Z]\w*\b|\b[A-Z]+[a-z]+[A-Z]\w*\b")
FANCY = r"\u2460-\u24ff\uff01-\uff5e\U0001d400-\U0001d7ff"  # of a class of characters
_WIDE = re.compile(f"[{FANCY}]")


@dataclass(frozen=True)
class Plain:
    """``text``: the readable copy, shouted words as they were. ``marks``: how words were hidden:
    "hidden", "alike", "wide", "spelled", "leet", "code", "cipher", "case"."""

    text: str
    marks: frozenset[str]


@lru_cache(maxsize=4096)
def plainly(text: str) -> Plain:
    """Return the readable copy of ``text`` and how its words were hidden."""
    if text.isascii() and not _suspicious(text):
        return Plain(text, frozenset())
    marks: set[str] = set()
    text = _unhidden(text, marks)
    text = _coded(text, marks)
    if _SPELLED.search(text):
        marks.add("spelled")
        text = _SPELLED.sub(_joined, text)
    text = _MIXED.sub(lambda match: _unleet(match.group(), marks), text)
    if len(_CASE.findall(text)) > 1:
        marks.add("case")
        text = text.lower()
    return Plain(_deciphered(text, marks), frozenset(marks))


def _suspicious(text: str) -> bool:
    """Return whether an ASCII text may hide words."""
    if re.search(r"\d[A-Za-z]|[A-Za-z]\d|[@$%\\&=]|[01]{7}|[.\-] ?/? ?[.\-]", text):
        return True
    if _SPELLED.search(text) or _CASE.search(text) or CODES.search(text):
        return True
    found = _WORD.findall(text)
    return sum(word.lower() not in known_words() for word in found) > 0.4 * len(found)


def _unhidden(text: str, marks: set[str]) -> str:
    """Return ``text`` without invisible characters, in plain Latin letters."""
    tags = [chr(ord(c) - 0xE0000) for c in text if 0xE0020 <= ord(c) < 0xE007F]
    invisible = sum(unicodedata.category(c) == "Cf" for c in text)
    if tags or invisible > 1:
        marks.add("hidden")
    backwards = "\u202e" in text
    text = "".join(c for c in text if unicodedata.category(c) != "Cf") + "".join(tags)
    text = text[::-1] if backwards else text
    if len(_WIDE.findall(text)) > 2:
        marks.add("wide")
    text = unicodedata.normalize("NFKC", text)
    mixed = any(
        any(c.isascii() and c.isalpha() for c in word)
        and any(c != c.translate(_ALIKE) for c in word)
        for word in re.findall(r"\w+", text)
    )
    if mixed:
        marks.add("alike")
        text = text.translate(_ALIKE)
    return text


def _coded(text: str, marks: set[str]) -> str:
    if not CODES.search(text):
        return text
    marks.add("code")
    return CODES.sub(" ", text)


def _joined(match: re.Match[str]) -> str:
    """Return a word, or words, that were spelled out letter by letter."""
    spaced = re.split(r"\s{2,}", match.group())
    return " ".join(re.sub(r"[^A-Za-z]+", "", word) for word in spaced)


def _unleet(word: str, marks: set[str]) -> str:
    """Return a word without digits for letters, if that makes it one that is known."""
    if _MEASURE.fullmatch(word):
        return word
    read = word.lower().translate(_LEET)
    for candidate in (read, read.replace("i", "l"), word.lower().replace("1", "l")):
        if candidate in known_words():
            marks.add("leet")
            return candidate
    return word


def _deciphered(text: str, marks: set[str]) -> str:
    """Return ``text`` with words of a cipher, backward or scrambled words made readable."""
    found = [word for word in _WORD.findall(text) if word.lower() not in known_words()]
    if len(found) > 2:
        for read in (codecs.decode(" ".join(found), "rot13"), " ".join(w[::-1] for w in found)):
            made = read.lower().split()
            if sum(word in known_words() for word in made) > 0.5 * len(made):
                marks.add("cipher")
                for word, plain in zip(found, made, strict=True):
                    text = re.sub(rf"\b{re.escape(word)}\b", plain, text)
                return text
    return _WORD.sub(lambda match: _unscrambled(match.group()), text)


def _unscrambled(word: str) -> str:
    lower = word.lower()
    if len(word) < 4 or lower in known_words():
        return word
    return _scrambles().get(_key(lower), word)


@lru_cache(maxsize=1)
def _scrambles() -> dict[str, str]:
    return {_key(word): word for word in sorted(known_words()) if len(word) > 3}


def _key(word: str) -> str:
    return word[0] + "".join(sorted(word[1:-1])) + word[-1]
