"""Tests that leaderboard figures match their rows, and that an evaluation reproduces them."""

from __future__ import annotations

import inspect
import json
import os
import re
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
import torch

import mitigate
from mitigate.core.observation import FORWARD, STOP
from mitigate.corruptions.registry import HALVES, unseen_names
from mitigate.evaluation import rows as result_rows
from mitigate.evaluation.grid import BLOCKS
from mitigate.evaluation.leaderboard import command
from mitigate.evaluation.leaderboard.entry import load
from mitigate.evaluation.leaderboard.figures import entry_of, rows_sha
from mitigate.evaluation.sections import sections
from mitigate.worlds.apartments.tasks import load_episodes
from mitigate.worlds.apartments.world import ApartmentsWorld
from tests.evaluation.made_rows import column
from tests.evaluation.page.test_document import page_data

ROOT = Path(__file__).parents[3]
SHIPPED = sorted((ROOT / "docs/leaderboard").rglob("*.json"))


@pytest.fixture
def rows() -> list[dict]:
    return column(8, {"spatter": 2, "missing_data": 7})


def test_entry_holds_the_figures_of_the_table(rows, tmp_path):
    entry = entry_of(rows, "base", severity=0.6, training_data="nothing", file="rows.jsonl")
    (part,) = sections(rows)
    prs = part.retained["base", "RGB", "SR"].estimate
    assert entry.scores["PRS-SR (RGB)"] == pytest.approx([prs.value, prs.low, prs.high], abs=1e-4)
    assert entry.scores["Clean SR"][0] == 0.8 and entry.SR["spatter"][0] == 0.2
    assert entry.episodes == 10 and entry.rows["count"] == 30
    assert load(entry.save(tmp_path / "base.json")) == entry
    assert [p.name for p in tmp_path.iterdir()] == ["base.json"]
    assert "PRS-SR (RGB): 0.25 [" in str(entry) and "Clean SR: 80.0 [50.0, 100.0] %" in str(entry)
    assert "SR under spatter: 20.0 [" in str(entry) and "SR under clean" not in str(entry)


def test_rows_sha_ignores_order_and_covers_values(rows):
    assert rows_sha(rows) == rows_sha(rows[::-1])
    assert rows_sha(rows) != rows_sha([rows[0] | {"spl": 0.25}, *rows[1:]])


def test_entry_of_rejects_invalid_rows(rows):
    with pytest.raises(ValueError, match="Did you mean base"):
        entry_of(rows, "bass", severity=0.6)
    with pytest.raises(ValueError, match=r"no corruption at severity 0\.5"):
        entry_of(rows, "base", severity=0.5)
    with pytest.raises(ValueError, match=r"29 of 30 rows\): it lacks some under spatter"):
        entry_of(
            [r for r in rows if r["corruption"] != "spatter" or r["episode_id"] != "3"],
            "base",
            severity=0.6,
        )
    other = [r | {"split": "val_seen"} for r in rows]
    with pytest.raises(ValueError, match="Name a split"):
        entry_of(rows + other, "base", severity=0.6)
    assert entry_of(rows + other, "base", severity=0.6, split="val_seen").split == "val_seen"
    elsewhere = [r | {"episode_id": f"{r['episode_id']}-b", "agent": "cccccc"} for r in rows]
    with pytest.raises(ValueError, match="several splits, lists.*from 0-b"):
        entry_of(rows + elsewhere, "base", severity=0.6)


def test_mean_sr_leaves_out_corrupted_instructions():
    frames = dict.fromkeys([*BLOCKS["RGB"], *BLOCKS["Depth"]], 4)
    plain = entry_of(column(8, frames), "base", severity=0.6)
    more = entry_of(column(8, frames | {"mask": 0, "black_box": 0}), "base", severity=0.6)
    assert more.scores["Mean SR"] == plain.scores["Mean SR"]
    assert "PRS-SR (Instruction)" in more.scores


