"""Tests that a table of all methods is computed cell by cell, resumes, and reports its cost."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from pathlib import Path

import pytest

from mitigate.core import conf
from mitigate.corruptions import DEPTH, RGB
from mitigate.evaluation import plots, rows, trajectories
from mitigate.evaluation.episode import start_of
from mitigate.training import cells, tables
from tests.evaluation.made_rows import column, row

ALL = dict.fromkeys((*RGB, *DEPTH), 4)
# the columns of Table I that are tested; other columns behave in the same way
KEPT = ("topological", "recurrent")


def less(table: str, remaining: Collection[str]) -> list[str]:
    """Return options that keep only these columns of a table."""
    return [f"~columns.{name}" for name in conf.load_config(table).columns if name not in remaining]


def load(table: str, *options: str) -> cells.TablesConfig:
    """Return the typed options of a table."""
    return cells.read_options(conf.load_config(table, [*options]))


def config(out: Path, **changes) -> cells.TablesConfig:
    cfg = load("table2", f"out={out}", "seeds=[0,1]", *less("table2", ["base", "da_per_frame"]))
    columns = {**cfg.columns, **changes.pop("columns", {})}
    return replace(cfg, columns=columns, **changes)


def finished(cfg) -> None:
    """Write rows of every cell as an evaluation would; seed 1 has a lower success rate than seed
    0."""
    for cell in tables.cells(cfg):
        agent = "base" if not cell.options else f"{cell.column}{cell.seed}"
        records = column(8 - 2 * cell.seed, ALL, name=cell.column, seed=cell.seed, agent=agent)
        rows.write(cell.folder / "evaluation" / "rows.jsonl", records)


@pytest.fixture(autouse=True)
def no_plots(monkeypatch):
    """Plot nothing, because plots take most of a report's time.

    tests/evaluation/test_report.py tests the plots.
    """
    monkeypatch.setattr(plots, "heatmap", lambda section, path: path)
    monkeypatch.setattr(plots, "severity_curves", lambda grid, path: path)


@pytest.fixture
def quick(monkeypatch):
    """Replace the programs that compute cells by processes that do nothing."""
    monkeypatch.setattr(
        tables.Cell, "commands", lambda self, cfg: [("train", ["timeit", "-n", "1", "pass"])]
    )


def test_partial_run_holds_every_column_of_the_first_seed(tmp_path):
    order = [(cell.column, cell.seed) for cell in tables.cells(config(tmp_path))]
    assert order == [("base", 0), ("da_per_frame", 0), ("base", 1), ("da_per_frame", 1)]


def test_cell_trains_and_evaluates_in_its_own_folder(tmp_path):
    cfg = config(tmp_path, episodes=5)
    base, trained = tables.cells(cfg)[0], tables.cells(cfg)[-1]
    assert [kind for kind, _ in base.commands(cfg)] == ["evaluate"]
    (_, train), (_, evaluate) = trained.commands(cfg)
    assert train[0] == "mitigate.train" and f"folder={trained.folder / 'run'}" in train
    assert f"checkpoint={trained.folder / 'run' / 'agent'}" in evaluate
    assert "seed=1" in train and "seed=1" in evaluate and "episodes=5" in evaluate


def test_table1_evaluates_and_trains_agents(tmp_path):
    more = '+columns.recurrent_mine=["agent=recurrent","recipe=ts_distill"]'
    cfg = load("table1", f"out={tmp_path}", "split=val_unseen_ogn", more)
    records = {cell.column: [args for _, args in cell.commands(cfg)] for cell in tables.cells(cfg)}
    (plain,), (shipped,) = records["recurrent"], records["recurrent_da"]
    train, hardened = records["recurrent_mine"]
    assert "checkpoint=checkpoints/recurrent/teacher" in shipped
    assert "agent=recurrent" in plain and not any(a.startswith("checkpoint=") for a in plain)
    assert {"agent=recurrent", "recipe=ts_distill"} <= set(train)
    weights = tmp_path / "cells" / "recurrent_mine-seed0" / "run" / "agent"
    assert {"agent=recurrent", f"checkpoint={weights}", "split=val_unseen_ogn"} <= set(hardened)
    assert any(a.startswith("conditions=[clean,motion_blur,") and "black_box" in a for a in plain)


@pytest.mark.parametrize(
    "option", ["suite=quick", "conditions=[clean,low_light_noise,missing_data]"]
)
def test_evaluations_can_be_selected(tmp_path, option):
    cfg = load("table1", f"out={tmp_path}", option)
    for cell in tables.cells(cfg):
        assert "conditions=[clean,low_light_noise,missing_data]" in cell.commands(cfg)[-1][1]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("option", "message"),
    [
        ('+evaluations.mine=["suite=unsen"]', "Evaluation mine: .*unseen"),
        ('+evaluations.mine=["conditions=[hase]"]', "Evaluation mine: .*Did you mean haze?"),
        ('+evaluations.mine=["severity=2"]', "Evaluation mine: Severity must be"),
        ("+evaluations.mine=pairs", "evaluations.mine=pairs must be a list of options"),
        ('+evaluations.mine=["restore=nope"]', "Evaluation mine: There is no restorer at nope"),
        ('+evaluations.mine=["safeguard=nope"]', "Evaluation mine: There is no safeguard 'nope'"),
        ('+evaluations.mine=["safeguard=reader+none"]', "mine: There is no safeguard"),
        (
            '+evaluations.mine=["out=x"]',
            "Evaluation mine: out=x is set by the table.* from its columns",
        ),
        ('+evaluations.mine=["name=x"]', "Evaluation mine: name=x is set by the table"),
        ('+evaluations.mine=["seed=5"]', "Evaluation mine: seed=5 is set by the table"),
        ('+evaluations.mine=["checkpoint=x"]', "Evaluation mine: checkpoint=x is set by the table"),
        ('+evaluations.mine=["agent=recurrent"]', "Evaluation mine: agent=recurrent is set by the"),
        ("+evaluations.mine=[1]", "evaluations.mine=.1. must be a list of options"),
        ('+columns.mine=["restore=nope"]', "Column mine: There is no restorer at nope"),
        (
            '+columns.mine=["restore=checkpoints/restorer:pose"]',
            "Column mine: There is no weights folder .*Did you mean checkpoints/restorer?",
        ),
        ('+columns.mine=["safeguard=clasifier"]', "Column mine: .*Did you mean classifier?"),
        ('+columns.mine=["agent=recurent"]', "Column mine: .*Did you mean recurrent?"),
        ('+columns.mine=["recipe=harden","agent.sze=3"]', "Column mine: .*agent.size?"),
        ("+columns.mine=recurrent", "columns.mine=recurrent must be a list of options"),
        ('+columns.mine=["recipe=harden","severity=7"]', "Column mine: severity must be from 0"),
        ('+columns.mine=["recipe=harden","trainer.precision=fp8"]', "Column mine: .*fp32"),
        ('+columns.mine=["recipe=harden","seed=3"]', "Column mine: seed=3 is set by the table"),
        (
            '+columns.mine=["severity=0.9"]',
            "Column mine: severity=0.9 is set by the table, the",
        ),
        ('train=["folder=x"]', "folder=x is set by the table, which gives each cell a seed"),
        ('train=["workers=4"]', "workers=4 is set by the table"),
        ('train=["evaluation.episodes=3"]', "evaluation.episodes=3 is set by the table"),
        ("seeds=[0,1,0]", r"seeds must be different, got \[0, 1, 0\]"),
        ("split=val_unsen", "no split 'val_unsen'. Did you mean val_unseen?"),
        ("conditions=[clen]", "no condition 'clen'. Did you mean clean?"),
    ],
)
def test_error_is_reported_once_before_any_cell_runs(tmp_path, monkeypatch, option, message):
    monkeypatch.setattr(tables, "_make_cells", lambda output, cfg: pytest.fail("cells are run"))
    cfg = load("table1", f"out={tmp_path / 'out'}", option, *less("table1", KEPT))
    with pytest.raises(ValueError, match=message):
        tables.make_table(cfg)
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_column_with_changed_options_is_rejected_with_rows(tmp_path, quick):
    cfg = config(tmp_path, seeds=[0])
    finished(cfg)
    tables.make_table(cfg)
    tables.make_table(cfg)
    changed = config(tmp_path, seeds=[0], columns={"base": ["checkpoint=checkpoints/teacher"]})
    with pytest.raises(ValueError, match=r"base-seed0 holds rows of an agent .* another out="):
        tables.make_table(changed)
    with pytest.raises(ValueError, match=r"da_per_frame-seed0 holds rows"):
        tables.make_table(config(tmp_path, seeds=[0], train=["severity=0.4"]))


def test_walks_of_what_is_no_column_are_told(tmp_path, capsys):
    assert tables.draw_walks(config(tmp_path, walks=["base", "stacked"]), tmp_path) == []
    assert "no pictures of episodes: stacked in walks= is not a column" in capsys.readouterr().out


@pytest.mark.slow
def test_undefined_or_partial_score_is_marked(tmp_path, quick):
    cfg = config(tmp_path, seeds=[0])
    finished(cfg)
    failed, part = (cell.evaluation / "rows.jsonl" for cell in tables.cells(cfg))
    rows.write(failed, [{**row, "success": 0} for row in rows.read(failed)])
    two = [row for row in rows.read(part) if row["corruption"] in ("clean", "flare")]
    rows.write(part, two, fewer=True)
    report = tables.make_table(cfg).read_text(encoding="utf-8")
    assert "| undefined ‡ (" in report or "| undefined ‡ |" in report
    assert "† 1/8" in report


@pytest.mark.slow
@pytest.mark.parametrize(
    "table, split, suite",
    [
        ("routes", "val_unseen", "all"),
        ("objects", "val_unseen_ogn", "all"),
        ("routes_ablations", "val_unseen", "clean"),
        ("objects_ablations", "val_unseen_ogn", "clean"),
    ],
)
def test_table1_columns_are_agents_or_trainings(table, split, suite):
    cfg = load("table1", f"table={table}")
    assert (cfg.split, cells.measured(cfg)[0]) == (split, "clean")
    for cell in tables.cells(cfg):
        node = conf.load_config("train" if cell.trains else "evaluate", cell.options)
        blind = cell.column.partition("_no_")[2]
        assert list(node.agent.blind) == [blind] * bool(blind)
        kind = Path(node.weights.base).parts[1]  # checkpoints/base, checkpoints/recurrent/base
        assert cell.column.startswith("topological" if kind == "base" else kind)
        if "ogn" not in split:
            assert node.env.split == split, "an agent that follows no routes"


@pytest.mark.slow
def test_report_has_pooled_seeds_and_paper_figures(tmp_path, quick):
    cfg = config(tmp_path)
    finished(cfg)
    report = tables.make_table(cfg).read_text(encoding="utf-8")
    lines = {line.split(" | ")[0].strip("| "): line for line in report.splitlines()}
    assert lines["Corruption"] == "| Corruption | base | da_per_frame |"
    assert "40.0 (52)" in lines["Motion blur"]  # the paper reports 52 for per-frame augmentation
    assert lines["Seeds"] == "| Seeds | 0 1 | 0 1 |"
    assert lines["Clean SR"] == "| Clean SR | 70.0 | 70.0 |"  # 80 and 60


@pytest.mark.slow
def test_report_can_be_rebuilt_from_rows_only(tmp_path, quick):
    cfg = config(tmp_path / "all")
    finished(cfg)
    whole = tables.make_table(cfg).read_text(encoding="utf-8").splitlines()
    again = config(tmp_path / "again", rows=[str(c.folder) for c in tables.cells(cfg)])
    report = tables.make_table(again).read_text(encoding="utf-8").splitlines()
    assert report == whole
    assert not (tmp_path / "again" / "cells").exists()


@pytest.mark.slow
def test_further_evaluations_are_measured_and_reported_apart(tmp_path, quick, monkeypatch):
    """Each evaluation uses the options of the table and its own options, and its rows are stored
    separately."""
    measured = tables.Cell.measurement
    cfg = load("table2", f"out={tmp_path}", "seeds=[0]", "evaluations=beyond", "episodes=7")
    cfg.columns = {name: cfg.columns[name] for name in ("base", "restored")}
    plain, restored = tables.cells(cfg)
    mild = measured(plain, cfg, "severity_02", cfg.evaluations["severity_02"])
    node = conf.load_config("evaluate", mild)
    assert (node.severity, node.episodes, node.name) == (0.2, 7, "base")
    assert node.out != str(plain.evaluation) and len(node.suite.conditions) == 13
    node = conf.load_config("evaluate", measured(restored, cfg, "", ["conditions=[clean]"]))
    assert (node.name, node.restore, node.episodes) == ("base", "checkpoints/restorer", 7)

    for cell, name in ((plain, "base"), (restored, "base+restorer")):
        records = column(8, ALL, name=name, agent=cell.column)
        rows.write(cell.evaluation / "rows.jsonl", records)
        rows.write(
            cell.evaluation_folder("severity_02") / "rows.jsonl", records[: len(records) // 2]
        )
    report = tables.make_table(cfg).read_text(encoding="utf-8")
    apart = (tmp_path / "severity_02" / "table.md").read_text(encoding="utf-8")
    assert "| base | base+restorer |" in report and "| base | base+restorer |" in apart
    assert "Missing cells" in apart and "Missing cells" not in (tmp_path / "table.md").read_text()
    assert not (tmp_path / "pairs").exists(), "without rows there is no report"


@pytest.mark.parametrize(
    ("table", "requests", "walked"),
    [(3, "150", 3), (200, "150", 150), (3, "null", 3), (None, "150", 150), (None, "null", None)],
)
def test_additional_evaluation_limits_episodes(tmp_path, table, requests, walked):
    cfg = config(tmp_path, episodes=table)
    measured = tables.cells(cfg)[0].measurement(cfg, "mine", [f"episodes={requests}"])
    assert conf.load_config("evaluate", measured).episodes == walked


@pytest.mark.slow
def test_null_column_or_evaluation_is_left_out(tmp_path):
    null = ["columns.base=null", "evaluations.pairs=null", "+evaluations.mine=null"]
    # fewer columns, because composing and checking the options of each column takes time
    columns = less("table2", ["base", "da_per_frame"])
    cfg = load("table2", f"out={tmp_path}", "evaluations=beyond", *null, *columns)
    output = tables.cells(cfg)
    cells.check(output, cfg)
    assert "base" not in {cell.column for cell in output}
    kinds = [kind for kind, _ in output[0].commands(cfg)]
    assert "evaluate unseen" in kinds and not {"evaluate pairs", "evaluate mine"} & {*kinds}
    rows.write(output[0].evaluation_folder("pairs") / "rows.jsonl", column(8, ALL))
    assert tables.write_additional_reports(output, cfg, tmp_path) == []
    with pytest.raises(ValueError, match="columns.* must not be empty"):
        tables.cells(replace(cfg, columns=dict.fromkeys(cfg.columns)))


def test_cell_is_trained_once_and_measured_per_evaluation(tmp_path):
    cfg = config(tmp_path)
    cfg.evaluations = {"pairs": ["suite=pairs"]}
    kinds = [[kind for kind, _ in cell.commands(cfg)] for cell in tables.cells(cfg)[:2]]
    assert kinds == [["evaluate", "evaluate pairs"], ["train", "evaluate", "evaluate pairs"]]


@pytest.mark.slow
def test_failed_cell_does_not_lose_the_others(tmp_path, quick, monkeypatch):
    cfg = config(tmp_path)
    finished(cfg)
    broken = tables.cells(cfg)[-1]
    # the training run of this cell fails before it writes rows
    (broken.evaluation / "rows.jsonl").unlink()
    monkeypatch.setattr(
        tables.Cell,
        "commands",
        lambda self, cfg: [
            ("train", ["no_such_module"] if self == broken else ["timeit", "-n", "1", "pass"])
        ],
    )
    with pytest.raises(ValueError, match=f"{broken.column}, seed {broken.seed}: train ended with"):
        tables.make_table(cfg)
    report = (tmp_path / tables.REPORT).read_text(encoding="utf-8")
    assert "| Seeds | 0 1 | 0 |" in report


def test_empty_table_is_rejected(tmp_path):
    with pytest.raises(ValueError, match="must not be empty"):
        tables.cells(config(tmp_path, seeds=[]))


def test_rows_of_another_severity_are_told(tmp_path):
    cfg = config(tmp_path, severity=0.9)
    rows.write(tmp_path / "cells" / "rows.jsonl", column(8, ALL))
    cfg = replace(cfg, rows=[str(tmp_path / "cells")])
    with pytest.raises(ValueError, match="only of val_unseen at 0, val_unseen at 0.6"):
        tables.make_table(cfg)


def test_clean_rows_alone_make_a_report(tmp_path):
    """A table may have no corrupted rows, as in the tables of ablations."""
    rows.write(tmp_path / "rows.jsonl", column(8, {}))
    cfg = config(tmp_path / "out", rows=[str(tmp_path / "rows.jsonl")])
    report = tables.make_table(cfg).read_text(encoding="utf-8")
    assert "clean only" in report and "| Clean SR | 80.0 |" in report


def test_paper_figures_appear_only_at_their_severity(tmp_path):
    rows.write(tmp_path / "rows.jsonl", column(8, ALL, name="da_per_frame", severity=0.9))
    cfg = config(tmp_path / "out", severity=0.9, rows=[str(tmp_path / "rows.jsonl")])
    lines = tables.make_table(cfg).read_text(encoding="utf-8").splitlines()
    assert "| Motion blur | 40.0 |" in lines


@pytest.mark.slow
def test_trajectories_show_episodes_won_back_by_the_last_agent(tmp_path, quick, monkeypatch):
    """Make every cell use the base agent's weights, so that a test takes seconds."""
    monkeypatch.setattr(tables.Cell, "agent", ())
    cfg = config(tmp_path, walks=["base", "da_per_frame"], episodes=2, seeds=[0])
    ids = [
        episode.episode_id
        for episode in tables.episodes(conf.load_config("evaluate").env, cfg.split, 2)
    ]
    for cell, wins in zip(tables.cells(cfg), ("10", "11"), strict=True):
        output = [
            row(i, won == "1", name=cell.column, corruption=c, severity=0.6 * (c != "clean"))
            for c in ("clean", "flare")
            for i, won in zip(ids, wins, strict=True)
        ]
        others = row("of-a-longer-run", True, name=cell.column)
        rows.write(cell.folder / "evaluation" / "rows.jsonl", [*output, others])
    tables.make_table(cfg)
    assert [p.name for p in (tmp_path / "pictures").iterdir()] == [f"{ids[1]}-flare.png"]


