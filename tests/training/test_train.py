"""Tests that ``train.run`` trains one agent in stages, resumes, and names its folder."""

from __future__ import annotations

import importlib
import linecache
import os
import sys
from pathlib import Path

import pytest
import torch
from omegaconf import DictConfig, OmegaConf, open_dict
from safetensors.torch import load_file

from mitigate.core import checkpoint, conf
from mitigate.core.build import build
from mitigate.evaluation.config import column_of
from mitigate.training import config as options
from mitigate.training import plan, states, train
from tests.tiny import TinyAgent

TINY = {"_target_": "tests.tiny.TinyRecipe"}


def stage(**trainer) -> options.StageConfig:
    return options.StageConfig(recipe=TINY, trainer=options.TrainerConfig(**trainer))


def config(folder, *arguments: str, stages: dict | None = None) -> DictConfig:
    cfg = conf.load_config("train", ["evaluation.enabled=false", f"folder={folder}", *arguments])
    with open_dict(cfg):
        cfg.name, cfg.init = "tiny", None
        cfg.agent = {"_target_": "tests.tiny.TinyAgent"}
        cfg.stages = stages or {
            "first": stage(steps=4, save_every=2),
            "second": stage(steps=6, save_every=2),
        }
    return cfg


def weights(folder) -> dict[str, torch.Tensor]:
    return load_file(folder / "agent" / "model.safetensors")


def same(one, two) -> bool:
    return one.keys() == two.keys() and all(torch.equal(one[name], two[name]) for name in one)


def test_stages_run_in_order_and_leave_agent_and_config(tmp_path):
    assert train.run(config(tmp_path)) == tmp_path
    steps = [states.checkpoints(tmp_path / name)[-1].name for name in ("first", "second")]
    assert steps == ["step-00000004.pt", "step-00000006.pt"]
    last = states.load(states.checkpoints(tmp_path / "second")[-1])["model"]
    assert torch.equal(last["agent.body.0.weight"], weights(tmp_path)["body.0.weight"])
    assert OmegaConf.load(tmp_path / "config.yaml").name == "tiny"
    assert OmegaConf.load(tmp_path / "agent" / "config.yaml").agent["_target_"]


def test_second_stage_continues_from_the_first(tmp_path):
    train.run(config(tmp_path / "two"))
    train.run(config(tmp_path / "one", stages={"second": stage(steps=6)}))
    assert not same(weights(tmp_path / "one"), weights(tmp_path / "two"))


def test_train_resumes_an_interrupted_run(tmp_path, capsys):
    train.run(config(tmp_path / "whole"))
    train.run(config(tmp_path / "broken"))
    states.checkpoints(tmp_path / "broken" / "second")[-1].unlink()
    (tmp_path / "broken" / "agent" / "model.safetensors").unlink()
    capsys.readouterr()
    train.run(config(tmp_path / "broken"))
    out = capsys.readouterr().out
    assert "already trained for 4 steps" in out and "resumed at step 4" in out
    assert same(weights(tmp_path / "whole"), weights(tmp_path / "broken"))


def test_stage_with_other_settings_is_not_resumed(tmp_path):
    train.run(config(tmp_path))
    with pytest.raises(ValueError, match=r"trainer\.lr"):
        train.run(config(tmp_path, "trainer.lr=0.5"))


OWN_AGENT = """
from tests.tiny import TinyAgent

def scaled(values):
    return values * {scale}

class OwnAgent(TinyAgent):
    def forward(self, values):
        return scaled(self.body(values))
"""


