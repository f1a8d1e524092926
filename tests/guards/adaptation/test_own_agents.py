"""Tests of test-time adaptation of this project's agents."""

from __future__ import annotations

import pytest
import torch

from mitigate.agents.agent import KnowsEntropy, entropy_of
from mitigate.agents.recurrent import agent as recurrent
from mitigate.agents.topological import agent as topological
from mitigate.core import checkpoint
from mitigate.core.seeding import generator
from mitigate.corruptions import Corruption
from mitigate.evaluation.episode import run_episode
from mitigate.guards.adaptation.norm import Norm
from mitigate.guards.adaptation.recentre import Recentre
from mitigate.guards.adaptation.tent import Tent
from mitigate.guards.guard import Guards
from mitigate.worlds.apartments import simulator
from mitigate.worlds.apartments.tasks import DrawnEpisodes, load_episodes
from mitigate.worlds.apartments.world import ApartmentsWorld
from tests.agents.recurrent.test_recurrent import agent as recurrent_agent
from tests.agents.rooms import wanderer

KINDS = {
    "topological": (wanderer, topological, 12),
    "recurrent": (recurrent_agent, recurrent, 1),
}
DARK = Corruption("low_light", 0.8)
EPISODE = load_episodes("val_seen")[0]


@pytest.fixture(params=["topological", pytest.param("recurrent", marks=pytest.mark.slow)])
def kind(request, monkeypatch):
    monkeypatch.setattr(simulator, "MAX_STEPS", 40)
    return KINDS[request.param]


def decisions(module, monkeypatch, agent, world, guard):
    """Return the logits of every decision in an episode."""
    logits = []
    check = module.check_logits

    def record(values, by):
        logits.append(values.flatten().clone())
        return check(values, by)

    with monkeypatch.context() as patch:
        patch.setattr(module, "check_logits", record)
        run_episode(agent, world, EPISODE, DARK, 0, Guards([guard]))
    return logits


def same(one, other):
    return len(one) == len(other) and all(map(torch.equal, one, other))


def test_entropy_is_that_of_the_last_decision(kind, monkeypatch):
    make, module, views = kind
    agent, world = make(), ApartmentsWorld(16, 2, views)
    assert isinstance(agent, KnowsEntropy)
    logits = []
    monkeypatch.setattr(module, "check_logits", lambda values, by: logits.append(values) or values)
    observation = world.reset(EPISODE)
    agent.reset(EPISODE.instruction.text)
    for _ in range(12):
        count = len(logits)
        action = agent.act(observation)
        entropy = agent.entropy(observation)
        if len(logits) == count:
            assert entropy is None
        else:
            expected = entropy_of(logits[-1].flatten())
            torch.testing.assert_close(entropy.detach(), expected, atol=1e-4, rtol=1e-4)
            assert entropy.requires_grad
        if not action:
            break
        observation = world.step(action)


def test_adaptation_of_own_agents_changes_decisions_and_restores_weights(kind, monkeypatch):
    make, module, views = kind
    agent, world = make(), ApartmentsWorld(16, 2, views)
    before = checkpoint.weights_sha(agent)
    recentre = Recentre()
    recentre.calibrate(agent, world, lambda i: DrawnEpisodes(2).draw(generator(0, "draw", i)))
    plain = decisions(module, monkeypatch, agent, world, Tent(lr=0.0))
    assert same(plain, decisions(module, monkeypatch, agent, world, Tent(lr=0.0)))
    for guard in (Tent(lr=0.1), recentre):
        guard.check_agent(agent)
        assert not same(plain, decisions(module, monkeypatch, agent, world, guard))
        assert checkpoint.weights_sha(agent) == before
    with pytest.raises(ValueError, match="BatchNorm.*adapt=recentre"):
        Norm().check_agent(agent)
