"""Tests that a sweep runs every combination of options in its own folder and writes one table."""

from __future__ import annotations

import sys

import pytest

from mitigate.cluster import programs
from mitigate.core import conf
from mitigate.evaluation import rows
from mitigate.training import sweep
from tests.evaluation.made_rows import column


def config(runs, *options):
    return conf.typed(conf.load_config("sweep", [f"runs={runs}", *options]), "sweep")


@pytest.fixture
def fake(monkeypatch):
    """Replace training runs by fakes that take no time. Runs with ``seed=1`` fail, and all others
    write rows."""
    ran = []

    def run(chains, jobs, launcher, progress, reported):
        ran.append((chains, jobs, launcher.name))
        for number, chain in enumerate(chains):
            failed = "seed=1" in chain.name
            if not failed:
                records = column(5, {"flare": 4}, name=chain.name.split()[0])
                rows.write(chain.log.parent.parent / f"{number}" / "rows.jsonl", records)
            reported(number, "train ended with 1 (so)" if failed else "")

    monkeypatch.setattr(programs, "run", run)
    return ran


def test_sweep_runs_every_combination_of_hydra_grammar():
    objective = sweep.combinations(["recipe=da_per_frame,stacked", "seed=range(2)", "severity=0.3"])
    assert objective == [
        [f"recipe={recipe}", f"seed={seed}", "severity=0.3"]
        for recipe in ("da_per_frame", "stacked")
        for seed in (0, 1)
    ]
    assert sweep.combinations([]) == [[]]


def test_list_is_one_value_and_not_a_sweep():
    assert len(sweep.combinations(["agent.blind=[rgb,depth]", "seed=3"])) == 1


@pytest.mark.parametrize("value", [[], ["runs=sweeps/default"], ["command=evaluate", "jobs=2"]])
def test_sweep_without_combinations_shows_help_and_runs_nothing(value, monkeypatch, fake, capsys):
    """The option ``runs=`` does not count as a combination; ``make sweep`` always passes it."""
    monkeypatch.setattr(sys, "argv", ["mitigate sweep", *value])
    assert sweep.main() == 2 and not fake
    printed = capsys.readouterr()
    assert "mitigate sweep recipe=imitation,stacked seed=0,1" in printed.out
    assert "jobs: 1  # runs at a time" in printed.out and "set options to combine" in printed.err


@pytest.mark.parametrize(
    ("command", "option"), [("evaluate", "out=x"), ("train", "folder=x"), ("train", "+out=x")]
)
def test_shared_folder_for_all_runs_is_rejected(tmp_path, fake, command, option):
    with pytest.raises(ValueError, match=r"is a single folder, .* Set runs=FOLDER"):
        sweep.run_all(config(tmp_path, f"command={command}"), ["seed=0,1", option])
    assert not fake


@pytest.mark.slow
def test_options_to_combine_are_run(monkeypatch, fake, tmp_path):
    monkeypatch.setattr(sys, "argv", ["mitigate sweep", f"runs={tmp_path}", "seed=0,2"])
    assert sweep.main() == 0
    assert [len(chains) for chains, _, _ in fake] == [2]


@pytest.mark.parametrize(
    "named",
    [["--config-dir", "mine"], pytest.param(["--config-dir=mine"], marks=pytest.mark.slow)],
)
def test_configs_of_ones_own_are_those_of_every_run(monkeypatch, fake, tmp_path, named):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine/recipe").mkdir(parents=True)
    own_value = "# @package _global_\ndefaults: [imitation]\nname: own\n"
    (tmp_path / "mine/recipe/own.yaml").write_text(own_value)
    words = ["mitigate sweep", *named, f"runs={tmp_path}", "recipe=own", "seed=0,2"]
    monkeypatch.setattr(sys, "argv", words)
    assert sweep.main() == 0
    chains, _, _ = fake[0]
    assert [chain.name for chain in chains] == ["recipe=own seed=0", "recipe=own seed=2"]
    assert all(" ".join(named) in " ".join(chain.programs[0][1]) for chain in chains)
    assert {chain.log.name for chain in chains} == {
        "recipe-own_seed-0.txt",
        "recipe-own_seed-2.txt",
    }
    monkeypatch.setattr(sys, "argv", ["mitigate sweep", *named])
    assert sweep.main() == 2  # nothing to combine


def test_sweep_gives_each_run_a_log_a_folder_and_cores(tmp_path, monkeypatch):
    monkeypatch.setenv("PYTHON_CPU_COUNT", "8")
    cfg = config(tmp_path, "command=evaluate", "jobs=4")
    chains = [sweep.chain(cfg, output) for output in sweep.combinations(["seed=0,1"])]
    folders = {word for c in chains for word in c.programs[0][1] if word.startswith("out=")}
    assert folders == {f"out={tmp_path}/seed-0", f"out={tmp_path}/seed-1"}
    assert len({chain.log for chain in chains}) == 2
    assert chains[0].environment["PYTHON_CPU_COUNT"] == "2"
    alone = sweep.chain(config(tmp_path), ["seed=0"])
    assert alone.environment == {}
    there = sweep.chain(config(tmp_path, "launcher=ray", "launcher.cpus=4"), ["seed=0"])
    assert there.environment["PYTHON_CPU_COUNT"] == "4"


def test_combinations_with_equal_names_get_a_digest(tmp_path):
    cfg = config(tmp_path, "command=evaluate")
    output = sweep.combinations(["checkpoint=a/b,a_b"])
    assert len({sweep.chain(cfg, one, output).log for one in output}) == 2


@pytest.mark.slow
def test_sweep_continues_after_a_failed_run(tmp_path, fake):
    options = ["severity=0.3,0.6", "seed=0,1"]
    with pytest.raises(ValueError, match="2 of 4 runs failed.*Run the same command again"):
        sweep.run_all(config(tmp_path, "jobs=2", "launcher=ray"), options)
    assert len(fake[0][0]) == 4 and fake[0][1:] == (2, "ray")
    assert "severity=0.6" in (tmp_path / "table.md").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("own_value", "options", "message"),
    [
        (["command=trian"], [], "Did you mean train"),
        (["jobs=0"], [], "jobs must be >= 1"),
        ([], ["recipe=stacked,da_per_fram"], "Did you mean da_per_frame"),
        ([], ["sevrity=0.1"], "Did you mean severity"),
        ([], ["severity=high"], "must be a number"),
    ],
)
def test_impossible_options_are_reported_before_any_run(
    tmp_path, fake, own_value, options, message
):
    with pytest.raises(ValueError, match=message):
        sweep.run_all(config(tmp_path, *own_value), options)
    assert not fake


@pytest.mark.slow
def test_sweep_infers_the_agent_from_weights(tmp_path, fake):
    """The recurrent agent has the setting ``rgb_width``, and the default agent does not."""
    cfg = config(tmp_path, "command=evaluate")
    options = ["checkpoint=checkpoints/recurrent/base", "agent.rgb_width=1,2"]
    sweep.run_all(cfg, options)
    ((chains, _, _),) = fake
    assert len(chains) == 2
    with pytest.raises(ValueError, match=r"no option 'agent.rgb_width'"):
        sweep.run_all(cfg, ["checkpoint=checkpoints/base", *options[1:]])
