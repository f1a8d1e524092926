"""Use small recurrent networks to find the span of clauses that forms an attack.

A bidirectional GRU (Cho et al. 2014) reads the features of all clauses of a text. For each clause,
the network predicts a score for whether it is part of an attack. For each boundary between clauses,
it predicts a score for whether an attack starts or ends there. The score of a span is the sum of
the scores of its clauses and its two boundaries, relative to the score of "no attack". Because the
network reads each clause in its context, it does not take an unusual style for an attack. The
scores of several networks are averaged. Inference needs only numpy;
:mod:`mitigate.guards.text.learning.segmentation` trains a network.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from mitigate.corruptions.language.fidelity import facts
from mitigate.guards.text import gate

if TYPE_CHECKING:
    from mitigate.guards.text.classifier import Classifier, Clause

FEATURES = 22  # number of features of a clause
EDGES = (11, 12, 13, 15)  # indices of the features that describe the boundary before a clause
# number of characters before a clause in which the last non-space character is searched
GAP = 80
# This is added to the score of each boundary inside the text.
# The reason is that few training texts have an attack inside a route.
INSIDE = 0.75
CLIP = 6.0  # largest absolute value of a feature
SCALE = 0.5  # factor by which features that are log odds are multiplied
NAMES = (
    "net_input", "net_input_bias", "net_from_input", "net_from_state",
    "net_from_input_bias", "net_from_state_bias", "net_clause", "net_clause_bias", "net_edge",
    "net_edge_bias", "net_none",
)  # fmt: skip


def features(text: str, clauses: Sequence[Clause], classifier: Classifier) -> np.ndarray:
    """Return the features of clauses, shape [clauses, FEATURES].

    The first ten features are real numbers, and the other twelve are 0 or 1.
    """
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
    result = np.zeros((len(clauses), FEATURES), np.float32)
    # columns 0, 1 and 4 to 8 are log odds of an attack in a part of the text
    result[:, 0] = classifier.log_odds(products, squares)  # the clause
    result[:, 1] = by_sentence[sentence]  # its sentence
    result[:, 2] = [clause.style for clause in clauses]
    result[:, 3] = np.log(words + 1) - 1.5  # words of the clause
    result[:, 4] = first[1:]  # the text up to and including the clause
    result[:, 5] = first[:-1]  # the text before the clause
    result[:, 6] = last[:-1]  # the text from the clause on
    result[:, 7] = last[1:]  # the text after the clause
    result[:, 8] = first[-1]  # the whole text
    result[:, 9] = np.log(words.sum() + 1) - 3.5  # words of the text
    result[:, [0, 1, 2, 4, 5, 6, 7, 8]] *= SCALE
    for place, clause in enumerate(clauses):
        start = clause.piece.start
        previous = clauses[place - 1] if place else None
        before = text[max(0, start - GAP) : start].rstrip()[-1:]
        gap = text[previous.piece.end : start] if previous else ""
        result[place, 10:] = (
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
        )
    return np.clip(result, -CLIP, CLIP)


def _names_the_way(text: str) -> bool:
    content = facts(text)
    return bool(content.directions or set(content.landmarks) & gate.KNOWN)


class Segmenter:
    """K networks with averaged scores.

    ``arrays`` contains the weights under the names in ``NAMES``. H is the size of the GRU's hidden
    state. ``net_from_input`` [K, 2, 3H, H] and ``net_from_state`` [K, 2, 3H, H] are the weights of
    the forward and the backward GRU, with the gates in the order reset, update, new.
    """

    def __init__(self, arrays: Mapping[str, np.ndarray]) -> None:
        self.arrays = {name: arrays[name].astype(np.float32) for name in NAMES}

    def attack(self, values: np.ndarray, bonus: float) -> tuple[float, int, int]:
        """Return the log odds that the text contains an attack, and the best span.

        Args:
            values: the features of the n clauses, shape [n, FEATURES].
            bonus: number that is added to the score of a span for each of its clauses, before the
                span with the highest score is chosen. The bonus does not change the log odds.

        Returns:
            The log odds, and the first and the last clause of the span.
        """
        clause, edge = self.scores(values)
        if len(clause) < 2:
            return -np.inf, 0, 0
        edge[1:-1] += INSIDE
        starts, ends = _sides(clause, edge)
        total = np.logaddexp.accumulate(starts) + ends
        # a span must not cover the whole text
        total[-1] = np.logaddexp.reduce(starts[1:]) + ends[-1]
        odds = float(np.logaddexp.reduce(total) - self.arrays["net_none"].mean())
        starts, ends = _sides(clause + bonus, edge)
        best = np.maximum.accumulate(starts) + ends
        best[-1] = starts[1:].max() + ends[-1]
        last = int(best.argmax())
        skipped = int(last == len(clause) - 1)
        return odds, skipped + int(starts[skipped : last + 1].argmax()), last

    def scores(self, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the scores of the n clauses and of the n + 1 boundaries around them."""
        a = self.arrays
        inputs = np.tanh(values @ a["net_input"].transpose(0, 2, 1) + a["net_input_bias"][:, None])
        states = self._states(inputs)
        nothing = np.zeros((len(states), 1, states.shape[2]), np.float32)
        marks = np.zeros((len(states), len(values) + 1, len(EDGES)), np.float32)
        marks[:, :-1] = values[:, EDGES]
        around = [np.concatenate(pair, 1) for pair in ((nothing, states), (states, nothing))]
        return (
            _mean([states, inputs], a["net_clause"], a["net_clause_bias"]),
            _mean([*around, marks], a["net_edge"], a["net_edge_bias"]),
        )

    def _states(self, inputs: np.ndarray) -> np.ndarray:
        """Return the hidden states of the forward and the backward GRUs, shape [K, n, 2H]."""
        a = self.arrays
        size = inputs.shape[2]
        both = np.stack([inputs, inputs[:, ::-1]], 1)  # [K, 2, n, H]
        gates = both @ a["net_from_input"].swapaxes(2, 3) + a["net_from_input_bias"][:, :, None]
        weights = a["net_from_state"]
        bias = a["net_from_state_bias"]
        state = np.zeros((len(inputs), 2, size), np.float32)
        states = np.empty_like(both)
        for step in range(inputs.shape[1]):
            recurrent = (weights @ state[..., None])[..., 0] + bias
            now = gates[:, :, step]
            mixed = _sigmoid(now[..., : 2 * size] + recurrent[..., : 2 * size])
            new = np.tanh(now[..., 2 * size :] + mixed[..., :size] * recurrent[..., 2 * size :])
            state = new + mixed[..., size:] * (state - new)
            states[:, :, step] = state
        return np.concatenate([states[:, 0], states[:, 1, ::-1]], 2)


def _mean(parts: list[np.ndarray], weights: np.ndarray, bias: np.ndarray) -> np.ndarray:
    """Apply a layer to the joined ``parts`` [K, n, ...]; return the mean over the K networks."""
    output = np.concatenate(parts, 2) @ weights[:, :, None] + bias[:, None]
    return output.mean(0)[:, 0]


def _sides(clause: np.ndarray, edge: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return a start term and an end term for every clause.

    The score of a span is the start term of its first clause plus the end term of its last clause.
    """
    sums = np.cumsum(clause)
    return edge[:-1] - sums + clause, edge[1:] + sums


def _sigmoid(x: np.ndarray) -> np.ndarray:
    return 1 / (1 + np.exp(-x))
