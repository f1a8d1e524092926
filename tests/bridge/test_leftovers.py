"""Tests of processes that outlive their command, and of runs that end too early."""

import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest

from mitigate.bridge import program

EPISODES = """
import os, subprocess, sys, time, numpy, mitigate_hook

def episode(name):
    one = mitigate_hook.connect(name)
    one.corrupt({"rgb": numpy.full((8, 8, 3), 90, "uint8")})
    one.finish(success=True)

"""
SUPERVISOR = program.__file__.encode()
DETACHED = {
    "setsid": "if os.fork() == 0:\n    os.setsid()\n    rest()",
    "double fork": (
        "if os.fork() == 0:\n    os.setsid()\n    if os.fork():\n        os._exit(0)\n    rest()\n"
        "os.wait()"
    ),
    "nohup": (
        "if len(sys.argv) > 1:\n    rest()\n"
        "subprocess.Popen(['nohup', sys.executable, __file__, 'rest'])"
    ),
    "ignores SIGTERM": (
        "import signal\nif os.fork() == 0:\n    os.setsid()\n"
        "    signal.signal(signal.SIGTERM, signal.SIG_IGN)\n    rest()"
    ),
    "clears its environment": (
        "if len(sys.argv) > 1:\n    time.sleep(60)\n"
        "subprocess.Popen([sys.executable, __file__, 'x'], env={'PYTHONPATH': ':'.join(sys.path)},"
        " start_new_session=True)"
    ),
}


@pytest.fixture
def sleeper(tmp_path):
    """Write a program that runs one of five episodes; a detached process runs the others."""

    def write(how, pause=60):
        file = tmp_path / "nav.py"
        rest = (
            f"def rest():\n    time.sleep({pause})\n"
            "    for name in 'bcde':\n        episode(name)\n    os._exit(0)\n\n"
        )
        file.write_text(EPISODES + rest + DETACHED[how] + "\nepisode('a')\n")
        return f"{sys.executable} {file}"

    yield write
    for pid in running(tmp_path):
        os.kill(pid, signal.SIGKILL)


def slow(value):
    return pytest.param(value, marks=pytest.mark.slow)


def running(folder):
    """Return the processes whose command line names the program in ``folder``."""
    matches = []
    for entry in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            words = (entry / "cmdline").read_bytes().split(b"\0")
            named = str(folder / "nav.py").encode() in words
            if named and b"--" not in words and SUPERVISOR not in words:
                matches.append(int(entry.name))
    return [pid for pid in matches if pid != os.getpid()]


@pytest.mark.slow
@pytest.mark.parametrize("how", DETACHED)
def test_run_does_not_finish_a_condition_whose_command_detaches(run, sleeper, tmp_path, how):
    result = run(tmp_path / "o", "conditions=[clean]", sleeper(how))
    assert result.returncode == 1 and "1 process that it started still ran" in result.stderr, (
        result.stderr
    )
    assert "nav.py" in result.stderr and not running(tmp_path)
    assert not (tmp_path / "o/conditions/clean/done.json").exists()


def test_run_counts_a_detached_process_that_ends_soon(run, sleeper, tmp_path):
    result = run(tmp_path / "o", "conditions=[clean]", sleeper("double fork", pause=0.5))
    assert result.returncode == 0 and "clean: 5 episodes" in result.stdout, result.stderr
    assert not running(tmp_path)


def test_run_fails_if_fewer_episodes_end_than_wanted_returned(run, tmp_path):
    file = tmp_path / "nav.py"
    file.write_text(
        EPISODES + "for _, name in mitigate_hook.wanted([('', n) for n in 'abcde'])[:1]:\n"
        "    episode(name)\n"
    )
    result = run(tmp_path / "o", "conditions=[clean]", f"{sys.executable} {file}")
    assert result.returncode == 1
    assert "ended after 1 episode, and wanted() returned 5" in result.stderr
    assert not (tmp_path / "o/conditions/clean/done.json").exists()


@pytest.mark.parametrize(
    ("number", "status"),
    [
        (signal.SIGTERM, 143),
        (signal.SIGKILL, -9),
        pytest.param(signal.SIGINT, 130, marks=pytest.mark.slow),
        pytest.param(signal.SIGHUP, 129, marks=pytest.mark.slow),
    ],
)
def test_run_leaves_no_process_after_a_signal(sleeper, tmp_path, number, status):
    command = sleeper("setsid").split()
    (tmp_path / "nav.py").write_text((tmp_path / "nav.py").read_text() + "time.sleep(60)\n")
    out = tmp_path / "o"
    words = [sys.executable, "-m", "mitigate", "run", f"out={out}", "conditions=[clean]", "--"]
    process = subprocess.Popen(
        [*words, *command],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        # tests that run as a background job inherit an ignored SIGINT
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    events = out / "conditions/clean/events.jsonl"
    until = time.monotonic() + 60
    while time.monotonic() < until and not (events.is_file() and '"end"' in events.read_text()):
        time.sleep(0.05)
    assert len(running(tmp_path)) == 2
    process.send_signal(number)
    assert process.wait(30) == status
    until = time.monotonic() + 10
    # a killed run cannot wait for its processes
    while running(tmp_path) and time.monotonic() < until:
        time.sleep(0.05)
    assert not running(tmp_path)


SLEEP = "if len(sys.argv) > 1:\n    time.sleep(60)\n"
CHILDREN = {
    "keeps its environment": "if os.fork() == 0:\n    os.setsid()\n    time.sleep(60)\n",
    "clears its environment": (
        f"{SLEEP}subprocess.Popen([sys.executable, __file__, 'x'], env={{}}, "
        "start_new_session=True)\n"
    ),
}


@pytest.mark.parametrize("child", ["keeps its environment", slow("clears its environment")])
def test_run_ends_processes_whose_parent_was_killed(run, tmp_path, child):
    file = tmp_path / "nav.py"
    file.write_text(
        f"import os, signal, subprocess, sys, time\n{CHILDREN[child]}"
        "os.kill(os.getppid(), signal.SIGKILL)\ntime.sleep(60)\n"
    )
    result = run(tmp_path / "o", "conditions=[clean]", f"{sys.executable} {file}")
    assert result.returncode == 1 and "status -9" in result.stderr and not running(tmp_path)
