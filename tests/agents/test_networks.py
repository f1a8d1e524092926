"""Tests that an agent's networks are found wherever it stores them, and that their modes are
kept."""

from __future__ import annotations

from functools import partial
from types import SimpleNamespace

import pytest
import torch
from torch import nn

from mitigate.agents import networks
from mitigate.agents.fingerprint import fingerprint
from mitigate.agents.networks import in_eval_mode


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
    "a default": lambda thing: SimpleNamespace(decide=lambda x, net=thing: net(x)),
    "a layer": lambda thing: nn.Sequential(SimpleLayer(thing)),
    "beside many": lambda thing: SimpleNamespace(
        seen=[(n,) for n in range(20_000)], pol=[{"p": thing}]
    ),
}


class SimpleLayer(nn.Module):
    def __init__(self, thing: nn.Module) -> None:
        super().__init__()
        self.further = [thing]


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("settings", [True, False])
def test_fingerprint_changes_with_weights_anywhere(place, settings):
    agents = [PLACES[place](net(weight)) for weight in (1, 1, 2)]
    for one in agents if settings else ():
        one.settings = dict
    first, again, other = (fingerprint(one, {}) for one in agents)
    assert first == again != other


def test_networks_follow_cycles_and_stop_at_a_limit(monkeypatch):
    agent = SimpleNamespace(itself=None, session=iter(()), deep=SimpleNamespace())
    agent.itself = agent
    place = agent.deep
    for _ in range(2000):
        place.deep = SimpleNamespace()
        place = place.deep
    place.net = net()
    assert [*networks.networks(agent).values()] == [place.net]
    monkeypatch.setattr(networks, "MOST_VALUES", 1000)
    assert not networks.networks(agent)


def test_in_eval_mode_restores_every_mode():
    nested = nn.Sequential(nn.Dropout(), nn.BatchNorm1d(1))
    nested[1].eval()
    agent = SimpleNamespace(pol=SimpleNamespace(nets=[nested]))
    with pytest.raises(KeyError), in_eval_mode(agent):
        assert not any(module.training for module in nested.modules())
        raise KeyError
    assert [module.training for module in nested.modules()] == [True, True, False]


def test_in_eval_mode_accepts_frozen_programs():
    frozen = torch.jit.freeze(torch.jit.script(net().eval()))
    with in_eval_mode(SimpleNamespace(net=frozen)):
        assert fingerprint(SimpleNamespace(net=frozen), {})


class Merged(nn.Linear):
    """A layer that merges its weights only in eval mode, as LoRA does."""

    def train(self, mode: bool = True):
        self.merged = not mode
        return super().train(mode)


def test_in_eval_mode_calls_overridden_eval():
    agent = SimpleNamespace(net=Merged(1, 1))
    with in_eval_mode(agent):
        assert agent.net.merged
    assert not agent.net.merged and agent.net.training
