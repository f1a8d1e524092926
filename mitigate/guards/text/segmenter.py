"""Use small recurrent networks to find the span of clauses that forms an attack.

A bidirectional GRU (Cho et al. 2014) reads the features of all clauses of a text (:mod:`features`).
For each clause, the network predicts a score for whether it is part of an attack. For each boundary
between clauses, it predicts a score for whether an attack starts or ends there. The score of a span
is the sum of the scores of its clauses and its two boundaries, relative to the score of "no
attack". Because the network reads each clause in its context, it does not take an unusual style for
an attack. The scores of several networks are averaged. Inference needs only numpy;
:mod:`mitigate.guards.text.learning.segmentation` trains a network.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from mitigate.guards.text.features import EDGES

# This is added to the score of each boundary inside the text.
# The reason is that few training texts have an attack inside a route.
INSIDE = 0.75
NAMES = (
    "net_input", "net_input_bias", "net_from_input", "net_from_state",
    "net_from_input_bias", "net_from_state_bias", "net_clause", "net_clause_bias", "net_edge",
    "net_edge_bias", "net_none",
)  # fmt: skip


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
