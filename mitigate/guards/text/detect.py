"""Find what does not belong to an instruction, and take it out if the gate allows."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import groupby

import numpy as np

from mitigate.corruptions.language.fidelity import facts
from mitigate.guards.text import gate
from mitigate.guards.text.classifier import FEATURES, Classifier, Segment, spans
from mitigate.guards.text.pieces import Piece, without

MOST = 40  # clauses that are read together; the time grows with their square
FOREIGN = 0.3  # share of letters in another script from which the route may be in it
ROUTE = -1.0  # score below which English text is surely a route
STYLED = 1.2  # less log odds are needed beside text in a style, which looks foreign itself
EDGE = 4  # words at an end of the text that go with what stands beside them
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
            piece = _to_the_edge(text, piece)
            rest = without(text, [*pieces, piece])
            problem = gate.leaves_no_instruction(text, piece.of(text), rest)
            if problem:
                refusals.append(f"kept {piece.of(text)[:40]!r}: {problem}")
            else:
                pieces.append(piece)
    removed = [piece.of(text) for piece in sorted(pieces, key=lambda piece: piece.start)]
    return (without(text, pieces) if pieces else text), removed, refusals


def _to_the_edge(text: str, piece: Piece) -> Piece:
    """Return a piece with the few words that are left between it and an end of the text, if they
    say nothing of the way: "Warning!", "Sure!"."""
    head, tail = text[: piece.start].strip(), text[piece.end :].strip()
    start = 0 if head and _says_nothing(head) else piece.start
    end = len(text) if tail and _says_nothing(tail) else piece.end
    return Piece(start, end) if (start or end < len(text)) else piece


def _says_nothing(text: str) -> bool:
    if not text.isascii() or not 0 < len(text.split()) <= EDGE:
        return False
    said = facts(text)
    return not (said.directions or set(said.landmarks) & gate.KNOWN or said.numbers)


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
    other = sum(s.letters for s in segments if s.script == "other")
    much = other > FOREIGN * sum(s.letters for s in segments)
    if other and (much or whole(english, classifier.bias) > ROUTE):
        return _english_attacks(segments, classifier.bias)
    found: list[Piece] = []
    cuts: set[int] = set()  # places between segments where something was taken out
    while len(segments) > 1 and len(found) < CUTS:
        first, last, rows = spans(segments, classifier.bias, cuts)
        score = np.where(_allowed(rows), classifier.logits(rows), -np.inf)
        best = int(score.argmax()) if len(score) else 0
        if not len(score):
            break
        low, high = int(first[best]), int(last[best])
        needed = classifier.threshold - STYLED * _is_styled(segments, low, high, classifier)
        if _evidence(score) < needed:
            break
        found.append(Piece(segments[low].piece.start, segments[high].piece.end))
        segments = segments[:low] + segments[high + 1 :]
        removed = high + 1 - low
        cuts = {place if place <= low else max(low, place - removed) for place in cuts} | {low}
    return found


def _is_styled(segments: list[Segment], low: int, high: int, classifier: Classifier) -> bool:
    """Return whether what is left around a span is in a style."""
    rest = [*segments[:low], *segments[high + 1 :]]
    square = sum(s.square for s in rest)
    style = sum(s.style for s in rest) / math.sqrt(square + 1e-6)
    return bool(rest) and style + float(classifier.config["style_bias"]) > 0


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
