"""Inject faults into evaluations, whose rows must equal the rows of an undisturbed evaluation."""

from __future__ import annotations

import os
import random
import shutil
import signal
import time
from collections.abc import Callable
from pathlib import Path

from tools.faults.disk import filled, small_disk
from tools.faults.processes import Command, workers
from tools.faults.training import NOTICE_TIME, STATUS, TRIES, check_one_rejected

OPTIONS = ("checkpoint=checkpoints/base", "episodes=8", "suite=quick", "workers=2")
ROWS = "rows.jsonl"
DISK = 60  # MB
TOO_LATE = "not run: the evaluation ended before the fault"


class Evaluation:
    """An evaluation in ``folder``; ``rng`` chooses the times of faults."""

    def __init__(self, folder: Path, rng: random.Random) -> None:
        self.folder = folder
        self.rng = rng
        self.started = 0
        self.arguments = ["mitigate.evaluate", *OPTIONS, f"out={folder}", f"runs={folder}"]

    def start(self, environment: dict[str, str] | None = None) -> Command:
        """Start or resume it."""
        self.started += 1
        name = f"{self.folder.name}-{self.started}.txt"
        return Command(self.arguments, self.folder.parent / name, environment)

    def start_and_wait(self, environment: dict[str, str] | None = None) -> Command:
        """Start or resume the evaluation, and wait until a random number of rows is written."""
        command = self.start(environment)
        count = self.rng.randint(1, 9)
        command.wait_for(lambda: self.rows().count(b"\n") >= count)
        return command

    def rows(self) -> bytes:
        """Return the path of the row file."""
        path = self.folder / ROWS
        return path.read_bytes() if path.is_file() else b""


def send_signal(evaluation: Evaluation, number: int) -> str:
    """Send a signal to the evaluation."""
    command = evaluation.start_and_wait()
    if not command.runs():
        return TOO_LATE
    command.process.send_signal(number)
    problem = command.problem(STATUS[signal.Signals(number)], 0)
    return TOO_LATE if not problem and command.process.returncode == 0 else problem


def kill_worker(evaluation: Evaluation) -> str:
    """Kill a worker process."""
    command = evaluation.start_and_wait()
    pids = workers(command)
    if not pids:
        return TOO_LATE
    os.kill(evaluation.rng.choice(pids), signal.SIGKILL)
    noticed = command.wait_for(lambda: "A worker process was" in command.output(), NOTICE_TIME)
    return "" if noticed else f"not noticed within {NOTICE_TIME:g} s: {command.last_lines()}"


def pause_worker(evaluation: Evaluation) -> str:
    """Stop a worker process for some seconds."""
    command = evaluation.start_and_wait()
    pids = workers(command)
    if not pids:
        return TOO_LATE
    os.kill(pids[0], signal.SIGSTOP)
    time.sleep(3.0)
    os.kill(pids[0], signal.SIGCONT)
    return ""


def jump_clock(evaluation: Evaluation) -> str:
    """Let the clock jump by up to a day, about once per second."""
    clock = {"PYTHONPATH": str(Path(__file__).parent / "clock")}
    return evaluation.start(clock).problem(0)


def start_twice(evaluation: Evaluation) -> str:
    """Start two evaluations in the same folder; one of them must be rejected."""
    return check_one_rejected([evaluation.start(), evaluation.start()])


def cut_row(evaluation: Evaluation) -> str:
    """Cut off the last row, as if the machine had lost power during a write."""
    command = evaluation.start_and_wait()
    command.process.kill()
    command.process.wait()
    rows = evaluation.rows()
    (evaluation.folder / ROWS).write_bytes(rows[: len(rows) - evaluation.rng.randint(1, 200)])
    return ""


def fill_disk(evaluation: Evaluation) -> str:
    """Fill the disk; the evaluation must report this, and finish when there is space again."""
    with small_disk(evaluation.folder, DISK) as mounted:
        if not mounted:
            return "not run: no file system may be mounted here"
        with filled(evaluation.folder, evaluation.rng.randrange(4096, 8192)):
            command = evaluation.start()
            problem = command.problem(1)
            reported = "No space left" in command.output()
            problem = problem or ("" if reported else command.last_lines())
        return problem or evaluation.start().problem(0) or copy_folder(evaluation)


def copy_folder(evaluation: Evaluation) -> str:
    """Copy the folder before its disk is unmounted; return the problem if it has no rows."""
    rows = evaluation.rows()
    shutil.copytree(evaluation.folder, evaluation.folder.with_name("kept"))
    return "" if rows else "no rows"


FAULTS: dict[str, Callable[[Evaluation], str]] = {
    "SIGKILL": lambda e: send_signal(e, signal.SIGKILL),
    "SIGTERM": lambda e: send_signal(e, signal.SIGTERM),
    "SIGINT": lambda e: send_signal(e, signal.SIGINT),
    "worker killed": kill_worker,
    "worker stands still": pause_worker,
    "two in one folder": start_twice,
    "last row cut": cut_row,
    "clock jumps": jump_clock,
    "full disk": fill_disk,
}


def break_evaluation(out: Path, seed: int, faults: list[str]) -> dict[str, str]:
    """Return the outcome of each fault, which is "survived", "not run: ..." or the problem.

    Each fault is injected into a separate evaluation, which is then finished and compared.
    """
    rng = random.Random(f"{seed} evaluation")
    unbroken = Evaluation(out / "unbroken", rng)
    problem = unbroken.start().problem(0)
    if problem:
        return {"unbroken": problem}
    expected = unbroken.rows()
    if not expected:
        return {"unbroken": f"it wrote no {ROWS}"}
    outcomes = {}
    for name in faults:
        for attempt in range(TRIES):
            evaluation = Evaluation(out / f"{name.replace(' ', '-')}-{attempt}", rng)
            problem = FAULTS[name](evaluation)
            if problem != TOO_LATE:
                break
        if name == "full disk" and not problem:
            evaluation.folder = evaluation.folder.with_name("kept")
        elif not problem:
            problem = finish(evaluation)
        if not problem and evaluation.rows() != expected:
            problem = "rows differ from the undisturbed evaluation"
        outcomes[name] = problem or "survived"
    shutil.rmtree(out, ignore_errors=True)
    return outcomes


def finish(evaluation: Evaluation) -> str:
    """Wait for the disturbed evaluation to end, then run the command once more."""
    for _ in range(600):
        command = evaluation.start()
        problem = command.problem(0)
        # otherwise the disturbed evaluation is still running
        if "is in use" not in command.output():
            return problem
        time.sleep(1.0)
    return problem
