"""Tests that the planner's scores do not depend on padding or on the order of ghosts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import torch

from mitigate.agents.text import PAD, Vocabulary
from mitigate.agents.topological.mapping import Decision, TopologicalMap
from mitigate.agents.topological.planner import Planner, collate
from mitigate.core.observation import VIEWS

TEXT = ["Walk past the red sofa, then stop at the plant.", "Find a bed."]


@pytest.fixture(scope="module")
def planner() -> Planner:
    torch.manual_seed(0)
    return Planner(8, 8, width=16, heads=2, text_layers=1, layers=2).eval()


def decision(moves: int) -> Decision:
    """Return the inputs of a decision after some moves; each move adds about 3 ghosts."""
    rng = np.random.default_rng(moves)
    graph, pose = TopologicalMap(), np.zeros(3)
    for _ in range(moves):
        pose = pose + np.array([1.5, rng.uniform(-1, 1), rng.uniform(-1, 1)])
        yaws = rng.uniform(0, 2 * np.pi, 4)
        graph.add(pose, np.stack([yaws, rng.uniform(1, 2.2, 4)], 1))
    return graph.decision(pose)


def views(planner: Planner, panoramas: int) -> torch.Tensor:
    generator = torch.Generator().manual_seed(panoramas)
    return torch.rand(panoramas, VIEWS, sum(planner.widths), generator=generator)


@torch.no_grad()
def score(planner, decisions, rows, offsets, panoramas, tokens) -> torch.Tensor:
    batch = collate(decisions, rows, offsets)
    return planner(planner.read(tokens), planner.embed_views(views(planner, panoramas)), batch)[
        "logits"
    ]


def split(logits: torch.Tensor, output: Decision, nodes: int) -> tuple[torch.Tensor, torch.Tensor]:
    """Return the score of [stop] and the scores of the ghosts; ``logits`` is padded to ``nodes``
    nodes."""
    return logits[0], logits[1 + nodes : 1 + nodes + len(output.ghosts)]


def test_planner_ignores_padding_of_decisions(planner):
    short, long = decision(2), decision(6)
    tokens = Vocabulary().batch(TEXT)
    alone = score(planner, [short], [0], [6], 8, tokens)
    together = score(planner, [long, short], [1, 0], [0, 6], 8, tokens)
    stop, ghosts = split(together[1], short, len(long.nodes))
    wanted_stop, expected = split(alone[0], short, len(short.nodes))
    assert torch.allclose(stop, wanted_stop, atol=1e-5)
    assert torch.allclose(ghosts, expected, atol=1e-5) and len(ghosts) > 2
    padded = together[1, 1 + len(long.nodes) + len(short.ghosts) :]
    assert torch.isinf(padded).all()


def test_planner_ignores_padding_of_instructions(planner):
    output, tokens = decision(3), Vocabulary().batch([TEXT[0]])
    longer = torch.nn.functional.pad(tokens, (0, 9), value=PAD)
    one, other = (score(planner, [output], [0], [0], 3, t) for t in (tokens, longer))
    assert torch.allclose(one, other, atol=1e-5)


def test_planner_permutes_scores_with_ghosts(planner):
    output, tokens = decision(4), Vocabulary().batch([TEXT[0]])
    count, first = len(output.ghosts), 1 + len(output.nodes)
    order = np.random.default_rng(0).permutation(count)
    geometry = output.geometry.copy()
    geometry[first:] = output.geometry[first:][order]
    moved = replace(
        output,
        sightings=output.sightings[order],
        geometry=geometry,
        ghosts=[output.ghosts[i] for i in order],
        travel=output.travel[order],
    )
    before, after = (score(planner, [d], [0], [0], 4, tokens)[0] for d in (output, moved))
    assert count > 3 and not np.array_equal(order, np.arange(count))
    assert torch.allclose(before[0], after[0], atol=1e-5)
    assert torch.allclose(before[first:][order], after[first:], atol=1e-5)
    assert before[first:].std() > 1e-3


def test_planner_allows_only_stop_and_ghosts(planner):
    output = decision(3)
    logits = score(planner, [output], [0], [0], 3, Vocabulary().batch([TEXT[1]]))[0]
    nodes = logits[1 : 1 + len(output.nodes)]
    assert torch.isinf(nodes).all() and torch.isfinite(logits).sum() == 1 + len(output.ghosts)


def test_planner_reads_instruction_and_views(planner):
    output, tokens = decision(3), Vocabulary().batch(TEXT)
    first, second = (score(planner, [output], [row], [0], 3, tokens) for row in (0, 1))
    other = score(planner, [output], [0], [1], 4, tokens)  # different panoramas with the same map
    allowed = torch.isfinite(first)
    assert (first - second)[allowed].abs().max() > 1e-4
    assert (first - other)[allowed].abs().max() > 1e-4
