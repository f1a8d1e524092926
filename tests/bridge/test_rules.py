"""Tests of success rules: which rule judges an episode, and the message if a rule cannot judge
it."""

import json
import sys

import pytest

from mitigate.bridge.results import (
    COMMON,
    OWN,
    count_missing,
    count_without_path,
    maybe_normalised,
    read,
    rows,
)
from mitigate.bridge.server import Listener
from mitigate.corruptions import CLEAN
from mitigate.worlds.measures import RULES

from .conftest import condition, python

LABEL = {"agent": "a", "name": "n", "split": "s", "seed": 0}
LOOP = """
import numpy, mitigate_hook
rgb, depth = numpy.full((8, 8, 3), 90, "u1"), numpy.full((8, 8, 1), 0.4, "f4")
for name in "ab":
    episode = mitigate_hook.connect(name, instruction="go")
    episode.corrupt({"rgb": rgb, "depth": depth})
    %s
"""


def judge(tmp_path, finish, rule):
    """Run a loop. Return (success, SPL) of the first episode for each rule, the reports, and the
    output."""
    with Listener(condition(), tmp_path) as listener:
        process = python(listener, LOOP % finish)
    reports = read(tmp_path)
    first = [row for row in rows(reports, CLEAN, LABEL, rule) if row["episode_id"] == "a"]
    return {row["rule"]: (row["success"], row["spl"]) for row in first}, reports, process.stdout


@pytest.mark.parametrize(
    ("stopped", "expected"), [("", None), (", stopped=True", 1.0), (", stopped=0", 0.0)]
)
def test_rows_need_stop_for_a_rule_with_stop(tmp_path, stopped, expected):
    finish = f"episode.finish(success=True, spl=1, distance_to_goal=0.05{stopped})"
    judged, reports, printed = judge(tmp_path, finish, "objectnav")
    assert not printed and "stopped" not in reports.ends["a"]["metrics"]
    assert judged.get(str(RULES["objectnav"]), (None,))[0] == expected
    assert count_missing(reports, "objectnav") == ({} if stopped else {"stopped": 2})
    assert count_missing(reports, "etpnav") == {}


@pytest.mark.parametrize("far", [", distance_to_goal=9.0", ""])
def test_rows_count_a_failure_without_stop(run, tmp_path, far):
    file, out = tmp_path / "nav.py", tmp_path / "o"
    success = "episode.finish(success=True, stopped=True, distance_to_goal=0.05, spl=0.9)"
    failure = f"episode.finish(success=False{far})"
    file.write_text(
        LOOP % f"{success} if name == 'a' or 'clean' in __import__('sys').argv else {failure}"
    )
    result = run(
        out, "conditions=[spatter] rule=objectnav", f"{sys.executable} {file} {{condition}}"
    )
    assert f"success 50.0 ({RULES['objectnav']})" in result.stdout, result.stderr
    result_rows = [json.loads(line) for line in (out / "rows.jsonl").read_text().splitlines()]
    for rule in (RULES["objectnav"], COMMON["text"]):
        successes = [
            r["success"]
            for r in result_rows
            if (r["rule"], r["corruption"]) == (str(rule), "spatter")
        ]
        assert sorted(successes) == [0.0, 1.0]


@pytest.mark.slow
@pytest.mark.parametrize("first", ["rule=objectnav", ""])
def test_run_rejects_a_rule_that_judges_only_some_episodes(run, tmp_path, first):
    file = tmp_path / "nav.py"
    known = "stopped=True if name == 'a' or 'clean' in __import__('sys').argv else None"
    file.write_text(LOOP % f"episode.finish(success=True, distance_to_goal=0.05, {known})")
    # at first the condition has no results; the second time it has results without the rule
    for options in (first, "rule=objectnav"):
        options = f"conditions=[spatter] {options}"
        result = run(tmp_path / "o", options, f"{sys.executable} {file} {{condition}}")
    assert (
        "spatter-s0.6: rule=objectnav needs to know whether the agent called STOP" in result.stderr
    )
    assert "1 of 2 episodes did not report. Pass finish(stopped=...)" in result.stderr


def test_rows_have_no_common_rule_without_words_or_objects(tmp_path):
    code = LOOP.replace(', instruction="go"', "")
    with Listener(condition(), tmp_path) as listener:
        python(listener, code % "episode.finish(success=False, distance_to_goal=0.05)")
    assert {row["rule"] for row in rows(read(tmp_path), CLEAN, LABEL, None)} == {OWN}


