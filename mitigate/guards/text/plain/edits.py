"""Edits that make plain words of speech: each word or mark is kept, dropped or said in its plain
form, and one of a few phrases may stand before it.

The phrases name no thing, no side, no number and no colour, and a plain form is the same thing or
motion by another name: whatever edits are chosen, they cannot tell of what was not heard.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

from mitigate.corruptions.language.tagger import Token, tag
from mitigate.guards.text.texts.lexicon import FUNCTION
from mitigate.guards.text.texts.plain_words import PHRASES, plain_form

KEEP, DROP, PLAIN = range(3)
CLAUSE_ENDS = frozenset(".,;:!?()–—")
ENDS, PAUSES = frozenset(".!?;:"), frozenset(",;:-–—(")
NUMBER = {phrase: number for number, phrase in enumerate(PHRASES, 1)}  # 0: no phrase
# worth of a pair of words in an alignment: equal, both of one word, a small word, marks (ours)
EQUAL, KIN, SMALL, MARKS, NEXT = 2.0, 1.7, 1.0, 0.4, 0.6


@dataclass(frozen=True)
class Edit:
    """What becomes of a token: ``act`` is KEEP, DROP or PLAIN (of a mark: a full stop);
    ``before``: number of the phrase that stands before it, 0 for none."""

    act: int
    before: int = 0


class Said(NamedTuple):
    """A ``word`` or mark that would be given on, in lower case; the ``place`` of its token, or of
    the one that the ``phrase`` stands before which it is of."""

    word: str
    place: int
    phrase: bool


@dataclass
class Edited:
    """A sentence's tokens and what becomes of each, to be changed in place: its act, and the number
    of the phrase ``before`` it."""

    found: Sequence[Token]
    acts: list[int]
    before: list[int]

    def kept(self, place: int) -> bool:
        """Return whether the token stays, as it is or in its plain form."""
        return self.acts[place] != DROP

    def kept_words(self, place: int) -> list[str]:
        """Return the tokens that stay from ``place`` on, in lower case."""
        return [t.lower for p, t in enumerate(self.found) if p >= place and self.kept(p)]

    def give_back(self, places: Iterable[int]) -> bool:
        """Keep what stands at ``places``, without phrases; return whether that changes anything."""
        changed = False
        for place in places:
            changed |= self.acts[place] == DROP or self.before[place] != 0
            self.before[place] = 0
            if self.acts[place] == DROP:
                self.acts[place] = KEEP
        return changed

    def said(self) -> list[Said]:
        """Return the words and marks that would be given on."""
        made: list[Said] = []
        for place, token in enumerate(self.found):
            if self.before[place]:
                phrase = PHRASES[self.before[place] - 1].split()
                if phrase[-1] != plain_form(token.lower):
                    made += [Said(word, place, True) for word in phrase]
            if self.kept(place):
                made.append(Said(token.lower, place, False))
        return made

    def clause(self, place: int) -> tuple[int, int]:
        """Return the first place of the words between marks around ``place``, and the mark's."""
        first = place
        while first and self.found[first - 1].text not in CLAUSE_ENDS:
            first -= 1
        return first, self.end_of_clause(place)

    def end_of_clause(self, place: int) -> int:
        """Return the place of the next mark from ``place`` on, or the sentence's end."""
        while place < len(self.found) and self.found[place].text not in CLAUSE_ENDS:
            place += 1
        return place


def tokens(text: str) -> list[Token]:
    """Return the words and marks of ``text``, tagged."""
    return tag(text)


def taught(heard: str, meant: str) -> list[Edit]:
    """Return the edits that bring ``heard`` nearest to ``meant``, one a token."""
    source, target = tokens(heard), tokens(meant)
    pairs = [(-1, -1), *align(source, target), (len(source), len(target))]
    acts, before = [DROP] * len(source), [0] * (len(source) + 1)
    for place, goal in pairs[1:-1]:
        acts[place] = KEEP if source[place].lower == target[goal].lower else PLAIN
    for (a, b), (c, d) in zip(pairs, pairs[1:], strict=False):
        number = _phrase([t.lower for t in target[b + 1 : d]])
        if number:
            before[_stands(source, a + 1, c)] = number
    return [Edit(act, number) for act, number in zip(acts, before[:-1], strict=True)]


def _phrase(words: list[str]) -> int:
    """Return the number of the longest phrase at the end of what is missing, else at its start."""
    for start in range(len(words)):
        if number := NUMBER.get(" ".join(words[start:])):
            return number
    for end in range(len(words) - 1, 0, -1):
        if number := NUMBER.get(" ".join(words[:end])):
            return number
    return 0


def _stands(source: Sequence[Token], first: int, last: int) -> int:
    """Return the token that a phrase stands before: the first verb of those it replaces."""
    for place in range(first, last):
        if source[place].tag == "VERB":
            return place
    return first


