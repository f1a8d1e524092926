"""How probably a sentence is no part of a route: by what it says and what stands around it
(:mod:`evidence`), and by a network that reads the text as well, if there is one (:mod:`reader`).
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

from mitigate.guards.text.fidelity import gate
from mitigate.guards.text.plain.manners import unasked
from mitigate.guards.text.plain.plainly_said import Tagged, Tags
from mitigate.guards.text.texts.decode import plainly
from mitigate.guards.text.texts.evidence import VERBS, features, in_another_language, in_context
from mitigate.guards.text.texts.pieces import Piece, sentence_pieces
from mitigate.guards.text.texts.text import words
from mitigate.guards.text.texts.weights import CONTEXT, OWN
from mitigate.guards.text.texts.written import without_written

SURE = 0.5
PLAIN = 0.06  # mean strangeness of sentences that are surely a plain route
# of the log odds of a network that reads the text as well: weights of the rules' and of its own,
# and the bias, for a sentence that tells nothing, names things, tells the way: beside what is
# surely a plain route, and elsewhere (chosen by what went of R2R-CE's train texts)
BOTH = (0.7, 1.0)
BIAS_PLAIN, BIAS = (1.0, 0.25, 0.0), (0.5, 0.0, -0.5)


@dataclass(frozen=True)
class Judged:
    """A sentence of a text: where it stands, its words, how probably it is no part of the route by
    itself (``own``) and beside the others (``foreign``)."""

    piece: Piece
    text: str
    own: float
    foreign: float


def probability(weights: Mapping[str, float], values: Mapping[str, float]) -> float:
    """Return the logistic function of a bias and weighted values."""
    score = weights["bias"] + sum(weights[name] * value for name, value in values.items())
    return 1 / (1 + math.exp(-max(-30.0, min(30.0, score))))


def logit(p: float) -> float:
    """Return the log odds of ``p``, at most 6."""
    p = min(max(p, 0.0025), 0.9975)
    return math.log(p / (1 - p))


@lru_cache(maxsize=512)
def judged(text: str, tags: Tags | None = None) -> tuple[Judged, ...]:
    """Return the sentences of ``text``, judged; ``tags``: a network that reads them as well."""
    found = sentence_pieces(text)
    said = [piece.of(text) for piece in found]
    wraps = wrapped(text, found)
    own = [
        1.0 if piece.tag else asked(s, bool(piece.block) and piece.block not in wraps)
        for s, piece in zip(said, found, strict=True)
    ]
    around = in_context(said, own)
    foreign = [
        p if piece.tag else probability(CONTEXT, {"own": logit(p), **context})
        for p, piece, context in zip(own, found, around, strict=True)
    ]
    if tags is None:
        return tuple(Judged(*row) for row in zip(found, said, own, foreign, strict=True))
    return _read_too(found, said, own, foreign, tags.tag(text))


def _read_too(
    found: Sequence[Piece],
    said: Sequence[str],
    own: Sequence[float],
    foreign: Sequence[float],
    tagged: Tagged,
) -> tuple[Judged, ...]:
    """Return the sentences judged by what is known of them and by what the network reads."""
    read = [_attacked(piece, s, tagged) for piece, s in zip(found, said, strict=True)]
    tells = [gate.weight(s) for s in said]
    surely = [together(p, q, BIAS[w]) for p, q, w in zip(foreign, read, tells, strict=True)]
    rest = [together(p, q, BIAS[w])
        for p, q, w, f in zip(own, read, tells, surely, strict=True) if f < SURE]  # fmt: skip
    plain = sum(rest) < PLAIN * len(rest)
    bias = [
        (BIAS_PLAIN if plain and not leads(s) else BIAS)[w]
        for s, w in zip(said, tells, strict=True)
    ]
    foreign = [together(*row) for row in zip(foreign, read, bias, strict=True)]
    own = [  # what moves one and tells the way goes only by what the rules say of it
        p if w == 2 and leads(s) else together(p, q, b)
        for p, q, b, w, s in zip(own, read, bias, tells, said, strict=True)
    ]
    return tuple(Judged(*row) for row in zip(found, said, own, foreign, strict=True))


def leads(sentence: str) -> bool:
    """Return whether a sentence begins with a motion or a turn."""
    return any(word in VERBS for word in words(sentence)[:2])


def _attacked(piece: Piece, said: str, tagged: Tagged) -> float | None:
    """Return how probably a piece is an attack by what the network reads; None where it cannot."""
    if piece.tag or in_another_language(said):
        return None
    return tagged.attacked(piece.start, piece.end)


def together(rules: float, read: float | None, bias: float) -> float:
    """Return the probability of which the log odds are the weighted sum of both."""
    if read is None:
        return rules
    score = bias + BOTH[0] * logit(rules) + BOTH[1] * logit(read)
    return 1 / (1 + math.exp(-max(-30.0, min(30.0, score))))


def wrapped(text: str, found: Sequence[Piece]) -> frozenset[int]:
    """Return the numbers of the markup blocks that hold more of the way than the rest does."""
    told: Counter[int] = Counter()
    disguised = set()
    for piece in found:
        said = piece.of(text)
        if plainly(said).marks or in_another_language(said):
            disguised.add(piece.block)
        if not piece.tag:
            told[piece.block] += len(gate.route_facts(said))
    return frozenset(
        b
        for b, count in told.items()
        if b and (count == told.total() if b in disguised else 2 * count > told.total())
    )


def asked(sentence: str, markup: bool) -> float:
    """As :func:`strangeness`, where words that ask politely for a step count for nothing."""
    plain = unasked(sentence)
    found = strangeness(sentence, markup)
    if plain == sentence or not gate.route_facts(plain):
        return found
    return min(found, strangeness(plain, markup))


def strangeness(sentence: str, markup: bool = False) -> float:
    """Return the probability that ``sentence`` is no part of a route, by what it says."""
    if not any(c.isalnum() for c in sentence):
        return 0.0
    if in_another_language(sentence):
        return 0.99
    if leads(sentence):  # "follow the sign that says ..."
        sentence = without_written(sentence)
    return probability(OWN, features(sentence, markup))
