"""The policy of the recurrent agent chooses a low-level action from views, motion and text.

The structure follows VLN-CE's cross-modal attention model (Krantz et al. 2020). One recurrent cell
stores views and actions. Attention selects the current words, and then the part of the view that
these words describe. A second recurrent cell stores both results. The attention over words also
receives its earlier positions (location-sensitive attention, Chorowski et al. 2015), because
instructions describe routes in order.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor, nn

from mitigate.agents.attention import TextReader
from mitigate.agents.encoders import DIRECTIONS, GRID
from mitigate.agents.text import CONCEPTS, Vocabulary
from mitigate.core.observation import FORWARD, FORWARD_METRES, LEFT, RIGHT, TURN_DEGREES

# number of motion features: last action (5 values), sine and cosine of heading, metres, steps
MOVES = 5 + 4
_METRES, _STEPS = 5.0, 50.0  # divisors of the distance moved and of the number of steps
ACTIONS = 4
KEYS = 64  # width of the attention over words; chosen small to limit the training time
REACH = 7  # kernel size (in words) of the location-sensitive attention; must be odd


class Odometer:
    """Dead reckoning: estimate an agent's motion from its actions, without a sensor."""

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
        """Correct the last step, in which the agent did not make the motion that it chose.

        Args:
            action: replaces the last action; -1 means no action.
            metres: distance that the agent really moved forward.
            radians: angle that the agent really turned to the left.
        """
        self.heading -= math.radians(TURN_DEGREES) * ((self.last == LEFT) - (self.last == RIGHT))
        self.metres -= FORWARD_METRES * (self.last == FORWARD)
        self.last = action
        self.heading += radians
        self.metres += max(0.0, metres)

    def moves(self) -> np.ndarray:
        """Return the features of the motion, float32 [9].

        The first five values are a one-hot code of the last action (no action, or one of four). The
        others are the sine and cosine of the heading relative to the start, the metres moved
        divided by 5, and the number of steps divided by 50.
        """
        out = np.zeros(MOVES, np.float32)
        out[1 + self.last] = 1.0  # one-hot: no action, or one of four
        out[5:7] = math.sin(self.heading), math.cos(self.heading)
        out[7:] = self.metres / _METRES, self.steps / _STEPS
        return out


class Text(NamedTuple):
    """The encoded words of E instructions."""

    keys: Tensor  # [E, L, KEYS]
    values: Tensor  # [E, L, width]
    mask: Tensor  # bool [E, L], True for words and False for padding

    def rows(self, index: Tensor) -> Text:
        return Text(*(part[index] for part in self))


class State(NamedTuple):
    """Memory of E episodes."""

    hidden: Tensor  # [E, width]
    last: Tensor  # the last attention over words, [E, L]
    sum: Tensor  # the sum of all attentions so far, [E, L]

    @classmethod
    def start(cls, text: Text) -> State:
        last = torch.zeros_like(text.mask, dtype=text.values.dtype)
        return cls(torch.zeros_like(text.values[:, 0]), last, last.clone())

    @classmethod
    def join(cls, states: Sequence[State]) -> State:
        """Concatenate ``states`` whose texts have equal length."""
        return cls(*(torch.cat(parts) for parts in zip(*states, strict=True)))

    def rows(self, index: Tensor) -> State:
        return State(*(part[index] for part in self))

    def put(self, index: Tensor, fresh: State) -> None:
        """Replace the rows of this state at ``index`` with the rows of ``fresh``, in place."""
        for part, rows in zip(self, fresh, strict=True):
            part[index] = rows


def gated(inputs: Tensor, hidden: Tensor, cell: nn.GRUCell) -> Tensor:
    """Return the next hidden state of ``cell``, given its projected inputs [E, 3 * width]."""
    reset, update, new = inputs.chunk(3, -1)
    state = F.linear(hidden, cell.weight_hh, cell.bias_hh)
    state_reset, state_update, state_new = state.chunk(3, -1)
    candidate = torch.tanh(new + torch.sigmoid(reset + state_reset) * state_new)
    keep = torch.sigmoid(update + state_update)
    return candidate + keep * (hidden - candidate)


