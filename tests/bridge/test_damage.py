"""Tests that an error names the damaged file of a finished run, and that no row is lost."""

import json
import os
import shutil
import sys

import pytest

from mitigate.bridge import results
from mitigate.bridge.cell import read_done
from mitigate.bridge.condition import Subset
from mitigate.bridge.events import write_event
from mitigate.core.files import sha256
from mitigate.core.output import FolderLostError
from mitigate.evaluation import rows

PROGRAM = """
import numpy, sys, mitigate_hook
for _, name in mitigate_hook.wanted([("", name) for name in "abc"]):
    episode = mitigate_hook.connect(name, instruction="Go to the door.")
    episode.corrupt({"rgb": numpy.full((8, 8, 3), 90, "uint8")})
    episode.finish(success=name == "a", distance_to_goal=1.0)
"""
CONDITION = "conditions/low_light-s0.6"


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A folder with the program and its finished run, shared by all tests in this file."""
    return tmp_path_factory.mktemp("finished")


@pytest.fixture
def finished(run, place):
    """A finished run with two conditions: its folder, and a function that runs it again.

    The run is executed for the first test; each test gets a copy of its folder.
    """
    out, remaining = place / "o", place / "kept"

    def again(options="conditions=[low_light]"):
        return run(out, options, f"{sys.executable} {place / 'nav.py'}")

    if not remaining.exists():
        (place / "nav.py").write_text(PROGRAM)
        assert not again().stderr
        shutil.copytree(out, remaining)
    else:
        shutil.rmtree(out)
        shutil.copytree(remaining, out)
    return out, again


def contents(folder):
    """Return every file in a folder with its bytes, except locks."""
    files = (path for path in folder.rglob("*") if path.is_file() and path.name != "lock")
    return {path.relative_to(folder): path.read_bytes() for path in files}


def with_damaged_line(data, number):
    """Return ``data`` (the bytes of a file) with line ``number`` damaged."""
    lines = data.splitlines(keepends=True)
    lines[number - 1] = b"[" + lines[number - 1][1:]
    return b"".join(lines)


@pytest.mark.parametrize("number", [1, 4, -1])
def test_run_rejects_damaged_event_line_and_changes_nothing(finished, number):
    out, again = finished
    events = out / CONDITION / "events.jsonl"
    count = len(events.read_bytes().splitlines())
    number = number if number > 0 else count
    events.write_bytes(with_damaged_line(events.read_bytes(), number))
    before = contents(out)
    result = again()
    assert result.returncode == 1 and f"{events}: line {number} is damaged" in result.stderr
    assert f"move {out / CONDITION} out of" in result.stderr and contents(out) == before


@pytest.mark.parametrize("cut", [1, 40])
def test_run_rejects_events_cut_after_the_condition_finished(finished, cut):
    out, again = finished
    events = out / CONDITION / "events.jsonl"
    events.write_bytes(events.read_bytes()[:-cut])
    before = contents(out)
    result = again()
    assert (
        result.returncode == 1
        and f"{events}: its size or sha256 differs" in result.stderr
        and contents(out) == before
    )


def test_run_rejects_events_in_which_a_result_changed(finished):
    out, again = finished
    events = out / CONDITION / "events.jsonl"
    text = events.read_text()
    assert text.count('"success": 0') > 0
    events.write_text(text.replace('"success": 0', '"success": 1', 1))
    result = again()
    assert result.returncode == 1 and "its size or sha256 differs" in result.stderr


def test_run_rejects_damage_in_another_condition(finished):
    out, again = finished
    events = out / CONDITION / "events.jsonl"
    events.write_bytes(with_damaged_line(events.read_bytes(), 2))
    before = contents(out)
    result = again("conditions=[clean]")
    assert (
        result.returncode == 1 and "line 2 is damaged" in result.stderr and contents(out) == before
    )


@pytest.mark.parametrize("text", ["[]", "null", '"x"', "3", "true", "{", "", "\udcff"])
def test_run_rejects_a_marker_that_is_not_an_object(finished, text):
    out, again = finished
    marker = out / CONDITION / "done.json"
    marker.write_text(text, errors="surrogateescape")
    before = contents(out)
    for options in ("conditions=[low_light]", "conditions=[clean]"):
        result = again(options)
        assert result.returncode == 1 and f"{marker} " in result.stderr and contents(out) == before


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("episodes_told", "3"),
        ("episodes_told", True),
        ("severity", None),
        ("files", []),
        ("events", None),
        ("repeat", -1),
    ],
)
def test_run_rejects_a_marker_with_an_invalid_entry(finished, name, value):
    out, again = finished
    marker = out / CONDITION / "done.json"
    marker.write_text(json.dumps(json.loads(marker.read_text()) | {name: value}))
    result = again()
    assert result.returncode == 1 and f"{marker}: {name} must be" in result.stderr


@pytest.mark.parametrize("options", ["conditions=[low_light,flare]", "conditions=[clean]"])
@pytest.mark.parametrize("copied", [False, True])
def test_run_rejects_the_folder_of_another_condition(finished, options, copied):
    out, again = finished
    other = out / "conditions" / "flare-s0.6"
    (shutil.copytree if copied else os.rename)(out / CONDITION, other)
    before = contents(out)
    result = again(options)
    assert result.returncode == 1 and f"{other} holds the condition low_light-s0.6" in result.stderr
    assert f"move {other} out of" in result.stderr and contents(out) == before


@pytest.mark.parametrize(
    ("entry", "reason"),
    [
        ({"condition": "flare"}, "holds the condition flare-s0.6"),
        ({"severity": 0.3}, "holds the condition low_light-s0.3"),
        ({"repeat": 1}, "holds the condition low_light-s0.6-again1"),
        ({"episodes_told": 2}, "3 episodes ended, and done.json records 2"),
        ({"events": {"bytes": 5}}, "its size or sha256 differs from that in done.json"),
    ],
)
def test_run_rejects_a_changed_entry_of_a_marker(finished, entry, reason):
    out, again = finished
    marker = out / CONDITION / "done.json"
    marker.write_text(json.dumps(json.loads(marker.read_text()) | entry))
    before = contents(out)
    result = again()
    assert result.returncode == 1 and reason in result.stderr and contents(out) == before


def test_run_rejects_another_condition_in_the_folder_of_clean(finished):
    out, again = finished
    marker = out / "conditions" / "clean" / "done.json"
    marker.write_text(json.dumps(json.loads(marker.read_text()) | {"condition": "flare"}))
    result = again()
    assert result.returncode == 1 and "clean holds the condition flare-s0" in result.stderr


def test_run_measures_a_moved_condition_again(finished, tmp_path):
    out, again = finished
    content = rows.read(out / "rows.jsonl")
    (out / CONDITION).rename(tmp_path / "aside")
    result = again()
    assert not result.stderr and "low_light-s0.6: started" in result.stdout
    assert rows.read(out / "rows.jsonl") == content


def test_run_keeps_rows_without_a_finished_condition(finished, tmp_path):
    out, again = finished
    (out / CONDITION).rename(tmp_path / "aside")
    before = (out / "rows.jsonl").read_bytes()
    result = again("conditions=[clean]")
    assert result.returncode == 1 and "The results of 6 of them are no longer in" in result.stderr
    assert (out / "rows.jsonl").read_bytes() == before


def test_run_copies_rows_that_leave_the_table(finished):
    out, again = finished
    before = (out / "rows.jsonl").read_bytes()
    marker = out / CONDITION / "done.json"
    marker.write_text(json.dumps(json.loads(marker.read_text()) | {"seed": 7}))
    result = again("conditions=[flare]")
    assert not result.stderr and "are now only in" in result.stdout
    assert (out / "rows.jsonl.before").read_bytes() == before


@pytest.mark.parametrize("other", [{"agent": "abc"}, {"seed": 9}, {"split": "elsewhere"}])
def test_run_copies_rows_of_another_agent_seed_or_split(finished, other):
    out, again = finished
    content = rows.read(out / "rows.jsonl")
    rows.write(out / "rows.jsonl", [*content, content[-1] | other])
    before = (out / "rows.jsonl").read_bytes()
    result = again()
    assert not result.stderr and f"another {next(iter(other))}" in result.stdout
    assert (out / "rows.jsonl.before").read_bytes() == before
    assert rows.read(out / "rows.jsonl") == content


def test_run_judges_the_same_episodes_by_another_rule(finished):
    out, again = finished
    result = again("conditions=[low_light] rule=etpnav")
    assert not result.stderr, result.stderr
    assert len(rows.read(out / "rows.jsonl")) == 6 and not list(out.glob("*.before*"))


def test_read_ignores_an_incomplete_last_line(tmp_path):
    write_event(tmp_path, event="hello")
    with open(tmp_path / "events.jsonl", "a") as file:
        file.write('{"event": "bye"')
    assert results.read(tmp_path).connected == 1
    write_event(tmp_path, event="bye")
    with pytest.raises(ValueError, match="line 2 is damaged"):
        results.read(tmp_path)


@pytest.mark.parametrize("line", ["null", "[]", '"x"', "{}", '{"event": 3}', '{"event": "spec"}'])
def test_read_rejects_a_line_that_is_not_an_event(tmp_path, line):
    (tmp_path / "events.jsonl").write_text(line + "\n")
    with pytest.raises(ValueError, match=r"events\.jsonl: line 1 is"):
        results.read(tmp_path)


def test_read_done_returns_none_for_an_unfinished_condition(tmp_path):
    write_event(tmp_path, event="hello")
    assert read_done(tmp_path) is None


@pytest.mark.parametrize("text", ["null", "[]", '{"episodes": 2}', '{"bound": "x", "of": 3}'])
def test_subset_rejects_a_damaged_choice(tmp_path, text):
    (tmp_path / "episodes.json").write_text(text)
    with pytest.raises(ValueError, match=r"episodes\.json"):
        Subset(2, tmp_path, settled=0).keep(["a", "b"])


@pytest.mark.parametrize("line", ["null", '"a', "7"])
def test_subset_rejects_a_damaged_name(tmp_path, line):
    (tmp_path / "episodes.txt").write_text(line + "\n")
    with pytest.raises(ValueError, match=r"episodes\.txt has a damaged line"):
        Subset(2, tmp_path, settled=0).keep(["a", "b"])


@pytest.mark.parametrize("name", ["done.json", "lock"])
def test_run_names_a_folder_in_place_of_its_files(finished, name):
    out, again = finished
    path = out / CONDITION / name
    path.unlink()
    path.mkdir()
    if name == "lock":
        (out / CONDITION / "done.json").unlink()
    result = again()
    assert result.returncode == 1 and path.is_dir()
    assert f"{path} must be a " in result.stderr and "got a folder" in result.stderr


@pytest.mark.parametrize("kind", ["link", "file"])
def test_run_keeps_finished_condition_that_cannot_be_moved(finished, tmp_path, kind):
    out, again = finished
    aside = out / "conditions/low_light-s0.6.finished"
    if kind == "link":
        aside.symlink_to(tmp_path)
    else:
        aside.write_text("mine")
    write_event(out / "conditions/clean", event="end", scene="", episode="d", steps=1, calls=1)
    clean = out / "conditions/clean/done.json"
    events = clean.parent / "events.jsonl"
    seal = {"bytes": len(events.read_bytes()), "sha256": sha256(events)}
    entries = json.loads(clean.read_text()) | {"episodes_told": 4, "events": seal}
    clean.write_text(json.dumps(entries))
    before = contents(out / CONDITION)
    # an episode of the clean condition is missing now, so the condition runs again
    result = again()
    assert result.returncode == 1 and str(aside) in result.stderr
    assert contents(out / CONDITION) == before


@pytest.mark.parametrize("how", ["os.remove(path)", "os.replace(path, path + '.old')"])
def test_run_stops_if_its_events_are_removed(run, tmp_path, how):
    program = PROGRAM.replace("import numpy", "import os, numpy")
    lines = f"    path = sys.argv[1] + '/events.jsonl'\n    if name == 'b':\n        {how}\n"
    (tmp_path / "nav.py").write_text(program + lines)
    out = tmp_path / "o"
    command = f"{sys.executable} {tmp_path / 'nav.py'} {{out}}"
    with pytest.raises(FolderLostError, match=r"events\.jsonl was removed or replaced"):
        run(out, "conditions=[clean]", command)
    assert not (out / "conditions/clean/done.json").exists()
