"""A text cut into pieces that can be judged and taken out one by one.

Sentences first, whatever ends them: full stops before quotes and brackets, lines, markup, a capital
verb where a full stop is missing. Then the parts of a sentence: what stands in brackets or quotes,
behind a colon or a dash, between commas. Too many cuts do no harm, as what is kept keeps its place.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from mitigate.guards.text.texts.decode import CODES, FANCY
from mitigate.guards.text.texts.lexicon import FUNCTION
from mitigate.guards.text.texts.written import quotes

_BEFORE = (
    r"(?<!\bDr)(?<!\bMr)(?<!\bMs)(?<!\bMrs)(?<!\bSt)(?<!\bProf)(?<!\bNo)(?<!\be\.g)(?<!\bi\.e)"
    r"(?<!\bvs)(?<!\bapprox)(?<!\bRm)(?<!\bApt)(?<!\bFig)(?<!\bfl)(?<!\bJr)(?<!\bft)(?<!\b[ap]\.m)"
)
_STARTS = (
    "Walk|Go|Turn|Exit|Leave|Enter|Head|Continue|Proceed|Take|Make|Pass|Climb|Descend|Ascend|Stop|"
    "Wait|Move|Cross|Follow|Veer|Bear|Keep|Step|Face|Start|Begin|Once|When|After|From|With|Then|"
    "Next|You|There|Now|Find|Look|Come|Get|Stand|Facing|Starting|Upon|As|At|The|In|On|Hey|Hi|Hello|"
    "Okay|Please|Kindly|First|Finally|Let|Just|Right|Left|Out|Up|Down|Past|Straight"
)
# what stands for a space, and what no reader sees: zero width, soft hyphens, control characters
_GAP = r"[\s\x00-\x1f\x7f\u00ad\u200b-\u200f\u2028-\u202f\u2060-\u2064\ufeff]"
_STOP = r"[.!?…‼⁇-⁉؟।॥。｡．！？]"
_CLOSE = r"[\"'”’»)\]*_]"
# pictures and signs that part sentences as full stops do
_SIGN = r"[•‣·◦|¦/\\~=^→-⇿☀-➿⬀-⯿\U0001f000-\U0001faff\ufe0e\ufe0f]"
_PICTURE = r"[☀-➿\U0001f000-\U0001faff]"
_END = re.compile(
    rf"{_BEFORE}{_STOP}+{_CLOSE}*(?:(?:{_GAP}|{_SIGN})+|$)"
    rf"|(?<=[\w)]){_STOP}+[\"'”’»)\]—–]*(?=[A-Z][a-z]|(?:{_STARTS.lower()})\s+[a-z])"
    r"|[।॥。｡！？]+|\s*\n+\s*"
    rf"|\s+{_SIGN}+\s+|\s*(?:{_PICTURE}[\ufe0e\ufe0f\u200d]?)+\s*"
    rf"|(?<=[a-z0-9)\]>}}=\"'”’;,])\s+(?=(?:{_STARTS})\s+[a-z])"
    rf"|(?<=:)\s+[\"“'‘]?(?=(?:{_STARTS})\s)"
)
_STRAY = re.compile(rf"(?<={_STOP})(?:{_GAP}|{_SIGN})+$")  # between a sentence and one that went
_SIGNS = re.compile(rf"(?:{_SIGN}|\s|\u200d)+")
_PHRASE = 4  # words on both sides of a sign that parts sentences (ours)
_TAG = (
    r"</?[a-z][\w-]*(?:\s+[\w-]+\s*=[^<>]*)?\s*/?>|<\|[^|<>]*\|>|<</?\w+>>"
    r"|\[/?[A-Z]{3,}(?: [A-Z]+)*\]|<!--|-->|```\w*|/\*|\*/"
)
_TAGS = re.compile(_TAG)
_MARKUP = re.compile(
    r"<!--.*?(?:-->|$)|```.*?(?:```|$)|<\|.*?\|>.*?(?:<\|.*?\|>|$)|<<\w+>>.*?(?:<</\w+>>|$)"
    r"|/\*.*?(?:\*/|$)|(?:<([a-z]\w*)\b[^<>]*>.*?</\1>\s*)+"
    r"|(?:</?[a-z]\w*(?:\s+\w+\s*=[^<>]*)?\s*/?>\s*)+(?:[^<>]{1,300}</[a-z]\w*>)?"
    r"|\[(?!MASK|UNK|mask)(\w+)\].*?\[/\2\]"
    r"|(?:\[[A-Z]{3,}(?: [A-Z]+)+\]\s*)+(?:[^\[]*\[[A-Z]{3,}(?: [A-Z]+)+\])?"
    r"|\{[^{}]*(?:\{[^{}]*\}[^{}]*)*:[^{}]*(?:\{[^{}]*\}[^{}]*)*\}"
    r"|(?:^|(?<=\s))#{1,6} (?!\d)[^\n.]*[\n.]?(?: ?(?<=\n)[^\n.]*\.?)?|(?:^|(?<=\s))// [^\n.]*\.?"
    r"|(?:^|(?<=\n)|(?<=[.!?] ))---\n.*?\n---|(?:(?:^|(?<=\n)|(?<=[.!?] ))- \[[x ]\][^\n]*\n?)+"
    r"|\*\*[^*\n]+\*\*[^.\n]*\.?"
    r"|(?<![A-Za-z] )\b(?:System|User|Assistant|Human|AI|Bot|Operator)\s?:[^.!?]*[.!?]?"
    rf"|(?:[{FANCY}]+[\s\u3000]*){{2,}}|\u202e[^\u202c]*\u202c?|[\U000e0020-\U000e007f]+"
    r"|\S?(?:[\u200b-\u200d\u2060\ufeff]\s?[^\s\u200b]?){4,}"
    r"|(?<![^\W\d_])(?:[\u0370-\u1dff\u2c80-\ua4cf\uac00-\ud7ff\uf900-\ufaff]{2,}[^A-Za-z\n]*)+"
    rf"|{CODES.pattern}",
    re.DOTALL,
)
_OPEN_ENDED = re.compile(r"#|//|[A-Z]|\*\*")
_MASKS = re.compile(r"(?:(?:<(?:mask|unk)>|\[(?:MASK|UNK|mask)\])\s*)+")
_ENCLOSED = re.compile(
    r"\([^()]*\)|\[[^\[\]]*\]|\"[^\"]*\"|“[^”]*”|«[^»]*»|(?<!\w)'[^'\n]*(?:\w'\w[^'\n]*)*'(?!\w)"
    r"|[^\x00-\u024f\u2000-\u206f]{2,}(?:\s*[^\x00-\u024f\u2000-\u206f]+)*"
)
SENTENCES = 100  # of a section (ours)
_MARKS = " ,;:–—-"  # that join what stands beside them
_CUT = re.compile(r"(?<=[:;,])\s+|\s+[-–—]+\s+|\s+(?=(?:but|although|unless|which|or rather)\s)")


@dataclass(frozen=True)
class Piece:
    """``text[start:end]`` of a text; ``block``: the number of the markup it stands in, 0 for none;
    ``tag``: whether it is a mark of that markup and no words of it."""

    start: int
    end: int
    block: int = 0
    tag: bool = False

    def of(self, text: str) -> str:
        """Return the piece of ``text``."""
        return text[self.start : self.end]


def sentence_pieces(text: str) -> list[Piece]:
    """Return the sentences of ``text`` in order, without the spaces between them."""
    found: list[Piece] = []
    at = block = 0
    for match in _MARKUP.finditer(text):
        if _MASKS.fullmatch(match.group()) or not match.group().strip() or _mixed(text, match):
            continue
        block += 1
        found += _sentences(text, at, match.start())
        found += _marked(text, match, block)
        at = match.end()
    return found + _sentences(text, at, len(text))


def parts(text: str, piece: Piece) -> list[Piece]:
    """Return the parts of a sentence: enclosed ones, and what commas, colons, dashes divide; none
    if there is but one."""
    body, found, at = piece.of(text), [], 0
    for match in _ENCLOSED.finditer(body):
        found += list(_cut(body, at, match.start()))
        found.append((match.start(), match.end()))
        at = match.end()
    found += list(_cut(body, at, len(body)))
    made = [Piece(piece.start + a, piece.start + b, piece.block) for a, b in found]
    return made if len(made) > 1 else []


def _mixed(text: str, match: re.Match[str]) -> bool:
    """Return whether letters of another script end within a word of Latin ones."""
    last, after = match.group()[-1], text[match.end() : match.end() + 1]
    return not last.isascii() and last.isalpha() and after.isalpha()


def _marked(text: str, match: re.Match[str], block: int) -> list[Piece]:
    """Return tags and sentences of a match of markup; what runs on behind a heading, a comment or a
    speaker's name is none."""
    if not any(c.isprintable() for c in match.group()):
        return [Piece(match.start(), match.end(), block, tag=True)]
    found, at = [], match.start()
    for mark in _TAGS.finditer(text, match.start(), match.end()):
        found += _sentences(text, at, mark.start(), block)
        found.append(Piece(mark.start(), mark.end(), block, tag=True))
        at = mark.end()
    found += _sentences(text, at, match.end(), block)
    if not _OPEN_ENDED.match(match.group()):
        return found
    for index, (piece, after) in enumerate(zip(found, found[1:], strict=False), 1):
        if "\n" not in text[piece.end : after.start]:
            return found[:index] + [Piece(p.start, p.end) for p in found[index:]]
    return found