def test_stage_with_other_user_code_is_not_resumed(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    folder, cfg = tmp_path / "run", config(tmp_path / "run")
    cfg.agent = {"_target_": "own_scaled_agent.OwnAgent"}
    for number, scale in enumerate((1, 1, 2)):
        (tmp_path / "own_scaled_agent.py").write_text(
            # the source has a new length, so Python does not use the old bytecode
            OWN_AGENT.format(scale=scale) + "#" * number
        )
        sys.modules.pop("own_scaled_agent", None)
        importlib.invalidate_caches()
        linecache.clearcache()
        if scale == 1:
            train.run(cfg.copy())
    with pytest.raises(ValueError, match="other settings .code_sha256"):
        train.run(cfg.copy())
    sys.modules.pop("own_scaled_agent")
    assert (folder / "agent").is_dir()


def test_rejected_resume_leaves_the_folder_unchanged(tmp_path):
    train.run(config(tmp_path))
    before = {p: p.read_bytes() for p in tmp_path.rglob("*") if p.is_file()}
    with pytest.raises(ValueError, match="other settings"):
        train.run(config(tmp_path, "seed=1"))
    after = {p: p.read_bytes() for p in tmp_path.rglob("*") if p.is_file()}
    assert {p for p in before if after[p] != before[p]} == set()


def test_train_skips_a_damaged_checkpoint(tmp_path, capsys):
    train.run(config(tmp_path))
    expected = weights(tmp_path)
    newest = states.checkpoints(tmp_path / "second")[-1]
    os.truncate(newest, newest.stat().st_size // 2)
    train.run(config(tmp_path))
    assert f"{newest} is damaged; resuming from step-00000004.pt" in capsys.readouterr().out
    assert same(expected, weights(tmp_path)) and states.load(newest)["step"] == 6


def test_train_rewrites_damaged_final_weights(tmp_path):
    train.run(config(tmp_path))
    file = tmp_path / "agent" / "model.safetensors"
    whole = file.read_bytes()
    file.write_bytes(whole[:-1] + bytes([whole[-1] ^ 1]))
    with pytest.raises(ValueError, match="the same `make train` command writes them again"):
        checkpoint.load_weights(TinyAgent(), tmp_path / "agent")
    train.run(config(tmp_path))
    assert file.read_bytes() == whole
    checkpoint.load_weights(TinyAgent(), tmp_path / "agent")


def test_negative_number_of_workers_is_rejected(tmp_path):
    with pytest.raises(ValueError, match="null uses one per core"):
        train.run(config(tmp_path, "workers=-1"))
    for wrong in (0, -3):  # this error was once raised only after training
        with pytest.raises(
            ValueError, match=f"evaluation.workers must be from 1 to 256, got {wrong}"
        ):
            train.run(config(tmp_path, f"evaluation.workers={wrong}"))


@pytest.mark.parametrize(
    ("option", "words"),
    [
        ("severity=1.5", "severity must be from 0 to 1, got 1.5. It is a severity"),
        ("severity_depth=nan", "severity_depth must be from 0 to 1, got nan"),
        ("rollouts=0", "rollouts must be from 1 to 100000, got 0"),
        ("refresh_episodes=0", "refresh_episodes must be .* got 0"),
        ("trainer.precision=fp8", "auto, fp32, bf16"),
        ("+trainer.warmpu=3", "no setting of a trainer 'trainer.warmpu'.*mean trainer.warmup"),
    ],
)
def test_train_rejects_invalid_options_before_building(tmp_path, option, words, monkeypatch):
    monkeypatch.setattr(plan, "build_agent", lambda *_, **__: pytest.fail("was built"))
    with pytest.raises(ValueError, match=words):
        train.run(config(tmp_path, option))


def test_run_reports_its_plan_and_duration_first(tmp_path, capsys):
    cfg = config(tmp_path)
    cfg.stages.first.cost, cfg.stages.second.cost = 60.0, 60.0
    train.run(cfg)
    # the first line warns that a schedule is not used
    printed = capsys.readouterr().out.splitlines()[1]
    assert printed.startswith("tiny: first 4 steps, second 6 steps: about ") and "min" in printed
    train.run(cfg)  # the estimate does not include finished stages
    assert "about 0 s" in capsys.readouterr().out.splitlines()[1]


def test_trainer_options_go_before_a_stages_own(tmp_path):
    train.run(config(tmp_path, "trainer.steps=3"))
    names = {states.checkpoints(tmp_path / stage)[-1].name for stage in ("first", "second")}
    assert names == {"step-00000003.pt"}


def test_training_starts_from_the_weights_of_init(tmp_path):
    train.run(config(tmp_path / "a"))
    cfg = config(tmp_path / "b", "trainer.lr=1e-12")
    cfg.init = str(tmp_path / "a" / "agent")
    train.run(cfg)
    one, two = weights(tmp_path / "a"), weights(tmp_path / "b")
    assert all(torch.allclose(one[name], two[name], atol=1e-6) for name in one)


def test_default_folder_contains_changed_options():
    cfg = conf.load_config("train", ["recipe=da_success", "severity=0.9", "seed=3"])
    assert options.default_folder(cfg) == "runs/da_success-s0.9-seed3"
    cfg.severity_depth = 0.8
    name = options.default_folder(cfg, "init=checkpoints/mine,debug=smoke")
    assert name == "runs/da_success-s0.9-d0.8-seed3-init-checkpoints_mine_debug-smoke"
    swept, single = (options.default_folder(cfg, f"a.b={value}") for value in ("False", "false"))
    assert swept == single  # in a sweep, Hydra writes values in Python syntax (False)


def test_column_name_contains_training_options():
    """Runs with the same name count as seeds of one recipe, so a run with a different learning rate
    needs a different name."""
    cfg = conf.load_config("train", ["recipe=da_success", "seed=3"])
    plain, other = (
        Path(options.default_folder(cfg, variant)) for variant in ("", "trainer.lr=1e-5")
    )
    assert column_of(cfg.name, cfg.seed, plain) == "da_success"
    assert column_of(cfg.name, cfg.seed, other) == "da_success+trainer.lr-1e-5"
    weak = Path("runs/da_success-s0.3-d0.5-seed0-trainer.lr-1e-5")
    assert column_of("da_success", 0, weak) == "da_success+s0.3-d0.5+trainer.lr-1e-5"
    assert column_of("da_success", 0, Path("runs/mine")) == "da_success"


@pytest.mark.parametrize("option", ["evaluation.episodes=null", "trainer.figure_every=7"])
def test_default_folder_ignores_options_without_effect(option, monkeypatch):
    """A training run must not be repeated if only the number of reported episodes changes."""
    met = []
    monkeypatch.setattr(train, "run", lambda cfg: met.append(cfg.folder))
    for value in ([], [option]):
        monkeypatch.setattr(sys, "argv", ["train", "recipe=da_success", *value])
        conf.main(train.hydra_main, "train")
    assert met == ["runs/da_success-s0.6-seed0"] * 2


def test_build_passes_objects_on_and_shows_user_errors():
    agent = TinyAgent()
    assert build(OmegaConf.create(TINY), agent=agent).agent is agent
    node = OmegaConf.create(
        {"_target_": "mitigate.corruptions.Schedule", "mode": "x", "severity": 0}
    )
    outer = OmegaConf.create({"_target_": "builtins.dict", "schedule": node})
    for wrong in (node, outer):
        with pytest.raises(ValueError, match="per_episode"):
            build(wrong)
