"""What the tagger makes of an instruction, sentence by sentence, each past the gate.

A sentence that the gate refuses is tried again without phrases, then with only those edits that the
tagger is sure of, and else left as it was heard.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from mitigate.corruptions.language.tagger import Token
from mitigate.corruptions.language.words import bag
from mitigate.guards.text.fidelity import gate
from mitigate.guards.text.plain.edits import CLAUSE_ENDS, DROP, KEEP, Edit, edited
from mitigate.guards.text.plain.manners import asks_for_else
from mitigate.guards.text.plain.taken_back import SURE, taken_back
from mitigate.guards.text.texts.pieces import sentence_pieces
from mitigate.guards.text.texts.steps import HALTS, MOVES, STEP
from mitigate.guards.text.texts.text import MASK, words
from mitigate.guards.text.texts.written import written

# probability of dropping from which a word goes, and whether phrases are put, at each try (chosen
# on the validation voices)
TRIES = ((0.65, True), (0.65, False), (0.95, False))
SPEECH = 0.3  # mean probability of dropping a word from which a text counts as speech (the same)
_JOINS = bag("then and next now finally or")
_LEADS = MOVES | STEP.keys() | HALTS | bag("face facing keep start starting standing past")


@dataclass(frozen=True)
class Tagged:
    """A text as a tagger sees it: its ``tokens``; for each the ``edit`` that is likeliest if it
    is not dropped, and the probability ``drop`` that it is; ``attack``: that it is part of an
    attack, empty where the tagger does not say; ``least``: how much must go for it to be speech;
    ``more``: how much more, if each of its clauses begins as a route's does."""

    tokens: tuple[Token, ...]
    edits: tuple[Edit, ...]
    drop: tuple[float, ...]
    attack: tuple[float, ...] = ()
    least: float = SPEECH
    more: float = 0.0

    def edit(self, place: int, least: float = TRIES[0][0], phrases: bool = True) -> Edit:
        """Return what becomes of a token that is dropped from the probability ``least`` on."""
        made = self.edits[place]
        act = DROP if self.drop[place] > least else made.act
        return Edit(act, made.before if phrases else 0)

    def all_edits(self, text: str) -> str:
        """Return ``text`` after all edits, without rules and gate."""
        made = [self.edit(place) for place in range(len(self.tokens))]
        return edited(text, made, self.tokens)

    def attacked(self, start: int, end: int) -> float | None:
        """Return how probably the words of ``text[start:end]`` are an attack, in the mean; None
        where the tagger does not say, or there is no word."""
        found = [
            p
            for token, p in zip(self.tokens, self.attack, strict=False)
            if start <= token.start < end and token.is_word
        ]
        return sum(found) / len(found) if found else None

    @property
    def speech(self) -> float:
        """How much of the text would go, 0 to 1."""
        found = [p for token, p in zip(self.tokens, self.drop, strict=True) if token.is_word]
        return sum(found) / max(1, len(found))


@dataclass(frozen=True)
class Said:
    """A sentence, or several in a row, as it was ``heard``, and as it is ``said`` plainly;
    ``aside``: words of it, in lower case, that went and surely tell nothing of the way."""

    heard: str
    said: str
    aside: tuple[str, ...] = ()


class Tags(Protocol):
    """What tags a text."""

    def tag(self, text: str) -> Tagged: ...

    def __hash__(self) -> int: ...


def judging(tags: Tags | None, text: str) -> Tags | None:
    """Return ``tags`` if it says what of ``text`` is an attack, None otherwise."""
    return tags if tags is not None and tags.tag(text).attack else None


def is_speech(tagged: Tagged) -> bool:
    """Return whether a text is surely no plain route."""
    return tagged.speech >= tagged.least + tagged.more * led(tagged.tokens)


def led(found: Sequence[Token]) -> float:
    """Return the share of clauses that begin as those of a plain route do: with a verb of motion, a
    turn or a stop, whatever joins it to what stands before."""
    begins, told = True, []
    for token in found:
        if token.text in CLAUSE_ENDS:
            begins = True
        elif begins and token.is_word and token.lower not in _JOINS:
            told.append(token.lower in _LEADS)
            begins = False
    return sum(told) / max(1, len(told))


def plainly_said(text: str, tagged: Tagged) -> tuple[list[Said], list[str]]:
    """Return what becomes of each sentence of ``text``, and what was kept for which reason."""
    reasons: list[str] = []
    for tries in (TRIES, TRIES[-1:]):
        found, kept = _all_said(text, tagged, tries)
        said = together(found)
        problem = gate.result_refused(text, said) or gate.goal_refused(text, said)
        reasons += [*kept, *([f"kept all: {problem}"] if problem else [])]
        if not problem:
            return found, reasons
    return [replace(part, said=part.heard) for part in found], reasons


def together(found: Sequence[Said]) -> str:
    """Return what all of them say."""
    return " ".join(part.said for part in found if part.said)


def _all_said(
    text: str, tagged: Tagged, tries: Sequence[tuple[float, bool]]
) -> tuple[list[Said], list[str]]:
    found, reasons = [], []
    for piece in sentence_pieces(text):
        heard = text[piece.start : piece.end]
        places = [i for i, t in enumerate(tagged.tokens) if piece.start <= t.start < piece.end]
        said, problem = _sentence(text, heard, tagged, places, tries)
        kept = set(words(said))
        sure = (tagged.tokens[i].lower for i in places if tagged.drop[i] >= SURE)
        aside = tuple(word for word in sure if word not in kept)
        found.append(Said(heard, said, aside))
        if problem:
            reasons.append(f"kept {heard[:40]!r}: {problem}")
    return found, reasons


def _sentence(
    text: str,
    heard: str,
    tagged: Tagged,
    places: Sequence[int],
    tries: Sequence[tuple[float, bool]],
) -> tuple[str, str]:
    """Return what is given on of a sentence, and why it is not what the tagger would say."""
    if MASK.search(heard):
        return heard, "words are hidden"
    found = [tagged.tokens[i] for i in places]
    stands = {i for a, b in written(text) for i in places if a <= tagged.tokens[i].start < b}
    refused = ""
    for least, phrases in tries:
        edits = [Edit(KEEP) if i in stands else tagged.edit(i, least, phrases) for i in places]
        edits = taken_back(found, edits, [tagged.drop[i] for i in places])
        if all(edit == Edit(KEEP) for edit in edits):
            return heard, refused
        said = edited(text, edits, found)
        if not gate.weight(said) or (gate.weight(said) == 1 and len(words(said)) < 2):
            said = ""  # what is left tells nothing
        aside = [
            token.lower
            for token, edit, i in zip(found, edits, places, strict=True)
            if edit.act == DROP and tagged.drop[i] >= SURE
        ]
        problem = gate.edit_refused(heard, said, aside)
        if not problem and asks_for_else(heard, said):
            problem = "it asks for no step"
        if not problem:
            return said, ""
        refused = refused or problem
    return heard, refused
