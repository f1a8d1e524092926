"""Tests of reading the state of agents: networks, arrays and values at any place."""

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

from mitigate.agents.fingerprint import fingerprint
from mitigate.agents.networks import in_eval_mode
from mitigate.agents.state import read_state


def net(weight: float = 1.0) -> nn.Linear:
    model = nn.Linear(1, 1)
    nn.init.constant_(model.weight, weight)
    nn.init.zeros_(model.bias)
    return model


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
def test_fingerprint_changes_with_weights_anywhere(place, kinds):
    first, other = (PLACES[place](thing) for thing in kinds)
    assert (
        fingerprint(first, {}) == fingerprint(PLACES[place](kinds[0]), {}) != fingerprint(other, {})
    )


def test_fingerprint_counts_lists_of_networks():
    def agent(weight: float) -> nn.Module:
        model = net()
        model.further = [net(weight)]
        return model

    assert fingerprint(agent(1), {}) == fingerprint(agent(1), {}) != fingerprint(agent(2), {})


def test_fingerprint_counts_arrays_without_settings():
    first = SimpleNamespace(net=net(), mean=torch.zeros(2))
    other = SimpleNamespace(net=net(), mean=torch.ones(2))
    assert fingerprint(first, {}) != fingerprint(other, {})
    first.settings = other.settings = {"size": 2}
    assert fingerprint(first, {}) == fingerprint(other, {})


def test_read_state_follows_cycles_and_reports_unreadable_values():
    agent = SimpleNamespace(itself=None, session=iter(()), deep=SimpleNamespace())
    agent.itself = agent
    place = agent.deep
    for _ in range(2000):
        place.deep = SimpleNamespace()
        place = place.deep
    place.net = net()
    state = read_state(agent)
    assert [*state.unreadable] == ["session"] and len(state.networks) == 1
    assert not read_state(SimpleNamespace(steps=1, words=["a"], where={"x": 1.5})).unreadable
    assert not read_state(agent, attributes=False).unreadable


def test_in_eval_mode_restores_every_mode():
    nested = nn.Sequential(nn.Dropout(), nn.BatchNorm1d(1))
    nested[1].eval()
    agent = SimpleNamespace(pol=SimpleNamespace(nets=[nested]))
    with pytest.raises(KeyError), in_eval_mode(agent):
        assert not any(module.training for module in nested.modules())
        raise KeyError
    assert [module.training for module in nested.modules()] == [True, True, False]


def test_read_state_limits_values_and_loads_no_lazy_mapping(monkeypatch):
    class Lazy(Mapping):
        def __getitem__(self, key):
            raise AssertionError("loaded")

        def __iter__(self):
            return iter(range(3))

        def __len__(self):
            return 3

    monkeypatch.setattr("mitigate.agents.state.MOST_VALUES", 1000)
    many = [[object()] for n in range(2000)]
    assert "more than 1,000 values" in read_state(SimpleNamespace(seen=many)).unreadable[""]
    words = [str(n) for n in range(2000)]
    assert not read_state(SimpleNamespace(words=words, data=Lazy())).unreadable


def test_read_state_accepts_standard_library_objects():
    things = (re.compile("a"), range(3), threading.Lock(), datetime.datetime(2020, 1, 1))
    assert not read_state(SimpleNamespace(things=things, first=operator.itemgetter(0))).unreadable


class Anything:
    def __getattr__(self, name):
        return lambda *arguments: None


def test_read_state_reports_unreadable_values():
    sparse, mixed = torch.eye(2).to_sparse(), np.array([object()])
    agent = SimpleNamespace(remote=Anything(), sparse=sparse, mixed=mixed)
    assert [*read_state(agent).unreadable] == ["sparse", "mixed"] and fingerprint(agent, {})
    frozen = torch.jit.freeze(torch.jit.script(net().eval()))
    with in_eval_mode(SimpleNamespace(net=frozen)):
        assert fingerprint(SimpleNamespace(net=frozen), {})


class Merged(nn.Linear):
    """A layer that merges its weights only in eval mode, like LoRA layers."""

    def train(self, mode: bool = True):
        self.merged = not mode
        return super().train(mode)


def test_in_eval_mode_calls_overridden_eval():
    agent = SimpleNamespace(net=Merged(1, 1))
    with in_eval_mode(agent):
        assert agent.net.merged
    assert not agent.net.merged and agent.net.training
