"""Tests of the fault injection tool: its exit status and stored outcomes."""

from __future__ import annotations

import json

import pytest

from tools.faults import __main__ as faults
from tools.faults import evaluation, training


@pytest.fixture
def run_tool(tmp_path, monkeypatch):
    """Run the tool with given outcomes of training or evaluation."""

    def run(outcomes, *arguments):
        monkeypatch.setattr(training, "break_training", lambda *_: dict(outcomes))
        monkeypatch.setattr(evaluation, "break_evaluation", lambda *_: dict(outcomes))
        return faults.main(["--out", str(tmp_path), *arguments])

    return run


def test_main_fails_if_nothing_was_tried(run_tool):
    assert run_tool({"SIGTERM": "survived"}, "--recipes", "ts_distill") == 0
    assert run_tool({"SIGTERM": "survived", "SIGINT": "other bits"}, "--recipes", "ts_distill") == 1
    assert run_tool({}, "--recipes", "ts_distill", "--faults") == 1
    assert run_tool({"full disk": "not run: no file system"}, "--recipes", "ts_distill") == 1
    assert run_tool({}, "--recipes") == 0  # this writes the table of stored outcomes


def test_main_replaces_stored_outcomes(run_tool, tmp_path):
    file = tmp_path / "faults-seed0.json"

    def stored():
        return json.loads(file.read_text())["evaluation"]

    run_tool({"SIGTERM": "survived"}, "--recipes", "evaluation")
    run_tool({"unbroken": "status 1"}, "--recipes", "evaluation")
    assert stored() == {"unbroken": "status 1"}
    run_tool({"SIGINT": "survived"}, "--recipes", "evaluation")
    run_tool({"SIGTERM": "survived"}, "--recipes", "evaluation")
    assert stored() == {"SIGINT": "survived", "SIGTERM": "survived"}
    run_tool({"SIGTERM": "other bits"}, "--recipes", "evaluation", "--seed", "7")
    assert stored() == {"SIGINT": "survived", "SIGTERM": "survived"}


def test_break_evaluation_fails_without_rows(tmp_path, monkeypatch):
    class Command:
        def problem(self, *_):
            return ""

    monkeypatch.setattr(evaluation.Evaluation, "start", lambda *_: Command())
    outcomes = evaluation.break_evaluation(tmp_path / "out", 0, ["clock jumps"])
    assert list(outcomes) == ["unbroken"] and "no rows" in outcomes["unbroken"]
