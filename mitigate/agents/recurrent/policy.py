"""The policy of the recurrent agent: what it saw, did and was told, to the next low-level action.

Structure after VLN-CE's cross-modal attention model (Krantz et al. 2020): one recurrent cell keeps
what was seen and done, attention picks the words that are due and then the part of the view that
they speak of, a second cell keeps both. The attention over words also knows where it was before
(location-sensitive attention, Chorowski et al. 2015), since routes are told in order.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor, nn

from mitigate.agents.attention import Layer
from mitigate.agents.encoders import DIRECTIONS, GRID
from mitigate.agents.text import CONCEPTS, MAX_WORDS, NEAR, PAD, THINGS, Vocabulary
from mitigate.core.observation import FORWARD, FORWARD_METRES, LEFT, RIGHT, TURN_DEGREES

MOVES = 5 + 4  # last action (none, or one of four); heading as sine and cosine, metres gone, steps
_METRES, _STEPS = 5.0, 50.0  # units in which metres gone and steps taken are given
ACTIONS = 4
KEYS = 64  # width of the attention over words: what it costs in training
REACH = 7  # words around the last ones that the attention sees at once, odd


class Odometer:
    """What an agent knows of its own motion: it counts the actions of an episode, and reads no
    sensor."""

    def __init__(self) -> None:
        self.last = -1
        self.heading = self.metres = 0.0
        self.steps = 0

    def add(self, action: int) -> None:
        """Count an action."""
        self.last, self.steps = action, self.steps + 1
        self.heading += math.radians(TURN_DEGREES) * ((action == LEFT) - (action == RIGHT))
        self.metres += FORWARD_METRES * (action == FORWARD)

    def correct(self, action: int, metres: float, radians: float) -> None:
        """Count in place of the last action another one, or none (-1), which went so far."""
        self.heading -= math.radians(TURN_DEGREES) * ((self.last == LEFT) - (self.last == RIGHT))
        self.metres -= FORWARD_METRES * (self.last == FORWARD)
        self.last = action
        self.heading += radians
        self.metres += max(0.0, metres)

    def moves(self) -> np.ndarray:
        """float32 [9]: which action was the last one (none, or one of four), sine and cosine of the
        turns since the start, metres gone / 5, steps taken / 50."""
        out = np.zeros(MOVES, np.float32)
        out[1 + self.last] = 1.0
        out[5:] = (
            math.sin(self.heading),
            math.cos(self.heading),
            self.metres / _METRES,
            self.steps / _STEPS,
        )
        return out


class Text(NamedTuple):
    """Words of E instructions: keys [E, L, KEYS] and values [E, L, width]; mask bool [E, L], True
    where there is a word."""

    keys: Tensor
    values: Tensor
    mask: Tensor

    def rows(self, index: Tensor) -> Text:
        return Text(*(part[index] for part in self))


@dataclass
class State:
    """Memory of E episodes: hidden [E, width], the last attention over words and the sum of all so
    far, each [E, L]."""

    hidden: Tensor
    last: Tensor
    sum: Tensor

    @classmethod
    def start(cls, text: Text) -> State:
        last, added = (torch.zeros_like(text.mask, dtype=text.values.dtype) for _ in range(2))
        return cls(text.values.new_zeros(len(text.values), text.values.shape[-1]), last, added)

    @classmethod
    def join(cls, states: Sequence[State]) -> State:
        """All rows of ``states``, of texts of one length."""
        return cls(*(torch.cat([vars(s)[name] for s in states]) for name in vars(states[0])))

    def rows(self, index: Tensor) -> State:
        return State(self.hidden[index], self.last[index], self.sum[index])

    def put(self, index: Tensor, fresh: State) -> None:
        """Replace the rows ``index``, in place."""
        for name, value in vars(fresh).items():
            vars(self)[name][index] = value


def gated(inputs: Tensor, hidden: Tensor, cell: nn.GRUCell) -> Tensor:
    """What ``cell`` makes of ``hidden`` [E, width], its input's part [E, 3 width] given."""
    reset, update, new = inputs.chunk(3, -1)
    held_reset, held_update, held_new = F.linear(hidden, cell.weight_hh, cell.bias_hh).chunk(3, -1)
    candidate = torch.tanh(new + torch.sigmoid(reset + held_reset) * held_new)
    kept = torch.sigmoid(update + held_update)
    return candidate + kept * (hidden - candidate)


