"""Tests of agents' fingerprints, which are hashes of everything that determines behaviour."""

from __future__ import annotations

import copy
import importlib
import os
import shutil
import subprocess
import sys
import types

import pytest
import torch
from torch import nn
from torch.nn.utils.parametrizations import weight_norm

from mitigate.agents.adapters import insert_adapters
from mitigate.agents.fingerprint import code_of, contents, fingerprint
from mitigate.agents.frontier import FrontierAgent
from mitigate.agents.networks import in_eval_mode
from mitigate.agents.recurrent import RecurrentAgent
from mitigate.agents.text import WORDS
from mitigate.agents.topological import TopologicalAgent
from mitigate.core import conf, seeding
from mitigate.core.build import maker
from mitigate.core.observation import STOP, cameras
from mitigate.evaluation.episode_lists import episodes

SMALL = {"heads": 2, "text_layers": 1, "layers": 1}


def agent(**settings) -> TopologicalAgent:
    seeding.seed_everything(0, "identity")
    return TopologicalAgent(16, **{"planner": SMALL, **settings})


def test_fingerprint_changes_with_every_difference():
    plain, views = agent(), cameras(64)
    moved = copy.deepcopy(plain)
    with torch.no_grad():
        next(moved.parameters()).view(-1)[0] += 1e-3
    others = [
        fingerprint(moved, views),
        fingerprint(agent(blind=["rgb"]), views),
        fingerprint(agent(size=32), views),
        fingerprint(agent(planner={**SMALL, "fusion": {"rate": 4, "cap": 3}}), views),
        # the same words with different ids
        fingerprint(agent(vocabulary=[*WORDS[1:], WORDS[0]]), views),
        fingerprint(plain, cameras(32)),
        fingerprint(plain, views, "rules"),
    ]
    assert fingerprint(plain, views) == fingerprint(agent(), views)
    assert len({fingerprint(plain, views), *others}) == 1 + len(others)


PLAIN = """
class Plain:
    def reset(self, instruction):
        self.steps = 0

    def act(self, observation):
        return 0
"""


