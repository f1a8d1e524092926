"""A long job says at once and then all the time how far it is, in a terminal or out of it."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from mitigate.core import progress
from mitigate.core.progress import Progress, duration, say

ROOT = Path(__file__).parents[2]


@pytest.fixture
def quick(monkeypatch) -> None:
    """A clock that speaks after 0.1 s of silence."""
    monkeypatch.setattr(progress, "EVERY", 0.1)
    monkeypatch.setattr(progress, "REDRAW", 0.05)


def run(code: str, **settings) -> subprocess.CompletedProcess:
    """Run ``code`` in a new Python whose clock speaks after 0.2 s of silence."""
    head = "import time\nfrom mitigate.core import progress\nprogress.EVERY = 0.2\n"
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.run(
        [sys.executable, "-c", head + code], env=environment, text=True, timeout=60, **settings
    )


def lines(capsys) -> list[str]:
    return capsys.readouterr().out.splitlines()


def test_first_and_last_line_name_the_job_its_length_and_its_time(capsys):
    with Progress("maps", 3, unit="map") as bar:
        for loss in (3, 2, 1):
            bar.advance(note=f"loss {loss}")
    assert lines(capsys) == ["maps: 3 maps", "maps: map 3/3, done in 0 s, loss 1"]


def test_a_job_that_does_not_advance_still_prints_lines(capsys, quick):
    with Progress("maps", 3):
        time.sleep(0.55)
    assert lines(capsys).count("maps: step 0/3, 0 s so far") >= 3


def test_lines_come_while_the_main_thread_waits_in_c():
    code = "with progress.Progress('maps', 3): progress.os.system('sleep 1')"
    out = run(code, capture_output=True).stdout.splitlines()
    assert len([line for line in out if "so far" in line]) >= 3


def test_lines_come_while_the_main_thread_never_gives_up_the_interpreter_lock_by_itself():
    code = """
with progress.Progress('maps', 3):
    end = time.monotonic() + 1
    while time.monotonic() < end: sum(range(1000))
