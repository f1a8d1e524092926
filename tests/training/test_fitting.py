"""Tests that an invalid combination of agent, world and recipe is rejected before the first step.

The error message must be one paragraph.
"""

from __future__ import annotations

import copy
from collections import Counter
from pathlib import Path

import pytest
from omegaconf import OmegaConf, open_dict
from torch import nn

from mitigate.agents.frontier import FrontierAgent
from mitigate.agents.recurrent import RecurrentAgent
from mitigate.agents.stepwise import StepwiseAgent
from mitigate.agents.topological import TopologicalAgent
from mitigate.core import checkpoint, conf
from mitigate.core.build import build
from mitigate.corruptions import DEPTH, RGB
from mitigate.recipes.dagger import Dagger
from mitigate.recipes.encoder import HardenEncoder
from mitigate.recipes.imitate import Imitate
from mitigate.recipes.imitate_stored import ImitateStored
from mitigate.recipes.pretrain import Pretrain
from mitigate.recipes.restore import Restore
from mitigate.training import plan, stages, train
from mitigate.training.config import StageConfig, TrainConfig, read
from mitigate.training.objective import Objective, ObjectiveSpec
from mitigate.training.ranks import Ranks
from mitigate.worlds.apartments.world import ApartmentsWorld
from tests.tiny import TinyAgent, TinyRecipe

OFF = "evaluation.enabled=false"


def load(*options: str) -> TrainConfig:
    """Return the options of a training run as a ``TrainConfig``."""
    return read(conf.load_config("train", [*options]))


class NoAgent(TinyRecipe):
    def __init__(self):
        super().__init__()


def no_recipe(agent):
    return agent


def refusal(folder, *options: str) -> str:
    cfg = conf.load_config("train", ["debug=smoke", "workers=0", f"folder={folder}", *options])
    with pytest.raises(ValueError) as caught:
        train.run(cfg)
    assert not list(folder.glob("*/step-*.pt"))
    return str(caught.value)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("recipe", "agent", "words"),
    [
        ("base", "recurrent", ["stage planner", "store", "recipe=dagger"]),
        ("base", "frontier", ["stage planner", "store", "recipe=dagger"]),
        ("swap_encoder", "recurrent", ["belongs to the agent", "TopologicalAgent"]),
        ("dagger", "topological", ["stage policy", "not plain data", "recipe=imitation"]),
        ("encoder", "recurrent", ["stage encoder", "agent=efficientnet_lite0"]),
        ("restore", "frontier", ["stage rgb", "agent=restorer"]),
        ("da_per_episode", "restorer", ["stage perception_rgb", "not define labels, see"]),
    ],
)
def test_recipe_for_other_agents_names_them(tmp_path, recipe, agent, words):
    message = refusal(tmp_path, f"recipe={recipe}", f"agent={agent}", OFF)
    assert all(word in message for word in words), message


@pytest.mark.parametrize(
    "recipe", [Dagger, HardenEncoder, Imitate, ImitateStored, Pretrain, Restore]
)
def test_recipe_names_what_the_agent_lacks(recipe):
    message = recipe.misfit(TinyAgent())
    assert message.startswith("it does not define ") and len(message.split(". ")) > 1
    assert not TinyRecipe.misfit(TinyAgent())


@pytest.mark.parametrize("recipe", ["dagger", "base", "safeguard_lora"])
def test_plan_warns_about_an_unused_schedule(recipe, capsys):
    plan.warn_unused_schedule(load(f"recipe={recipe}"))
    assert not capsys.readouterr().out
    plan.warn_unused_schedule(load(f"recipe={recipe}", "schedule=per_episode"))
    assert f"has no effect: recipe={recipe} samples no corruptions" in capsys.readouterr().out
    plan.warn_unused_schedule(load(f"recipe={recipe}", "experiment=broad"))
    assert "(mode clean) has no effect" in capsys.readouterr().out


def test_own_recipe_may_nest_the_schedule(capsys):
    draws = {"_target_": "a.Schedule", "mode": "per_frame"}
    stages = {"one": StageConfig({"parts": [draws]})}
    plan.warn_unused_schedule(TrainConfig("own", schedule=draws, stages=stages))
    assert not capsys.readouterr().out


