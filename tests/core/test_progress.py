"""Tests of the progress display of a long job, in a terminal and without one."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from mitigate.core import progress
from mitigate.core.progress import Progress, duration, say

ROOT = Path(__file__).parents[2]


def lines(capsys) -> list[str]:
    return capsys.readouterr().out.splitlines()


def test_first_and_last_line_name_job_length_and_time(capsys):
    with Progress("maps", 3, unit="map") as bar:
        for loss in (3, 2, 1):
            bar.advance(note=f"loss {loss}")
    assert lines(capsys) == ["maps: 3 maps", "maps: map 3/3, done in 0 s, loss 1"]


def test_waiting_job_prints_a_line_after_a_while(capsys, monkeypatch):
    monkeypatch.setattr(progress, "EVERY", 0.05)
    with Progress("maps", 3) as bar:
        bar.advance(0)
        time.sleep(0.1)
        bar.advance(0)
        bar.advance(0)
    assert lines(capsys)[1:-1] == ["maps: step 0/3, 0 s so far"]


def test_lines_reach_a_pipe_at_once():
    code = "with progress.Progress('maps', 3): time.sleep(30)"
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", f"import time\nfrom mitigate.core import progress\n{code}"]
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout is not None and child.stdout.readline() == "maps: 3 steps\n"
        child.kill()


def test_line_reports_pace_time_left_and_latest_note(monkeypatch):
    now = [100.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    bar = Progress("perception_rgb", 700, start=100)
    assert bar.line() == "perception_rgb: step 100/700, 0 s so far" and bar.left() == float("inf")
    now[0] += 60  # the first step compiles, so the pace is measured after it
    bar.advance()
    assert bar.line() == "perception_rgb: step 101/700, 1 min 00 s so far"
    assert bar.left() == float("inf")
    now[0] += 30  # each worker compiles
    bar.advance(5)
    assert bar.line() == "perception_rgb: step 106/700, 1 min 30 s so far"
    now[0] += 10
    bar.advance(15, note="loss 0.31")
    assert bar.line() == "perception_rgb: step 121/700, 2 s per step, 19 min 18 s left, loss 0.31"
    now[0] += 160
    bar.advance(0, note="loss 0.3")
    assert bar.line() == "perception_rgb: step 121/700, 10 s per step, 1 h 36 min left, loss 0.3"
    bar.unit = "episode"
    assert "10 s per episode" in bar.line()
    now[0] += 3600
    assert "3 min 10 s per episode" in bar.line()


def test_advance_without_a_note_keeps_the_latest():
    bar = Progress("maps", 3)
    bar.advance(note="loss 1")
    bar.advance()
    assert bar.done == 2 and bar.note == "loss 1"


def test_exception_passes_and_last_line_reports_the_position(capsys):
    with pytest.raises(KeyError), Progress("maps", 3) as bar:
        bar.advance()
        raise KeyError("x")
    assert lines(capsys)[-1] == "maps: step 1/3, stopped after 0 s"


def test_resumed_job_reports_earlier_progress(capsys):
    with Progress("maps", 9, start=4):
        pass
    assert lines(capsys)[0] == "maps: 9 steps, 4 already done"


def test_start_must_lie_within_the_total():
    with pytest.raises(ValueError, match="start=5 must be between 0 and total=3"):
        Progress("maps", 3, start=5)


def test_terminal_shows_a_bar_instead_of_lines(capsys, monkeypatch):
    monkeypatch.setattr("sys.stdout.isatty", lambda: True, raising=False)
    with Progress("maps", 4) as bar:
        bar.advance(3, note="loss 1")
        time.sleep(0.2)
        bar.say("a line")
        bar.advance(1)
    out = capsys.readouterr().out
    assert "4/4 [00:00<00:00" in out and "step/s, loss 1]" in out
    assert "a line\n" in out and "maps: 4 steps" not in out


def test_nested_bar_lies_below_and_is_removed(capsys, monkeypatch):
    monkeypatch.setattr("sys.stdout.isatty", lambda: True, raising=False)
    with Progress("outer", 1) as outer:
        with Progress("inner", 1) as inner:
            inner.advance()
        outer.advance()
    out = capsys.readouterr().out
    assert "\n\rinner" in out and out.rstrip("\n").split("\r")[-1].startswith("outer: 100%")


def test_say_prints_with_and_without_a_job(capsys):
    say("before")
    with Progress("maps", 1):
        say("within")
    assert lines(capsys)[:3] == ["before", "maps: 1 step", "within"]


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (0.4, "0 s"),
        (59.4, "59 s"),
        (59.6, "1 min 00 s"),
        (190, "3 min 10 s"),
        (3900, "1 h 05 min"),
        (float("inf"), "unknown time"),
    ],
)
def test_durations_are_words(seconds, words):
    assert duration(seconds) == words
