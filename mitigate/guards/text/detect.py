"""Find attacks in an instruction, and remove those whose removal the gate accepts.

The networks in :mod:`segmenter` read all clauses of the text together. They decide whether
the text contains an attack, and where the attack begins and ends. The search is repeated, because a
text can contain several attacks. The constants were chosen on one part of the test texts, called
"choose" (``tools/safeguard``).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from mitigate.corruptions.language.fidelity import facts
from mitigate.guards.text import gate
from mitigate.guards.text.classifier import Classifier, Clause
from mitigate.guards.text.pieces import Piece, without

# if more than this fraction of the letters is not Latin, the route may be in a non-Latin script
FOREIGN = 0.3
ROUTE = -1.0  # English text is treated as a route if its log odds of an attack are below this
ATTACK = 0.0  # a text contains an attack if the log odds of the networks are above this
# The networks' score is reduced if the regression gives the detected span log odds below this.
# It is reduced by the difference between this value and the regression's log odds.
# Without this second opinion, three times as many R2R-CE routes were harmed.
SURE = 1.0
LONGER = 0.1  # bonus per clause of a span; without it, parts of attacks remained in the text
# A clause next to an attack may say nothing about the route.
# It is also removed if its log odds are above this.
BESIDE = -2.0
GOAL = 30  # a text with fewer words than this that names no turn is often only a goal object
BARE = 1.9  # ``ATTACK`` is increased by this for such a text
ATTACKS = 3  # maximum number of attacks that are removed from a text
STEP = 5  # maximum number of words of a short route step such as "Turn back."
# In a text with non-Latin parts, an English attack is removed if it has at least this many words.
SHORTEST = 3
READ = 20_000  # maximum number of characters of a text that are read


def take_out(text: str, classifier: Classifier) -> tuple[str, list[str], list[str]]:
    """Remove the attacks from ``text``.

    Returns the remaining text, the removed pieces, and the gate's reasons to keep other pieces.
    Only whole clauses are removed, and an instruction always remains.
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
    """Return the pieces of a text that are attacks.

    At most one piece is returned, unless the route may be in non-Latin parts of the text. In that
    case, every English part that looks like an attack is returned. The route may be in the
    non-Latin parts if more than the fraction ``FOREIGN`` of the letters is not Latin, or if the log
    odds of an attack in the Latin parts are above ``ROUTE``.
    """
    clauses = classifier.clauses(text)
    english = [clause for clause in clauses if clause.script != "other"]
    other = sum(clause.letters for clause in clauses if clause.script == "other")
    much = other > FOREIGN * sum(clause.letters for clause in clauses)
    if other and (much or classifier.score(english) > ROUTE):
        return _english_attacks(clauses, classifier)
    if len(clauses) < 2:
        return []
    odds, first, last = classifier.attack(text, clauses, LONGER)
    odds += min(0.0, classifier.score(clauses[first : last + 1]) - SURE)
    bare = sum(clause.words for clause in clauses) < GOAL and not _names_a_turn(text)
    if odds <= ATTACK + BARE * bare:
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


def _names_a_turn(text: str) -> bool:
    return bool(set(facts(text).directions) - {"stop"})


def _is_step(text: str) -> bool:
    return len(text.split()) <= STEP and _names_a_turn(text)


def _english_attacks(clauses: Sequence[Clause], classifier: Classifier) -> list[Piece]:
    """Return the English parts that look like attacks, in a text that has non-Latin parts.

    The route is assumed to be in the non-Latin parts, so these parts are never removed.
    """
    spans = []
    for other, run in groupby(clauses, key=lambda clause: clause.script == "other"):
        parts = list(run)
        words = sum(clause.words for clause in parts)
        if not other and words >= SHORTEST and classifier.score(parts) > 0:
            spans.append(_span(parts))
    return spans