@pytest.mark.parametrize("recipe", ["harden", "replan", "stacked"])
def test_plan_warns_about_unused_severity(recipe, capsys):
    options = [f"recipe={recipe}", "severity=0.9", "severity_depth=0.8"]
    cfg = conf.load_config("train", options)
    assert build(cfg.schedule) == build(conf.load_config("train", options[:1]).schedule)
    plan.warn_unused_schedule(read(cfg))
    printed = capsys.readouterr().out
    assert (
        "severity=0.9 affects only the evaluation" in printed and "which is [0.3, 1.0]" in printed
    )
    assert "severity_depth=0.8 affects only the evaluation" in printed
    plan.warn_unused_schedule(load(*options[:1]))
    plan.warn_unused_schedule(load("recipe=da_per_frame", *options[1:]))
    assert not capsys.readouterr().out


@pytest.mark.parametrize("recipe", ["base", "dagger", "replan", "swap_encoder"])
def test_oracle_share_falls_over_the_actual_steps(recipe):
    for options, steps in (
        (["trainer.steps=7"], 7),
        (["stages.{}.trainer.steps=9"], 9),
        ([], None),
    ):
        stage = "policy" if recipe == "dagger" else "planner"
        arguments = [option.format(stage) for option in options]
        settings = conf.load_config("train", [f"recipe={recipe}", *arguments]).stages[stage]
        assert settings.recipe.steps == (steps or settings.trainer.steps)


def test_plan_warns_about_stages_shorter_than_the_warmup(capsys):
    plan.warn_warmup(load("trainer.steps=40"))
    assert capsys.readouterr().out == (
        "perception_rgb: it ends after 40 steps, before the warmup of 50 steps is over: "
        "set trainer.warmup below trainer.steps\n"
    )
    plan.warn_warmup(load("trainer.steps=40", "debug=smoke"))
    assert not capsys.readouterr().out


@pytest.mark.parametrize(
    "options",
    [
        ["recipe=replan", "agent=recurrent"],
        ["recipe=da_per_episode", "agent=frontier", "experiment=frozen"],
        ["recipe=ablation", "agent=frontier", "agent.blind=[rgb]", OFF],
    ],
)
def test_plan_rejects_runs_without_stages(tmp_path, options):
    assert "all of its stages were skipped" in refusal(tmp_path, *options)


class Walker(StepwiseAgent):
    """An agent that can only be trained on episodes, because it has no encoders."""

    def __init__(self):
        super().__init__()
        self.head = nn.Linear(2, 2)


def left(cfg) -> list[str]:
    return [*cfg.active_stages]


@pytest.mark.parametrize(
    ("recipe", "stage"),
    [("imitation", "imitation"), ("da_success", "imitation"), ("ts_distill", "episodes")],
)
def test_agent_without_encoders_trains_on_episodes_only(recipe, stage, capsys):
    cfg = load(f"recipe={recipe}")
    plan.leave_out_stages(cfg, Walker())
    assert left(cfg) == [stage]
    assert "left out, Walker has no encoders, labels, see" in capsys.readouterr().out


def test_plan_drops_view_stages_without_random_poses(monkeypatch, capsys):
    cfg = load("recipe=imitation")
    plan.leave_out_stages(cfg, TopologicalAgent(16))
    assert len(left(cfg)) == 3  # no stage is left out, because the apartments support all of them
    # a world class without the members that other stages need
    monkeypatch.setattr(plan, "maker", lambda node: Walker)
    plan.leave_out_stages(cfg, TopologicalAgent(16))
    assert left(cfg) == ["imitation"] and "no random poses" in capsys.readouterr().out


def test_plan_keeps_the_camera_in_worlds_that_cannot_displace_it(monkeypatch, capsys):
    class Fixed(ApartmentsWorld):
        def put(self, xy, heading, *, views=None, rgb=True):
            return super().put(xy, heading, views=views, rgb=rgb)

    cfg = load("recipe=harden")
    plan.disable_camera_share(cfg)
    shares = [stage.recipe["camera_share"] for stage in cfg.active_stages.values()]
    assert shares == [0.4, 0.4] and not capsys.readouterr().out
    monkeypatch.setattr(plan, "maker", lambda node: Fixed)
    plan.disable_camera_share(cfg)
    shares = [stage.recipe["camera_share"] for stage in cfg.active_stages.values()]
    assert shares == [0.0, 0.0]
    assert "views_depth: without displaced cameras, Fixed.put" in capsys.readouterr().out


