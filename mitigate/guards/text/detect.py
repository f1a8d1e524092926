"""Find attacks in an instruction, and remove them if the gate allows it.

A sentence is foreign if it looks more like an attack than the rest of the text does. Neighbouring
sentences are removed with it if they also look foreign. Clauses inside the remaining sentences are
judged in the same way. The constants were chosen on the half "choose" of the test texts
(``tools/safeguard``).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from mitigate.corruptions.language.fidelity import facts
from mitigate.guards.text import gate
from mitigate.guards.text.classifier import Classifier, Clause
from mitigate.guards.text.pieces import Piece, without

# if more than this fraction of letters is in a different script, the route may be in that script
FOREIGN = 0.3
ROUTE = -1.0  # English text with a score below this is certainly a route
# fraction of the rest's score that is subtracted, because all sentences of an odd route look odd
CONTRAST = 0.3
LIMIT = 3.0  # the score of the rest is clipped to this absolute value
NAMED = 0.3  # subtracted from the score of a sentence that names a place or a turn
# this value, divided by the number of words, is subtracted from the score, because short sentences
# are ambiguous
BRIEF = 2.0
STEP = 5  # maximum number of words of a short route step such as "Turn back."
SENTENCE = 1.2  # a sentence with a score above this is foreign
CLAUSE = 3.0  # a clause inside a sentence with a score above this is foreign
BESIDE = -0.5  # a neighbour of a foreign sentence is foreign above this score
BESIDE_CLAUSE = 0.5  # a neighbour of a foreign clause is foreign above this score
SHORTEST = 3  # minimum number of words of clauses that are removed
LONG = 20  # clauses are removed from texts with at least this number of words
GOAL = 9  # a text with fewer words than this is often only an object goal
BARE = 1.0  # subtracted from the scores of sentences in such a short text
READ = 60_000  # maximum characters that are analysed


def take_out(text: str, classifier: Classifier) -> tuple[str, list[str], list[str]]:
    """Return ``text`` without its foreign pieces, the removed pieces, and the rejections of the
    gate.

    Only whole pieces are removed, and the result is always an instruction.
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
    """Return the foreign pieces of a text: first sentences, then clauses."""
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
    words = [sum(clause.words for clause in sentence) for sentence in sentences]
    bare = BARE if sum(words) < GOAL else 0.0
    seeds = [score - BRIEF / max(1, n) - bare for score, n in zip(scores, words, strict=True)]
    sentence_runs = runs(seeds, scores, SENTENCE, BESIDE) if len(sentences) > 1 else []
    pieces = [_span(sentences[first] + sentences[last]) for first, last in sentence_runs]
    pieces = [piece for piece in pieces if not _is_step(piece.of(text))]
    if sum(words) < LONG:
        return pieces
    for number, sentence in enumerate(sentences):
        if any(first <= number <= last for first, last in sentence_runs):
            continue
        scores = [_contrast([clause], total, classifier) for clause in sentence]
        for first, last in runs(scores, scores, CLAUSE, BESIDE_CLAUSE):
            run = sentence[first : last + 1]
            if len(run) < len(sentence) and sum(clause.words for clause in run) >= SHORTEST:
                pieces.append(_span(run))
    return pieces


def _contrast(part: Sequence[Clause], total: tuple[float, float], classifier: Classifier) -> float:
    """Return the score of a part of a text minus ``CONTRAST`` times the score of the rest."""
    product, square = classifier.total(part)
    rest = classifier.of_sums(total[0] - product, total[1] - square)
    return classifier.of_sums(product, square) - CONTRAST * max(-LIMIT, min(LIMIT, rest))


def runs(
    seeds: Sequence[float], scores: Sequence[float], least: float, beside: float
) -> list[tuple[int, int]]:
    """Return the first and last index of each foreign sequence, starting with the highest score.

    A sequence contains one score above ``least`` and the neighbours whose scores are above
    ``beside``.
    """
    result: list[tuple[int, int]] = []
    for place in sorted(range(len(seeds)), key=lambda place: -seeds[place]):
        if seeds[place] <= least:
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
    content = facts(text)
    return bool(content.directions or set(content.landmarks) & gate.KNOWN)


def _is_step(text: str) -> bool:
    return len(text.split()) <= STEP and bool(set(facts(text).directions) - {"stop"})


def _english_attacks(clauses: Sequence[Clause], classifier: Classifier) -> list[Piece]:
    """Return English sequences that look like attacks, in a text mostly in a different script.

    The route is in that script, so text in it is never removed.
    """
    spans = []
    for other, run in groupby(clauses, key=lambda clause: clause.script == "other"):
        parts = list(run)
        words = sum(clause.words for clause in parts)
        if not other and words >= SHORTEST and classifier.score(parts) > 0:
            spans.append(_span(parts))
    return spans
