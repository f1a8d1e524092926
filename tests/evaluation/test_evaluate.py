"""Tests of ``mitigate evaluate`` that run no long episodes."""

from __future__ import annotations

import pytest
import torch
from safetensors.torch import save_file
from torch import nn

from mitigate.core import conf
from mitigate.evaluation import evaluate, rows
from mitigate.evaluation.config import default_folder
from mitigate.evaluation.page import command
from tests.evaluation.made_rows import cell
from tests.evaluation.straight import Straight


def test_evaluate_prints_the_requested_rows(tmp_path, capsys):
    """The file has rows of three episodes, and two of them are requested."""

    all_rows = cell(2, 3)
    rows.write(tmp_path / "rows.jsonl", all_rows)
    evaluate.write_table([tmp_path / "rows.jsonl"], tmp_path, all_rows[:2])
    printed = capsys.readouterr().out
    assert "N = 2 episodes" in printed and "N = 3" not in printed
    assert f"{tmp_path} holds 1 other row, too; {tmp_path / 'table.md'} includes them." in printed
    assert "N = 3 episodes" in (tmp_path / "table.md").read_text()
    evaluate.write_table([tmp_path / "rows.jsonl"], tmp_path, all_rows)
    printed = capsys.readouterr().out
    assert "N = 3 episodes" in printed and "other row" not in printed


def test_evaluate_checks_the_safeguard_before_writing(tmp_path):
    cfg = conf.load_config("evaluate", ["safeguard=rule", f"runs={tmp_path}"])
    with pytest.raises(ValueError, match="no safeguard 'rule'"):
        evaluate.run(cfg)
    assert not list(tmp_path.iterdir())


def test_default_folder_depends_on_depth_severity_and_world():
    folders = [
        default_folder(conf.load_config("evaluate", options), "mine")
        for options in ([], ["severity_depth=0.9"], ["severity_depth=0.6"], ["env.name=maze"])
    ]
    ends = ["val_unseen-s0.6", "val_unseen-s0.6-d0.9", "val_unseen-s0.6-d0.6"]
    assert folders == [f"runs/evaluate/mine-{end}" for end in (*ends, "maze-val_unseen-s0.6")]


@pytest.mark.parametrize("option", ["finetune.lr=9", "++cost.evaluation=4"])
def test_evaluate_rejects_options_of_trainings(tmp_path, option):
    cfg = conf.load_config("evaluate", [option, f"runs={tmp_path}"])
    with pytest.raises(ValueError, match="is a training option"):
        evaluate.run(cfg, [option])
    assert not list(tmp_path.iterdir())


@pytest.fixture
def policies(tmp_path):
    """Return a function that makes a config for the user's agent class ``target``."""

    def options(target, *more, settings=""):
        folder = tmp_path / "mine" / "agent"
        folder.mkdir(parents=True, exist_ok=True)
        agent = f"# @package _global_\nagent: {{_target_: {target}{settings}}}\n"
        (folder / "own.yaml").write_text(agent)
        of = [f"--config-dir={tmp_path / 'mine'}", "agent=own", f"runs={tmp_path / 'runs'}"]
        small = ["env.size=16", "episodes=1", "conditions=[clean,flare]", "workers=1"]
        return conf.load_config("evaluate", [*of, *small, *more])

    return options


def test_evaluate_accepts_an_agent_without_weights(policies, tmp_path):
    straight = "tests.evaluation.straight.Straight"
    cfg = policies(straight, "restore=checkpoints/restorer:rgb", settings=", steps: 2")
    records = rows.read(evaluate.run(cfg) / "rows.jsonl")
    assert {row["name"] for row in records} == {"Straight+restorer-rgb"} and len(records) == 2
    weights = tmp_path / "w.safetensors"
    save_file({"w": torch.zeros(1)}, weights)
    with pytest.raises(ValueError, match=r"Straight is not a torch.nn.Module.*Leave out .*w.safe"):
        evaluate.run(policies(straight, f"checkpoint={weights}", settings=", steps: 2"))


@pytest.mark.slow
def test_walks_of_an_agent_without_weights_are_drawn(policies, tmp_path):
    records = evaluate.run(policies("tests.evaluation.straight.Straight", settings=", steps: 2"))
    arguments = [str(records / "rows.jsonl"), "--config-dir", str(tmp_path / "mine"), "agent=own"]
    arguments += ["env.size=16", "--walks", "1", "--out", str(tmp_path / "report.html"), "--walk"]
    assert command.main([*arguments, "Straight="]) == 0
    with pytest.raises(ValueError, match="checkpoint is not set"):
        evaluate.load(conf.load_config("evaluate").agent, None)


class Slots:
    """An agent that accepts no new attributes."""

    __slots__ = ()

    def reset(self, instruction):
        pass

    def act(self, observation):
        return 0


def test_load_requires_settings_of_the_agent(policies):
    with pytest.raises(ValueError, match=r"Slots accepts no attribute .settings. .* settings\(\)"):
        evaluate.run(policies(f"{__name__}.Slots"))


def remote() -> Straight:
    return Straight(1)


def make_network() -> nn.Module:
    """A function that returns a network; a config may name it instead of a class."""
    return Net()


class Net(nn.Linear):
    """A policy that was trained outside this project."""

    def __init__(self) -> None:
        super().__init__(1, 4)

    def reset(self, instruction):
        pass

    def act(self, observation):
        return int(self.bias.argmax())


@pytest.mark.slow
def test_load_accepts_foreign_safetensors(policies, tmp_path):
    net = Net()
    nn.init.constant_(net.bias, 0.0)
    net.bias.data[0] = 9.0
    save_file(net.state_dict(), tmp_path / "w.safetensors")
    cfg = policies(f"{__name__}.Net", f"checkpoint={tmp_path / 'w.safetensors'}")
    records = rows.read(evaluate.run(cfg) / "rows.jsonl")
    assert [(row["name"], row["steps"]) for row in records] == [("w", 1), ("w", 1)]
    by_function = policies(
        f"{__name__}.make_network", f"checkpoint={tmp_path / 'w.safetensors'}", "name=f"
    )
    assert len(rows.read(evaluate.run(by_function) / "rows.jsonl")) == 2
    with pytest.raises(ValueError, match="checkpoint is not set"):
        evaluate.run(policies(f"{__name__}.make_network"))
    # a function that does not return a network
    remote = policies(f"{__name__}.remote", "conditions=[clean,flare]")
    assert len(rows.read(evaluate.run(remote) / "rows.jsonl")) == 2
    torch.save(net.state_dict(), tmp_path / "w.pt")
    with pytest.raises(FileNotFoundError, match="may run code.*safetensors.torch.save_file"):
        evaluate.run(policies(f"{__name__}.Net", f"checkpoint={tmp_path / 'w.pt'}"))
    with pytest.raises(ValueError, match="or a .safetensors file of its weights"):
        evaluate.run(policies(f"{__name__}.Net"))
