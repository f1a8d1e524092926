"""Split an instruction into sentences, and sentences into clauses.

A piece is a span of the original text, so deleting it changes nothing else. A block between
delimiters, such as tags or comment marks, is a separate piece. Where the script changes, a new
piece begins.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass

from mitigate.corruptions.language.words import bag

# HTML tags, code comments and similar blocks never occur in a route; each block is one piece.
# The text between most delimiters is limited to 4,000 characters (heuristic).
# Searches from each opening delimiter to the end of the text would take quadratic time.
_BLOCK = re.compile(
    r"<!--.*?(?:-->|$)|/\*.*?(?:\*/|$)|```.*?(?:```|$)|\{\{.{0,4000}?\}\}"
    r"|<(?P<tag>[a-zA-Z][\w:-]*)[^<>]*>.{0,4000}?</\s*(?P=tag)\s*>"
    r"|\[(?P<mark>[A-Za-z_]+)\].{0,4000}?\[/\s*(?P=mark)\s*\]"
    r"|(?<![.\-\w])[.\-]{1,5}(?:[ /|]+[.\-]{1,5}){3,}(?![.\-\w])"
    r"|<\|[^<>|]*\|>|</[A-Za-z][^<>\n]{0,60}>|<[A-Za-z][\w:-]*(?:\s[^<>\n]{0,200}|/)>|<<[^<>]*>>"
    r"|</?(?:system|user|assistant|admin|human|tool|inst|prompt|s|im_start|im_end)>",
    re.DOTALL | re.IGNORECASE,
)
_SENTENCE = re.compile(
    r"(?<=[.!?…。！？।॥])[\"'”’)\]*_]*\s+|(?<=[.!?])(?=[A-Z][a-z])|\s*\n+\s*|(?<=[.!?][\"'”’)])\s+"
)
# These words begin a sentence.
# If one has a capital letter without a full stop before it, an attack may begin or end there.
# "I" is not listed, because it is always a capital letter.
_BEGINS = (
    "Go|Walk|Turn|Exit|Leave|Enter|Head|Take|Make|Move|Continue|Proceed|Climb|Pass|Stop|Find|Start|Stand|"
    "Follow|Veer|Step|Wait|Come|Get|Keep|Look|Cross|Face|Do|Don't|Never|Always|Ignore|Forget|Bring|Let|Let's|"
    "With|From|Starting|Facing|Travel|One|Would|Could|Can|Will|You|Your|The|An?|It|It's|He|He's|She|She's|"
    "They|We|My|Our|And|So|Now|Then|When|Once|After|Before|At|In|On|Out|Up|Down|Over|Past|Through|"
    "Behind|Beyond|Until|If|As|To|For|By|Kindly|Please|Pray|Oh|Well|Hey|Hi|Hello|Ok|Okay|Alright|Ladies|"
    "Dear|Right|Left|Straight|Just|There|There's|This|That|Here|Here's|Where|What|Is|Are|Not|No|Yes|First|"
    "Second|Next|Last|Finally|Roll|Off|Into|Along|Around|Across|Breathe"
)
_RUN_ON = re.compile(rf"(?<=[\w\])}}>=*\"'~|✔…])\s+(?=(?:{_BEGINS})\b[,']?\s[a-z(])")
_CLAUSE = re.compile(
    r"(?<=[,;:])\s+|\s+(?=[-–—]{1,3}\s)|(?<=\s[-–—])\s+|(?<=\s--)\s+|(?<=[—])|(?=[—])"
    r"|\s+(?=(?:and|but|until|or|so|because|unless|if|which|where|while|when)\b)"
    r"|(?<!\band)(?<!\bAnd)\s+(?=then\b)"
    r"|\s+(?=[\[({<])|(?<=[\])}>])\s+|(?<=[\])}>])(?=\w)|\s+(?=//|#\w|\||/\s)|(?<=\s[/|])\s+"
)
# A word of _CALL may begin a sentence even if no full stop precedes it.
# After the words of _LINKS, a capital letter begins a name and not a sentence.
_CALL = re.compile(r"(?:um+|uh|okay|ok|yo|hey|arr+|please|kindly)\b")
_LINKS = bag(
    "the a an of to at in by on is my your our its and or for from with past this that into near"
)
LETTERS = re.compile(r"[^\W\d_]")
_ABBREVIATION = re.compile(
    r"\b(?:Mr|Mrs|Ms|Dr|St|No|Prof|approx|ft|e\.g|i\.e|vs|rm|etc)\.\s*$", re.I
)
# number of characters before a sentence boundary that are searched for an abbreviation
ABBREVIATED = 10
# minimum number of words in a clause; shorter clauses are joined to the previous clause
MIN_WORDS = 2


@dataclass(frozen=True)
class Piece:
    """A span of a text; ``block`` states whether it is between delimiters."""

    start: int
    end: int
    block: bool = False

    def of(self, text: str) -> str:
        return text[self.start : self.end]


def sentence_pieces(text: str) -> list[Piece]:
    """Return the sentences and blocks of a text, in order."""
    pieces: list[Piece] = []
    at = 0
    for match in _BLOCK.finditer(text):
        pieces += _cut(text, at, match.start(), _sentence_cuts)
        pieces.append(Piece(match.start(), match.end(), True))
        at = match.end()
    return [*pieces, *_cut(text, at, len(text), _sentence_cuts)]


def clause_pieces(text: str, sentence: Piece) -> list[Piece]:
    """Return the clauses of a sentence.

    If possible, a clause of a single word is joined to a neighbouring clause.
    """
    if sentence.block:
        return [sentence]
    clauses: list[Piece] = []
    before = ""  # script of the last clause, which is not computed again for joined clauses
    opened = False  # whether the last clause is one capitalised word that begins a new sentence
    for piece in _cut(text, sentence.start, sentence.end, _clause_cuts):
        first = text[piece.start]
        short = len(piece.of(text).split()) < MIN_WORDS and first not in "([{<"
        joined = opened or short and not first.isupper()
        opened = short and first.isupper() and bool(clauses)
        here = script(piece.of(text))
        if clauses and joined and here == before:
            clauses[-1] = Piece(clauses[-1].start, piece.end)
        else:
            clauses.append(piece)
            before = here
    return clauses


def _cut(text: str, start: int, end: int, cuts) -> list[Piece]:
    part = text[start:end]
    edges = [0]
    for low, high in sorted({*cuts(part), *_script_cuts(part)}):
        if low >= edges[-1]:
            edges += [low, high]
    edges.append(len(part))
    pieces = []
    for low, high in zip(edges[::2], edges[1::2], strict=True):
        fragment = part[low:high]
        if fragment.strip():
            left = low + len(fragment) - len(fragment.lstrip())
            pieces.append(Piece(start + left, start + left + len(fragment.strip())))
    return pieces


def _sentence_cuts(part: str) -> list[tuple[int, int]]:
    cuts = [
        match.span()
        for match in _SENTENCE.finditer(part)
        # only the last characters are searched; a search from the start would take quadratic time
        if not _ABBREVIATION.search(part[: match.start()].rstrip()[-ABBREVIATED:])
    ]
    return cuts + [match.span() for match in _RUN_ON.finditer(part)]


def _clause_cuts(part: str) -> list[tuple[int, int]]:
    return [match.span() for match in _CLAUSE.finditer(part)] + _seams(part)


def _seams(part: str) -> list[tuple[int, int]]:
    """Return the positions inside a sentence where an attack may begin or end without a full stop.

    Such a position is before a capitalised word, before an interjection such as "um", or at the
    start or end of a sequence of words in capitals.
    """
    cuts = []
    words = list(re.finditer(r"\S+", part))
    caps = [len(word.group()) > 1 and word.group().isupper() for word in words]
    for place in range(1, len(words)):
        before, word = words[place - 1].group(), words[place].group()
        starts = word[0].isupper() and not before[0].isupper() or bool(_CALL.match(word))
        if caps[place] or caps[place - 1]:
            starts = caps[place] != caps[place - 1] and (
                caps[place - 2 : place] == [True, True] or caps[place : place + 2] == [True, True]
            )
        if starts and before not in _LINKS:
            cuts.append((words[place - 1].end(), words[place].start()))
    return cuts


def _script_cuts(part: str) -> list[tuple[int, int]]:
    """Return the positions between two words in different scripts."""
    if part.isascii():
        return []
    cuts = []
    before, at = "", 0
    for match in re.finditer(r"\S+", part):
        here = script(match.group())
        if here and before and here != before:
            cuts.append((at, match.start()))
        before, at = here or before, match.end()
    return cuts


def script(text: str) -> str:
    """Return "latin" if at least half of the letters are Latin, otherwise "other".

    Fullwidth letters and those of mathematical alphabets count as Latin. For a text without
    letters, return "".
    """
    letters = LETTERS.findall(unicodedata.normalize("NFKC", text))
    if not letters:
        return ""
    latin = sum(c.isascii() or unicodedata.name(c, "").startswith("LATIN") for c in letters)
    return "latin" if 2 * latin >= len(letters) else "other"


def without(text: str, pieces: Sequence[Piece]) -> str:
    """Delete ``pieces`` from ``text``, and tidy up spaces and punctuation."""
    rest, at = "", 0
    for piece in sorted(pieces, key=lambda piece: piece.start):
        rest += text[at : piece.start].rstrip() + " "
        at = max(at, piece.end)
        while at < len(text) and text[at].isspace():
            at += 1
    left = (rest + text[at:]).strip()
    left = re.sub(r"\s+([,.;!?])", r"\1", left)
    left = re.sub(r"^[,;:.!?\s–—-]+(?=\w)", "", left)
    left = re.sub(r"(?:,\s*(?:and|then|but|or|so)?|\s+(?:and|then|but|or))\s*$", "", left).rstrip()
    return left[:1].upper() + left[1:] if left[:1].islower() and text[:1].isupper() else left


def sentences(text: str) -> list[str]:
    """Return the sentences of a text, including their end marks."""
    return [piece.of(text) for piece in sentence_pieces(text)]
