"""Find what does not belong to an instruction, and take it out if the gate allows.

A sentence is foreign if it looks like an attack more than the rest of the text does. Sentences
beside it go with it if they look foreign, too. Clauses within the other sentences are tried in the
same way. The constants were chosen on the half "choose" of the fresh banks.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from mitigate.corruptions.language.fidelity import facts
from mitigate.guards.text import gate
from mitigate.guards.text.classifier import Classifier, Clause
from mitigate.guards.text.pieces import Piece, without

FOREIGN = 0.3  # share of letters in another script from which the route may be in it
ROUTE = -1.0  # score below which English text is surely a route
CONTRAST = 0.2  # share of the rest's score that is subtracted: all of an odd route looks foreign
LIMIT = 3.0  # of the rest's score, in both directions
NAMED = 0.3  # what a sentence that names a place or a turn needs more
STEP = 5  # words up to which text that names a turn is a step of the route: "Turn back."
SENTENCE = 1.2  # score from which a sentence is foreign
CLAUSE = 3.0  # score from which a clause within a sentence is foreign
BESIDE = -0.5  # score from which a sentence beside a foreign one is foreign, too
BESIDE_CLAUSE = 0.5  # as BESIDE, for clauses
SHORTEST = 3  # words of a run of clauses that may go
LONG = 20  # words of a text from which clauses may go; short object goals lost too much
READ = 60_000  # characters that are read


def take_out(text: str, classifier: Classifier) -> tuple[str, list[str], list[str]]:
    """Return ``text`` without what is foreign, the pieces that were taken out, and refusals.

    Only whole pieces go, and an instruction is left.
    """
    pieces: list[Piece] = []
    refusals: list[str] = []
    for piece in foreign(text, classifier):
        rest = without(text, [*pieces, piece])
        problem = gate.leaves_no_instruction(text, piece.of(text), rest)
        if problem:
            refusals.append(f"kept {piece.of(text)[:40]!r}: {problem}")
        else:
            pieces.append(piece)
    removed = [piece.of(text) for piece in sorted(pieces, key=lambda piece: piece.start)]
    return (without(text, pieces) if pieces else text), removed, refusals


def foreign(text: str, classifier: Classifier) -> list[Piece]:
    """Return the pieces of a text that do not belong to it: sentences, then clauses."""
    clauses = classifier.clauses(text[:READ])
    english = [clause for clause in clauses if clause.script != "other"]
    other = sum(clause.letters for clause in clauses if clause.script == "other")
    much = other > FOREIGN * sum(clause.letters for clause in clauses)
    if other and (much or classifier.score(english) > ROUTE):
        return _english_attacks(clauses, classifier)
    sentences = [list(run) for _, run in groupby(clauses, key=lambda clause: clause.sentence)]
    total = classifier.total(clauses)
    scores = [
        _contrast(sentence, total, classifier) - NAMED * _names_the_way(_span(sentence).of(text))
        for sentence in sentences
    ]
    sentence_runs = runs(scores, SENTENCE, BESIDE) if len(sentences) > 1 else []
    pieces = [_span(sentences[first] + sentences[last]) for first, last in sentence_runs]
    pieces = [piece for piece in pieces if not _is_step(piece.of(text))]
    if sum(clause.words for clause in clauses) < LONG:
        return pieces
    for number, sentence in enumerate(sentences):
        if any(first <= number <= last for first, last in sentence_runs):
            continue
        scores = [_contrast([clause], total, classifier) for clause in sentence]
        for first, last in runs(scores, CLAUSE, BESIDE_CLAUSE):
            run = sentence[first : last + 1]
            if len(run) < len(sentence) and sum(clause.words for clause in run) >= SHORTEST:
                pieces.append(_span(run))
    return pieces


def _contrast(part: Sequence[Clause], total: tuple[float, float], classifier: Classifier) -> float:
    """Return the score of a part of a text, less ``CONTRAST`` of the score of the rest."""
    product, square = classifier.total(part)
    rest = classifier.of_sums(total[0] - product, total[1] - square)
    return classifier.of_sums(product, square) - CONTRAST * max(-LIMIT, min(LIMIT, rest))


def runs(scores: Sequence[float], least: float, beside: float) -> list[tuple[int, int]]:
    """Return first and last place of the runs around a score above ``least``, highest first.

    A run reaches as far as the scores are above ``beside``.
    """
    result: list[tuple[int, int]] = []
    for place in sorted(range(len(scores)), key=lambda place: -scores[place]):
        if scores[place] <= least:
            break
        if any(first <= place <= last for first, last in result):
            continue
        first = last = place
        while first > 0 and scores[first - 1] > beside:
            first -= 1
        while last + 1 < len(scores) and scores[last + 1] > beside:
            last += 1
        result.append((first, last))
    return result


def _span(clauses: Sequence[Clause]) -> Piece:
    return Piece(clauses[0].piece.start, clauses[-1].piece.end)


def _names_the_way(text: str) -> bool:
    said = facts(text)
    return bool(said.directions or set(said.landmarks) & gate.KNOWN)


def _is_step(text: str) -> bool:
    return len(text.split()) <= STEP and bool(set(facts(text).directions) - {"stop"})


def _english_attacks(clauses: Sequence[Clause], classifier: Classifier) -> list[Piece]:
    """Return the runs of English beside text in another script that look like attacks.

    The route is in the other script, since the English is none; that script is never touched.
    """
    found = []
    for other, run in groupby(clauses, key=lambda clause: clause.script == "other"):
        parts = list(run)
        words = sum(clause.words for clause in parts)
        if not other and words >= SHORTEST and classifier.score(parts) > 0:
            found.append(_span(parts))
    return found