def test_trajectories_use_the_input_guard_of_the_table(tmp_path, monkeypatch):
    """The name of each agent equals the name in its rows."""
    cfg = config(tmp_path, seeds=[0], episodes=1, walks=["base", "restored"])
    restored = ["name=base", "restore=checkpoints/restorer:rgb", "safeguard=rules"]
    cfg.columns = {"base": [], "restored": restored}
    (episode,) = tables.episodes(conf.load_config("evaluate").env, cfg.split, 1)
    names = "base", "base+classifier+restorer-rgb"
    for cell, name in zip(tables.cells(cfg), names, strict=True):
        for corruption in ("clean", "flare", "black_box"):
            at = {"corruption": corruption, "severity": 0.6 * (corruption != "clean")}
            output = row(
                episode.episode_id, name != "base" or corruption == "flare", name=name, **at
            )
            rows.append(cell.evaluation / "rows.jsonl", [output])
    walked = []

    def run_episode(agent, world, episode, met, seed, guards):
        world.reset(episode)
        walked.append((met.name, guards.begin(start_of(agent, episode, met, seed)), guards.frames))
        return {"success": 1}

    monkeypatch.setattr(trajectories, "run_episode", run_episode)
    tables.draw_walks(cfg, tmp_path)
    plain, attacked, repaired = walked
    text = episode.instruction.text
    assert plain == ("clean", text, ())
    assert attacked[0] == "black_box" and attacked[1] != text and attacked[2] == ()
    assert repaired == ("black_box", text, ("rgb",))