def test_run_prints_one_plain_table_per_rule(run, tmp_path):
    file = tmp_path / "nav.py"
    file.write_text(LOOP % "episode.finish(success=True, distance_to_goal=2.0)")
    result = run(tmp_path / "o", "conditions=[clean]", f"{sys.executable} {file}")
    for name in ("own", "etpnav"):
        assert f"## unnamed split, clean only, success rule {name}\n" in result.stdout
    assert "geodesic <= 3.0 m" in result.stdout and "\\" not in result.stdout
    assert "geodesic \\<= 3.0 m" in (tmp_path / "o/table.md").read_text()


def test_rows_omit_common_rule_without_all_episodes(tmp_path):
    known = "distance_to_goal=0.05 if name == 'a' else None"
    judged, _, _ = judge(tmp_path, f"episode.finish(success=True, {known})", None)
    assert list(judged) == [OWN]


def test_rows_judge_failures_if_clean_reports_distance(tmp_path):
    _, clean, _ = judge(tmp_path / "c", "episode.finish(success=True, distance_to_goal=1)", None)
    _, reports, _ = judge(tmp_path / "t", "episode.finish(success=False)", None)
    common = str(COMMON["text"])
    assert common not in {row["rule"] for row in rows(reports, CLEAN, LABEL, None)}
    result_rows = rows(reports, CLEAN, LABEL, None, clean)
    assert [row["success"] for row in result_rows if row["rule"] == common] == [0.0, 0.0]


def test_finish_rejects_an_invalid_stop(tmp_path):
    _, _, printed = judge(tmp_path, "episode.finish(success=True, stopped='maybe')", None)
    assert "finish(stopped='maybe')" in printed


def test_rows_use_the_reported_spl_for_the_common_rule(tmp_path):
    finish = "episode.finish(success=True, spl=0.5, distance_to_goal=2.0)"
    judged, reports, _ = judge(tmp_path, finish, None)
    assert set(judged.values()) == {(1.0, 0.5)} and not count_without_path(reports, None)


def test_count_without_path_counts_by_rule(tmp_path):
    finish = "episode.finish(success=False, distance_to_goal=2.0)"
    judged, reports, _ = judge(tmp_path, finish, None)
    assert judged == {OWN: (0.0, 0.0), str(RULES["etpnav"]): (1.0, 1.0)}
    assert count_without_path(reports, None) == {str(RULES["etpnav"]): 2}


@pytest.mark.parametrize(
    ("finish", "cameras"),
    [
        ("episode.finish(success=True)", ["depth"]),
        ("episode.corrupt({'depth': depth}); episode.finish(success=True)", ["depth"]),
        ("depth[:] = 2; episode.finish(success=True)", []),
    ],
)
def test_maybe_normalised_names_depth_up_to_one(tmp_path, finish, cameras):
    _, reports, _ = judge(tmp_path, finish, None)
    assert maybe_normalised(reports) == cameras


def test_run_warns_about_depth_and_missing_paths(run, tmp_path):
    file = tmp_path / "nav.py"
    file.write_text(LOOP % "episode.finish(success=name == 'a', distance_to_goal=2.0)")
    result = run(tmp_path / "o", "conditions=[spatter]", f"{sys.executable} {file}")
    assert result.returncode == 0 and result.stdout.count("is it normalised? If so") == 2
    assert f"1 successful without a path by {OWN}: their SPL is 1" in result.stdout
    assert f"2 successful without a path by {RULES['etpnav']}: their SPL is 1" in result.stdout


@pytest.mark.parametrize("rule", ["etpnav", "objectnav"])
def test_run_rejects_a_rule_without_distances(run, tmp_path, rule):
    file, out = tmp_path / "nav.py", tmp_path / "o"
    file.write_text(LOOP % "episode.finish(success=True)")
    # at first the condition has no results; the second time it has results without the rule
    for before in ("", "conditions=[clean]"):
        if before:
            assert run(out, before, f"{sys.executable} {file}").returncode == 0
        result = run(out, f"conditions=[clean] rule={rule}", f"{sys.executable} {file}")
        assert f"rule={rule} needs to know the distance to the goal" in result.stderr
        assert "finish(distance_to_goal=...), or leave rule= out" in result.stderr
    assert (out / "conditions/clean/done.json").exists()
