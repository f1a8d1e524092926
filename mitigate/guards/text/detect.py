"""Find what does not belong to an instruction, and take it out if the gate allows."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from mitigate.guards.text import gate
from mitigate.guards.text.classifier import FEATURES, Classifier, Segment, spans
from mitigate.guards.text.pieces import Piece, without

MOST = 40  # clauses that are read together; the time grows with their square
CUTS = 4  # spans that are taken out of as many clauses
READ = 60_000  # characters that are read
_COLUMN = {name: number for number, name in enumerate(FEATURES)}


def take_out(text: str, classifier: Classifier) -> tuple[str, list[str], list[str]]:
    """Return ``text`` without what is foreign, the pieces that were taken out, and refusals.

    Only whole pieces go, and an instruction is left.
    """
    segments = classifier.segments(text[:READ])
    pieces: list[Piece] = []
    refusals: list[str] = []
    for part in windows(segments):
        others = len(segments) > len(part)
        for piece in foreign(part, classifier, others):
            rest = without(text, [*pieces, piece])
            problem = gate.leaves_no_instruction(text, piece.of(text), rest)
            if problem:
                refusals.append(f"kept {piece.of(text)[:40]!r}: {problem}")
            else:
                pieces.append(piece)
    removed = [piece.of(text) for piece in sorted(pieces, key=lambda piece: piece.start)]
    return (without(text, pieces) if pieces else text), removed, refusals


def windows(segments: Sequence[Segment]) -> Iterator[list[Segment]]:
    """Yield the clauses in groups of at most ``MOST``, cut between sentences if possible."""
    start = 0
    while start < len(segments):
        end = min(len(segments), start + MOST)
        if end < len(segments):
            cuts = [
                i for i in range(start + 1, end) if segments[i].sentence != segments[i - 1].sentence
            ]
            end = cuts[-1] if cuts else end
        yield list(segments[start:end])
        start = end


def foreign(segments: list[Segment], classifier: Classifier, others: bool = False) -> list[Piece]:
    """Return the spans of a text that do not belong to it, the surest first.

    ``others``: the text goes on outside these clauses.
    """
    found: list[Piece] = []
    while len(segments) > 1 and len(found) < CUTS:
        first, last, rows = spans(segments, classifier.bias)
        score = np.where(_allowed(rows), classifier.logits(rows), -np.inf)
        top = score.max()
        if not np.isfinite(top) or top + np.log(np.exp(score - top).sum()) < classifier.threshold:
            break
        best = int(score.argmax())
        low, high = int(first[best]), int(last[best])
        found.append(Piece(segments[low].piece.start, segments[high].piece.end))
        segments = segments[:low] + segments[high + 1 :]
    return found


def _allowed(rows: np.ndarray) -> np.ndarray:
    """Return which spans may go at all.

    Text in another script goes only if what is left is surely an English route: nobody here can
    tell a route in that script from an attack.
    """
    other = rows[:, _COLUMN["other script"]] > 0
    surely_route = rows[:, _COLUMN["rest"]] < -1.0
    return (rows[:, _COLUMN["words of the rest"]] >= np.log1p(2)) & (~other | surely_route)
