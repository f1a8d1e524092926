"""What the tagger makes of an instruction, sentence by sentence, each past the gate.

A sentence that the gate refuses is tried again with only those edits that the tagger is sure of,
and then left as it was heard.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from mitigate.corruptions.language.tagger import Token
from mitigate.safeguard import gate
from mitigate.safeguard.edits import DROP, KEEP, Edit, edited
from mitigate.safeguard.pieces import sentence_pieces
from mitigate.safeguard.text import MASK

# probabilities of dropping from which a word goes, at the first and the second try; and from which
# it may go although it may tell of the way (chosen on the validation voices)
TRIES = (0.5, 0.9)
SURE = 0.97
SPEECH = 0.12  # mean probability of dropping a word from which a text counts as speech (the same)


@dataclass(frozen=True)
class Tagged:
    """A text as a tagger sees it: its ``tokens``; for each the ``edit`` that is likeliest if it
    is not dropped, and the probability ``drop`` that it is."""

    tokens: tuple[Token, ...]
    edits: tuple[Edit, ...]
    drop: tuple[float, ...]

    @property
    def speech(self) -> float:
        """How much of the text would go, 0 to 1."""
        found = [p for token, p in zip(self.tokens, self.drop, strict=True) if token.is_word]
        return sum(found) / max(1, len(found))


class Tags(Protocol):
    """What tags a text."""

    def tag(self, text: str) -> Tagged: ...


def is_speech(tagged: Tagged) -> bool:
    """Return whether a text is surely no plain route."""
    return tagged.speech >= SPEECH


def plainly_said(text: str, tagged: Tagged) -> tuple[str, list[str]]:
    """Return ``text`` in plain words, and what was kept for which reason."""
    given, reasons = [], []
    spans = [(piece.start, piece.end) for piece in sentence_pieces(text)]
    for index, (start, end) in enumerate(spans):
        chosen = [i for i, t in enumerate(tagged.tokens) if start <= t.start < end]
        said, problem = _sentence(text, text[start:end], tagged, chosen, index == len(spans) - 1)
        given.append(said)
        if problem:
            reasons.append(f"kept {text[start:end][:40]!r}: {problem}")
    said = " ".join(part for part in given if part)
    problem = gate.result_refused(text, said)
    if problem:
        return text, [*reasons, f"kept all: {problem}"]
    return said, reasons


def _sentence(
    text: str, heard: str, tagged: Tagged, chosen: Sequence[int], last: bool
) -> tuple[str, str]:
    found = [tagged.tokens[i] for i in chosen]
    refused = ""
    if MASK.search(heard):
        return heard, "words are hidden"
    for least in TRIES:
        edits = [
            replace(tagged.edits[i], act=DROP) if tagged.drop[i] > least else tagged.edits[i]
            for i in chosen
        ]
        if all(edit == Edit(KEEP) for edit in edits):
            return heard, refused
        said = edited(text, edits, found)
        sure = [
            t for t, e, i in zip(found, edits, chosen, strict=True)
            if e.act == DROP and tagged.drop[i] >= SURE
        ]  # fmt: skip
        problem = gate.edit_refused(heard, said, [t.lower for t in sure], last)
        if not problem:
            return said, ""
        refused = refused or problem
    return heard, refused
