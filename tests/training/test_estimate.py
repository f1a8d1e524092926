"""Tests that estimated training times are within 10 % of measured times."""

from __future__ import annotations

import math

import pytest

from mitigate.agents.building import build_agent
from mitigate.core import conf, precision
from mitigate.evaluation.config import CostConfig
from mitigate.training import estimate, plan
from mitigate.training.config import TrainConfig, read

# These are measured minutes of training runs on 2 cores that are limited to AVX2.
# They include the evaluation but not the set-up of the environment.
# See "How long they take" in recipes/README.md, where times include the set-up.
TIMED = [
    ("da_per_episode", "topological", 8.5),
    ("conv_adapter", "topological", 8.5),
    ("ts_distill", "topological", 10.5),
    ("stacked", "topological", 18.5),
    ("da_per_episode", "recurrent", 13.5),
    ("conv_adapter", "recurrent", 10.7),
    ("ts_distill", "recurrent", 14.2),
    ("da_per_episode", "recurrent_rgb", 10.6),
    ("da_per_episode", "frontier", 8.35),
]


@pytest.fixture
def reference(monkeypatch):
    """Simulate the machine on which the costs were measured."""
    monkeypatch.setattr(precision, "probe", lambda: precision.REFERENCE)
    monkeypatch.setattr(estimate, "cores", lambda: 2)


def training(recipe: str, agent: str, *options: str) -> TrainConfig:
    cfg = read(conf.load_config("train", [f"recipe={recipe}", f"agent={agent}", *options]))
    plan.leave_out_stages(cfg, build_agent(cfg.agent, weights=None, seed=0))
    return cfg


@pytest.mark.slow
@pytest.mark.parametrize(("recipe", "agent", "minutes"), TIMED)
def test_estimate_matches_measured_times(reference, tmp_path, recipe, agent, minutes):
    seconds = estimate.estimate(training(recipe, agent), tmp_path)
    assert seconds / 60 == pytest.approx(minutes, rel=0.1)


@pytest.mark.parametrize("recipe", ["dagger", "imitation", "ablation", "harden", "stacked"])
@pytest.mark.parametrize("agent", ["recurrent", "recurrent_rgb"])
def test_every_recipe_kind_has_an_estimate(reference, tmp_path, recipe, agent):
    assert estimate.estimate(training(recipe, agent), tmp_path) > 60


def test_finished_stages_take_no_time(reference, tmp_path):
    cfg = training("da_per_episode", "recurrent")
    whole = estimate.estimate(cfg, tmp_path)
    (tmp_path / "imitation").mkdir()
    (tmp_path / "imitation" / "step-00000040.pt").touch()
    left = estimate.estimate(cfg, tmp_path)
    assert whole - left == pytest.approx(40 * cfg.stages["imitation"].cost)


@pytest.mark.parametrize("unknown", ["episodes", "evaluation"])
def test_estimate_is_nan_for_agents_without_costs(tmp_path, unknown):
    cfg = training("da_per_episode", "recurrent", f"cost.{unknown}=null")
    assert math.isnan(estimate.estimate(cfg, tmp_path))
    assert ": no estimate on this machine" in estimate.describe(cfg, tmp_path)
    known = training("conv_adapter", "recurrent", "cost.episodes=null")  # walks none
    assert estimate.estimate(known, tmp_path) > 60


def test_description_names_the_initial_weights(tmp_path):
    line = estimate.describe(training("da_per_episode", "recurrent"), tmp_path)
    assert "initial weights: checkpoints/recurrent/base;" in line
    line = estimate.describe(training("da_per_episode", "recurrent", "init=null"), tmp_path)
    assert "initial weights: those that the agent is built with;" in line


def test_estimate_is_nan_for_unknown_evaluation_cost(tmp_path):
    cfg = training("conv_adapter", "recurrent")
    cfg.cost = CostConfig()
    assert math.isnan(estimate.estimate(cfg, tmp_path))
    cfg.evaluation.enabled = False
    assert estimate.estimate(cfg, tmp_path) > 60


def test_estimate_scales_by_the_machines_probe(monkeypatch, reference, tmp_path):
    cfg = training("conv_adapter", "recurrent")
    here = estimate.estimate(cfg, tmp_path)
    monkeypatch.setattr(precision, "probe", lambda: 3 * precision.REFERENCE)
    assert estimate.estimate(cfg, tmp_path) == pytest.approx(3 * here)


def test_estimate_of_a_faster_machine_is_that_of_the_reference(monkeypatch, reference, tmp_path):
    """On a machine with faster matrix products, rendering still takes the same time."""
    cfg = training("conv_adapter", "recurrent")
    here = estimate.estimate(cfg, tmp_path)
    monkeypatch.setattr(precision, "probe", lambda: 0.5 * precision.REFERENCE)
    assert estimate.estimate(cfg, tmp_path) == here


def test_base_without_evaluation_is_not_counted(tmp_path):
    """swap_encoder starts from parts of an agent. These are not a complete agent that could be
    evaluated."""
    cfg = read(conf.load_config("train", ["recipe=swap_encoder"]))
    assert ", 1 x 40 episodes x 13 conditions: about " in estimate.describe(cfg, tmp_path)
    assert ", 2 x 40 episodes x 13 conditions: about " in estimate.describe(
        read(conf.load_config("train", ["recipe=harden"])), tmp_path
    )