def test_mean_sr_of_some_frames_leaves_out_instructions():
    rgb, words = dict.fromkeys(BLOCKS["RGB"], 4), {"mask": 0, "black_box": 0}
    plain, more, alone = (
        entry_of(column(8, met), "base", severity=0.6) for met in (rgb, rgb | words, words)
    )
    assert more.scores["Mean SR"] == plain.scores["Mean SR"] != alone.scores["Mean SR"]


def test_half_of_unseen_corruptions_has_its_name():
    halves = {half: unseen_names("rgb", half=half) for half in HALVES}
    test = entry_of(column(5, dict.fromkeys(halves["test"], 3)), "base", severity=0.6)
    assert "PRS-SR (unseen RGB, test)" in test.scores and "PRS-SR (unseen RGB)" not in test.scores
    every = dict.fromkeys([*halves["test"], *halves["validation"]], 3)
    both = entry_of(column(5, every), "base", severity=0.6).scores
    assert {"PRS-SR (unseen RGB)", "PRS-SR (unseen RGB, test)"} <= both.keys()


def test_check_reports_wrong_figures_hashes_and_missing_rows(rows, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    result_rows.write("rows.jsonl.gz", rows)
    add = ["add", "rows.jsonl.gz", "--name", "base", "--folder", "entries"]
    assert command.main(add) == 0 and command.main(["check", "entries"]) == 0
    assert command.main(add) == 2 and "--overwrite" in capsys.readouterr().err
    entry = load("entries/base.json")
    better = replace(entry, SR=entry.SR | {"spatter": [0.9, 0.8, 1.0]})
    better.save("entries/base.json")
    assert command.main(["check", "entries"]) == 1
    message = "entries/base.json: base, SR, spatter, is [0.9, 0.8, 1.0], but its rows say [0.2, "
    assert message in capsys.readouterr().out
    entry.save("entries/base.json")
    result_rows.write("rows.jsonl.gz", [rows[0] | {"steps": 5}, *rows[1:]])
    assert command.differences(entry, command.rows_of(entry))[0].startswith("rows, sha256, is")
    Path("rows.jsonl.gz").unlink()
    assert command.main(["check", "entries"]) == 1
    assert "not available" in capsys.readouterr().out


def test_check_continues_after_a_damaged_entry(rows, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    result_rows.write("rows.jsonl", rows)
    entry = entry_of(rows, "base", severity=0.6, file="rows.jsonl")
    entry.save("entries/whole.json")
    replace(entry, name="lost", rows=entry.rows | {"file": "é" * 180}).save("entries/lost.json")
    Path("entries/cut.json").write_text("{")
    Path("entries/folder.json").mkdir()
    Path("entries/old.json").write_text(json.dumps({**entry.__dict__, "format": 1}))
    assert command.main(["check", "entries", "nowhere.json"]) == 1
    printed = capsys.readouterr().out.splitlines()
    assert printed[:6] == [
        "entries/cut.json, not a valid entry",
        "entries/folder.json, not a valid entry",
        "entries/lost.json: lost, does NOT match its rows",
        "entries/old.json, not a valid entry",
        "entries/whole.json: base, matches its rows",
        "nowhere.json, not a valid entry",
    ]
    wrong = "entries/cut.json is truncated", "entries/folder.json", "lost, File name too long"
    for line, words in zip(printed[6:], [*wrong, "old.json: format must", "nowhere"], strict=True):
        assert words in line
    assert command.main(["check", "entries/whole.json"]) == 0


def test_rows_of_rejects_a_folder(rows, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    result_rows.write("mine/rows.jsonl", rows)
    add = ["add", "mine", "--name", "base", "--folder", "entries"]
    assert command.main(add) == 0 and command.main(["check", "entries"]) == 0
    entry = load("entries/base.json")
    assert entry.rows["file"] == "mine/rows.jsonl"
    os.mkfifo("pipe.jsonl")
    for file, words in (
        ("mine", "one file of rows, but mine is not a file"),
        (".", "one file of rows, but . is not a file"),
        ("pipe.jsonl", "one file of rows, but pipe.jsonl is not a file"),
    ):
        replace(entry, rows=entry.rows | {"file": file}).save("entries/base.json")
        assert command.main(["check", "entries"]) == 1
        assert words in capsys.readouterr().out
    result_rows.write("mine/more.jsonl", rows)
    assert command.main([*add, "--overwrite"]) == 0
    assert load("entries/base.json").rows["file"] == ""  # of several


def test_add_writes_separate_files_for_unicode_names(rows, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = ["基準", "強化", "Größe +"]
    for name in names:
        result_rows.write(f"{name}.jsonl", [row | {"name": name} for row in rows])
        add = ["add", f"{name}.jsonl", "--name", name, "--folder", "entries"]
        assert command.main(add) == 0
    files = sorted(Path("entries").iterdir())
    assert [file.name for file in files] == ["Größe.json", "基準.json", "強化.json"]
    assert [load(file).name for file in files] == ["Größe +", "基準", "強化"]
    assert command.main(["check", "entries"]) == 0


def test_show_ranks_entries_by_mean_sr(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    evil = "</script><script>alert(1)</script>"
    rows = column(8, {"spatter": 2}, name="low") + column(8, {"spatter": 7}, name=evil)
    result_rows.write("rows.jsonl", rows)
    for name, file in (("low", "a"), (evil, "b")):
        entry = entry_of(rows, name, severity=0.6, file="rows.jsonl", training_data="halls")
        entry.save(f"entries/{file}.json")
    assert command.main(["show", "entries", "--out", "page.html"]) == 0
    text = Path("page.html").read_text(encoding="utf-8")
    data, _ = page_data(text)
    assert text.count("<script") == 3
    assert [[c["label"] for c in s["columns"]] for s in data["sections"]] == [[evil, "low"]]
    assert sum("trained on halls" in note for note in data["notes"]) == 2
    unknown = json.loads(Path("entries/a.json").read_text())
    unknown["scores"]["Mean SR"] = [0.2, None, None]
    Path("entries/a.json").write_text(json.dumps(unknown))
    assert command.main(["show", "entries", "--out", "page.html"]) == 0
    Path("rows.jsonl").unlink()
    assert command.main(["show", "entries", "--out", "page.html"]) == 2
    assert "not available" in capsys.readouterr().err


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_shipped_entry_loads(path):
    entry = load(path)
    assert entry.name.replace("+", "-") == path.stem and entry.episodes in (100, 300)
    assert (ROOT / entry.rows["file"]).is_file() and (ROOT / entry.link).exists()


@pytest.mark.slow
def test_shipped_entry_matches_its_rows_and_a_rerun(tmp_path, monkeypatch):
    """The rerun evaluates two episodes with the shipped weights, clean and with missing depth."""
    entry = load(ROOT / "docs/leaderboard/base.json")
    message = command.rows_of(entry)
    assert command.differences(entry, message) == []
    monkeypatch.chdir(tmp_path)
    options = {"episodes": 2, "suite": ["missing_data"], "workers": 1, "out": "again"}
    matches = mitigate.benchmark("checkpoints/base", name=entry.name, **options)
    again = result_rows.read("again/rows.jsonl")
    own_value = [r for r in message if r["seed"] == 0 and r["name"] == entry.name]
    index = {(r["episode_id"], r["corruption"]): r for r in own_value}
    assert len(again) == 4 and {r["agent"] for r in again} == {entry.agents[0]["agent"]}
    for row in again:
        before = index[row["episode_id"], row["corruption"]]
        changed = {key for key in before if before[key] != row[key]}
        assert not changed, (row, before)
    assert (matches.suite, matches.rule, matches.sensors) == (
        entry.suite,
        entry.rule,
        entry.sensors,
    )


class Straight:
    """An agent that takes one step and stops, without reading a frame."""

    def reset(self, instruction: str) -> None:
        self.left = 1

    def act(self, observation) -> int:
        self.left -= 1
        return FORWARD if self.left >= 0 else STOP


def test_benchmark_prints_an_estimate_and_resumes(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    options = {"episodes": 2, "suite": ["flare"], "workers": 1, "training_data": "none"}
    options["options"] = ["env.size=16"]
    entry = mitigate.benchmark(Straight(), **options)
    printed = capsys.readouterr().out
    assert "2 episodes x 2 conditions = 4 episodes" in printed and "1 process: about" in printed
    assert entry.name == "Straight" and entry.SR.keys() == {"clean", "flare"}
    assert entry.sensors[0] == "rgb: 12 views of 16 x 16 x 3 uint8, 90 degrees wide"
    rows = Path(entry.rows["file"])
    before = rows.read_bytes()
    assert mitigate.benchmark(Straight(), **options) == entry and rows.read_bytes() == before
    assert command.differences(entry, command.rows_of(entry)) == []
    json.dumps(entry.scores, allow_nan=False)


def test_benchmark_refuses_what_measures_nothing():
    with pytest.raises(ValueError, match="has no effect"):
        mitigate.benchmark(Straight(), suite="clean")
    with pytest.raises(ValueError, match="Did you mean flare"):
        mitigate.benchmark(Straight(), suite=["flair"])


def test_check_compares_only_the_rows_of_the_entry(rows):
    entry = entry_of(rows, "base", severity=0.6)
    more = [r | {"seed": 1} for r in rows] + [r | {"corruption": "flare"} for r in rows[10:20]]
    assert command.differences(entry, [*rows, *more]) == []
    with pytest.raises(ValueError, match="hold no results of 0123456789ab with seed 0"):
        command.differences(entry, [r | {"seed": 1} for r in rows])


def test_check_warns_of_rows_that_an_entry_omits(rows, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    more = [r | {"seed": 1, "agent": "cccccc"} for r in rows]
    other = [r | {"name": "other"} for r in more] + [r | {"split": "val_seen"} for r in more]
    milder = [r | {"severity": 0.3, "corruption": "flare"} for r in rows[10:20]]
    result_rows.write("rows.jsonl", [*rows, *other, *milder])
    chosen = [r for r in rows if r["corruption"] != "spatter"]
    entry_of(rows, "base", severity=0.6, file="rows.jsonl").save("a.json")
    entry_of(chosen, "base", severity=0.6, file="rows.jsonl").save("b.json")
    assert command.main(["check", "a.json"]) == 0 and "WARNING" not in capsys.readouterr().out
    result_rows.write("rows.jsonl", [*rows, *other, *more, *milder])
    assert command.main(["check", "a.json", "b.json"]) == 0
    assert capsys.readouterr().out.splitlines() == [
        "a.json: base, matches its rows",
        "a.json: base, WARNING: its rows also hold seed 1 (agent cccccc)",
        "b.json: base, matches its rows",
        "b.json: base, WARNING: its rows also hold seed 1 (agent cccccc), spatter",
    ]


def test_add_writes_the_sensors_it_is_given(rows, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    result_rows.write("rows.jsonl", rows)
    sensors = ["rgb: 64 x 64 x 3 uint8", "depth: 64 x 64 x 1 float32, m"]
    add = ["add", "rows.jsonl", "--name", "base", "--folder", "entries", "--sensors", *sensors]
    assert command.main(add) == 0
    assert load("entries/base.json").sensors == tuple(sensors)
    assert command.main(["check", "entries/base.json", "entries/base.json"]) == 0
    for wrong, words in (
        (["add", "--name", "base"], "required: ROWS"),
        ([*add, "--no-such", "x"], "unrecognized arguments: --no-such"),
    ):
        with pytest.raises(SystemExit):
            command.main(wrong)
        assert words in capsys.readouterr().err


def test_add_writes_only_valid_entries(rows, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    result_rows.write("rows.jsonl", rows)
    before = {p.name: p.read_bytes() for p in tmp_path.iterdir()}
    add = ["add", "rows.jsonl", "--name", "base", "--folder", "."]
    for wrong in (["--training-data", "x" * 2001], ["--link", "\u202e"]):
        assert command.main([*add, *wrong]) == 2
        assert f"{wrong[0][2:].replace('-', '_')} must be valid" in capsys.readouterr().err
    assert command.main(["show", "--out", "rows.jsonl"]) == 2
    assert "must end in .html" in capsys.readouterr().err
    assert {p.name: p.read_bytes() for p in tmp_path.iterdir()} == before


class Pupil(Straight):
    """An agent whose weights are in a network attribute."""

    def __init__(self, weight: float) -> None:
        self.net = torch.nn.Linear(1, 1)
        torch.nn.init.constant_(self.net.weight, weight)
        self.net.bias.data.zero_()


def test_benchmark_hashes_networks_and_reports_unreadable_state(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    options = {"episodes": 1, "suite": ["flare"], "workers": 1, "options": ["env.size=16"]}
    first = mitigate.benchmark(Pupil(1), **options)
    assert mitigate.benchmark(Pupil(1), **options) == first
    assert "settings()" not in capsys.readouterr().out
    second = mitigate.benchmark(Pupil(2), **options)
    assert "All attributes of a Pupil count" in capsys.readouterr().out
    assert second.agents != first.agents and second.rows["sha256"] != first.rows["sha256"]
    for entry in (first, second):
        assert command.differences(entry, command.rows_of(entry)) == []
    described = Straight()
    described.settings = {"speed": 1}  # ``settings`` may be a dict instead of a method
    capsys.readouterr()
    assert mitigate.benchmark(described, **options).agents != first.agents
    assert "settings()" not in capsys.readouterr().out


class Dark(ApartmentsWorld):
    """Shows depth alone."""

    def __init__(self) -> None:
        super().__init__(16)
        del self.sensors["rgb"]


@pytest.mark.slow
def test_benchmark_runs_the_script_of_the_page(tmp_path):
    """The script defines the agent, and calls ``benchmark`` without ``if __name__ == "__main__"``.
    It runs from a file and with ``python -c``."""
    script = (
        "import mitigate\n"
        f"{inspect.getsource(Straight)}"
        "FORWARD, STOP = 1, 0\n"
        "made = mitigate.benchmark(Straight(), episodes=40, suite=['flare'],\n"
        "                          options=['env.size=8'])\n"
        "print('reached', made.episodes)\n"
    )
    (tmp_path / "mine.py").write_text(script, encoding="utf-8")
    for call, name in ((["mine.py"], "file"), (["-c", script], "typed")):
        done = subprocess.run(
            [sys.executable, *call],
            cwd=tmp_path,
            env={**os.environ, "PYTHONPATH": str(ROOT), "PYTHON_CPU_COUNT": "2"},
            capture_output=True,
            text=True,
        )
        assert "reached 40" in done.stdout, (name, done.stderr)
        shutil.rmtree(tmp_path / "runs")


class OneCamera(Straight):
    views = 1


@pytest.mark.parametrize(
    ("agent", "options", "words"),
    [
        (Straight, {}, "got the class Straight"),
        (None, {}, "A NoneType cannot run episodes"),
        (lambda observation: STOP, {}, "no reset"),
        (Straight(), {"suite": "fulll"}, "no suite 'fulll'. Did you mean full?"),
        (Straight(), {"options": ["no.option=1"]}, "no.option"),
        (Straight(), {"severity": 0}, "at severity 0 has no effect"),
        (Straight(), {"name": "x" * 201}, "name must be valid, not"),
        (Straight(), {"training_data": "x" * 2001}, "training_data must be"),
        (Straight(), {"listed": []}, "listed must list at least one episode"),
        (Straight(), {"listed": ["e1"]}, "listed must contain only Episode objects, got 'e1'"),
        (Straight(), {"episodes": "2"}, "or null for the whole list, got '2'"),
        (Straight(), {"episodes": 2.0}, "or null for the whole list, got 2.0"),
        (Straight(), {"options": "env.views=1"}, "options must be a list of strings"),
        (OneCamera(), {}, "OneCamera needs 1. Set env.views=1"),
        (
            Straight(),
            {"world": ApartmentsWorld(16)},
            "a function that creates a world, got a ApartmentsWorld",
        ),
        (Straight(), {"world": Dark, "suite": ["spatter"]}, "the world Dark has only"),
        (Straight(), {"world": lambda: ApartmentsWorld(16), "workers": 2}, "set workers=1"),
    ],
)
def test_benchmark_says_what_is_wrong_before_anything_walks(
    tmp_path, monkeypatch, agent, options, words
):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ValueError, match=re.escape(words)):
        mitigate.benchmark(agent, **options)
    assert not [*tmp_path.iterdir()]


def test_entry_of_rejects_an_unfinished_seed(rows):
    half = [r | {"seed": 1, "agent": "cccccc"} for r in rows if r["episode_id"] < "5"]
    with pytest.raises(ValueError, match=r"Seed 1 of base is not finished \(15 of 30 rows\)"):
        entry_of(rows + half, "base", severity=0.6)


def test_entry_of_requires_all_rows_of_each_seed(rows):
    """Otherwise the figures of an entry would not come from the seeds that it names."""
    second = [r | {"seed": 1, "agent": "cccccc"} for r in rows]
    assert len(entry_of(rows + second, "base", severity=0.6).agents) == 2
    clean = [r for r in second if r["corruption"] == "clean"]
    with pytest.raises(ValueError, match=r"Seed 1 of base .*10 of 30.* spatter, missing_data"):
        entry_of(rows + clean, "base", severity=0.6)
    unseen = [r | {"corruption": unseen_names("rgb")[0]} for r in rows[10:20]]
    with pytest.raises(ValueError, match=rf"Seed 1 of base .*under {unseen[0]['corruption']}"):
        entry_of(rows + second + unseen, "base", severity=0.6)
    other = [r | {"agent": "dddddd"} for r in unseen]
    with pytest.raises(ValueError, match="several .* agents"):
        entry_of(rows + other, "base", severity=0.6)


def test_benchmark_reuses_only_rows_of_one_world(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    options = {"suite": ["flare"], "workers": 1, "out": "rows", "options": ["env.size=16"]}
    mitigate.benchmark(Straight(), episodes=1, **options)
    mitigate.benchmark(Straight(), episodes=2, **options)  # additional episodes of the same list
    some = load_episodes("val_unseen")[::150]
    other = [replace(episode, trajectory_id="another") for episode in some]
    with pytest.raises(ValueError, match="rows of episode .* of another list"):
        mitigate.benchmark(Straight(), listed=other, split="val_unseen", **options)


def test_benchmark_goes_on_whatever_else_episodes_carry(tmp_path, monkeypatch):
    """Two episodes count as equal if only the objects in their ``info`` differ, because the
    addresses of objects differ between processes."""
    monkeypatch.chdir(tmp_path)
    options = {"suite": ["flare"], "workers": 1, "out": "rows", "options": ["env.size=16"]}
    (episode,) = load_episodes("val_unseen")[:1]
    for carried in (object(), object()):
        info = episode.info | {"mine": carried}
        mitigate.benchmark(Straight(), listed=[replace(episode, info=info)], **options)
    note = Path("rows/walked.json")
    (known,) = json.loads(note.read_text()).values()
    (world,) = known["worlds"].values()
    older = {"world": world["its class"], "episodes": {episode.episode_id: "a" * 12}}
    note.write_text(json.dumps({"val_unseen": older}))
    mitigate.benchmark(Straight(), listed=[episode], **options)
    for other in (
        replace(episode, instruction=replace(episode.instruction, text="Wait here.")),
        replace(episode, info=episode.info | {"seed": 5}),
        replace(episode, goals=()),
    ):
        with pytest.raises(ValueError, match="rows of episode .* of another list"):
            mitigate.benchmark(Straight(), listed=[other], **options)