@pytest.mark.parametrize("recipe", ["conv_adapter", "harden"])
def test_plan_names_missing_members_for_recipes_on_views(recipe, tmp_path):
    cfg = load(f"recipe={recipe}")
    plan.leave_out_stages(cfg, Walker())
    with pytest.raises(ValueError, match=r"Walker .*not define encoders, labels, see\..*Adapt"):
        plan.plan_stages(cfg, Walker(), tmp_path)


def test_blinded_agent_without_stages_is_evaluated(tmp_path, monkeypatch, capsys):
    met = []
    monkeypatch.setattr(stages, "get_method", lambda _: lambda cfg, *agents: met.append(agents))
    options = ["recipe=ablation", "agent=frontier", "agent.blind=[rgb]", f"folder={tmp_path}"]
    train.run(conf.load_config("train", [*options, "workers=0"]))
    before, after = met[0][:2]
    assert before.blind == () and after.blind == ("rgb",)
    assert checkpoint.weights_sha(before) == checkpoint.weights_sha(after)
    assert "nothing is trained: the agent is evaluated with agent.blind" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("agent", "views", "record_action"),
    [("recurrent", 12, 1), ("frontier", 12, 1), ("topological", 1, 12)],
)
def test_world_with_another_number_of_views_is_rejected(tmp_path, agent, views, record_action):
    message = refusal(tmp_path, f"agent={agent}", f"env.views={views}", OFF)
    assert f"needs {record_action}" in message and f"env.views={record_action}" in message


def tiny(folder, name: str, *stages: str, width: int = 8):
    cfg = conf.load_config("train", [OFF, f"folder={folder}", "trainer.steps=2", "workers=0"])
    with open_dict(cfg):
        cfg.name, cfg.init = name, None
        cfg.agent = {"_target_": "tests.tiny.TinyAgent", "width": width}
        stage = StageConfig(recipe={"_target_": "tests.tiny.TinyRecipe"})
        cfg.stages = dict.fromkeys(stages, stage)
    return cfg


def test_folder_of_another_recipe_is_unchanged(tmp_path):
    train.run(tiny(tmp_path, "one", "first"))
    before = {p: p.read_bytes() for p in tmp_path.rglob("*") if p.is_file()}
    with pytest.raises(ValueError, match=r"another recipe: it has a stage first.*folder="):
        train.run(tiny(tmp_path, "two", "second"))
    assert before == {p: p.read_bytes() for p in tmp_path.rglob("*") if p.is_file()}


def test_plan_rejects_changed_settings_of_a_later_stage(tmp_path):
    train.run(tiny(tmp_path, "one", "second"))
    with pytest.raises(ValueError, match=r"second holds a run with other settings \(agent.width"):
        train.run(tiny(tmp_path, "two", "first", "second", width=16))
    assert not (tmp_path / "first").exists()
    train.run(tiny(tmp_path, "three", "second"))  # the same run continues


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["stages.imitation.recipe.train_parts=[planer]"], "part of the agent 'planer'"),
        (["recipe=ts_distill", "stages.episodes.recipe.teacher=nowhere"], "no teacher at nowhere"),
        (["recipe=ts_distill", "+stages.episodes.recipe.temperature=0"], "must be above 0"),
        (["stages.imitation.trainer.precision=fp8"], "auto, fp32, bf16"),
    ],
)
def test_plan_checks_all_stages_first(tmp_path, options, words, monkeypatch):
    monkeypatch.setattr(stages, "train_stage", lambda *_: pytest.fail("a stage was trained"))
    options = ["debug=smoke", "workers=0", f"folder={tmp_path}", OFF, *options]
    with pytest.raises((ValueError, FileNotFoundError), match=words):
        train.run(conf.load_config("train", options))


