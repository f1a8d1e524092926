"""One hash over all that makes an agent behave as it does."""

from __future__ import annotations

import copy
import importlib
import linecache
import sys
from collections import OrderedDict
from types import SimpleNamespace

import pytest
import torch
from torch import nn

from mitigate.agents.text import WORDS
from mitigate.agents.topological import TopologicalAgent
from mitigate.core import seeding
from mitigate.core.held import in_eval_mode
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
        (folder / "own_agent.py").write_text(source + "#" * 9 * number)  # of other lengths
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


NOTEBOOK = """
from functools import partial
from torch import nn

net = nn.Sequential(nn.Dropout(0.5), nn.Linear(1, 1, bias=False))
nn.init.constant_(net[1].weight, {weight})
LIMIT = {limit}

def choose(frame):
    return {answer}

def later(frame, steps):
    return steps

class Named:
    def reset(self, instruction):
        self.steps = 0

    @property
    def near(self):
        return LIMIT

    def act(self, observation):
        return [self.head(frame) for frame in observation] and choose(observation)

    def head(self, frame):
        return net(frame)

class Given:
    def __init__(self, decide):
        self.decide = decide

    def reset(self, instruction):
        pass

made = {{
    "named": Named(),
    "a partial call": Given(partial(later, steps={limit})),
    "a closure": (lambda steps: Given(lambda frame: steps))({limit}),
    "a bound method": Given(Named().act),
    "a function": Given(choose),
}}
"""
USUAL = {"weight": 1.0, "limit": 3, "answer": 0}


def _notebook(tmp_path, name, **changes):
    (tmp_path / f"{name}.py").write_text(NOTEBOOK.format(**{**USUAL, **changes}))
    module = importlib.import_module(name)
    for kind in (module.Named, module.Given):  # its own name is the file's: make them alike
        kind.__module__ = "notebook"
    return module


@pytest.mark.parametrize(
    ("place", "change"),
    [
        ("named", {"weight": 2.0}),
        ("named", {"limit": 4}),
        ("named", {"answer": 1}),
        ("a partial call", {"limit": 4}),
        ("a closure", {"limit": 4}),
        ("a bound method", {"weight": 2.0}),
        ("a bound method", {"answer": 1}),
        ("a function", {"answer": 1}),
    ],
)
def test_what_the_code_of_an_agent_names_is_part_of_it(tmp_path, monkeypatch, place, change):
    monkeypatch.syspath_prepend(tmp_path)
    number = len([*sys.modules])
    first, again, other = (
        identity(_notebook(tmp_path, f"notebook_{number}_{i}", **options).made[place], {})
        for i, options in enumerate(({}, {}, change))
    )
    assert first == again != other


def test_what_it_does_in_an_episode_makes_no_other_agent(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    agent = _notebook(tmp_path, "notebook_walked").made["named"]
    before = identity(agent, {})
    agent.reset("go")
    assert identity(agent, {}) == before


def test_a_network_that_its_code_names_is_in_eval_mode(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    module = _notebook(tmp_path, "notebook_modes")
    with in_eval_mode(module.made["named"]):
        assert not module.net[0].training
    assert module.net[0].training
