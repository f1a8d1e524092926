"""Find what does not belong to an instruction, and take it out if the gate allows."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import groupby

import numpy as np

from mitigate.guards.text import gate
from mitigate.guards.text.classifier import FEATURES, Classifier, Segment, spans
from mitigate.guards.text.pieces import Piece, without

MOST = 40  # clauses that are read together; the time grows with their square
ROUTE = -1.0  # score below which English text is surely a route
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
        for piece in foreign(part, classifier):
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


def foreign(segments: list[Segment], classifier: Classifier) -> list[Piece]:
    """Return the spans of a text that do not belong to it, the surest first."""
    english = [s for s in segments if s.script != "other"]
    if len(english) < len(segments) and whole(english, classifier.bias) > ROUTE:
        return _english_attacks(segments, classifier.bias)
    found: list[Piece] = []
    cuts: set[int] = set()  # places between segments where something was taken out
    while len(segments) > 1 and len(found) < CUTS:
        first, last, rows = spans(segments, classifier.bias, cuts)
        score = np.where(_allowed(rows), classifier.logits(rows), -np.inf)
        best = int(score.argmax()) if len(score) else 0
        if not len(score) or _evidence(score) < classifier.threshold:
            break
        low, high = int(first[best]), int(last[best])
        found.append(Piece(segments[low].piece.start, segments[high].piece.end))
        segments = segments[:low] + segments[high + 1 :]
        removed = high + 1 - low
        cuts = {place if place <= low else max(low, place - removed) for place in cuts} | {low}
    return found


def _english_attacks(segments: list[Segment], bias: float) -> list[Piece]:
    """Return the runs of English beside text in another script that look like attacks.

    The route is in the other script, since the English is none; that script is never touched.
    """
    found = []
    for other, run in groupby(segments, key=lambda segment: segment.script == "other"):
        parts = list(run)
        if not other and whole(parts, bias) > 0 and sum(s.words for s in parts) > 2:
            found.append(Piece(parts[0].piece.start, parts[-1].piece.end))
    return found


def whole(segments: list[Segment], bias: float) -> float:
    """Return the score of some segments as one text."""
    square = sum(s.square for s in segments)
    return sum(s.product for s in segments) / math.sqrt(square + 1e-6) + bias


def _evidence(score: np.ndarray) -> float:
    """Return the log odds of any span against none."""
    top = score.max()
    return float(top + np.log(np.exp(score - top).sum())) if np.isfinite(top) else -np.inf


def _allowed(rows: np.ndarray) -> np.ndarray:
    """Return which spans may go at all.

    Text in another script goes only if what is left is surely an English route.
    """
    other = rows[:, _COLUMN["other script"]] > 0
    surely_route = rows[:, _COLUMN["rest"]] < ROUTE
    return (rows[:, _COLUMN["words of the rest"]] >= np.log1p(2)) & (~other | surely_route)
