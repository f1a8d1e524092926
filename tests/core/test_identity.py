"""One hash over all that makes an agent behave as it does."""

from __future__ import annotations

import copy

import torch

from mitigate.agents.text import WORDS
from mitigate.agents.topological import TopologicalAgent
from mitigate.core import seeding
from mitigate.core.identity import identity
from mitigate.core.observation import cameras

SMALL = {"heads": 2, "text_layers": 1, "layers": 1}


def agent(**settings) -> TopologicalAgent:
    seeding.seed_everything(0, "identity")
    return TopologicalAgent(16, **{"planner": SMALL, **settings})


def test_equal_agents_have_one_identity_and_every_difference_another():
    plain, views = agent(), cameras(64)
    moved = copy.deepcopy(plain)
    with torch.no_grad():
        next(moved.parameters()).view(-1)[0] += 1e-3
    others = [
        identity(moved, views),
        identity(agent(blind=["rgb"]), views),
        identity(agent(size=32), views),
        identity(agent(planner={**SMALL, "fusion": {"rate": 4, "cap": 3}}), views),
        identity(agent(vocabulary=[*WORDS[1:], WORDS[0]]), views),  # equally many, other ids
        identity(plain, cameras(32)),
        identity(plain, views, "rules"),
    ]
    assert identity(plain, views) == identity(agent(), views)
    assert len({identity(plain, views), *others}) == 1 + len(others)