def test_check_stages_does_not_change_the_agent(tmp_path, capsys):
    cfg = load("recipe=stacked", "debug=smoke", f"folder={tmp_path}")
    agent = build(cfg.agent)
    before = checkpoint.weights_sha(agent), [p.requires_grad for p in agent.parameters()]
    plan.check_fit(cfg, agent, plan.plan_stages(cfg, agent, tmp_path), Ranks())
    assert before == (
        checkpoint.weights_sha(agent),
        [p.requires_grad for p in agent.parameters()],
    )
    assert not capsys.readouterr().out


@pytest.mark.parametrize(
    ("recipe", "agent", "count", "words"),
    [
        ("dagger", "recurrent", 2, "stage policy of recipe=dagger has 1 work item, too few"),
        ("da_per_episode", "topological", 3, "perception_depth .* has 2 work items.*NPROC=2"),
        ("restore", "restorer", 2, "stage .*gate.* has 1 work item"),
    ],
)
def test_plan_rejects_more_ranks_than_pieces(tmp_path, recipe, agent, count, words):
    cfg = load(f"recipe={recipe}", f"agent={agent}", "init=null", f"folder={tmp_path}")
    built = build(cfg.agent)
    planned = plan.plan_stages(cfg, built, tmp_path)
    with pytest.raises(ValueError, match=words):
        plan.check_fit(cfg, built, planned, Ranks(0, count))


@pytest.mark.parametrize(
    ("target", "words"),
    [
        ("tests.tiny.TinyAgent", "tests.tiny.TinyAgent is not an objective. Make it a subclass"),
        ("tests.training.test_fitting.NoAgent", "takes no agent. Give its constructor"),
        ("tests.training.test_fitting.no_recipe", "no_recipe is not an objective"),
        ("tests.tiny.Nope", "tests.tiny.Nope.* A _target_ must be module.Name"),
    ],
)
def test_plan_rejects_targets_that_are_not_objectives(tmp_path, target, words):
    cfg = tiny(tmp_path, "own", "first")
    cfg.stages.first.recipe._target_ = target
    with pytest.raises(ValueError, match=words):
        train.run(cfg)


@pytest.mark.parametrize(
    "options", [["recipe=stacked"], ["recipe=da_success", "experiment=frozen"]]
)
def test_smoke_run_measures_success_without_workers(tmp_path, monkeypatch, options):
    met = []

    def measured(self, step, workers):
        met.append((self.refresh_episodes, workers))
        raise InterruptedError

    monkeypatch.setattr("mitigate.training.success.DrawsBySuccess.refresh", measured)
    options = [*options, "agent=recurrent", "debug=smoke", "workers=0", f"folder={tmp_path}"]
    with pytest.raises(InterruptedError):
        train.run(conf.load_config("train", [*options, OFF]))
    assert met == [(1, 0)]


def test_invalid_agent_setting_names_allowed_values(tmp_path):
    message = refusal(tmp_path, "agent=recurrent", "agent.blind=[sonar]", OFF)
    assert "agent.blind" in message and "a list of rgb, depth, instruction" in message
    assert "agent.size" not in message


def test_missing_weights_name_the_recipe_that_makes_them(tmp_path):
    with pytest.raises(FileNotFoundError, match="RECIPE=base.*other recipes are in docs/agents.md"):
        checkpoint.weights_file(tmp_path / "base")


def fitted(agent, *options: str):
    """Remove corruptions from training stages if ``agent`` does not read their sensors.

    Return the new stages and the original stages.
    """
    cfg = load(*options)
    before = copy.deepcopy(cfg.stages)
    plan.drop_unread_corruptions(cfg, agent)
    return cfg.stages, before


@pytest.mark.parametrize(
    ("agent", "read"),
    [
        (RecurrentAgent(["rgb"]), RGB),
        (RecurrentAgent(["depth"]), DEPTH),
        (StepwiseAgent(), RGB),  # its ``needs`` contain only rgb
    ],
)
@pytest.mark.parametrize("recipe", ["da_per_frame", "da_per_episode", "da_success", "ts_distill"])
def test_agent_gets_corruptions_of_its_sensors_only(recipe, agent, read, capsys):
    stages, _ = fitted(agent, f"recipe={recipe}")
    for stage in stages.values():
        schedule = build(stage.recipe["schedule"])
        met = Counter(schedule.draw(0, f"e{i}", 0)[0].name for i in range(2000))
        assert set(met) == {"clean", *read}
        # the fraction of clean frames is as configured
        assert met["clean"] / 2000 == pytest.approx(0.25, abs=0.03)
    lost = ", ".join(DEPTH if read is RGB else RGB)
    printed = capsys.readouterr().out
    assert printed.count("reads no") == 1 and printed.endswith(f"the schedule leaves out {lost}\n")


