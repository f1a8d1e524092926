"""The tool that breaks trainings: what it tells is of what was tried, and of nothing else."""

from __future__ import annotations

import json

import pytest

from tools.faults import __main__ as faults
from tools.faults import evaluation, training


@pytest.fixture
def told(tmp_path, monkeypatch):
    """Run the tool where a training, or the evaluation, comes to ``found``."""

    def run(found, *arguments):
        monkeypatch.setattr(training, "break_training", lambda *_: dict(found))
        monkeypatch.setattr(evaluation, "break_evaluation", lambda *_: dict(found))
        return faults.main(["--out", str(tmp_path), *arguments])

    return run


def test_main_fails_if_nothing_was_tried(told):
    assert told({"SIGTERM": "survived"}, "--recipes", "ts_distill") == 0
    assert told({"SIGTERM": "survived", "SIGINT": "other bits"}, "--recipes", "ts_distill") == 1
    assert told({}, "--recipes", "ts_distill", "--faults") == 1
    assert told({"full disk": "not run: no file system"}, "--recipes", "ts_distill") == 1
    assert told({}, "--recipes") == 0  # to write the table of what was found before


def test_main_replaces_stored_outcomes(told, tmp_path):
    notes = tmp_path / "faults-seed0.json"

    def held():
        return json.loads(notes.read_text())["evaluation"]

    told({"SIGTERM": "survived"}, "--recipes", "evaluation")
    told({"unbroken": "status 1"}, "--recipes", "evaluation")
    assert held() == {"unbroken": "status 1"}
    told({"SIGINT": "survived"}, "--recipes", "evaluation")
    told({"SIGTERM": "survived"}, "--recipes", "evaluation")
    assert held() == {"SIGINT": "survived", "SIGTERM": "survived"}
    told({"SIGTERM": "other bits"}, "--recipes", "evaluation", "--seed", "7")
    assert held() == {"SIGINT": "survived", "SIGTERM": "survived"}


def test_break_evaluation_fails_without_rows(tmp_path, monkeypatch):
    class Command:
        def problem(self, *_):
            return ""

    monkeypatch.setattr(evaluation.Evaluation, "start", lambda *_: Command())
    found = evaluation.break_evaluation(tmp_path / "out", 0, ["clock jumps"])
    assert list(found) == ["unbroken"] and "no rows" in found["unbroken"]
