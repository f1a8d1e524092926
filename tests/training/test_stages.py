"""Tests that one recipe trains agents of all kinds, skipping stages without trainable parts."""

from __future__ import annotations

import pytest

from mitigate.agents.frontier import FrontierAgent
from mitigate.agents.recurrent import RecurrentAgent
from mitigate.agents.topological import TopologicalAgent
from mitigate.core import conf
from mitigate.training import train
from mitigate.training.parts import policy_parts, train_only
from mitigate.training.plan import nothing_to_train
from mitigate.worlds.apartments import simulator
from tests.tiny import TinyAgent

RGB, DEPTH, POLICY, STORED = (
    {"modality": "rgb"},
    {"modality": "depth"},
    {"train_parts": "policy"},
    {"variants": 3},
)
KINDS = ["topological", "recurrent", "recurrent_rgb", "frontier"]


@pytest.mark.parametrize(
    ("agent", "left"),
    [
        (TopologicalAgent(16), []),
        (RecurrentAgent(), [STORED]),
        (RecurrentAgent(["rgb"]), [DEPTH, STORED]),
        (FrontierAgent(), [DEPTH, POLICY, STORED]),
        (TinyAgent(), [STORED]),
    ],
    ids=lambda x: type(x).__name__,
)
def test_stage_without_trainable_parts_explains_why(agent, left):
    texts = [stage for stage in (RGB, DEPTH, POLICY, STORED) if nothing_to_train(stage, agent)]
    assert texts == left
    if left:
        assert type(agent).__name__ in nothing_to_train(left[0], agent)


def test_policy_is_everything_except_the_encoders():
    agent = TopologicalAgent(16)
    assert policy_parts(agent) == ["planner"]
    train_only(agent, "policy")
    assert {n.split(".")[0] for n, p in agent.named_parameters() if p.requires_grad} == {"planner"}


@pytest.mark.parametrize("kind", KINDS)
def test_every_agent_kind_states_its_world_requirements(kind):
    cfg = conf.load_config("train", [f"agent={kind}"])
    assert cfg.env.world.views == (12 if kind == "topological" else 1)
    assert cfg.evaluation.split == ("val_unseen_ogn" if kind == "frontier" else "val_unseen")
    assert conf.load_config("evaluate", [f"agent={kind}"]).checkpoint == cfg.weights.base


@pytest.mark.slow
def test_stage_may_reference_a_removed_one(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(simulator, "MAX_STEPS", 40)
    small = ["agent.size=16", "env.size=16", "agent.depth_width=8", "init=null", "trainer.steps=1"]
    options = ["agent=recurrent", "agent.sensors=[depth]", *small, "evaluation.enabled=false"]
    cfg = conf.load_config("train", ["recipe=ts_distill", "debug=smoke", "rollouts=1", *options])
    cfg.runs, cfg.stages.views_rgb.recipe.teacher = str(tmp_path), "start"
    for other in ("views_depth", "episodes"):
        cfg.stages[other].recipe.teacher = "${stages.views_rgb.recipe.teacher}"
    assert (train.run(cfg) / "episodes").is_dir()
    assert "views_rgb: left out, RecurrentAgent has no rgb encoder" in capsys.readouterr().out
