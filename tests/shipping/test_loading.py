"""Tests that one function loads an agent from any folder and infers the kind of agent."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
import torch
import yaml

import mitigate
from mitigate.agents.building import agent_option, stored_settings
from mitigate.core import checkpoint, conf
from mitigate.evaluation import evaluate
from mitigate.guards.text.guard import open_safeguard
from mitigate.worlds.apartments import simulator

ROOT = Path(__file__).parents[2]
SHIPPED = {
    "checkpoints/base": "TopologicalAgent",
    "checkpoints/hardened/conv_adapter": "TopologicalAgent",
    "checkpoints/recurrent/base": "RecurrentAgent",
    "checkpoints/recurrent_rgb/base/model.safetensors": "RecurrentAgent",
    "checkpoints/frontier/base": "FrontierAgent",
}


@pytest.mark.parametrize("folder", SHIPPED)
def test_own_agent_loads_from_its_folder_only(folder, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # found in the project
    state = torch.random.get_rng_state()
    agent = mitigate.load(folder)
    assert type(agent).__name__ == SHIPPED[folder] and not agent.training
    assert torch.equal(state, torch.random.get_rng_state())
    agent.reset("walk past the red sofa")


def test_shipped_folders_are_found_from_anywhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    mitigate.load_hardened("checkpoints/hardened/harden")
    assert open_safeguard("checkpoints/safeguard_classifier").canonicalise("Turn left.").text


def test_load_rejects_weights_that_the_manifest_does_not_list(tmp_path):
    folder = Path(shutil.copytree(ROOT / "checkpoints/recurrent_rgb/base", tmp_path / "base"))
    manifest = json.loads((folder / "manifest.json").read_text())
    (folder / "manifest.json").write_text(json.dumps({**manifest, "files": {}}))
    with pytest.raises(ValueError, match=r"model\.safetensors is not listed in manifest\.json"):
        mitigate.load(folder)


def test_load_suggests_the_nearest_shipped_weights():
    with pytest.raises(FileNotFoundError, match="Did you mean checkpoints/hardened/harden?"):
        mitigate.load("checkpoints/harden")
    with pytest.raises(FileNotFoundError, match="but in its folders conv_adapter, harden,"):
        mitigate.load("checkpoints/hardened")


def test_load_rejects_unnamed_or_different_agent(tmp_path):
    with pytest.raises(FileNotFoundError, match="There are no weights at"):
        mitigate.load(tmp_path)
    checkpoint.save_weights(torch.nn.Linear(2, 2), tmp_path)
    with pytest.raises(FileNotFoundError, match=r"config\.yaml is missing"):
        mitigate.load(tmp_path)
    (tmp_path / "config.yaml").write_text(yaml.safe_dump({"agent": {"_target_": "os.system"}}))
    with pytest.raises(ValueError, match=r"belongs to the agent os\.system"):
        mitigate.load(tmp_path)
    with pytest.raises(TypeError, match="NoneType"):
        mitigate.load(None)


def test_changed_hardened_folder_is_rejected(tmp_path):
    folder = Path(shutil.copytree(ROOT / "checkpoints/hardened/stacked", tmp_path / "stacked"))
    with open(folder / "model.safetensors", "ab") as file:
        file.write(b"x")
    with pytest.raises(ValueError, match="does not have the sha256"):
        mitigate.load(folder)


def test_evaluate_rejects_changed_settings(tmp_path):
    folder = Path(shutil.copytree(ROOT / "checkpoints/base", tmp_path / "base"))
    node = conf.composed("evaluate", []).agent
    assert stored_settings(node, str(folder))
    with open(folder / "config.yaml", "a") as file:
        file.write("# another\n")
    with pytest.raises(ValueError, match=r"config\.yaml does not have the sha256"):
        stored_settings(node, str(folder))


def test_options_take_the_agent_kind_of_the_weights():
    assert agent_option([], "checkpoints/recurrent_rgb/base") == ["agent=recurrent"]
    assert agent_option(["split=val_seen"], "checkpoints/frontier/base") == ["agent=frontier"]
    assert agent_option(["agent=frontier"], "checkpoints/recurrent/base") == []
    for usual in ("checkpoints/base", "checkpoints/topological_imagenet/base", "runs/nothing"):
        assert agent_option([], usual) == []


def test_evaluate_takes_world_needs_from_the_checkpoint(monkeypatch):
    seen = []
    monkeypatch.setattr(evaluate, "run", lambda cfg, options: seen.append((cfg, options)))
    monkeypatch.chdir(ROOT)
    for words in (["checkpoint=checkpoints/frontier/base"], ["checkpoint=checkpoints/base"]):
        monkeypatch.setattr("sys.argv", ["evaluate", *words])
        evaluate.main()
    (matches, options), (usual, _) = seen
    assert matches == conf.load_config("evaluate", ["agent=frontier", *options])
    assert matches.split == "val_unseen_ogn" and matches.env.views == 1
    assert usual.split == "val_unseen"


@pytest.mark.slow
def test_benchmark_takes_the_kind_of_agent_from_the_weights(tmp_path, monkeypatch):
    monkeypatch.setattr(simulator, "MAX_STEPS", 40)
    entry = mitigate.benchmark(
        "checkpoints/frontier/base", episodes=1, suite=["spatter"], out=tmp_path
    )
    assert entry.split == "val_unseen_ogn"