def test_trajectories_need_the_agents_cells(tmp_path):
    assert tables.draw_walks(config(tmp_path), tmp_path) == []


def test_cell_is_measured_in_its_training_world(tmp_path):
    cfg = load("table2", f"out={tmp_path}", 'train=["env.size=32"]')
    cfg.columns = {"mine": ["recipe=da_per_episode", "env.rule=etpnav", "severity=0.9"]}
    (_, train), (_, evaluate) = tables.cells(cfg)[0].commands(cfg)
    assert {"env.size=32", "env.rule=etpnav"} <= {*train} & {*evaluate}
    assert "severity=0.9" in train and "severity=0.6" in evaluate


def test_column_may_have_user_configs(tmp_path):
    cfg = load("table2", f"out={tmp_path}")
    cfg.columns = {"mine": ["--config-dir=mine", "recipe=own"]}
    commands = tables.cells(cfg)[0].commands(cfg)
    assert all("--config-dir=mine" in words for _, words in commands)


@pytest.mark.slow
def test_cell_without_a_whole_row_shows_its_error(tmp_path, quick, monkeypatch):
    cfg = config(tmp_path, seeds=[0])
    finished(cfg)
    broken = tables.cells(cfg)[-1]
    monkeypatch.setattr(
        tables.Cell,
        "commands",
        lambda self, cfg: [
            ("train", ["no_such_module"] if self == broken else ["timeit", "-n", "1", "pass"])
        ],
    )
    for left in ("", '{"agent": "abc'):
        (broken.evaluation / "rows.jsonl").write_text(left)
        with pytest.raises(ValueError, match=f"{broken.column}, seed 0: train ended with"):
            tables.make_table(cfg)


@pytest.mark.slow
def test_run_names_cells_whose_rows_are_lost(tmp_path, quick):
    cfg = config(tmp_path)
    finished(cfg)
    (tables.cells(cfg)[1].evaluation / "rows.jsonl").unlink()
    with pytest.raises(ValueError, match="da_per_frame, seed 0: its rows in .* were removed"):
        tables.make_table(cfg)