class Policy(TextReader):
    """Recurrent policy that reads instructions, views and motion.

    Args:
        rgb: number of RGB features per column, or 0 without RGB.
        depth: number of depth features per column, or 0 without depth.
        vocabulary: words of the instructions.
        width: width of all layers.
        heads: attention heads of the text layers.
        text_layers: number of transformer layers over the text.
        dropout: dropout rate.
    """

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
        super().__init__(vocabulary, width, heads, text_layers, dropout)
        self.sizes = [
            *([GRID * rgb, GRID * len(CONCEPTS)] if rgb else [0, 0]),
            *([GRID * depth, DIRECTIONS] if depth else [0, 0]),
        ]
        self.keys = nn.Linear(width, KEYS)
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
        """Encode token ids [E, L]."""
        values, mask = super().read(tokens)
        return Text(self.keys(values), values, mask)

    def embed_views(self, views: Tensor) -> Tensor:
        """Return the features of columns [..., 4, width] of encoded views [..., F]."""
        rgb, concepts, depth, free = views.split(self.sizes, -1)
        x = self.column
        if self.sizes[0]:
            seen, close, others = self.concept_features(concepts.unflatten(-1, (GRID, -1)))
            x = x + self.rgb(rgb.unflatten(-1, (GRID, -1))) + seen + close + others
        if self.sizes[2]:
            x = x + self.depth(depth.unflatten(-1, (GRID, -1))) + self.free(free)[..., None, :]
        return self.column_norm(x)

    def step(self, text: Text, columns: Tensor, moves: Tensor, state: State) -> State:
        """Advance E episodes by one step.

        Args:
            text: the encoded instructions.
            columns: features of four image columns, [E, 4, width].
            moves: the last motions, [E, MOVES].
            state: the memory before this step.
        """
        return self._step(text, columns, self._inputs(columns, moves), state)

    def _inputs(self, columns: Tensor, moves: Tensor) -> Tensor:
        """Return the part of both cells' inputs that needs no memory, [..., 6 * width].

        This part is computed for all steps at once.
        """
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
        location = self.near(torch.stack([state.last, state.sum], 1).to(first.dtype))
        energy = energy + self.place(torch.tanh(location).transpose(1, 2)).squeeze(-1)
        attention = energy.float().masked_fill(~text.mask, -1e4).softmax(-1)
        attention = attention.to(text.values.dtype)
        words = (attention[:, None] @ text.values).squeeze(1)
        match = (columns @ self.look_for(words)[:, :, None]).squeeze(-1) * width**-0.5
        view = (match.softmax(-1)[:, None] @ columns).squeeze(1)
        read = torch.cat([words, view, match], -1)
        into_second = into_second + F.linear(read, self.second.weight_ih[:, width:])
        hidden = gated(into_second, first, self.second)
        return State(hidden, attention, state.sum + attention)

    def answer(self, hidden: Tensor) -> Tensor:
        """Return logits [..., 4] over the actions."""
        return self.act(self.dropout(hidden)).float()

    def forward(self, text: Text, views: Tensor, moves: Tensor) -> dict[str, Tensor]:
        """Run all steps of E episodes.

        Args:
            text: E instructions.
            views: [E, T, F].
            moves: [E, T, MOVES].

        Returns:
            A dict with the entries "logits" [E, T, 4]; "distance" [E, T], the predicted metres to
            the goal divided by 5; "grounding" [E, T, 4], one logit per column, which predicts
            whether the column shows the goal's landmark; and "state" [E, T, width].
        """
        columns = self.embed_views(views)
        inputs = self._inputs(columns, moves)
        state = State.start(text)
        states = []
        for x, step_columns in zip(inputs.unbind(1), columns.unbind(1), strict=True):
            state = self._step(text, step_columns, x, state)
            states.append(state.hidden)
        hidden = torch.stack(states, 1)
        return {
            "logits": self.answer(hidden),
            "distance": self.distance(hidden).squeeze(-1).float(),
            "grounding": self.grounding(hidden).float(),
            "state": hidden,
        }