"""
    out = run(code, capture_output=True).stdout.splitlines()
    assert len([line for line in out if "so far" in line]) >= 3


def test_lines_reach_a_pipe_at_once():
    code = "with progress.Progress('maps', 3): time.sleep(30)"
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", f"import time\nfrom mitigate.core import progress\n{code}"]
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout is not None and child.stdout.readline() == "maps: 3 steps\n"
        child.kill()


def test_a_line_says_pace_time_left_and_the_latest_note(monkeypatch):
    now = [100.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    bar = Progress("perception_rgb", 700, start=100)
    assert bar.line() == "perception_rgb: step 100/700, 0 s so far" and bar.left() == float("inf")
    now[0] += 10
    bar.advance(20, note="loss 0.31")
    assert bar.line() == ("perception_rgb: step 120/700, 2 steps/s, 4 min 50 s left, loss 0.31")
    now[0] += 190
    bar.advance(0, note="loss 0.3")
    assert bar.line() == "perception_rgb: step 120/700, 10 s per step, 1 h 36 min left, loss 0.3"
    bar.unit = "episode"
    assert "10 s per episode" in bar.line()
    now[0] += 3600
    assert "3 min 10 s per episode" in bar.line()


def test_an_advance_without_a_note_keeps_the_latest():
    bar = Progress("maps", 3)
    bar.advance(note="loss 1")
    bar.advance()
    assert bar.done == 2 and bar.note == "loss 1"


def test_the_clock_is_silent_while_others_print(capsys, quick):
    with Progress("maps", 3) as bar:
        for _ in range(12):
            time.sleep(0.03)
            bar.say("a line")
    assert lines(capsys)[1:-1] == ["a line"] * 12


def test_clock_lines_keep_their_distance(capsys, quick, monkeypatch):
    times: list[float] = []
    print_line = progress.say
    monkeypatch.setattr(
        progress, "say", lambda text: (times.append(time.monotonic()), print_line(text))
    )
    with Progress("outer", 2), Progress("inner", 2):
        time.sleep(0.55)
    clock = times[2:-2]
    assert len(clock) >= 3
    assert all(b - a >= 0.1 for a, b in zip(clock, clock[1:], strict=False))


def test_the_innermost_job_speaks_and_then_the_outer_one_again(capsys, quick):
    with Progress("outer", 2) as outer:
        with Progress("inner", 2):
            time.sleep(0.25)
        outer.advance()
        time.sleep(0.25)
    out = lines(capsys)
    end = out.index("inner: step 0/2, done in 0 s")
    assert all(line.startswith("inner") for line in out[2:end]) and end > 2
    assert out[end + 1].startswith("outer: step 1/2") and len(out) > end + 2


def test_consecutive_jobs_leave_one_clock_and_in_the_end_none(capsys):
    for _ in range(20):
        with Progress("maps", 3):
            assert [t.name for t in threading.enumerate()].count("progress") <= 1
    for thread in threading.enumerate():
        if thread.name == "progress":
            thread.join(5)
    assert "progress" not in [t.name for t in threading.enumerate()]


def test_an_exception_passes_and_the_last_line_says_where_it_stopped(capsys):
    with pytest.raises(KeyError), Progress("maps", 3) as bar:
        bar.advance()
        raise KeyError("x")
    assert lines(capsys)[-1] == "maps: step 1/3, stopped after 0 s"


def test_a_resumed_job_says_what_was_done_before(capsys):
    with Progress("maps", 9, start=4):
        pass
    assert lines(capsys)[0] == "maps: 9 steps, 4 already done"


def test_start_must_lie_within_the_total():
    with pytest.raises(ValueError, match="start=5 must be at least 0 and at most total=3"):
        Progress("maps", 3, start=5)


def test_a_terminal_gets_a_bar_with_the_time_left_and_no_plain_lines(capsys, quick, monkeypatch):
    monkeypatch.setattr("sys.stdout.isatty", lambda: True, raising=False)
    with Progress("maps", 4) as bar:
        bar.advance(3, note="loss 1")
        time.sleep(0.2)
        bar.say("a line")
        bar.advance(1)
    out = capsys.readouterr().out
    assert "4/4 [00:00<00:00" in out and "step/s, loss 1]" in out
    assert "a line\n" in out and "maps: 4 steps" not in out


def test_a_bar_is_redrawn_although_nothing_advances(capsys, quick, monkeypatch):
    monkeypatch.setattr("sys.stdout.isatty", lambda: True, raising=False)
    with Progress("maps", 4):
        time.sleep(0.4)
    assert capsys.readouterr().out.count("0/4") >= 4


def test_a_nested_bar_lies_below_and_is_removed(capsys, monkeypatch):
    monkeypatch.setattr("sys.stdout.isatty", lambda: True, raising=False)
    with Progress("outer", 1) as outer:
        with Progress("inner", 1) as inner:
            inner.advance()
        outer.advance()
    out = capsys.readouterr().out
    assert "\n\rinner" in out and out.rstrip("\n").split("\r")[-1].startswith("outer: 100%")


def test_a_forked_child_can_speak_and_open_a_job_of_its_own():
    code = """
import os
with progress.Progress('parent', 3):
    time.sleep(0.3)
    child = os.fork()
    if child == 0:
        with progress.Progress('child', 1): time.sleep(0.5)
        os._exit(0)
    assert os.waitpid(child, 0)[1] == 0
"""
    out = run(code, capture_output=True).stdout
    assert "child: step 0/1, 0 s so far" in out and out.endswith("parent: step 0/3, done in 1 s\n")


def test_a_reader_that_went_away_does_not_stop_the_job():
    code = """
import os, sys
bar = progress.Progress('maps', 3)
with bar:
    os.close(1)
    time.sleep(0.6)
    os.open(os.devnull, os.O_WRONLY)
sys.stderr.write('finished')
"""
    result = run(code, capture_output=True)
    assert result.returncode == 0 and result.stderr == "finished"


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
