"""What an agent holds is found wherever it is."""

from __future__ import annotations

from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest
import torch
from torch import nn

from mitigate.core.held import DEPTH, held, in_eval_mode
from mitigate.core.identity import identity


def net(weight: float = 1.0) -> nn.Linear:
    made = nn.Linear(1, 1)
    nn.init.constant_(made.weight, weight)
    nn.init.zeros_(made.bias)
    return made


PLACES = {
    "an attribute": lambda thing: SimpleNamespace(net=thing),
    "a mapping": lambda thing: SimpleNamespace(nets={"policy": thing}),
    "a list": lambda thing: SimpleNamespace(nets=[thing]),
    "an object": lambda thing: SimpleNamespace(pol=SimpleNamespace(net=thing)),
    "a function": lambda thing: SimpleNamespace(decide=lambda x: thing(x)),
    "a partial": lambda thing: SimpleNamespace(decide=partial(max, thing)),
}


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize(
    "kinds", [(net(1), net(2)), (np.zeros(3), np.ones(3)), (torch.zeros(3), torch.ones(3))]
)
def test_other_weights_are_another_agent_wherever_they_are(place, kinds):
    first, other = (PLACES[place](thing) for thing in kinds)
    assert identity(first, {}) == identity(PLACES[place](kinds[0]), {}) != identity(other, {})


def test_a_list_of_networks_in_a_network_counts():
    def agent(weight: float) -> nn.Module:
        made = net()
        made.further = [net(weight)]
        return made

    assert identity(agent(1), {}) == identity(agent(1), {}) != identity(agent(2), {})


def test_arrays_beside_networks_are_memory_and_no_weights():
    first = SimpleNamespace(net=net(), hidden=torch.zeros(2))
    later = SimpleNamespace(net=net(), hidden=torch.ones(2))
    assert identity(first, {}) == identity(later, {})


def test_circles_end_and_what_cannot_be_looked_into_is_named():
    agent = SimpleNamespace(itself=None, lock=iter(()), deep=SimpleNamespace())
    agent.itself, place = agent, agent.deep
    for _ in range(DEPTH + 1):
        place.deep = SimpleNamespace()
        place = place.deep
    found = held(agent)
    assert found.unknown == ["lock", ".".join(["deep"] * DEPTH)]
    assert held(SimpleNamespace(steps=1, words=["a"], where={"x": 1.5})).unknown == []


def test_every_module_is_in_eval_mode_and_as_it_was_afterwards():
    nested = nn.Sequential(nn.Dropout(), nn.BatchNorm1d(1))
    nested[1].eval()
    agent = SimpleNamespace(pol=SimpleNamespace(nets=[nested]))
    with pytest.raises(KeyError), in_eval_mode(agent):
        assert not any(module.training for module in nested.modules())
        raise KeyError
    assert [module.training for module in nested.modules()] == [True, True, False]
