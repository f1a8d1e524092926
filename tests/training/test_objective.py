"""Tests that a recipe's flat arguments are split between an objective and its data source."""

from __future__ import annotations

from functools import partial

import pytest
import torch

from mitigate.training.objective import Objective, ObjectiveSpec
from tests.tiny import TinyAgent, assemble


class Numbers:
    """A source of numbers."""

    def __init__(self, agent, count: int = 2, seed: int = 0) -> None:
        self.agent = agent
        self.count = count
        self.seed = seed


class OnNumbers(Objective):
    sources = {"numbers": partial(Numbers, count=3)}

    def __init__(self, agent, numbers: Numbers, seed: int = 0, weight: float = 1.0) -> None:
        super().__init__()
        self.agent = agent
        self.numbers = numbers
        self.seed = seed
        self.scale = weight


TARGET = f"{__name__}.OnNumbers"


def test_spec_passes_arguments_by_constructor_name():
    spec = ObjectiveSpec.of({"_target_": TARGET, "count": 5, "seed": 7, "weight": 2.0})
    assert spec.source == {"count": 5, "seed": 7}
    assert spec.arguments == {"seed": 7, "weight": 2.0}
    agent = TinyAgent()
    output = spec.build(agent)
    assert output.agent is output.numbers.agent is agent
    assert (output.numbers.count, output.numbers.seed, output.seed, output.scale) == (5, 7, 7, 2.0)


def test_spec_uses_the_source_defaults_of_the_objective():
    assert ObjectiveSpec.of({"_target_": TARGET}).build(TinyAgent()).numbers.count == 3
    assert assemble(OnNumbers, TinyAgent(), count=4).numbers.count == 4


def test_spec_rejects_an_argument_that_neither_constructor_names():
    with pytest.raises(ValueError, match="no argument 'cuont'. Did you mean count?"):
        ObjectiveSpec.of({"_target_": TARGET, "cuont": 5})


def test_build_never_trains_weights_that_are_not_floating_point():
    agent = TinyAgent()
    agent.register_parameter("bits", torch.nn.Parameter(torch.ones(2).byte(), requires_grad=False))
    ObjectiveSpec.of({"_target_": TARGET}).build(agent)
    assert not agent.bits.requires_grad and agent.body[0].weight.requires_grad
