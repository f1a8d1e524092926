"""Tests that every YAML file in conf/ composes, that its targets exist, and that wrong options are
explained."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest
from hydra.utils import get_object
from omegaconf import DictConfig, OmegaConf
from omegaconf.errors import OmegaConfBaseException

from mitigate.cluster import programs
from mitigate.core import conf
from mitigate.corruptions import NAMES
from mitigate.evaluation import evaluate
from mitigate.training import config as train_options
from mitigate.training import plan, train
from mitigate.worlds.episodes import Instruction, read_episodes, write_episodes

YAMLS = sorted(path.relative_to(conf.CONF) for path in conf.CONF.rglob("*.yaml"))
GROUPS = [path for path in YAMLS if len(path.parts) > 1]


def targets(node) -> list[str]:
    if isinstance(node, dict):
        own_value = [node["_target_"]] if "_target_" in node else []
        return own_value + [name for value in node.values() for name in targets(value)]
    return []


def check(options: list[str]) -> None:
    plan.check(train_options.read(conf.load_config("train", options)))


def no_rows(*_, out: Path, **__) -> None:
    """Stand-in for an evaluation that writes an empty row file."""
    out.touch()


def resolved(cfg: DictConfig) -> dict:
    return OmegaConf.to_container(cfg, resolve=True, throw_on_missing=True)


def composed(path) -> dict:
    if len(path.parts) == 1:
        return resolved(conf.load_config(path.stem))
    commands = {"launcher": "evaluate", "suite": "evaluate", "table": "table1"}
    command = {**commands, "evaluations": "table2"}.get(path.parts[0], "train")
    return resolved(conf.load_config(command, [f"{path.parent}={path.stem}"]))


@pytest.mark.slow
@pytest.mark.parametrize("path", YAMLS, ids=str)
def test_every_yaml_composes_and_its_targets_import(path):
    assert len(path.parts) == 2 or path.stem in conf.TYPES
    output = composed(path)
    assert output
    for name in targets(output):
        assert callable(get_object(name))


def test_load_config_imports_the_module_of_the_options():
    code = "from mitigate.core import conf; conf.load_config('train')"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert "import the module of the command first" in done.stderr


@pytest.mark.parametrize("path", YAMLS, ids=str)
def test_every_yaml_states_its_purpose(path):
    assert "# " in (conf.CONF / path).read_text(encoding="utf-8")


@pytest.mark.parametrize("path", [p for p in GROUPS if p.parts[0] == "recipe"], ids=str)
def test_recipe_is_named_after_its_file_and_has_stages(path):
    cfg = conf.load_config("train", [f"recipe={path.stem}"])
    assert cfg.name == path.stem and len(cfg.stages) >= 1


def test_full_suite_is_clean_and_all_corruptions():
    cfg = conf.load_config("evaluate")
    assert list(cfg.suite.conditions) == ["clean", *NAMES]


def test_conditions_take_the_severity_of_their_modality():
    records = evaluate.conditions(["clean", "flare", "multipath"], 0.9, 0.8)
    assert [(c.name, c.severity) for c in records] == [
        ("clean", 0),
        ("flare", 0.9),
        ("multipath", 0.8),
    ]


def test_severity_out_of_range_is_rejected_with_any_condition():
    for value in ((1.2, None), (0.5, 1.2)):
        with pytest.raises(ValueError, match="from 0 .clean. to 1 .worst., got 1.2"):
            evaluate.conditions(["clean"], *value)


def test_weights_are_named_after_their_folder_or_run():
    for path in (
        "checkpoints/base",
        "runs/base/agent",
        "runs/table2/cells/base/run/agent",
        "x/base/model.safetensors",
        "base.safetensors",
    ):
        assert evaluate.name_of(path) == "base"
    assert evaluate.name_of("checkpoints/frontier/base") == "frontier"
    assert evaluate.name_of("runs/da-s0.6-seed0/agent") == "da-s0.6-seed0"


def test_unknown_condition_or_split_names_the_nearest():
    with pytest.raises(ValueError, match="Did you mean flare"):
        evaluate.conditions(["flair"], 0.5, None)
    with pytest.raises(ValueError, match="Did you mean val_seen"):
        evaluate.episodes(conf.load_config("evaluate").env, "val_sen", 1)


def test_few_episodes_come_from_many_layouts():
    env = conf.load_config("evaluate").env
    chosen = {
        count: [e.episode_id for e in evaluate.episodes(env, "val_unseen", count)]
        for count in (1, 40, 100, 300, 999, None)
    }
    layouts = {name.partition("-")[0] for name in chosen[40]}
    assert len(chosen[1]) == 1 and len(chosen[40]) == 40 and len(layouts) > 25
    assert set(chosen[1]) < set(chosen[40]) < set(chosen[100]) < set(chosen[300])
    assert chosen[300] == chosen[999] == chosen[None]
    assert chosen[40] == [name for name in chosen[300] if name in set(chosen[40])]


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (lambda listed: [], "must list at least one episode"),
        (lambda listed: [*listed, listed[0]], "-0 twice"),
        (lambda listed: [replace(listed[0], instruction=Instruction(" "))], "has no instruction"),
    ],
)
def test_list_without_scores_is_rejected(tmp_path, change, text):
    cfg = conf.load_config("evaluate", [f"+env.episodes.mine={tmp_path / 'mine.json'}"])
    listed = list(read_episodes(cfg.env.episodes.val_seen))[:2]
    write_episodes(tmp_path / "mine.json", change(listed))
    with pytest.raises(ValueError, match=text):
        evaluate.episodes(cfg.env, "mine", None)


def test_experiment_harsh_is_the_papers_stronger_setting():
    cfg = conf.load_config("train", ["experiment=harsh"])
    assert (cfg.schedule.severity, cfg.schedule.severity_depth) == (0.9, 0.8)


@pytest.mark.parametrize("recipe", ["da_per_frame", "ts_distill", "conv_adapter"])
def test_experiment_broad_draws_what_harden_draws(recipe):
    broad = conf.load_config("train", [f"recipe={recipe}", "experiment=broad"]).schedule
    harden = conf.load_config("train", ["recipe=harden"]).schedule
    assert broad.broad_share == harden.broad_share > 0
    assert broad.severity == harden.severity and broad.severity_depth is None


def test_smoke_shortens_every_stage():
    cfg = conf.load_config("train", ["recipe=base", "debug=smoke"])
    assert cfg.trainer.steps == 2 and cfg.evaluation.episodes == 2


def test_frozen_fits_only_recipes_with_its_stages():
    check(["recipe=da_success", "experiment=frozen"])
    for recipe in ("ts_distill", "conv_adapter"):
        with pytest.raises(ValueError, match="has no stage 'imitation'.*imitation and da_"):
            check([f"recipe={recipe}", "experiment=frozen"])


def test_evaluate_takes_agent_settings_from_the_command_line(monkeypatch, tmp_path):
    """The agent's settings are loaded with the weights, and the command line overrides them. The
    column name shows such a change, because the hash of the weights stays the same."""
    met = {}

    def meet(agent, world, episodes, conditions, *, name, out, **others):
        met[name] = agent
        out.touch()

    monkeypatch.setattr("mitigate.evaluation.evaluator.evaluate", meet)
    monkeypatch.setattr(evaluate, "write_table", lambda *_: None)
    for options in (
        [],
        ["agent.blind=[rgb]", "agent.planner={fusion: {rate: 4, cap: 3}}", "env.size=32"],
    ):
        arguments = ["checkpoint=checkpoints/hardened/ts_distill", f"out={tmp_path}", *options]
        monkeypatch.setattr(sys, "argv", ["evaluate", *arguments])
        conf.main(evaluate.hydra_main, "evaluate")
    (plain, agent), (name, changed) = met.items()
    assert plain == "ts_distill" and agent.blind == () and agent.planner.fusion is None
    assert name == "ts_distill+blind-rgb+planner-fusion-rate-4-cap-3+env.size-32"
    assert changed.blind == ("rgb",) and changed.planner.fusion.keywords == {"rate": 4, "cap": 3}


def test_agent_name_holds_its_options_and_views():
    options = ["agent=topological", "++env.size=32", "agent.blind=[rgb]", "split=val_seen"]
    assert evaluate.changed(options) == ["env.size-32", "blind-rgb"]


def test_rows_of_an_edited_episode_list_are_not_resumed(monkeypatch, tmp_path):
    monkeypatch.setattr("mitigate.evaluation.evaluator.evaluate", no_rows)
    monkeypatch.setattr(evaluate, "write_table", lambda *_: None)
    mine = tmp_path / "mine.json.gz"
    cfg = conf.load_config(
        "evaluate", [f"+env.episodes.mine={mine}", "split=mine", f"out={tmp_path}"]
    )
    shutil.copy(cfg.env.episodes.val_seen, mine)
    evaluate.run(cfg)
    evaluate.run(cfg)
    seen = conf.load_config("evaluate", ["split=val_seen", f"out={tmp_path}"])
    # the list of a different split may use the same folder, because rows contain their split
    evaluate.run(seen)
    shutil.copy(cfg.env.episodes.val_unseen, mine)
    with pytest.raises(ValueError, match="rows of another"):
        evaluate.run(cfg)


def test_command_line_overrides_recipe_and_recipe_overrides_defaults():
    encoder = ["recipe=encoder", "agent=encoder"]
    assert conf.load_config("train", encoder).workers == 0
    assert conf.load_config("train", [*encoder, "workers=2"]).workers == 2
    assert conf.load_config("train", ["recipe=harden"]).workers is None


def test_ablation_blanks_a_sensor():
    for agent in ("topological", "recurrent_rgb", "frontier"):
        cfg = conf.load_config("train", ["recipe=ablation", f"agent={agent}"])
        assert cfg.agent.blind == ["rgb"] and cfg.suite.conditions == ["clean"]
    blind = conf.load_config("train", ["recipe=ablation", "agent.blind=[depth]"]).agent.blind
    assert blind == ["depth"]


@pytest.mark.parametrize("count", [0, -1])
def test_zero_episodes_are_rejected_before_training(count):
    with pytest.raises(ValueError, match=f"episodes must be a whole number .* got {count}"):
        check(["recipe=da_per_episode", f"evaluation.episodes={count}"])


def complaint(monkeypatch, capsys, *options: str) -> str:
    monkeypatch.setattr(sys, "argv", ["train", *options])
    monkeypatch.delenv("HYDRA_FULL_ERROR", raising=False)
    with pytest.raises(SystemExit) as stop:
        conf.main(train.hydra_main, "train")
    text = str(stop.value.code)
    assert text.startswith("error: ") and "\n" not in text
    assert "Traceback" not in capsys.readouterr().err
    return text


@pytest.mark.parametrize(
    ("option", "words"),
    [
        ("recipe=da_per_epsiode", ["Did you mean da_per_episode?", "ablation, base, "]),
        ("recpie=base", ["Did you mean recipe?"]),
        ("severty=0.5", ["Did you mean severity?"]),
        ("trainer.stps=4", ["Did you mean trainer.steps?"]),
        ("stages.imitatoin.trainer.steps=4", ["Did you mean stages.imitation"]),
        ("trainer.steps=four", ["trainer.steps=four", "a whole number"]),
        ("severity=high", ["severity=high", "a number"]),
        ("evaluation.enabled=maybe", ["true or false"]),
        ("severity=1.2", ["severity must be", "got 1.2", "from 0 (clean) to 1"]),
        ("severity_depth=-0.1", ["severity_depth must be", "got -0.1", "from 0 (clean) to 1"]),
        ("severity==3", ["key=value"]),
        ("init=nowhere", ["nowhere", "make train RECIPE=base"]),
    ],
)
def test_wrong_option_is_explained_in_one_paragraph(monkeypatch, capsys, option, words):
    text = complaint(monkeypatch, capsys, option)
    for word in words:
        assert word in text


@pytest.mark.slow
@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["agent=frontier", "agent.widht=3"], ["Did you mean agent.width?", "agent.eye"]),
        (["recipe=harden", "stages.view_rgb=null"], ["Did you mean stages.views_rgb?"]),
        (["recipe=encoder", "agent=encoder", "agent.kwargs.width=3"], ["+agent.kwargs.width="]),
        (["recipe=harden", "~stages.views"], ["stages.views_rgb, stages.views_depth"]),
        (["stages.imitation=nul"], ["it holds recipe, trainer, cost"]),
    ],
)
def test_error_lists_alternatives_of_the_chosen_group(monkeypatch, capsys, options, words):
    text = complaint(monkeypatch, capsys, *options)
    for word in words:
        assert word in text


def test_own_configs_count_for_what_there_is_instead(monkeypatch, capsys, tmp_path):
    (tmp_path / "agent").mkdir()
    (tmp_path / "agent" / "mine.yaml").write_text("_target_: my.Agent\nbreadth: 3\n")
    arguments = ("--config-dir", str(tmp_path), "agent=mine", "agent.bredth=4")
    assert "Did you mean agent.breadth?" in complaint(monkeypatch, capsys, *arguments)


def test_nested_program_ends_in_one_paragraph(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(sys, "argv", ["sweep"])
    monkeypatch.delenv("HYDRA_FULL_ERROR", raising=False)
    chain = programs.Chain(
        "one", (("train", programs.python("mitigate.train", "sede=1")),), tmp_path / "log", tmp_path
    )

    def program():
        running = programs.Running(chain)
        while (problem := running.poll()) is None:
            time.sleep(0.02)
        raise ValueError(problem)

    with pytest.raises(SystemExit) as stop:
        conf.main(program, "sweep")
    assert "train ended with 1 (error: There is no option 'sede'." in str(stop.value.code)
    assert "HYDRA_FULL_ERROR" not in os.environ


@pytest.mark.parametrize("primary", conf.TYPES)
def test_help_says_what_every_option_and_group_means(primary):
    printed, cfg = conf.options_text(primary), conf.load_config(primary)
    settings = {"name", "report", "init", "init_parts", "rollouts"} if primary == "train" else set()
    # these options are set by the recipe
    plain = {name for name in cfg if not isinstance(cfg[name], DictConfig)}
    assert plain - settings <= {line.partition(":")[0] for line in printed.splitlines()}
    for group in ("suite", "launcher"):
        if group in cfg:
            assert f"{group}: " in printed and ", " in printed.partition(f"{group}: ")[2]


def test_deprecated_option_warns_once_on_stderr(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["mitigate table1", "+columns.recurrent=[agent=recurrent]"])
    conf.main(lambda: None, "table1")
    printed = capsys.readouterr().err
    assert printed.count("columns.recurrent already exists, and +columns.recurrent= replaces") == 1


AGENTS = sorted(path.stem for path in (conf.CONF / "agent").glob("*.yaml"))


@pytest.mark.parametrize("name", AGENTS)
def test_help_lists_agents_per_command(name):
    agent = get_object(conf.load_config("train", [f"agent={name}"]).agent._target_)
    (printed,) = re.findall(r"^agent: topological  # (.*)$", conf.options_text("evaluate"), re.M)
    (training,) = re.findall(r"^agent: topological  # (.*)$", conf.options_text("train"), re.M)
    walking, others = training.split("; cannot run episodes, have their own recipes: ")
    able = hasattr(agent, "reset") and hasattr(agent, "act")
    assert printed == walking and (name in walking.split(", ")) == able
    assert (name in others.split(", ")) == (not able)


def test_help_needs_no_config_to_compose(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["mitigate train", "--help", "sevrity=1"])
    train.main()
    printed = capsys.readouterr().out
    assert "Train an agent with a recipe" in printed and "severity: 0.6  # " in printed


def test_hydras_own_line_goes_before_no_paragraph(monkeypatch, capsys, tmp_path):
    monkeypatch.delenv("HYDRA_FULL_ERROR", raising=False)
    monkeypatch.setattr(sys, "argv", ["evaluate", "split=nowhere", f"runs={tmp_path}"])
    with pytest.raises(SystemExit) as stop:
        evaluate.main()
    assert "There is no split" in str(stop.value.code)
    assert "Error executing job" not in capsys.readouterr().err


def test_missing_reference_of_an_entry_is_named():
    cfg = OmegaConf.create({"first": "${stages.mine.teacher}", "stages": {}})
    with pytest.raises(OmegaConfBaseException) as caught:
        OmegaConf.resolve(cfg)
    assert "refers to stages.mine.teacher, which does not exist" in conf.explain(
        caught.value, "train"
    )


@pytest.mark.parametrize(
    ("option", "message"),
    [
        ("stages.episodes.recipe.temperature=3", "To add it, write +stages.episodes.recipe.temp"),
        ("stages.episodes.recipe.temperatur=3", "Did you mean +stages.episodes.recipe.temperature"),
        ("stages.episodes.recipe.w_kll=3", "+stages.episodes.recipe.w_kl, +stages"),
        ("stages.episodes.recipe.episods=3", "Did you mean stages.episodes.recipe.episodes?"),
    ],
)
def test_missing_arguments_of_a_recipe_are_named(option, message):
    with pytest.raises(ValueError, match="(?i)" + re.escape(message)):
        conf.composed("train", ["recipe=ts_distill", option])


def test_message_imports_no_class_of_other_packages(monkeypatch):
    monkeypatch.setattr(conf, "get_object", lambda target: pytest.fail(f"{target} was imported"))
    assert not conf._arguments(OmegaConf.create({"_target_": "mine.Recipe", "a": 1}))


@pytest.mark.parametrize("recipe", ["harden", "ts_distill", "stacked", "self_distill"])
def test_experiment_camera_displaces_the_camera_in_view_stages(recipe):
    composed = conf.load_config("train", [f"recipe={recipe}", "experiment=camera"])
    for stage in ("views_rgb", "views_depth"):
        assert composed.stages[stage].recipe.camera_share == 0.4
    check([f"recipe={recipe}", "experiment=camera"])
    with pytest.raises(ValueError, match="has no stage 'views_rgb'"):
        check(["recipe=da_per_episode", "experiment=camera"])