def test_unread_corruptions_are_dropped_from_a_list():
    stages, _ = fitted(RecurrentAgent(["rgb"]), "schedule.names=[multipath,flare,spatter]")
    assert stages["imitation"].recipe["schedule"]["names"] == ["flare", "spatter"]


@pytest.mark.parametrize(
    "agent", [TopologicalAgent(16), RecurrentAgent(), FrontierAgent(), TinyAgent()]
)
def test_agent_with_both_sensors_draws_the_whole_schedule(agent, capsys):
    """The schedules must not change at all, because they are part of a run's fingerprint."""
    for recipe in ("da_per_episode", "stacked"):
        stages, before = fitted(agent, f"recipe={recipe}")
        assert stages == before
    assert not capsys.readouterr().out


def test_clean_schedules_stay_as_they_are():
    stages, before = fitted(RecurrentAgent(["rgb"]), "recipe=imitation")
    assert stages == before


@pytest.mark.parametrize(
    ("sensor", "names", "words"),
    [
        ("rgb", "missing_data,multipath", ["no depth", "missing_data, multipath", "motion_blur"]),
        ("depth", "flare", ["no rgb", "only flare", "gaussian_noise"]),
    ],
)
def test_schedule_without_read_corruptions_is_rejected(tmp_path, sensor, names, words):
    options = ["agent=recurrent", f"agent.sensors=[{sensor}]", "init=null", OFF]
    message = refusal(tmp_path, *options, f"schedule.names=[{names}]")
    assert all(word in message for word in words) and "schedule.names=[...]" in message


def test_run_trains_on_and_records_the_drawn_corruptions(tmp_path, monkeypatch):
    met = {}

    def trained(plan, stage, *_):
        met[stage.name] = list(stage.objective.source["schedule"]["names"])
        return "fp32"

    monkeypatch.setattr(stages, "train_stage", trained)
    train.run(conf.load_config("train", ["agent=recurrent_rgb", OFF, f"folder={tmp_path}"]))
    assert met == {"perception_rgb": list(RGB), "imitation": list(RGB)}
    saved = OmegaConf.load(tmp_path / "config.yaml")
    assert saved.stages.imitation.recipe.schedule.names == list(RGB)


def test_plan_rejects_an_unused_teacher(tmp_path):
    assert "recipe=da_per_frame does not use a teacher" in refusal(
        tmp_path, "recipe=da_per_frame", "teacher=nowhere", OFF
    )


def test_check_stages_stops_at_the_first_user_stage(monkeypatch):
    built = []
    monkeypatch.setattr(
        ObjectiveSpec, "build", lambda spec, agent: built.append(spec.target) or Objective()
    )
    targets = ("mitigate.recipes.a.A", "mine.B", "mitigate.recipes.c.C")
    planned = [
        plan.StagePlan(target[-1], Path(), ObjectiveSpec(target), {}, {}) for target in targets
    ]
    plan.check_stages("own", TinyAgent(), planned, Ranks())
    assert built == ["mitigate.recipes.a.A"]


@pytest.mark.parametrize(
    ("option", "words"),
    [
        ("+agent.foo=1", "There is no argument 'foo'"),
        ("+stages.imitation.recipe.foo=1", "There is no argument 'foo'"),
        (
            "+stages.imitation.recipe.losses={distance: abc}",
            "losses.distance must be a number from 0 to 1e+09, got 'abc'",
        ),
        ("+stages.imitation.recipe.losses=[1]", "must map names of losses to weights"),
    ],
)
def test_plan_rejects_invalid_recipe_arguments(tmp_path, option, words):
    assert words in refusal(tmp_path, "recipe=da_per_episode", option, OFF)
