"""What the reference agent decided in rollouts, and the padded batch that it learns from."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import torch
from tensordict import tensorclass
from torch import Tensor

from mitigate.agents.topological.planner import DecisionBatch, collate
from mitigate.agents.topological.rollout import Piece, Step

STOP_WEIGHT = 1.5  # one decision in about six is a stop
FARTHEST = 25.0  # metres; the distance loss asks for no more


@tensorclass(shadow=True)
class MapDecisions:
    """Padded decisions over [stop], nodes (N) and ghosts (G) of B decisions in E episodes, which
    saw P panoramas (``planner.DecisionBatch`` has the first seven).

    target, metres [B, 1 + N + G]; weight [B]; tokens int64 [E, L]. Seen: ``views`` and
    ``clean_views`` are features [P, 12, F] where they are known, else there are frames; labels are
    there where the world has them.
    """

    episode: Tensor
    panorama: Tensor
    nodes: Tensor
    sightings: Tensor
    geometry: Tensor
    valid: Tensor
    allowed: Tensor
    target: Tensor
    metres: Tensor
    weight: Tensor
    tokens: Tensor
    episode_ids: Any
    rgb: Tensor | None = None
    depth: Tensor | None = None
    clean_rgb: Tensor | None = None
    clean_depth: Tensor | None = None
    views: Tensor | None = None
    clean_views: Tensor | None = None
    concepts: Tensor | None = None
    free: Tensor | None = None
    goal: Tensor | None = None

    @property
    def choices(self) -> DecisionBatch:
        """The decisions as the planner takes them."""
        return DecisionBatch(
            self.episode,
            self.panorama,
            self.nodes,
            self.sightings,
            self.geometry,
            self.valid,
            self.allowed,
        )


def join(pieces: Sequence[Piece], tokens: Callable[[list[str]], Tensor]) -> MapDecisions:
    """Pad the decisions of all traces with their targets; ``tokens`` encodes instructions."""
    traces = [trace for piece in pieces for trace in piece.traces]
    steps = [(row, step) for row, trace in enumerate(traces) for step in trace.steps]
    offsets = np.cumsum([0, *(len(trace.steps) for trace in traces)])
    choices = collate(
        [s.decision for _, s in steps],
        [row for row, _ in steps],
        [int(offsets[row]) for row, _ in steps],
    )
    target, metres = _answers(choices, [step for _, step in steps])
    seen = {
        name: torch.from_numpy(np.concatenate([piece.seen[name] for piece in pieces]))
        for name in pieces[0].seen
    }
    return MapDecisions(  # type: ignore[call-arg]
        **vars(choices),
        target=target,
        metres=metres,
        weight=1 + (STOP_WEIGHT - 1) * target[:, 0],
        tokens=tokens([trace.episode.instruction.text for trace in traces]),
        episode_ids=[trace.episode.episode_id for trace in traces],
        **seen,
        batch_size=[],
    )


def _answers(choices: DecisionBatch, steps: list[Step]) -> tuple[Tensor, Tensor]:
    """Padded targets and metres, each float32 [B, 1 + N + G]."""
    size, first = choices.valid.shape, 1 + choices.nodes.shape[1]
    target, metres = np.zeros(size, np.float32), np.zeros(size, np.float32)
    for index, step in enumerate(steps):
        ghosts, nodes = len(step.decision.ghosts), len(step.decision.nodes)
        target[index, 0], target[index, first : first + ghosts] = step.target[0], step.target[1:]
        metres[index, : 1 + nodes], metres[index, first : first + ghosts] = (
            step.metres[: 1 + nodes],
            step.metres[1 + nodes :],
        )
    return torch.from_numpy(target), torch.from_numpy(np.minimum(metres, FARTHEST))
