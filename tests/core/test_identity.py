"""One hash over all that makes an agent behave as it does."""

from __future__ import annotations

import copy
import importlib
import linecache
import sys
from collections import OrderedDict
from types import SimpleNamespace

import torch
from torch import nn

from mitigate.agents.text import WORDS
from mitigate.agents.topological import TopologicalAgent
from mitigate.core import seeding
from mitigate.core.identity import identity, source_of
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


PLAIN = """
class Plain:
    def reset(self, instruction):
        self.steps = 0

    def act(self, observation):
        return 0
"""


def test_an_agent_without_settings_is_another_one_when_its_code_is(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    edited = PLAIN.replace("steps = 0", "steps = 1")
    first, other, again = _hashes(tmp_path, "Plain", (PLAIN, edited, PLAIN))
    assert first == again != other


def _hashes(folder, agent, sources):
    """The hash of the class ``agent`` in one module whose source is one after the other."""
    found = []
    for number, source in enumerate(sources):
        (folder / "own_agent.py").write_text(source + "#" * number)  # of other lengths
        sys.modules.pop("own_agent", None)
        importlib.invalidate_caches()
        linecache.clearcache()
        found.append(identity(getattr(importlib.import_module("own_agent"), agent)(), {}))
    sys.modules.pop("own_agent")
    return found


def test_an_agent_is_what_was_loaded_whatever_becomes_of_its_file(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    file = tmp_path / "edited_agent.py"
    file.write_text(PLAIN)
    agent = importlib.import_module("edited_agent").Plain()
    before = identity(agent, {})
    file.write_text(PLAIN.replace("steps = 0", "steps = 1"))
    linecache.clearcache()
    assert identity(agent, {}) == before
    sys.modules.pop("edited_agent")


NETWORK = """
from torch import nn

class Head(nn.Linear):
    def forward(self, x):
        return super().forward(x)

class Agent(nn.Module):
    settings = dict

    def __init__(self):
        super().__init__()
        self.head = Head(1, 1)
        nn.init.ones_(self.head.weight)
        nn.init.ones_(self.head.bias)
"""


def test_the_code_of_installed_packages_does_not_count(tmp_path, monkeypatch):
    folder = tmp_path / "site-packages"
    folder.mkdir()
    monkeypatch.syspath_prepend(folder)
    (folder / "installed_agent.py").write_text(PLAIN)
    assert source_of(importlib.import_module("installed_agent").Plain) == []
    assert source_of(nn.Linear) == source_of(OrderedDict) == source_of(TopologicalAgent) == []
    assert source_of(Here)
    sys.modules.pop("installed_agent")


def test_a_set_of_networks_has_no_order():
    class Placed(nn.Linear):
        def __init__(self, place: int) -> None:
            super().__init__(1, 1)
            self.place = place
            nn.init.constant_(self.weight, place)
            nn.init.zeros_(self.bias)

        def __hash__(self):
            return self.place % 7

    def both(first: int, second: int) -> SimpleNamespace:
        return SimpleNamespace(nets={Placed(first), Placed(second)})

    assert [net.place for net in both(1, 8).nets] != [net.place for net in both(8, 1).nets]
    assert identity(both(1, 8), {}) == identity(both(8, 1), {}) != identity(both(1, 15), {})


class Here:
    """A class of no package."""


def test_the_code_of_an_agents_networks_counts_also_where_it_has_settings(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    edited = NETWORK.replace("return ", "return -")
    first, other, again = _hashes(tmp_path, "Agent", (NETWORK, edited, NETWORK))
    assert first == again != other
