"""Tests of worker processes: results are equal for any number of workers, and dead workers are
replaced."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from pkgutil import resolve_name
from threading import Timer

import pytest

from mitigate.core import workers
from mitigate.core.signals import Ended, delay_signals
from mitigate.core.workers import WorkersDied, results
from tests.deaths import die_in_a_message


@dataclass
class Squares:
    """A task that squares numbers. A job may also kill its process, fail, wait, or send a signal to
    its process."""

    folder: Path
    preload = "mitigate.core.workers"

    @contextmanager
    def ready(self):
        yield

    def work(self, jobs):
        for number, action in jobs:
            if action == "die once" and not (self.folder / str(number)).exists():
                (self.folder / str(number)).touch()
                os.kill(os.getpid(), signal.SIGKILL)
            if action == "die in a message" and not (self.folder / str(number)).exists():
                (self.folder / str(number)).touch()
                die_in_a_message()
            if action == "die":
                os.kill(os.getpid(), signal.SIGKILL)
            if action == "fail":
                raise FileNotFoundError(f"no file {number}")
            if action == "wait":
                time.sleep(1.5)
            if action == "tell":
                (self.folder / f"pid{os.getpid()}").touch()
                time.sleep(60 if (self.folder / "long").exists() else 1)
            yield (n for n in ()) if action == "a generator" else number**2

    def name(self, job):
        return f"number {job[0]}"


class Unreadable:
    """A job that a worker cannot unpickle."""

    def __reduce__(self):
        return _unreadable, ()


def _unreadable():
    raise OSError("this job cannot be unpickled")


class Lines:
    """A replacement for Progress that records its messages."""

    def __init__(self):
        self.said = []

    def say(self, text):
        self.said.append(text)

    def advance(self, count=1):
        pass


def run(task, groups, count=2):
    lines = Lines()
    matches = [item for item in results(task, groups, count, lines) if item is not None]
    return dict(matches), lines.said


def groups(*actions):
    return [
        [(3 * i + k, action if k == 1 else "") for k in range(3)]
        for i, action in enumerate(actions)
    ]


@pytest.mark.parametrize("count", [1, 2])
def test_results_are_numbered_by_job(count, tmp_path):
    matches, message = run(Squares(tmp_path), [*groups("", "", ""), []], count)
    assert matches == {n: n**2 for n in range(9)} and not message


@pytest.mark.parametrize("how", ["die once", "die in a message"])
def test_results_replace_the_first_dead_worker(how, tmp_path):
    began = time.monotonic()
    matches, message = run(Squares(tmp_path), groups("", how, ""))
    assert matches == {n: n**2 for n in range(9)} and time.monotonic() - began < 10
    assert (
        len(message) == 1
        and "SIGKILL" in message[0]
        and "jobs (2) start again in a new" in message[0]
    )


def test_results_raise_workers_died_after_a_second_death(tmp_path):
    began, matches = time.monotonic(), {}
    with pytest.raises(WorkersDied, match=r"of 6 jobs are finished.*workers=1.*memory"):
        for item in results(Squares(tmp_path), groups("", "die"), 2, Lines()):
            matches |= dict([item]) if item else {}
    assert {n for n in matches if n >= 3} == {3} and time.monotonic() - began < 10


@pytest.mark.parametrize("count", [1, 2])
def test_job_error_keeps_its_type(count, tmp_path):
    with pytest.raises(FileNotFoundError, match="no file 4"):
        run(Squares(tmp_path), groups("", "fail"), count)


def test_idle_worker_is_reported_and_not_killed(tmp_path, monkeypatch):
    monkeypatch.setattr(workers, "STUCK", 0.5)
    monkeypatch.setattr(workers, "SECOND", 0.1)
    matches, message = run(Squares(tmp_path), groups("wait", ""))
    assert matches == {n: n**2 for n in range(6)}
    # on a busy machine, other jobs may also run long enough to be reported
    assert any("has been running number 1 for 1 s" in line for line in message)


ENDLESS = """
from pathlib import Path
from tests.core.test_workers import Lines, Squares, groups, results
list(results(Squares(Path({folder!r})), groups("tell", "tell"), 2, Lines()))
"""


def stopped_by(how, folder):
    """Start two workers in a new process, send it the signal, and return the workers' ids."""
    process = subprocess.Popen(
        [sys.executable, "-c", ENDLESS.format(folder=str(folder))],
        cwd=Path(__file__).parents[2],
        stderr=subprocess.DEVNULL,
        # a background job ignores SIGINT
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    pids = []
    while len(pids) < 2:
        assert process.poll() is None
        time.sleep(0.05)
        pids = [int(path.name[3:]) for path in folder.glob("pid*")]
    process.send_signal(how)
    process.wait(5)
    return pids


GROUP = """
import os, signal
from pathlib import Path
from mitigate.core.signals import delay_signals
from tests.core.test_workers import Lines, Squares, groups, results
with delay_signals() as ending:
    for item in results(Squares(Path({folder!r})), groups("wait", "wait"), 2, Lines()):
        if item and not ending.number:
            os.killpg(0, signal.SIGTERM)
        print(item)
print("ended by", ending.number)
"""


@pytest.mark.slow
def test_signal_to_all_processes_is_handled_by_the_parent(tmp_path):
    """SLURM and ``timeout`` send SIGTERM to all processes.

    When workers died of this signal, the error message once blamed a lack of memory.
    """
    ended = subprocess.run(
        [sys.executable, "-c", GROUP.format(folder=str(tmp_path))],
        cwd=Path(__file__).parents[2],
        capture_output=True,
        text=True,
        start_new_session=True,
    )
    assert ended.returncode == 0, ended.stderr
    assert "(5, 25)" in ended.stdout and f"ended by {int(signal.SIGTERM)}" in ended.stdout


HELD = """
import sys
from pathlib import Path
from tests.core.test_workers import Lines, Squares, groups, results
held = results(Squares(Path({folder!r})), groups("", ""), 2, Lines())  # never closed
next(item for item in held if item)
sys.exit("an error")
"""


def test_error_ends_a_program_that_still_holds_its_workers(tmp_path):
    """The program never closes its workers, so they exist until the interpreter exits."""
    ended = subprocess.run(
        [sys.executable, "-c", HELD.format(folder=str(tmp_path))],
        cwd=Path(__file__).parents[2],
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert ended.returncode == 1 and ended.stderr == "an error\n"


def alive(pids):
    return [pid for pid in pids if Path(f"/proc/{pid}").exists()]


def test_ctrl_c_ends_workers_during_a_job(tmp_path):
    (tmp_path / "long").touch()
    assert not alive(stopped_by(signal.SIGINT, tmp_path))


@pytest.mark.slow
def test_workers_whose_parent_was_killed_end_after_their_job(tmp_path):
    pids, end = stopped_by(signal.SIGKILL, tmp_path), time.monotonic() + 5
    while alive(pids):
        assert time.monotonic() < end
        time.sleep(0.05)


def test_worker_count_is_cores_or_none_for_few_jobs(monkeypatch):
    monkeypatch.setattr(workers, "cores", lambda: 4)
    assert [workers.count(None, jobs, 10) for jobs in (0, 9, 29, 1000)] == [1, 1, 2, 4]
    assert workers.count(3, 1, 10) == 3
    with pytest.raises(ValueError, match="workers must be >= 1 or null .one per core., got 0"):
        workers.count(0, 100, 10)


def test_signal_ends_many_jobs_within_a_training(tmp_path):
    """Training delays signals until its step ends. A job takes minutes, so a signal must end it."""
    (tmp_path / "long").touch()
    began = time.monotonic()
    Timer(0.5, os.kill, (os.getpid(), signal.SIGTERM)).start()
    with pytest.raises(Ended) as ended, delay_signals():
        run(Squares(tmp_path), groups("tell", "tell"))
    assert ended.value.status == 143 and time.monotonic() - began < 10


def test_results_finish_a_started_job_before_a_signal(tmp_path):
    class Ending(Squares):
        def work(self, jobs):
            for job in jobs:
                os.kill(os.getpid(), signal.SIGTERM)
                time.sleep(0.01)
                yield job

    matches = []
    with pytest.raises(Ended) as ended:
        for item in results(Ending(tmp_path), [["one", "two"]], 1, Lines()):
            matches.append(item)
    assert matches == [(0, "one")] and ended.value.status == 143


def test_unpicklable_job_is_reported_with_a_way_out(tmp_path):
    class Local(Squares):
        """A class that is defined in a function, so that other processes cannot import it."""

    with pytest.raises(ValueError, match=r"cannot be sent to other processes.*workers=1"):
        list(results(Local(tmp_path), groups(1, 2), 2, Lines()))


class Guarded(Squares):
    """Like a class below ``if __name__ == "__main__":``, which a worker cannot import."""

    def __reduce__(self):
        return resolve_name, ("os:Guarded",)


def test_results_reject_tasks_below_main(tmp_path):
    with pytest.raises(ValueError, match="cannot read its task.*Guarded.*top level of a module"):
        list(results(Guarded(tmp_path), groups(1, 2), 2, Lines()))


@pytest.mark.parametrize(
    ("action", "kind", "words"),
    [
        (lambda: 0, ValueError, "A job of a worker cannot be sent .* workers=1"),
        ("a generator", ValueError, "The result of a worker cannot be sent .* workers=1"),
        (Unreadable(), OSError, "this job cannot be unpickled"),
    ],
    ids=["job", "result", "unread job"],
)
def test_results_reject_jobs_that_cannot_be_pickled(tmp_path, action, kind, words):
    with pytest.raises(kind, match=words) as raised:
        run(Squares(tmp_path), groups(action, ""))
    assert not isinstance(raised.value, WorkersDied)


SLOW = """
import time
from pathlib import Path
from tests.core.test_workers import Squares

Path("importing").touch()
time.sleep(1)

class Slow(Squares):
    preload = "slow_task"
"""
STOPPED = """
from pathlib import Path
from slow_task import Slow
from tests.core.test_workers import Lines, groups, results
Path("importing").unlink()
try:
    [*results(Slow(Path()), groups("wait", "wait"), 2, Lines())]
except KeyboardInterrupt:
    print("stopped")
"""


@pytest.mark.slow
def test_ctrl_c_during_worker_imports_prints_one_message(tmp_path):
    (tmp_path / "slow_task.py").write_text(SLOW)
    paths = os.pathsep.join([str(tmp_path), str(Path(__file__).parents[2])])
    process = subprocess.Popen(
        [sys.executable, "-c", STOPPED],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": paths},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    seen = 0
    # the command and the fork server of its workers each import this module
    while seen < 2:
        assert process.poll() is None
        time.sleep(0.02)
        if (tmp_path / "importing").exists():
            seen += 1
            while seen == 1 and (tmp_path / "importing").exists():
                time.sleep(0.02)
    os.killpg(process.pid, signal.SIGINT)
    assert process.communicate(timeout=60) == ("stopped\n", "")