def test_fingerprint_changes_with_code_without_settings(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    edited = PLAIN.replace("steps = 0", "steps = 1")
    commented = PLAIN.replace("    def act", "    # a comment\n\n    def act")
    first, other, again = _hashes(tmp_path, "Plain", (PLAIN, edited, commented))
    assert first == again != other


def _hashes(folder, agent, sources):
    """Return the fingerprints of the class ``agent``, one per source text of its module."""
    matches = []
    for source in sources:
        (folder / "own_agent.py").write_text(source)
        sys.modules.pop("own_agent", None)
        shutil.rmtree(folder / "__pycache__", ignore_errors=True)
        importlib.invalidate_caches()
        matches.append(fingerprint(getattr(importlib.import_module("own_agent"), agent)(), {}))
    sys.modules.pop("own_agent")
    return matches


def test_fingerprint_ignores_later_edits_of_the_file(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    file = tmp_path / "edited_agent.py"
    file.write_text(PLAIN)
    agent = importlib.import_module("edited_agent").Plain()
    before = fingerprint(agent, {})
    file.write_text(PLAIN.replace("steps = 0", "steps = 1"))
    assert fingerprint(agent, {}) == before
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


def test_fingerprint_ignores_code_of_installed_packages(tmp_path, monkeypatch):
    folder = tmp_path / "site-packages"
    folder.mkdir()
    monkeypatch.syspath_prepend(folder)
    (folder / "installed_agent.py").write_text(PLAIN)
    for kind in (importlib.import_module("installed_agent").Plain, nn.Linear, TopologicalAgent):
        assert not code_of(kind).parts and not code_of(kind).unreadable
    assert code_of(Here).parts["code"]
    sys.modules.pop("installed_agent")


class Here:
    """A class whose module belongs to no package."""


def test_fingerprint_counts_code_of_networks(tmp_path, monkeypatch):
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
    return importlib.import_module(name)


@pytest.mark.parametrize(
    ("place", "change"),
    [
        ("named", {"weight": 2.0}),
        ("named", {"limit": 4}),
        ("named", {"answer": 1}),
        ("a partial call", {"limit": 4}),
        ("a closure", {"limit": 4}),
        ("a bound method", {"weight": 2.0}),
        ("a function", {"answer": 1}),
    ],
)
def test_fingerprint_counts_objects_that_code_names(tmp_path, monkeypatch, place, change):
    monkeypatch.syspath_prepend(tmp_path)
    number = len([*sys.modules])
    names = [f"notebook_{number}_{i}" for i in range(3)]
    agents = [
        _notebook(tmp_path, name, **options).made[place]
        for name, options in zip(names, ({}, {}, change), strict=True)
    ]
    unreadable = {bool(contents(one).unreadable) for one in agents}
    readable = place in ("named", "a closure", "a function")
    assert unreadable == {not readable}
    if readable:
        first, again, other = (fingerprint(one, {}) for one in agents)
        assert first == again != other


def test_fingerprint_counts_modules_that_the_file_imports(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    agent = "def act():\n    from own_helper import decide\n    return decide()\n"
    agent = f"import own_settings\n\nclass Agent:\n    settings = dict\n\n{agent}"
    hashes = []
    for action, level in ((0, 0), (0, 0), (1, 0), (0, 1)):
        (tmp_path / "own_helper.py").write_text(f"def decide():\n    return {action}\n")
        (tmp_path / "own_settings.py").write_text(f"LEVEL = {level}\n")
        hashes += _hashes(tmp_path, "Agent", [agent])
        for name in ("own_helper", "own_settings"):
            sys.modules.pop(name, None)
    assert hashes[0] == hashes[1] and len({*hashes}) == 3


def test_fingerprint_needs_a_version_without_a_source_file():
    scope = {"__name__": "__main__"}
    exec("class Agent:\n    settings = dict\n", scope)
    scope["Agent"].__module__ = "no_such_module"
    assert "without a source file" in contents(scope["Agent"]()).explain()


def test_fingerprint_ignores_attributes_of_an_agent_with_settings(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    agent = _notebook(tmp_path, "notebook_walked").made["named"]
    agent.settings = dict
    before = fingerprint(agent, {})
    agent.reset("go")
    assert fingerprint(agent, {}) == before


def test_in_eval_mode_reaches_networks_that_code_names(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    module = _notebook(tmp_path, "notebook_modes")
    with in_eval_mode(module.made["named"]):
        assert not module.net[0].training
    assert module.net[0].training


def forward(module, inputs, output):
    return -output


class Owner:
    """An agent without settings() that contains a network."""

    threshold = 0.5

    def __init__(self, net: nn.Module) -> None:
        self.net = net
        self.thresholds = {"stop": [0.1, (0.2, 0.3)]}
        self.prepare = torch.relu

    def reset(self, instruction):
        pass

    def act(self, observation):
        return int(self.net(torch.ones(1, 4)).sum() > self.threshold)


class Vouched(Owner):
    """The same with settings()."""

    settings = {"width": 4}


def owner(kind=Owner):
    seeding.seed_everything(0, "owner")
    layers = nn.Linear(4, 4), nn.ReLU(), nn.BatchNorm1d(4), nn.LeakyReLU(0.1), nn.Conv2d(4, 4, 1)
    output = kind(nn.Sequential(*layers))
    output.net.register_buffer("scratch", torch.zeros(2), persistent=False)
    return output.net.eval() and output


def _attached(agent):
    insert_adapters(agent.net, ["4"])


CHANGES = {
    "a weight": lambda agent: agent.net[0].weight.data.add_(1),
    "a buffer": lambda agent: agent.net[2].running_mean.add_(1),
    "a non-persistent buffer": lambda agent: agent.net.scratch.add_(1),
    "a dtype": lambda agent: agent.net.double(),
    "an activation": lambda agent: agent.net.__setitem__(1, nn.GELU()),
    "our adapters": _attached,
    "a parametrization": lambda agent: weight_norm(agent.net[0]),
    "data parallel": lambda agent: setattr(agent, "net", nn.DataParallel(agent.net)),
}
WITHOUT_SETTINGS = {
    "a threshold": lambda agent: setattr(agent, "threshold", 0.6),
    "a nested threshold": lambda agent: agent.thresholds["stop"].append(1),
    "an array": lambda agent: setattr(agent, "mean", torch.ones(2)),
    "preprocessing": lambda agent: setattr(agent, "prepare", torch.sigmoid),
    "a slope": lambda agent: setattr(agent.net[3], "negative_slope", 0.9),
}


@pytest.mark.parametrize("change", [*CHANGES, *WITHOUT_SETTINGS])
def test_fingerprint_changes_with_behaviour(change):
    before, after = owner(), owner()
    {**CHANGES, **WITHOUT_SETTINGS}[change](after)
    assert fingerprint(before, {}) == fingerprint(owner(), {}) != fingerprint(after, {})
    assert not contents(before).unreadable


@pytest.mark.parametrize("change", CHANGES)
def test_fingerprint_with_settings_changes_with_behaviour(change):
    before, after = owner(Vouched), owner(Vouched)
    CHANGES[change](after)
    assert fingerprint(before, {}) == fingerprint(owner(Vouched), {}) != fingerprint(after, {})


def test_fingerprint_changes_when_a_network_is_quantised():
    def quantised(weight: float) -> Owner:
        agent = owner()
        agent.net[0].weight.data.fill_(weight)
        agent.net = torch.ao.quantization.quantize_dynamic(agent.net, {nn.Linear})
        return agent

    hashes = [fingerprint(quantised(weight), {}) for weight in (1.0, 1.0, 2.0)]
    assert hashes[0] == hashes[1] != hashes[2]
    assert hashes[0] != fingerprint(owner(), {})


def test_fingerprint_ignores_train_and_eval_mode():
    trained = owner()
    trained.net.train()
    assert fingerprint(trained, {}) == fingerprint(owner(), {})


UNREADABLE = {
    "a forward hook": lambda agent: agent.net[0].register_forward_hook(forward),
    "a forward pre-hook": lambda agent: agent.net.register_forward_pre_hook(lambda m, value: value),
    "a replaced method": lambda agent: setattr(agent, "act", lambda observation: 0),
    "a replaced forward": lambda agent: setattr(agent.net[0], "forward", lambda x: x + 1),
    "TorchScript": lambda agent: setattr(agent, "net", torch.jit.script(agent.net)),
}


@pytest.mark.parametrize("kind", [Owner, Vouched])
@pytest.mark.parametrize("change", UNREADABLE)
def test_contents_reports_what_cannot_be_read(change, kind):
    agent = owner(kind)
    UNREADABLE[change](agent)
    assert contents(agent).unreadable and contents(agent).explain()
    assert not contents(agent, version="1").unreadable
    hashes = {fingerprint(agent, {}, version=version) for version in (None, "1", "2")}
    assert len(hashes) == 3


def test_contents_reports_global_hooks():
    handle = nn.modules.module.register_module_forward_hook(lambda *arguments: None)
    try:
        assert "registered for all modules" in contents(owner()).explain()
    finally:
        handle.remove()


def test_shipped_fingerprint_notices_hooks_and_replaced_methods(monkeypatch):
    hooked, replaced = agent(), agent()
    hooked.rgb_encoder.register_forward_hook(forward)
    replaced.act = lambda observation: 0
    assert contents(hooked).unreadable and contents(replaced).unreadable
    monkeypatch.setattr(TopologicalAgent, "act", lambda self, observation: 1)
    assert contents(agent()).unreadable


def test_fingerprint_reads_hooks_that_describe_themselves():
    class Scale:
        def __init__(self, by: float) -> None:
            self.by = by

        def __call__(self, module, inputs, output):
            return output * self.by

        def fingerprint(self):
            return {"by": self.by}

    agents = [owner(Vouched) for _ in range(3)]
    for one, by in zip(agents, (1.0, 1.0, 2.0), strict=True):
        one.net[0].register_forward_hook(Scale(by))
    hashes = [fingerprint(one, {}) for one in agents]
    assert hashes[0] == hashes[1] != hashes[2] and not contents(agents[0]).unreadable


def test_fingerprint_of_a_shipped_agent_does_not_depend_on_its_module(monkeypatch):
    before = fingerprint(agent(), {})
    monkeypatch.setattr(TopologicalAgent, "__module__", f"{TopologicalAgent.__module__}_moved")
    assert fingerprint(agent(), {}) == before


SHIPPED = {
    "topological": (TopologicalAgent, {"planner": SMALL}, "planner"),
    "recurrent": (RecurrentAgent, {}, "policy"),
    "frontier": (FrontierAgent, {}, "rgb_encoder"),
}


def shipped(kind: str) -> nn.Module:
    seeding.seed_everything(0, "shipped")
    output, settings, _ = SHIPPED[kind]
    return output(**settings)


def _other_activation(agent, part):
    agent.rgb_encoder.stem[2] = nn.GELU()


def _added_layer(agent, part):
    getattr(agent, part).further = nn.Identity()


def _changed_buffer(agent, part):
    module = getattr(agent, part)
    name, *_ = module._non_persistent_buffers_set
    module._buffers[name] = module._buffers[name] + 1


SHIPPED_CHANGES = {
    "an activation": _other_activation,
    "a layer": _added_layer,
    "a layer's attribute": lambda agent, part: setattr(agent.rgb_encoder, "size", 32),
    "an attribute": lambda agent, part: setattr(agent, "blind", ("rgb",)),
    "a default of its class": lambda agent, part: setattr(agent, "tasks", ("vln", "ogn")),
    "a non-persistent buffer": _changed_buffer,
}


@pytest.mark.parametrize("kind", SHIPPED)
@pytest.mark.parametrize("change", SHIPPED_CHANGES)
def test_shipped_fingerprint_notices_changed_attributes(kind, change):
    if (kind, change) == ("frontier", "a non-persistent buffer"):
        pytest.skip("it has none")
    before, changed = shipped(kind), shipped(kind)
    assert "changes" not in contents(before).parts
    SHIPPED_CHANGES[change](changed, SHIPPED[kind][2])
    assert fingerprint(before, {}) == fingerprint(shipped(kind), {}) != fingerprint(changed, {})


@pytest.mark.parametrize("kind", SHIPPED)
def test_shipped_fingerprint_is_stable_while_running(kind):
    cfg = conf.load_config("evaluate", [f"agent={kind}"])
    world = maker(cfg.env.world)()
    (episode,) = episodes(cfg.env, cfg.split, 1)
    agent = shipped(kind).eval()
    before = fingerprint(agent, {})
    random_state = torch.random.get_rng_state()
    with agent.remembering():
        observation = world.reset(episode)
        agent.reset(episode.instruction.text)
        for _ in range(20):
            action = agent.act(observation)
            if action == STOP:
                break
            observation = world.step(action)
        assert fingerprint(agent, {}) == before
    assert fingerprint(agent, {}) == before
    assert torch.equal(torch.random.get_rng_state(), random_state)


@pytest.mark.parametrize("target", ["rgb_encoder.stages.0", "rgb_encoder.stem"])
def test_contents_reads_adapters_completely(target):
    settings = {"adapters": {"target_modules": [target]}}
    new_agent = [agent(**settings) for _ in range(2)]
    assert not contents(new_agent[0]).unreadable
    assert (
        fingerprint(new_agent[0], {}) == fingerprint(new_agent[1], {}) != fingerprint(agent(), {})
    )
    users = [owner() for _ in range(2)]
    for one in users:
        seeding.seed_everything(0, "adapters")
        insert_adapters(one.net, ["4"])
    assert fingerprint(users[0], {}) == fingerprint(users[1], {})
    assert not contents(users[0]).unreadable


class Scale(nn.Module):
    """A layer defined by the user."""

    def __init__(self, by: int) -> None:
        super().__init__()
        self.by = by

    def forward(self, x):
        return x * self.by


class Own:
    """An agent that has only plain attributes."""

    def act(self, observation):
        return helpers.decide(observation) + helpers.LEVEL


class Described(Own):
    """An agent with settings()."""

    def settings(self):
        return {}


class Biased(Described):
    """An agent that inherits settings() and adds an attribute."""

    def __init__(self, bias: int) -> None:
        self.bias = bias


class BiasedPlanner(TopologicalAgent):
    """A shipped agent with an added attribute."""


class Wrapper:
    """Delegates undefined attributes."""

    def __init__(self, bias: int) -> None:
        self.agent, self.bias = Described(), bias

    def __getattr__(self, name):
        return getattr(self.__dict__["agent"], name)


def first(observation):
    return 0


def second(observation):
    return 1


helpers = types.ModuleType("helpers")
helpers.decide, helpers.LEVEL = first, 0


def _scaled(by):
    new_agent = agent()
    new_agent.rgb_encoder.stages.append(Scale(by))
    return new_agent


def _parametrized(by):
    new_agent = agent()
    nn.utils.parametrize.register_parametrization(
        new_agent.rgb_encoder.stem[0], "weight", Scale(by)
    )
    return new_agent


def _adapted(removed):
    new_agent = agent(adapters={"target_modules": ["rgb_encoder.stages.0"]})
    if removed:
        new_agent.rgb_encoder.stages[0].adapter.hook.remove()
    return new_agent


def _biased_planner(bias):
    model = BiasedPlanner(16, planner=SMALL)
    model.bias = bias
    return model


def _with(owner, name, value, output):
    """Return a function that patches an attribute of ``owner`` and then creates an agent."""

    def make(number, patch):
        patch.setattr(owner, name, value(number), raising=False)
        return output()

    return make


def _network(weight):
    model = nn.Linear(1, 1)
    nn.init.constant_(model.weight, weight)
    return nn.init.zeros_(model.bias) is not None and model


REPLACED = {
    "an added layer": lambda n, patch: _scaled(n),
    "a parametrization": lambda n, patch: seeding.seed_everything(0, "p") or _parametrized(n),
    "a removed hook": lambda n, patch: _adapted(n),
    "a subclass's attribute": lambda n, patch: Biased(n),
    "a shipped subclass's attribute": lambda n, patch: (
        seeding.seed_everything(0, "b") or _biased_planner(n)
    ),
    "a wrapper's attribute": lambda n, patch: Wrapper(n),
    "a number of its class": _with(Own, "threshold", int, Own),
    "a mapping of its class": _with(Own, "table", lambda n: {"a": [n]}, Own),
    "an array of its class": _with(Own, "mean", lambda n: torch.full((2,), float(n)), Own),
    "a network of its class": _with(Own, "net", _network, Own),
    "a method of its class": _with(Own, "act", lambda n: (first, second)[n], Own),
    "a value of a module": _with(helpers, "LEVEL", int, Described),
}


@pytest.mark.parametrize("what", REPLACED)
def test_fingerprint_changes_with_replaced_code_and_data(what, monkeypatch):
    hashes, unreadable = [], []
    for number in (0, 0, 1):
        output = REPLACED[what](number, monkeypatch)
        hashes.append(fingerprint(output, {}))
        unreadable.append(bool(contents(output).unreadable))
    assert hashes[0] == hashes[1] and (hashes[0] != hashes[2] or all(unreadable))


def test_code_of_reads_packages_and_skips_what_is_not_python(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    package = tmp_path / "own_package"
    package.mkdir()
    (package / "__init__.py").write_text("")
    (package / "agent.py").write_text("from . import parts\n\nclass Agent:\n    pass\n")
    (package / "parts.py").write_text("LEVEL = 1\n")
    content = code_of(importlib.import_module("own_package.agent").Agent)
    assert not content.unreadable and "LEVEL = 1" in content.parts["code"]
    sys.modules["own_package.agent"].Agent.__module__ = "own_binary"
    (tmp_path / "own_binary.so").write_bytes(b"\x7fELF\x00")
    binary = types.ModuleType("own_binary")
    binary.__file__ = str(tmp_path / "own_binary.so")
    monkeypatch.setitem(sys.modules, "own_binary", binary)
    assert code_of(sys.modules["own_package.agent"].Agent).unreadable
    for name in ("own_package.agent", "own_package.parts", "own_package"):
        sys.modules.pop(name)


@pytest.mark.slow
def test_fingerprint_does_not_depend_on_the_hash_seed():
    program = (
        "from mitigate.agents.fingerprint import code_of\n"
        "from tests.evaluation.straight import Straight\n"
        "print(list(code_of(Straight).parts['names']))"
    )
    orders = {
        subprocess.run(
            [sys.executable, "-c", program],
            env={**os.environ, "PYTHONHASHSEED": str(seed)},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in range(3)
    }
    assert orders == {"['Straight.() FORWARD', 'Straight.() STOP']\n"}
