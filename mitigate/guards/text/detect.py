"""Find attacks in an instruction, and remove them if the gate allows it.

The networks in :mod:`segmenter` judge the clauses of the text together. They first decide whether
the text contains an attack, and then where the attack begins and ends. This is repeated, because a
text can contain more than one attack. The constants were chosen on the half "choose" of the test
texts (``tools/safeguard``).
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
ATTACK = 1.3  # log odds above which a text contains an attack
# a span whose log odds in the regression are lower needs a higher score of the networks; without
# this second opinion, three times as many R2R-CE routes were harmed
SURE = 1.0
LONGER = 0.1  # bonus per clause of an attack; without it, parts of attacks were left over
# a neighbour of an attack that says nothing about the way is removed above this score
BESIDE = -2.0
GOAL = 17  # a single sentence with fewer words than this is often only an object goal
BARE = 1.9  # added to ``ATTACK`` for such a sentence
ATTACKS = 3  # maximum number of attacks that are removed from a text
STEP = 5  # maximum number of words of a short route step such as "Turn back."
SHORTEST = 3  # minimum words of an English attack that is removed from text in a different script
READ = 60_000  # maximum characters that are analysed


def take_out(text: str, classifier: Classifier) -> tuple[str, list[str], list[str]]:
    """Return ``text`` without its foreign pieces, the removed pieces, and the rejections of the
    gate.

    Only whole pieces are removed, and the result is always an instruction.
    """
    removed: list[str] = []
    refusals: list[str] = []
    for _ in range(ATTACKS):
        pieces: list[Piece] = []
        for piece in foreign(text, classifier):
            rest = without(text, [*pieces, piece])
            problem = gate.leaves_no_instruction(text, piece.of(text), rest)
            if problem:
                refusals.append(f"kept {piece.of(text)[:40]!r}: {problem}")
            else:
                pieces.append(piece)
        if not pieces:
            break
        removed += [piece.of(text) for piece in sorted(pieces, key=lambda piece: piece.start)]
        text = without(text, pieces)
    return text, removed, refusals


def foreign(text: str, classifier: Classifier) -> list[Piece]:
    """Return the foreign pieces of a text: at most one, or all English attacks next to text in a
    different script.
    """
    clauses = classifier.clauses(text[:READ])
    english = [clause for clause in clauses if clause.script != "other"]
    other = sum(clause.letters for clause in clauses if clause.script == "other")
    much = other > FOREIGN * sum(clause.letters for clause in clauses)
    if other and (much or classifier.score(english) > ROUTE):
        return _english_attacks(clauses, classifier)
    if len(clauses) < 2:
        return []
    odds, first, last = classifier.attack(text, clauses, LONGER)
    odds += min(0.0, classifier.score(clauses[first : last + 1]) - SURE)
    words = sum(clause.words for clause in clauses)
    if odds <= ATTACK + BARE * (words < GOAL and clauses[-1].sentence == 0):
        return []

    def belongs(clause: Clause) -> bool:
        return classifier.score([clause]) > BESIDE and _says_nothing(clause.piece.of(text))

    while first > 0 and belongs(clauses[first - 1]):
        first -= 1
    while last + 1 < len(clauses) and belongs(clauses[last + 1]):
        last += 1
    piece = _span(clauses[first : last + 1])
    return [] if _is_step(piece.of(text)) else [piece]


def _span(clauses: Sequence[Clause]) -> Piece:
    return Piece(clauses[0].piece.start, clauses[-1].piece.end)


def _says_nothing(text: str) -> bool:
    content = facts(text)
    return not (content.directions or content.landmarks or content.relations)


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
