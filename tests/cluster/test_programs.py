"""Tests that chains of programs run on this machine, on Ray, and as SLURM jobs.

A chain computes one cell of a table.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from pathlib import Path

import pytest

from mitigate.cluster import programs
from mitigate.cluster.launcher import LauncherConfig
from mitigate.core.progress import Progress
from mitigate.core.signals import Ended, raise_ended

pytestmark = pytest.mark.xdist_group("launchers")  # as tests/cluster/test_launchers.py

# This program appends missing rows to a file.
# At the second row, it creates the second file and kills its parent process, which is a worker.
# If the second file exists or is called "none", the program does neither.
ROWS = """
import os, pathlib, signal, sys, time
file, note = map(pathlib.Path, sys.argv[1:])
have = file.read_text().split() if file.exists() else []
for row in "abcd":
    if row not in have:
        with open(file, "a") as out:
            out.write(row + "\\n")
    if row == "b" and note.name != "none" and not note.exists():
        note.touch()
        os.kill(os.getppid(), signal.SIGKILL)
        time.sleep(30)
        file.write_text("this program outlived its worker")
"""


def chain(folder: Path, name: str, deadly: bool = False, code: str = ROWS) -> programs.Chain:
    words = (
        sys.executable,
        "-c",
        code,
        str(folder / name),
        str(folder / ("died" if deadly else "none")),
    )
    reported = (sys.executable, "-c", "import os; print(os.environ['PYTHON_CPU_COUNT'])")
    return programs.Chain(
        name,
        (("train", words), ("evaluate", reported)),
        folder / f"{name}.txt",
        folder,
        {"PYTHON_CPU_COUNT": "1"},
    )


def run(chains, launcher, jobs=2) -> dict[int, str]:
    """Return the outcome of each chain, and check that each outcome is reported once."""
    results: dict[int, str] = {}

    def reported(number, outcome):
        assert number not in results
        results[number] = outcome

    with Progress("cells", len(chains), unit="cell") as progress:
        programs.run(chains, jobs, launcher, progress, reported)
    return results


def test_run_runs_each_chain(tmp_path):
    result = [chain(tmp_path, name) for name in ("one", "two", "three")]
    results = run(result, LauncherConfig())
    assert sorted(results) == [0, 1, 2]
    for number, one in enumerate(result):
        assert results[number] == ""
        assert (tmp_path / one.name).read_text().split() == [*"abcd"]
        assert one.log.read_text() == "1\n"


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["ray", "slurm"])
def test_chain_resumes_after_its_worker_is_killed(kind, request, tmp_path):
    launcher = request.getfixturevalue(f"{kind}_launcher")
    result = [chain(tmp_path, "one", deadly=True), chain(tmp_path, "two")]
    results = run(result, launcher() if kind == "slurm" else launcher)
    assert results == {0: "", 1: ""}
    assert (tmp_path / "died").exists()
    # the first program of the chain has also ended
    assert (tmp_path / "one").read_text().split() == [*"abcd"]


def test_failed_program_ends_only_its_chain(tmp_path):
    wrong = chain(tmp_path, "wrong", code="import sys; print('well'); sys.exit('no such recipe')")
    results = run([wrong, chain(tmp_path, "right")], LauncherConfig())
    assert results == {0: "train ended with 1 (no such recipe)", 1: ""}


SAVES = """
import pathlib, signal, sys, time
def save(*_):
    pathlib.Path(sys.argv[1]).write_text("saved")
    sys.exit(143)
signal.signal(signal.SIGTERM, save)
print("ready", flush=True)
time.sleep(30)
"""


def test_stopped_chain_lets_its_programs_save(tmp_path):
    result = [chain(tmp_path, name, code=SAVES) for name in ("one", "two", "never begun")]

    def stop():
        while not all(c.log.is_file() and "ready" in c.log.read_text() for c in result[:2]):
            time.sleep(0.05)
        os.kill(os.getpid(), signal.SIGTERM)

    before = signal.signal(signal.SIGTERM, raise_ended)
    stopping = threading.Thread(target=stop)
    stopping.start()
    try:
        with pytest.raises(Ended):
            run(result, LauncherConfig())
    finally:
        stopping.join()
        signal.signal(signal.SIGTERM, before)
    assert (tmp_path / "one").read_text() == (tmp_path / "two").read_text() == "saved"
    assert not result[2].log.exists()


def test_chain_repeats_little_of_a_program_that_prints_much(tmp_path):
    """Issue T2, item 9."""
    code = "import sys; sys.stdout.write('x' * (50 << 20)); sys.exit(3)"
    chain = programs.Chain(
        "one", (("train", (sys.executable, "-c", code)),), tmp_path / "log", tmp_path
    )
    running = programs.Running(chain)
    while (problem := running.poll()) is None:
        time.sleep(0.02)
    assert problem.startswith("train ended with 3 (xxx") and len(problem) < 450
