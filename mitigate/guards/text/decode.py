"""Decode hidden words: ciphers, codes, look-alike letters and spelled-out words.

The decoded copy of a text is used only to detect attacks. The agent receives the original
characters, except invisible ones.
"""

from __future__ import annotations

import base64
import binascii
import html
import re
import unicodedata
from collections.abc import Callable, Iterator, Set
from dataclasses import dataclass
from functools import partial

_ALIKE = str.maketrans(
    "аеорсухікѕјһԁԛԝАВЕКМНОРСТУХІЅЈαορινυκτγηΑΒΕΖΗΙΚΜΝΟΡΤΥΧɡᴀʙᴄᴅᴇɢʜɪᴊᴋʟᴍɴᴏᴘʀᴛᴜᴠᴡʏᴢ",
    "aeopcyxiksjhdqwABEKMHOPCTYXISJaopivuktynABEZHIKMNOPTYXgabcdeghijklmnoprtuvwyz",
)
_LEET = str.maketrans("0134578@$!|€", "oieastbasiie")
_SPELLED = re.compile(r"(?<![^\W_])(?:[A-Za-z](?:[.\-_*/|~]|\s+)){3,}[A-Za-z](?![^\W_])")
_MIXED = re.compile(r"(?<!\w)(?=[\w@$!|€]*[A-Za-z@$!|€])(?=[\w@$!|€]*[0-9@$!|€])[\w@$!|€]{2,}")
# These words with digits or signs are not leetspeak.
# They are numbers with a unit or letter, room names such as "A12", and words ending in "!" or "|".
_MEASURE = re.compile(
    r"\d+(?:st|nd|rd|th|m|cm|ft|feet|in|deg|am|pm|[a-zA-Z])?[!|]*$|(?:[A-Z]{1,3}|[a-z])\d+[!|]*$|"
    r"[A-Za-z]+[!|]+$"
)
_ESCAPES = re.compile(
    r"(?:%[0-9A-Fa-f]{2}){2,}|(?:\\u[0-9A-Fa-f]{4}){2,}|(?:\\x[0-9A-Fa-f]{2}){2,}|(?:&#x?[0-9A-Fa-f]+;){2,}"
)
_BINARY = re.compile(r"\b[01]{7,8}(?:\s+[01]{7,8})+\b|\b(?:[01]{8}){2,}\b")
_HEX = re.compile(r"\b(?:0x)?(?:[0-9A-Fa-f]{2}[\s:]?){6,}\b")
_BASE64 = re.compile(r"(?<![\w/+])[A-Za-z0-9+/_-]{12,}={0,2}(?![\w/+=])")
_BASE32 = re.compile(r"(?<![\w])[A-Z2-7]{16,}={0,6}(?![\w=])")
_MORSE = re.compile(r"(?<![.\-\w])[.\-]{1,5}(?:[ /|]+[.\-]{1,5}){3,}(?![.\-\w])")
_WORD = re.compile(r"[A-Za-z]+(?:['’][a-z]+)?")
_MORSE_CODES = (
    ".- -... -.-. -.. . ..-. --. .... .. .--- -.- .-.. -- -. --- .--. --.- .-. ... - ..- ...- "
    ".-- -..- -.-- --.."
)
_MORSE_LETTERS = dict(zip(_MORSE_CODES.split(), "abcdefghijklmnopqrstuvwxyz", strict=True))
_JOINERS = "\u200c\u200d"  # invisible joiners, which are needed in Indic scripts and in Persian
# A text is deciphered only if at most the fraction HIDDEN of its letters is in known words.
# The result is used only if at least the fraction ENGLISH of its letters is in known words.
ENGLISH, HIDDEN = 0.6, 0.45


@dataclass(frozen=True)
class Decoded:
    """A text after its hidden words were decoded.

    ``marks`` names the methods by which words were hidden, such as "code" or "leet".
    """

    text: str
    marks: frozenset[str]


def decode(text: str, known: Set[str]) -> Decoded:
    """Decode a piece of text; ``known`` contains common English words."""
    marks: set[str] = set()
    if not text.isascii():
        text = _letters(text, marks)
    for pattern, read in _CODES:
        text = pattern.sub(partial(_decoded, read, marks), text)
    if _SPELLED.search(text):
        joined = _SPELLED.sub(_joined, text)
        if _share(joined, known) >= _share(text, known):
            marks.add("spelled")
            text = joined
    text = _MIXED.sub(lambda match: _without_leet(match.group(), known, marks), text)
    if len(re.findall(r"\b[a-z]+[A-Z]+[a-z]\w*|\b[A-Z][a-z]+[A-Z]\w*", text)) > 2:
        marks.add("case")
        text = text.lower()
    if len(_WORD.findall(text)) > 2 and _share(text, known) <= HIDDEN:
        best = max(_ciphers(text), key=lambda read: _share(read, known))
        if _share(best, known) >= ENGLISH:
            marks.add("cipher")
            text = best
    return Decoded(text, frozenset(marks))