def _sentences(text: str, start: int, end: int, block: int = 0) -> list[Piece]:
    found, at = [], start
    whole = [(a, b) for _, a, b, _ in quotes(text)]  # no sentences of their own
    for match in _END.finditer(text, start, end):
        sign = _SIGNS.fullmatch(match.group().strip())
        if sign and not _parts(text[at : match.start()], text[match.end() : end]):
            continue
        goes_on = text[match.end() : match.end() + 1].islower()
        if any(a < match.start() < b and (match.end() < b or goes_on) for a, b in whole):
            continue
        found.append((at, match.end()))
        at = match.end()
    found.append((at, end))
    return [Piece(*s, block) for a, b in found if (s := _stripped(text, a, b))]


def _parts(before: str, behind: str) -> bool:
    """Return whether a picture or a sign stands between two sentences, and not for a word."""
    left, right = before.split(), re.split(r"[.!?\n]", behind, maxsplit=1)[0].split()
    return min(len(left), len(right)) >= _PHRASE and left[-1].lower() not in FUNCTION


def _cut(body: str, start: int, end: int) -> Iterator[tuple[int, int]]:
    at = start
    for match in _CUT.finditer(body, start, end):
        if span := _stripped(body, at, match.start()):
            yield span
        at = match.end()
    if span := _stripped(body, at, end):
        yield span


