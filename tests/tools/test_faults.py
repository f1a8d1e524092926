"""Tests of the fault injection tool: its exit status and stored outcomes."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time

import pytest

from tools.faults import __main__ as faults
from tools.faults import commands, evaluation, processes, training


@pytest.fixture
def run_tool(tmp_path, monkeypatch):
    """Return a function that runs the tool with made-up outcomes of training and evaluation."""

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
    # without faults, the tool only writes the table of stored outcomes
    assert run_tool({}, "--recipes") == 0


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


def test_break_commands_reports_a_problem_and_a_damaged_folder(tmp_path, monkeypatch):
    def damaged(_):
        raise ValueError("the card is damaged")

    outcomes = {"a": lambda _: "", "b": lambda _: "it hung", "c": damaged}
    monkeypatch.setattr(commands, "FAULTS", outcomes)
    assert commands.break_commands(tmp_path / "out", 0, ["a", "b", "c"]) == {
        "a": "survived",
        "b": "it hung",
        "c": "the card is damaged",
    }


def test_every_fault_is_documented():
    page = (processes.ROOT / "docs/reliability.md").read_text(encoding="utf-8").replace("\n", " ")
    for fault in {*training.FAULTS, *evaluation.FAULTS, *commands.FAULTS}:
        word = "a signal in an export" if "export" in fault else fault
        assert word.removesuffix(" in a write") in page, fault


@pytest.mark.parametrize(("redirect", "printed"), [(">&-", False), ("| head -n 1", True)])
def test_command_redirects_its_output(tmp_path, redirect, printed):
    command = processes.Command(["mitigate", "--help"], tmp_path / "log", redirect=redirect)
    assert command.problem(0) == "" and bool(command.output()) == printed


def test_descendants_finds_processes_by_their_command():
    code = "import subprocess, sys; subprocess.run(['sleep', '61.5'])"
    with subprocess.Popen([sys.executable, "-c", code], start_new_session=True) as process:
        try:
            for _ in range(200):
                pids = processes.descendants(os.getpid(), b"61.5")
                if len(pids) == 2:
                    break
                time.sleep(0.05)
            assert process.pid in pids and len(pids) == 2
        finally:
            os.killpg(process.pid, signal.SIGKILL)