def visible(text: str) -> str:
    """Return ``text`` without invisible characters.

    Joiners that follow a letter outside ASCII are kept, because some scripts need them. The
    characters after a right-to-left override are reversed to match the order in which they are
    displayed.
    """
    if text.isascii():
        return text
    text = re.sub("\u202e([^\u202c\n]*)\u202c?", lambda match: match[1][::-1], text)
    signs = []
    for place, sign in enumerate(text):
        needed = sign in _JOINERS and place > 0 and not text[place - 1].isascii()
        if unicodedata.category(sign) not in ("Cf", "Co", "Cs") or needed:
            signs.append(sign)
    return "".join(signs)


def _letters(text: str, marks: set[str]) -> str:
    """Return ``text`` with look-alike characters replaced by Latin letters."""
    plain = unicodedata.normalize("NFKC", text)
    if sum(a.isascii() for a in plain) - sum(a.isascii() for a in text) > 2:
        marks.add("wide")
    parts = unicodedata.normalize("NFD", plain)
    stripped = "".join(c for c in parts if unicodedata.category(c) != "Mn")
    if len(parts) - len(stripped) > 0.5 * len(plain):  # mostly accents
        marks.add("wide")
        plain = stripped
    for word in re.findall(r"\w+", plain):
        read = word.translate(_ALIKE)
        mixed = any(c.isascii() and c.isalpha() for c in word)
        if read != word and read.isascii() and (mixed or len(word) > 2):
            marks.add("alike")
            plain = plain.replace(word, read)
    return plain


def _decoded(read: Callable[[str], str], marks: set[str], match: re.Match[str]) -> str:
    """Decode a match, or return it unchanged if the result is not mostly letters."""
    coded = match.group()
    try:
        decoded = read(coded)
    except (ValueError, binascii.Error, OverflowError):
        return coded
    letters = sum(c.isascii() and (c.isalpha() or c == " ") for c in decoded)
    if len(decoded) < 3 or letters < 0.8 * len(decoded):
        return coded
    marks.add("code")
    return f" {decoded} "


def _base64(coded: str) -> str:
    if coded.isalpha() and (coded.islower() or coded.isupper() or coded.istitle()):
        raise ValueError("a word")
    coded = coded.rstrip("=").replace("-", "+").replace("_", "/")
    return base64.b64decode(coded + "=" * (-len(coded) % 4)).decode("utf-8")


def _base32(coded: str) -> str:
    coded = coded.rstrip("=")
    return base64.b32decode(coded + "=" * (-len(coded) % 8)).decode("utf-8")


def _hex(coded: str) -> str:
    return bytes.fromhex(re.sub(r"0x|[\s:]", "", coded)).decode("utf-8")


def _binary(coded: str) -> str:
    groups = coded.split() if " " in coded else re.findall(r"[01]{8}", coded)
    return "".join(chr(int(group, 2)) for group in groups)


def _escaped(coded: str) -> str:
    if coded.startswith("&"):
        return html.unescape(coded)
    return "".join(chr(int(code, 16)) for code in re.findall(r"(?:%|\\u|\\x)([0-9A-Fa-f]+)", coded))


def _morse(coded: str) -> str:
    codes = re.split(r"\s+|(?=[/|])|(?<=[/|])", coded)
    return "".join(" " if c in ("/", "|") else _MORSE_LETTERS.get(c, "") for c in codes)


_CODES: tuple[tuple[re.Pattern[str], Callable[[str], str]], ...] = (
    (_ESCAPES, _escaped), (_BINARY, _binary), (_HEX, _hex), (_BASE32, _base32), (_BASE64, _base64),
    (_MORSE, _morse),
)  # fmt: skip


def _joined(match: re.Match[str]) -> str:
    """Join the letters of words that were spelled out letter by letter."""
    words = re.split(r"\s{2,}|\s*[/|]\s*", match.group())
    return " ".join(re.sub(r"[^A-Za-z]+", "", word) for word in words)


def _without_leet(word: str, known: Set[str], marks: set[str]) -> str:
    """Replace digits and signs in a word by letters, if the result is a known word."""
    if _MEASURE.fullmatch(word):
        return word
    read = word.lower().translate(_LEET)
    other = word.lower().replace("1", "l").translate(_LEET)
    for candidate in (read, read.replace("i", "l"), other):
        if candidate.strip("i") in known or candidate in known:
            marks.add("leet")
            return candidate
    return word


def _ciphers(text: str) -> Iterator[str]:
    """Yield candidates: the text decoded with each of the common ciphers."""
    lower = text.lower()
    for shift in range(1, 26):
        yield "".join(chr((ord(c) - 97 + shift) % 26 + 97) if "a" <= c <= "z" else c for c in lower)
    yield lower[::-1]
    yield _WORD.sub(lambda match: match.group()[::-1], lower)
    yield "".join(chr(219 - ord(c)) if "a" <= c <= "z" else c for c in lower)
    yield re.sub(r"\b(\w+?)-?([^aeiou\W]*)ay\b", lambda m: re.sub(r"w$", "", m[2]) + m[1], lower)


def _share(text: str, known: Set[str]) -> float:
    """Return the fraction of the letters in ``text`` that belong to known words."""
    tokens = _WORD.findall(text.lower())
    words = [word for word in tokens if word in known and (len(word) > 1 or word in "ai")]
    return sum(map(len, words)) / max(1, sum(map(len, tokens)))