class Policy(nn.Module):
    """Args: rgb, depth: features of a column of each sensor; 0 for one that the agent has not.
    width, heads, text_layers: of the network. vocabulary: of the instructions."""

    concept_words: Tensor

    def __init__(
        self,
        rgb: int,
        depth: int,
        vocabulary: Vocabulary,
        width: int = 160,
        heads: int = 4,
        text_layers: int = 2,
        dropout: float = 0.1,
    ) -> None:
        super().__init__()
        self.sizes = [
            *([GRID * rgb, GRID * len(CONCEPTS)] if rgb else [0, 0]),
            *([GRID * depth, DIRECTIONS] if depth else [0, 0]),
        ]
        self.words = nn.Embedding(len(vocabulary), width, padding_idx=PAD)
        nn.init.normal_(self.words.weight, std=0.5)
        self.places = nn.Embedding(MAX_WORDS, width)
        nn.init.normal_(self.places.weight, std=0.1)
        self.register_buffer("concept_words", vocabulary.concept_words(), persistent=False)
        self.text = nn.ModuleList([Layer(width, heads, False, dropout) for _ in range(text_layers)])
        self.text_norm, self.keys = nn.LayerNorm(width), nn.Linear(width, KEYS)
        if rgb:
            self.rgb = nn.Linear(rgb, width)
            self.seen, self.close, self.kinds = (
                nn.Linear(width, width, bias=False) for _ in range(3)
            )
        if depth:
            self.depth, self.free = nn.Linear(depth, width), nn.Linear(DIRECTIONS, width)
        self.column = nn.Parameter(torch.randn(GRID, width) * 0.1)
        self.column_norm = nn.LayerNorm(width)
        self.whole = nn.Sequential(nn.Linear(GRID * width, width), nn.GELU(), nn.Dropout(dropout))
        self.move = nn.Linear(MOVES, width)
        self.first = nn.GRUCell(width, width)
        self.ask = nn.Linear(width, KEYS)
        self.near = nn.Conv1d(2, 8, REACH, padding=REACH // 2)
        self.place = nn.Linear(8, 1, bias=False)
        self.look_for = nn.Linear(width, width)
        self.second = nn.GRUCell(3 * width + GRID, width)
        self.dropout = nn.Dropout(dropout)
        self.act = nn.Sequential(nn.Linear(width, width), nn.GELU(), nn.Linear(width, ACTIONS))
        self.distance, self.grounding = nn.Linear(width, 1), nn.Linear(width, GRID)

    def read(self, tokens: Tensor) -> Text:
        """Token ids [E, L] to words."""
        mask = tokens != PAD
        x = self.words(tokens) + self.places.weight[: tokens.shape[1]]
        for layer in self.text:
            x = layer(x, mask)
        x = self.text_norm(x)
        return Text(self.keys(x), x, mask)

    def look(self, views: Tensor) -> Tensor:
        """Features [..., F] of views, as the agent encodes them, to columns [..., 4, width]."""
        rgb, concepts, depth, free = views.split(self.sizes, -1)
        x = self.column
        if self.sizes[0]:
            concepts = concepts.unflatten(-1, (GRID, -1))
            meaning = self.concept_words @ self.words.weight  # [concepts, width]
            x = x + self.rgb(rgb.unflatten(-1, (GRID, -1)))
            x = x + self.seen(concepts[..., THINGS] @ meaning[THINGS])
            x = x + self.close(concepts[..., NEAR] @ meaning[NEAR])
            x = x + self.kinds(concepts[..., NEAR.stop :] @ meaning[NEAR.stop :])
        if self.sizes[2]:
            x = x + self.depth(depth.unflatten(-1, (GRID, -1))) + self.free(free)[..., None, :]
        return self.column_norm(x)

    def step(self, text: Text, columns: Tensor, moves: Tensor, state: State) -> State:
        """One instant of E episodes: columns [E, 4, width], moves [E, MOVES]."""
        return self._step(text, columns, self._inputs(columns, moves), state)

    def _inputs(self, columns: Tensor, moves: Tensor) -> Tensor:
        """What of both cells depends on no memory, [..., 6 width]: for all steps at once."""
        x = self.whole(columns.flatten(-2)) + self.move(moves)
        width = x.shape[-1]
        first = F.linear(x, self.first.weight_ih, self.first.bias_ih)
        second = F.linear(x, self.second.weight_ih[:, :width], self.second.bias_ih)
        return torch.cat([first, second], -1)

    def _step(self, text: Text, columns: Tensor, inputs: Tensor, state: State) -> State:
        width = columns.shape[-1]
        into_first, into_second = inputs.chunk(2, -1)
        first = gated(into_first, state.hidden, self.first)
        energy = (text.keys @ self.ask(first)[:, :, None]).squeeze(-1) * KEYS**-0.5
        around = self.near(torch.stack([state.last, state.sum], 1).to(first.dtype))
        energy = energy + self.place(torch.tanh(around).transpose(1, 2)).squeeze(-1)
        due = energy.float().masked_fill(~text.mask, -1e4).softmax(-1).to(text.values.dtype)
        words = (due[:, None] @ text.values).squeeze(1)
        match = (columns @ self.look_for(words)[:, :, None]).squeeze(-1) * width**-0.5
        found = (match.softmax(-1)[:, None] @ columns).squeeze(1)
        read = torch.cat([words, found, match], -1)
        into_second = into_second + F.linear(read, self.second.weight_ih[:, width:])
        hidden = gated(into_second, first, self.second)
        return State(hidden, due, state.sum + due)

    def answer(self, hidden: Tensor) -> Tensor:
        """Logits [..., 4] over the actions."""
        return self.act(self.dropout(hidden)).float()

    def forward(self, text: Text, views: Tensor, moves: Tensor) -> dict[str, Tensor]:
        """All steps of E episodes: views [E, T, F], moves [E, T, MOVES].

        Returns logits [E, T, 4], distance [E, T] (predicted metres to the goal / 5), grounding
        [E, T, 4] (logit that the goal's landmark shows in a column), state [E, T, width].
        """
        columns = self.look(views)
        inputs, state = self._inputs(columns, moves), State.start(text)
        made = []
        for x, seen in zip(inputs.unbind(1), columns.unbind(1), strict=True):
            state = self._step(text, seen, x, state)
            made.append(state.hidden)
        hidden = torch.stack(made, 1)
        return {
            "logits": self.answer(hidden),
            "distance": self.distance(hidden).squeeze(-1).float(),
            "grounding": self.grounding(hidden).float(),
            "state": hidden,
        }
