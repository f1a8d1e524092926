"""Tests of the agent in closed loop: when it reads frames, when it stops, and that it is
deterministic."""

from __future__ import annotations

import numpy as np
import pytest
import torch
import torch.nn.functional as F

from mitigate.agents.encoders import halved
from mitigate.agents.topological import TopologicalAgent
from mitigate.agents.topological import agent as topological
from mitigate.core.observation import DEPTH, MAX_STEPS, RGB, STOP, Observation
from mitigate.worlds.apartments.simulator import Simulator
from mitigate.worlds.apartments.tasks import load_episodes
from tests.agents.rooms import wanderer


@pytest.fixture(scope="module")
def simulator() -> Simulator:
    return Simulator(16)


def drive(agent, simulator, number=0, change=lambda frames: frames) -> tuple[list[int], list[int]]:
    """Run an episode; return the actions and the numbers of the steps at which frames were read."""
    episode = load_episodes("val_seen")[number]
    simulator.reset(episode)
    agent.reset(episode.instruction.text)
    actions, looks = [], []

    def frames() -> dict[str, np.ndarray]:
        looks.append(simulator.steps)
        return change(simulator.observe())

    while not simulator.done:
        actions.append(agent.act(Observation(simulator.odometry(), frames, (RGB, DEPTH))))
        simulator.step(actions[-1])
    return actions, looks


def test_act_reads_frames_only_to_decide(simulator):
    agent = wanderer()
    actions, looks = drive(agent, simulator)
    assert len(looks) == agent.decisions > 3
    # frames are read once per decision, and the agent moves between decisions
    assert len(set(looks)) == len(looks) < len(actions) / 2


def test_act_stops_at_the_limit_of_decisions(simulator, monkeypatch):
    monkeypatch.setattr(topological, "MAX_DECISIONS", 6)
    agent = wanderer()
    actions, looks = drive(agent, simulator, 3)
    assert agent.decisions == 6 == len(looks)
    assert actions[-1] == STOP and actions.count(STOP) == 1 and len(actions) < MAX_STEPS


@pytest.mark.slow
def test_act_returns_to_the_best_node_at_the_limit(simulator, monkeypatch):
    monkeypatch.setattr(topological, "MAX_DECISIONS", 6)
    agent = wanderer()
    for number in (3, 30, 60):
        drive(agent, simulator, number)
        best = agent.map.positions[max(agent._stop_scores)[1]]
        assert np.hypot(*(simulator.xy - best)) < 0.5


def test_act_is_deterministic(simulator):
    agent = wanderer()
    first = drive(agent, simulator, 1)
    drive(agent, simulator, 2)
    assert drive(agent, simulator, 1) == first


def test_act_stops_without_free_space(simulator):
    agent = wanderer()
    agent.waypoint_head.out.bias.data.fill_(-50.0)
    assert drive(agent, simulator) == ([STOP], [0])


@pytest.mark.parametrize("sensor", [RGB, DEPTH])
def test_blind_agent_ignores_the_sensor(simulator, sensor):
    def blanked(frames):
        return {**frames, sensor: np.full_like(frames[sensor], 7)}

    assert drive(wanderer(sensor), simulator) == drive(wanderer(sensor), simulator, 0, blanked)


def test_blind_agent_ignores_the_instruction():
    agent = wanderer("instruction")
    assert agent.tokens(["Find a bed."]).equal(agent.tokens(["Walk to the red sofa."]))
    assert not wanderer().tokens(["Find a bed."]).equal(wanderer().tokens(["Find a tv."]))


def test_blind_rejects_unknown_inputs():
    with pytest.raises(ValueError, match=r"'sonar'. Choose one of: rgb, depth, instruction"):
        TopologicalAgent(blind=("sonar",))


@pytest.mark.parametrize("side", [4, 7, 32])
def test_halved_equals_average_pooling(side):
    x = torch.randn(12, 5, side, side)
    expected = F.avg_pool2d(x, 2)
    with torch.no_grad():
        assert halved(x).equal(expected)
    assert halved(x.requires_grad_()).equal(expected) and halved(x).requires_grad
