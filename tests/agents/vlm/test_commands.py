"""Tests of the commands that train and evaluate vision-language agents."""

from __future__ import annotations

import json
import sys

import pytest

from mitigate.evaluation import evaluate
from mitigate.shipping import export_command
from mitigate.training import train
from tests.agents.vlm.test_remote import server  # noqa: F401
from tests.agents.vlm.tiny_models import write_model

SMALL = ["agent=vlm", "debug=smoke", "env.size=28", "workers=0", "rollouts=1"]
SMALL += ["agent.lora.r=2", "agent.lora.language=[q_proj]", "agent.history=1"]


@pytest.fixture(scope="module")
def model(tmp_path_factory) -> str:
    return write_model(tmp_path_factory.mktemp("vlm"), "idefics3")


def run(monkeypatch, command, *options: str) -> None:
    monkeypatch.setattr(sys, "argv", ["mitigate", *options])
    command.main()


@pytest.mark.slow
@pytest.mark.parametrize("recipe", ["da_per_episode", "ts_distill", "self_distill", "dagger"])
def test_recipes_train_and_evaluate_a_vision_language_agent(model, recipe, monkeypatch, tmp_path):
    options = [*SMALL, f"recipe={recipe}", f"agent.model={model}", f"folder={tmp_path / 'run'}"]
    options += [] if recipe == "ts_distill" else ["evaluation.enabled=false"]
    options += ["teacher=start"] if recipe == "ts_distill" else []
    options += ["trainer.steps=1"]
    options += ["evaluation.episodes=1", "evaluation.workers=1", "suite.conditions=[clean,flare]"]
    run(monkeypatch, train, *options)
    agent = tmp_path / "run/agent"
    assert {file.name for file in agent.iterdir()} >= {"adapter_config.json", "config.yaml"}
    assert "model:" not in (agent / "config.yaml").read_text("utf-8")
    if recipe == "ts_distill":
        lines = next((tmp_path / "run").rglob("rows.jsonl")).read_text("utf-8").splitlines()
        assert len({json.loads(line)["corruption"] for line in lines}) == 2
        first = [
            "agent=vlm",
            f"agent.model={model}",
            f"checkpoint={agent}",
            f"out={tmp_path / 'a'}",
        ]
        first += ["env.size=28", "episodes=1", "conditions=[clean]", "workers=1"]
        # the settings of history and LoRA are read from the folder
        run(monkeypatch, evaluate, *first)
        with pytest.raises(SystemExit, match="needs no export: it is a PEFT folder"):
            run(monkeypatch, export_command, str(tmp_path / "run"), "name", f"--out={tmp_path}")


@pytest.mark.slow
def test_model_without_a_checkpoint_is_evaluated_as_it_is(model, monkeypatch, tmp_path):
    options = ["agent=vlm", f"agent.model={model}", "agent.lora=null", f"out={tmp_path / 'a'}"]
    options += ["env.size=28", "episodes=1", "conditions=[clean]", "workers=1"]
    run(monkeypatch, evaluate, *options)
    assert len((tmp_path / "a/rows.jsonl").read_text("utf-8").splitlines()) == 1


@pytest.mark.slow
@pytest.mark.parametrize("recipe", ["harden", "stacked"])
def test_recipes_with_encoder_adapters_are_explained(model, recipe, monkeypatch, tmp_path):
    options = [*SMALL, f"recipe={recipe}", f"agent.model={model}", f"folder={tmp_path / 'run'}"]
    with pytest.raises(SystemExit, match="recipe=harden, conv_adapter and stacked do not fit"):
        run(monkeypatch, train, *options)


@pytest.mark.slow
def test_served_agent_runs_episodes_of_the_apartments_at_once(server, monkeypatch, tmp_path):  # noqa: F811
    server.reply = lambda number, body: (200, "stop" if number > 40 else "forward 25 cm", 0)
    options = ["agent=remote", "agent.model=navid", f"agent.url={server.url}", "episodes=4"]
    options += ["env.size=28", "conditions=[clean]", "workers=1", f"out={tmp_path / 'a'}"]
    run(monkeypatch, evaluate, *options)
    lines = (tmp_path / "a/rows.jsonl").read_text("utf-8").splitlines()
    assert len(lines) == 4 and all('"unreadable_answers": 0' in line for line in lines)