def _stripped(text: str, start: int, end: int) -> tuple[int, int] | None:
    while start < end and text[start].isspace():
        start += 1
    while end > start and text[end - 1].isspace():
        end -= 1
    return (start, end) if start < end else None


def without(text: str, out: Iterable[Piece]) -> str:
    """Return ``text`` without some pieces, with a capital where it now begins. What was not beside
    a piece that went stays as it was, but for its spaces."""
    out = sorted(out, key=lambda piece: piece.start)
    if not out:
        return text
    kept, at = [], 0
    for piece in out:
        kept.append(_STRAY.sub("", text[at : piece.start].strip()))
        at = max(at, piece.end)
    kept.append(text[at:].strip())
    for place in range(1, len(kept)):  # what a sentence begins with now
        before = "".join(kept[:place]).rstrip("\"'”’) ")
        if before.endswith((".", "!", "?")) and text[: out[place - 1].start].rstrip()[-1:] in ".!?":
            kept[place] = kept[place][:1].upper() + kept[place][1:]
    left = kept[0]
    for part in kept[1:]:
        left = _joined(left, part)
    left = " ".join(_closed(text, left).split())
    return left[:1].upper() + left[1:] if not text.lstrip().startswith(left[:1]) else left


def _joined(left: str, right: str) -> str:
    """Return what stood before and behind a piece that went, with one mark between them."""
    if not left:
        return right.lstrip(".,;:!?- ")
    bare = right.lstrip(_MARKS)
    if not bare:
        return left.rstrip(_MARKS)
    if bare[0] in ".!?":
        return left.rstrip(_MARKS + ".!?") + bare
    if len(bare) < len(right):  # one of the marks that stood before and behind
        mark = next((m for m in (left[-1], right[0]) if m in ",;:.!?"), "")
        return f"{left.rstrip(_MARKS + '.!?')}{mark or ','} {bare}"
    return f"{left} {right}"


def _closed(text: str, left: str) -> str:
    """Return ``left`` without quotes and brackets of which one went with a piece of ``text``."""
    for opening, closing in ("()", "[]", "{}", "“”", "«»"):
        if _even(text, opening, closing) and not _even(left, opening, closing):
            left = left.replace(opening, " ").replace(closing, " ")
    if not text.count('"') % 2 and left.count('"') % 2:
        left = left.replace('"', " ")
    if not text.count("'") % 2 and left.count("'") % 2:
        left = re.sub(r"(?<!\w)'(?=[^']*$)|(?<=[.!?])'(?=\s|$)", " ", left)
    return re.sub(r"\s+(?=[,.!?;](?:\s|$))", "", left)


def _even(text: str, opening: str, closing: str) -> bool:
    return text.count(opening) == text.count(closing)


def sections(text: str, longest: int) -> list[str]:
    """Return ``text`` in consecutive parts of at most ``longest`` characters and ``SENTENCES``
    sentences, cut behind the last end of a sentence or, failing that, space of each."""
    found, at = [], 0
    while at < len(text):
        part = text[at : at + longest]
        ends = [m.end() for m in re.finditer(r"[.!?]\s+|\n\s*", part)][:SENTENCES]
        if at + longest < len(text) or len(ends) == SENTENCES:
            space = part.rfind(" ") + 1
            part = part[: (ends[-1] if ends else 0) or space or longest]
        found.append(part)
        at += len(part)
    return found
