"""Compute the features of clauses that the networks in :mod:`segmenter` read.

The features say how much a clause and the text around it look like an attack, where the clause
stands, how it is written, and how similar it is to the other clauses. An attack is usually written
in another manner and with other words than the route, so its first and last clause can be found
even if neither looks like an attack.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING

import numpy as np

from mitigate.corruptions.language.fidelity import facts
from mitigate.corruptions.language.words import bag
from mitigate.guards.text import gate

if TYPE_CHECKING:
    from mitigate.guards.text.classifier import Classifier, Clause

FEATURES = 40  # number of features of a clause
LOG_ODDS = (0, 1, 4, 5, 6, 7, 8)  # indices of the log odds of an attack in a part of the text
# indices of the features of the boundary before a clause that the networks also read directly
EDGES = (11, 12, 13, 15)
# number of characters before a clause in which the last non-space character is searched
LOOK_BACK = 80
CLIP = 6.0  # largest absolute value of a feature
SCALE = 0.5  # factor by which log odds are multiplied
ALIKE = 5.0  # factor by which similarities are multiplied
SMALLEST = 1e-3  # minimum product of two squared norms
_YOU = bag("you your yours yourself u ur ye thee thou")
_ME = bag("i me my mine we us our i'm i'll i've i'd im")
_WORD = re.compile(r"[a-z]+(?:['’][a-z]+)?|\d+")
_COMMON_SIGNS = ".,;:!?'\""


def features(text: str, clauses: Sequence[Clause], classifier: Classifier) -> np.ndarray:
    """Return the features of clauses, shape [clauses, FEATURES]."""
    parts = (
        _attack_odds(clauses, classifier),
        [_place(text, clauses, place) for place in range(len(clauses))],
        [_manner(clause.piece.of(text), classifier.known) for clause in clauses],
        _similarity(clauses),
    )
    return np.clip(np.concatenate(parts, 1), -CLIP, CLIP).astype(np.float32)


def _attack_odds(clauses: Sequence[Clause], classifier: Classifier) -> np.ndarray:
    """Return features 0 to 9: scaled log odds of attacks and styles, and numbers of words."""
    products = np.array([clause.product for clause in clauses])
    squares = np.array([clause.square for clause in clauses])
    words = np.array([clause.words for clause in clauses])
    _, sentence = np.unique([clause.sentence for clause in clauses], return_inverse=True)
    by_sentence = classifier.log_odds(
        np.bincount(sentence, products), np.bincount(sentence, squares)
    )
    sums = np.concatenate([[0.0], np.cumsum(products)])
    norms = np.concatenate([[0.0], np.cumsum(squares)])
    first = classifier.log_odds(sums, norms)
    last = classifier.log_odds(sums[-1] - sums, norms[-1] - norms)
    result = np.zeros((len(clauses), 10))
    result[:, 0] = classifier.log_odds(products, squares)  # the clause
    result[:, 1] = by_sentence[sentence]  # its sentence
    result[:, 2] = [clause.style for clause in clauses]
    result[:, 4] = first[1:]  # the text up to and including the clause
    result[:, 5] = first[:-1]  # the text before the clause
    result[:, 6] = last[:-1]  # the text from the clause on
    result[:, 7] = last[1:]  # the text after the clause
    result[:, 8] = first[-1]  # the whole text
    result *= SCALE
    result[:, 3] = np.log(words + 1) - 1.5  # words of the clause
    result[:, 9] = np.log(words.sum() + 1) - 3.5  # words of the text
    return result


def _place(text: str, clauses: Sequence[Clause], place: int) -> list[float]:
    """Return features 10 to 21, each 0 or 1: what precedes a clause, its kind and its position."""
    clause = clauses[place]
    start = clause.piece.start
    previous = clauses[place - 1] if place else None
    before = text[max(0, start - LOOK_BACK) : start].rstrip()[-1:]
    gap = text[previous.piece.end : start] if previous else ""
    return [
        clause.piece.block,
        previous is None or clause.sentence != previous.sentence,
        before in tuple(".!?。"),
        before in tuple(",;:"),
        "\n" in gap,
        before.isalnum(),
        clause.script == "other",
        _names_the_way(clause.piece.of(text)),
        text[start].isupper(),
        text[start].islower(),
        place == 0,
        place == len(clauses) - 1,
    ]


def _names_the_way(text: str) -> bool:
    content = facts(text)
    return bool(content.directions or set(content.landmarks) & gate.KNOWN)


def _manner(text: str, known: Collection[str]) -> list[float]:
    """Return features 22 to 35: how a clause is written, and what it mentions.

    ``known`` contains the common words.
    """
    words = _WORD.findall(text.lower())
    tokens = text.split()
    letters = [c for c in text if c.isalpha()]
    content = facts(text)

    def share(hits: int, of: Sequence[object]) -> float:
        return hits / max(1, len(of))

    signs = sum(not (c.isalnum() or c.isspace() or c in _COMMON_SIGNS) for c in text)
    return [
        2 * share(sum(w not in known and not w.isdigit() for w in words), words),  # rare words
        2 * share(sum(c.isupper() for c in letters), letters),
        (share(len(letters), words) - 4.2) / 1.5,  # mean length of words
        4 * share(sum(w in _YOU for w in words), words),
        4 * share(sum(w in _ME for w in words), words),
        min(2, len(content.directions)),
        min(2, len(set(content.landmarks) & gate.KNOWN)),
        min(2, len(content.relations)),
        min(2, content.denials),
        text.rstrip().endswith("!"),
        text.rstrip().endswith("?"),
        2 * share(sum(any(c.isdigit() for c in token) for token in tokens), tokens),
        3 * share(signs, text),
        # several capitalised words, as in names and titles
        text[:1].isupper() and sum(token[:1].isupper() for token in tokens) > 1,
    ]


def _similarity(clauses: Sequence[Clause]) -> np.ndarray:
    """Return features 36 to 39: scaled cosine similarities of TF-IDF vectors.

    The features compare the clause with the previous clause, with the text before it and with the
    text after it. The last one compares the text before the clause with the rest. The vectors of
    these texts are sums over clauses. Their products are updated from clause to clause, so the time
    grows linearly with the length of the text.
    """
    _, columns = np.unique(
        np.concatenate([clause.index for clause in clauses]), return_inverse=True
    )
    total = np.bincount(columns, np.concatenate([clause.value for clause in clauses]))
    places = np.split(columns, np.cumsum([len(clause.index) for clause in clauses])[:-1])
    before, previous = np.zeros_like(total), np.zeros_like(total)
    last = np.zeros(0, int)
    square = product = previous_square = 0.0  # |before|^2, before . total, |previous|^2
    all_square = float(total @ total)
    result = np.zeros((len(clauses), 4))
    for row, clause, place in zip(result, clauses, places, strict=True):
        value = clause.value.astype(float)  # in float32, differences of squares would not be 0
        own = float(value @ value)
        with_before, with_total = float(value @ before[place]), float(value @ total[place])
        next_square = square + 2 * with_before + own
        next_product = product + with_total
        row[:] = (
            _cosine(float(value @ previous[place]), own, previous_square),
            _cosine(with_before, own, square),
            _cosine(
                with_total - with_before - own,
                own,
                all_square - 2 * next_product + next_square,
            ),
            _cosine(product - square, square, all_square - 2 * product + square),
        )
        previous[last] = 0
        previous[place] = value
        before[place] += value
        last, previous_square = place, own
        square, product = next_square, next_product
    return ALIKE * result


def _cosine(product: float, square: float, other: float) -> float:
    """Return the cosine of two vectors, given their product and their squared norms."""
    return product / math.sqrt(max(square * other, SMALLEST))