def align(source: Sequence[Token], target: Sequence[Token]) -> list[tuple[int, int]]:
    """Return the pairs (place in source, place in target) of a best alignment without crossings;
    neighbours that stay neighbours are worth more."""
    rows, columns = len(source), len(target)
    ones = [(token.lower, token.is_word) for token in source]
    others = [(token.lower, token.is_word) for token in target]
    best = [[0.0] * (columns + 1) for _ in range(rows + 1)]
    joined = [[-1e9] * (columns + 1) for _ in range(rows + 1)]
    for i, (one, is_word) in enumerate(ones, 1):
        for j, (other, other_too) in enumerate(others, 1):
            value = _worth(one, other, is_word and other_too)
            if value:
                after = max(joined[i - 1][j - 1] + NEXT, best[i - 1][j - 1])
                joined[i][j] = after + value
            best[i][j] = max(joined[i][j], best[i - 1][j], best[i][j - 1])
    pairs, i, j, inside = [], rows, columns, False
    while i and j:
        if inside or best[i][j] == joined[i][j]:
            pairs.append((i - 1, j - 1))
            inside = joined[i - 1][j - 1] + NEXT >= best[i - 1][j - 1]
            i, j = i - 1, j - 1
        elif best[i][j] == best[i - 1][j]:
            i -= 1
        else:
            j -= 1
    return pairs[::-1]


@lru_cache(maxsize=65536)
def _worth(one: str, other: str, words: bool) -> float:
    if not words:
        ended = one in ENDS and other == "."
        return MARKS if one == other or ended or (one in PAUSES and other == ",") else 0.0
    if one == other:
        return SMALL if one in FUNCTION else EQUAL
    return KIN if plain_form(one) == other else 0.0


def edited(heard: str, edits: Sequence[Edit], found: Sequence[Token] | None = None) -> str:
    """Return ``heard`` after its edits, one a token."""
    found = tokens(heard) if found is None else found
    if all(edit == Edit(KEEP) for edit in edits):
        return heard
    out: list[str] = []  # words, marks and the space before each
    end = -1  # of the last token that was kept, where nothing stands between
    joined = _joining(found, edits)
    for place, (token, edit) in enumerate(zip(found, edits, strict=True)):
        phrase = PHRASES[edit.before - 1].split() if edit.before else []
        if phrase and phrase[-1] != plain_form(token.lower):  # "stop" is not said twice
            for word in phrase:
                out += ["" if word in ".," else " ", word]
            end = -1
        if edit.act == DROP:
            end = -1
            continue
        if place in joined or (out and end == token.start and _tight(found, edits, place)):
            out[-1] += token.text
        elif token.is_word:
            said = _lowered(token, heard) if end < 0 else token.text
            said = plain_form(token.lower) if edit.act == PLAIN else said
            out += [heard[end : token.start] if end >= 0 else " ", said]
        else:
            said = "." if edit.act == PLAIN and token.text in ENDS | PAUSES else token.text
            out += [" " if token.text in '([“"' else "", said]
        end = token.end
    return _closed(out)


def _tight(found: Sequence[Token], edits: Sequence[Edit], place: int) -> bool:
    """Return whether no space belongs between a token and the one before it, which stays, too: by
    a quote or a slash."""

    def inside(place: int) -> bool:
        """Return whether a straight quote at a place is open behind it."""
        mark = found[place].text
        kept = (t.text for t, e in zip(found[: place + 1], edits, strict=False) if e.act != DROP)
        return mark in "\"'" and sum(text == mark for text in kept) % 2 == 1

    one, other = found[place - 1].text, found[place].text
    opens = one in "“‘«/([" or inside(place - 1)
    return opens or other in "”’»/)]" or (other in "\"'" and not inside(place))


def _joining(found: Sequence[Token], edits: Sequence[Edit]) -> set[int]:
    """Return the places of kept hyphens inside a word, and of what stands behind them."""
    joined: set[int] = set()
    for place in range(1, len(found) - 1):
        one, mark, other = found[place - 1 : place + 2]
        tight = mark.text == "-" and one.end == mark.start and mark.end == other.start
        if (
            tight
            and all(e == Edit(KEEP) for e in edits[place : place + 2])
            and edits[place - 1].act != DROP
        ):
            joined |= {place, place + 1}
    return joined


def _lowered(token: Token, heard: str) -> str:
    """Return a word without the capital that only the beginning of a sentence gave it."""
    before = heard[: token.start].rstrip()
    first = not before or before[-1] in ".!?:\n\"'”’)"
    return token.text if token.text[1:].lower() != token.text[1:] or not first or (
        token.lower == "i" or token.lower.startswith("i'")
    ) else token.lower  # fmt: skip


def _closed(out: list[str]) -> str:
    """Join words and marks: one mark at a time, a capital after each full stop, one at the end."""
    made: list[str] = []
    for space, word in zip(out[::2], out[1::2], strict=True):
        mark = not word[:1].isalnum()
        last = made[-1][-1:] if made else ""
        if mark and word in ".,;:!?-–—":
            if not made or last in ",;:-–—" and word not in ".!?":
                continue
            if last in ".!?":
                continue
            if last in ",;:-–—":
                made[-1] = made[-1].rstrip(",;:-–— ")
            made.append(word if word in ".,;:!?" else " " + word)
            continue
        if not made or last in ".!?":
            word = word[:1].upper() + word[1:]
        space = "" if word[0] in ".,;:!?" else space or " "  # a full stop before closing quotes
        made.append(space + word if made else word)
    text = "".join(made).strip().rstrip(",;:-–— ")
    return text + "." if text and text[-1].isalnum() else text
