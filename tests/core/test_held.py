"""What an agent holds is found wherever it is."""

from __future__ import annotations

import datetime
import operator
import re
import threading
from collections.abc import Mapping
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
    "a getter": lambda thing: SimpleNamespace(decide=operator.methodcaller("at", thing)),
    "a default": lambda thing: SimpleNamespace(decide=lambda x, net=thing: net(x)),
    "beside many": lambda thing: SimpleNamespace(
        seen=[(n,) for n in range(20_000)], pol=[{"p": thing}]
    ),
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


def test_of_what_is_large_the_rest_is_unknown_and_a_mapping_is_not_loaded():
    class Lazy(Mapping):
        def __getitem__(self, key):
            raise AssertionError("loaded")

        def __iter__(self):
            return iter(range(3))

        def __len__(self):
            return 3

    assert held(SimpleNamespace(seen=[(n,) for n in range(2000)])).unknown == ["seen"]
    assert held(SimpleNamespace(words=[str(n) for n in range(2000)], data=Lazy())).unknown == []


def test_things_of_pythons_own_library_hold_no_weights():
    things = (re.compile("a"), range(3), threading.Lock(), datetime.datetime(2020, 1, 1))
    assert held(SimpleNamespace(things=things, first=operator.itemgetter(0))).unknown == []


class Anything:
    def __getattr__(self, name):
        return lambda *given: None


def test_what_cannot_be_hashed_is_unknown():
    sparse, mixed = torch.eye(2).to_sparse(), np.array([object()])
    agent = SimpleNamespace(remote=Anything(), sparse=sparse, mixed=mixed)
    assert held(agent).unknown == ["sparse", "mixed"] and identity(agent, {})
    frozen = torch.jit.freeze(torch.jit.script(net().eval()))
    with in_eval_mode(SimpleNamespace(net=frozen)):
        assert identity(SimpleNamespace(net=frozen), {})


class Merged(nn.Linear):
    """Merged in eval mode alone, as LoRA is."""

    def train(self, mode: bool = True):
        self.merged = not mode
        return super().train(mode)


def test_a_network_does_what_it_does_when_its_mode_changes():
    agent = SimpleNamespace(net=Merged(1, 1))
    with in_eval_mode(agent):
        assert agent.net.merged
    assert not agent.net.merged and agent.net.training
