"""Train the network that finds the span of an attack (:mod:`mitigate.guards.text.segmenter`).

The first term of the loss is the negative log likelihood of the correct answer, which is either a
span of clauses or "no attack". The second term is a binary cross-entropy for each clause, with a
small weight.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from torch import nn

from mitigate.core.progress import say
from mitigate.guards.text.features import EDGES, FEATURES, LOG_ODDS
from mitigate.guards.text.segmenter import NAMES

STATE = 32  # size of the GRU's hidden state
EPOCHS, BATCH = 8, 64
RATE, DECAY = 3e-3, 1e-3  # learning rate and weight decay of AdamW
DROPOUT = 0.25
NOISE = 0.1  # standard deviation of the noise that is added to features that are log odds
CLAUSES = 0.1  # weight of the second term of the loss
LONGEST = 45  # maximum number of clauses of a training text


@dataclass(frozen=True)
class Example:
    """The features of a text's clauses [clauses, FEATURES], and a mask of its attack clauses."""

    features: np.ndarray
    attack: np.ndarray


class Network(nn.Module):
    """The torch network, for training. :class:`Segmenter` is the same network in numpy."""

    def __init__(self) -> None:
        super().__init__()
        self.input = nn.Linear(FEATURES, STATE)
        self.gru = nn.GRU(STATE, STATE, bidirectional=True, batch_first=True)
        self.clause = nn.Linear(3 * STATE, 1)
        self.edge = nn.Linear(4 * STATE + len(EDGES), 1)
        self.none = nn.Parameter(torch.zeros(1))
        self.drop = nn.Dropout(DROPOUT)

    def forward(self, x: torch.Tensor, lengths: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """Return the scores of clauses [batch, n] and of the edges around them [batch, n + 1]."""
        inputs = self.drop(torch.tanh(self.input(x)))
        packed = nn.utils.rnn.pack_padded_sequence(
            inputs, lengths, batch_first=True, enforce_sorted=False
        )
        states, _ = nn.utils.rnn.pad_packed_sequence(self.gru(packed)[0], batch_first=True)
        states = self.drop(states)
        clause = self.clause(torch.cat([states, inputs], -1))[..., 0]
        nothing = torch.zeros(len(x), 1, states.shape[-1])
        marks = torch.cat([x[..., list(EDGES)], torch.zeros(len(x), 1, len(EDGES))], 1)
        around = [torch.cat([nothing, states], 1), torch.cat([states, nothing], 1), marks]
        return clause, self.edge(torch.cat(around, -1))[..., 0]

    def arrays(self) -> dict[str, np.ndarray]:
        """Return the weights as :class:`Segmenter` reads them, with one network (K = 1)."""
        gru = {name: value.detach() for name, value in self.gru.named_parameters()}
        kinds = ("weight_ih", "weight_hh", "bias_ih", "bias_hh")
        both = [torch.stack([gru[f"{kind}_l0"], gru[f"{kind}_l0_reverse"]]) for kind in kinds]
        layers = (self.clause, self.edge)
        ends = [value for layer in layers for value in (layer.weight[0], layer.bias)]
        values = [self.input.weight, self.input.bias, *both, *ends, self.none]
        return {name: v.detach().numpy()[None] for name, v in zip(NAMES, values, strict=True)}


def train(examples: Sequence[Example], seed: int) -> dict[str, np.ndarray]:
    """Train one network and return its weights."""
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    torch.manual_seed(seed)
    rng = np.random.default_rng(seed)
    network = Network()
    optimizer = torch.optim.AdamW(network.parameters(), lr=RATE, weight_decay=DECAY)
    steps = EPOCHS * -(-len(examples) // BATCH)
    schedule = torch.optim.lr_scheduler.LambdaLR(
        optimizer, lambda step: min(1, (step + 1) / 60) * max(0.02, 1 - step / steps)
    )
    for epoch in range(EPOCHS):
        losses = []
        for batch in _batches(examples, rng):
            loss = _loss(network, batch, rng)
            optimizer.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_(network.parameters(), 1.0)
            optimizer.step()
            schedule.step()
            losses.append(loss.item())
        say(f"epoch {epoch + 1} of {EPOCHS}: loss {np.mean(losses):.3f}")
    torch.set_num_threads(threads)
    return network.eval().arrays()


def _batches(examples: Sequence[Example], rng: np.random.Generator) -> list[list[Example]]:
    """Divide the examples randomly into batches of texts with similar lengths."""
    order = rng.permutation(len(examples))
    noisy = [len(examples[i].attack) + 4 * rng.random() for i in order]
    order = order[np.argsort(noisy, kind="stable")]
    batches = [order[at : at + BATCH] for at in range(0, len(order), BATCH)]
    return [[examples[i] for i in batches[k]] for k in rng.permutation(len(batches))]


def _loss(network: Network, batch: Sequence[Example], rng: np.random.Generator) -> torch.Tensor:
    lengths = torch.tensor([len(example.attack) for example in batch])
    most = int(lengths.max())
    x = torch.zeros(len(batch), most, FEATURES)
    attack = torch.zeros(len(batch), most)
    for row, example in enumerate(batch):
        values = example.features.copy()
        values[:, list(LOG_ODDS)] += NOISE * rng.standard_normal((len(values), len(LOG_ODDS)))
        x[row, : len(values)] = torch.from_numpy(values)
        attack[row, : len(values)] = torch.from_numpy(example.attack.astype(np.float32))
    clause, edge = network(x, lengths)
    spans = _span_scores(clause, edge, lengths)
    every = torch.cat([spans.flatten(1), network.none.expand(len(batch), 1)], 1).logsumexp(1)
    loss = every.sum()
    for row, example in enumerate(batch):
        correct = [spans[row, first, last] for first, last in _runs(example.attack)]
        loss = loss - (torch.stack(correct).logsumexp(0) if correct else network.none[0])
    valid = torch.arange(most)[None] < lengths[:, None]
    each = nn.functional.binary_cross_entropy_with_logits(clause, attack, reduction="none")
    return (loss + CLAUSES * (each * valid).sum()) / len(batch)


def _span_scores(clause: torch.Tensor, edge: torch.Tensor, lengths: torch.Tensor) -> torch.Tensor:
    """Return the scores of all spans, shape [batch, first, last].

    The score is -1e9 for the whole text and for spans that contain padding.
    """
    sums = nn.functional.pad(clause.cumsum(1), (1, 0))
    scores = (edge[:, 1:] + sums[:, 1:])[:, None] + (edge - sums)[:, :-1, None]
    place = torch.arange(clause.shape[1])
    ends = place[None] < lengths[:, None]
    allowed = (place[None] >= place[:, None])[None] & ends[:, None]
    whole = (place == 0)[None, :, None] & (place[None] == lengths[:, None] - 1)[:, None]
    return scores.masked_fill(~allowed | whole, -1e9)


def _runs(attack: np.ndarray) -> list[tuple[int, int]]:
    """Return the first and the last clause of each attack.

    The list is empty if the text contains no attack, or if it consists only of an attack.
    """
    places = np.flatnonzero(attack)
    if not 0 < len(places) < len(attack):
        return []
    runs = np.split(places, np.flatnonzero(np.diff(places) > 1) + 1)
    return [(int(run[0]), int(run[-1])) for run in runs]
