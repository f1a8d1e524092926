"""Tests of the errors that recipes raise if an agent implements only part of the interface."""

from __future__ import annotations

import pytest
import torch
from torch import nn

from mitigate.agents.agent import Output
from mitigate.agents.stepwise import StepDecisions, StepwiseAgent
from mitigate.recipes.distil import policy_kl
from mitigate.recipes.imitate import imitation
from mitigate.training.parts import load_teacher, train_only


class Policy(StepwiseAgent):
    def __init__(self) -> None:
        super().__init__()
        self.eyes, self.head = nn.Linear(3, 4), nn.Linear(4, 4)


class Forgetful(Policy):
    def parts(self):
        return {"head": self.head}


def decisions(target: torch.Tensor) -> StepDecisions:
    return StepDecisions({}, {}, [], target, torch.ones(len(target)), [])


def test_forbidden_candidates_do_not_enter_the_loss():
    logits = torch.tensor([[0.0, 0.0, float("-inf"), float("-inf")]])
    target = torch.tensor([[1.0, 0.0, 0.0, 0.0]])
    values = imitation(Output(logits), decisions(target), {})
    assert values["loss"] == pytest.approx(torch.log(torch.tensor(2.0)).item())
    assert policy_kl(logits + 5.0, logits, 1.0) == 0


def test_imitation_rejects_logits_of_another_shape():
    with pytest.raises(ValueError, match=r"got \[2, 4\], \[3, 4\] and"):
        imitation(Output(torch.zeros(2, 4)), decisions(torch.zeros(3, 4)), {})


def test_parts_must_hold_every_parameter():
    with pytest.raises(ValueError, match=r"leaves out eyes.weight"):
        train_only(Forgetful(), ["head"])


def test_agent_that_is_not_trainable_names_what_it_lacks():
    with pytest.raises(ValueError, match="parts, collect, join, decide"):
        train_only(nn.Linear(2, 2), None)


def test_only_named_parts_train_and_teacher_is_frozen():
    agent = Policy()
    train_only(agent, ["head"])
    assert [n for n, p in agent.named_parameters() if p.requires_grad] == [
        "head.weight",
        "head.bias",
    ]
    assert not any(p.requires_grad for p in load_teacher(agent, "start").parameters())
