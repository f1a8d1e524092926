"""Tests that users' objects can be agents, worlds and experts, and that missing members get
defaults."""

from __future__ import annotations

from contextlib import nullcontext

import numpy as np
import pytest
from torch import nn

from mitigate.agents.agent import Agent, as_agent
from mitigate.agents.fingerprint import contents
from mitigate.agents.stepwise import StepwiseAgent
from mitigate.core.contracts import missing_members
from mitigate.core.observation import Observation
from mitigate.worlds.world import Corrupted, Expert, World, as_world, expert_of


class Duck:
    """An agent with only the two required methods."""

    def reset(self, instruction: str) -> None:
        self.heard = instruction

    def act(self, observation) -> int:
        return len(self.heard)


class Prompted(Duck):
    system_prompt = "Be careful."
    views, tasks = 1, ("ogn",)
    together = 8  # without begin() and act_all()

    def taken(self, action: int, metres: float, radians: float) -> None:
        self.aim = np.array([metres, radians])


def test_agent_of_a_users_class_gets_the_defaults():
    duck = Duck()
    contract = as_agent(duck)
    contract.reset("go")
    assert contract.act({}) == 2 and duck.heard == "go"
    assert contract.views is contract.sensors is contract.tasks is contract.aim is None
    assert contract.together == 1 and not contract.encoders and not contract.frozen
    contract.taken(1, 0.25, 0.0)
    with contract.remembering():
        pass
    assert contract.precompute("piece", clean=True) == "piece"


def test_agent_of_a_users_class_keeps_what_it_has():
    agent = Prompted()
    contract = as_agent(agent)
    assert (contract.views, contract.tasks, contract.together) == (1, ("ogn",), 1)
    contract.system_prompt = "Obey."
    assert agent.system_prompt == "Obey." == contract.system_prompt
    contract.taken(1, 0.5, 0.0)
    assert contract.aim is agent.aim


def test_agent_is_not_changed_by_the_contract():
    agent = Prompted()
    before = vars(agent).copy()
    as_agent(agent)
    assert vars(agent) == before
    assert contents(agent) == contents(Prompted())


def test_as_agent_returns_an_agent_unchanged():
    class Mine(Agent):
        pass

    agent = Mine()
    assert as_agent(agent) is agent
    with pytest.raises(NotImplementedError, match="Mine defines no act"):
        agent.act({})


def test_lacking_counts_defaults_as_absent():
    class Blind(StepwiseAgent):
        pass

    missing = missing_members(Blind(), ("parts", "encoders", "labels", "see"))
    assert missing == ["encoders", "labels", "see"]


def test_teacher_is_by_default_a_copy_without_adapters():
    network = nn.Sequential(nn.Linear(2, 2))
    teacher = as_agent(network).as_teacher()
    assert teacher is not network and isinstance(teacher, nn.Sequential)


class Place:
    """A world with only the required members; its expert defines only ``action``."""

    sensors: dict = {}
    rule = "STOP"
    done = False

    def reset(self, episode) -> Observation:
        return Observation({}, dict, ())

    def step(self, action: int) -> Observation:
        return Observation({}, dict, ())

    def measures(self) -> dict:
        return {"success": 0, "spl": 0.0}

    def action(self) -> int:
        return 0


class Guided(Place):
    def expert(self) -> Guided:
        return self


def test_world_of_a_users_class_gets_the_defaults():
    world = as_world(Place())
    assert isinstance(world, World) and world.rule == "STOP" and not world.done
    assert world.expert() is None and world.truth() == {} and world.draw is None
    assert isinstance(world.remembering(), nullcontext)
    assert Corrupted(Place(), None, 0).truth() == {}
    with pytest.raises(ValueError, match="Place has no expert"):
        expert_of(Corrupted(Place(), None, 0))


def test_expert_of_a_users_class_gets_the_defaults():
    expert = expert_of(Guided())
    assert isinstance(expert, Expert) and expert.action() == 0
    assert np.isnan(expert.distance(np.zeros(2))) and expert.counts(9.0)
