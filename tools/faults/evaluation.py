"""Inject faults into evaluations, whose rows must equal the rows of an undisturbed evaluation."""

from __future__ import annotations

import os
import random
import shutil
import signal
import time
from collections.abc import Callable, Sequence
from importlib.util import find_spec
from pathlib import Path

from tools.faults.disk import filled, small_disk
from tools.faults.processes import (
    ASCII_OUTPUT,
    JUMPING_CLOCK,
    Command,
    descendants,
    workers,
)
from tools.faults.report import UNBROKEN
from tools.faults.training import NOTICE_TIME, STATUS, TRIES, check_one_rejected

OPTIONS = ("checkpoint=checkpoints/base", "episodes=8", "suite=quick", "workers=2")
Words = Sequence[str]
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

    def start(
        self, environment: dict[str, str] | None = None, redirect: str = "", options: Words = ()
    ) -> Command:
        """Start or resume it."""
        self.started += 1
        log = self.folder.parent / f"{self.folder.name}-{self.started}.txt"
        return Command([*self.arguments, *options], log, environment, redirect)

    def start_and_wait(self, options: Words = (), least: int = 1) -> Command:
        """Start or resume the evaluation, and wait until it has written a random number of rows."""
        command = self.start(options=options)
        count = self.rng.randint(least, 9)
        command.wait_for(lambda: self.rows().count(b"\n") >= count)
        return command

    def rows(self) -> bytes:
        """Return the content of the row file."""
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
    """Pause a worker process for three seconds."""
    command = evaluation.start_and_wait()
    pids = workers(command)
    if not pids:
        return TOO_LATE
    os.kill(pids[0], signal.SIGSTOP)
    time.sleep(3.0)
    os.kill(pids[0], signal.SIGCONT)
    return ""


def start_twice(evaluation: Evaluation) -> str:
    """Start two evaluations in the same folder; one of them must be rejected."""
    return check_one_rejected([evaluation.start(), evaluation.start()])


def cut_row(evaluation: Evaluation) -> str:
    """Cut off the last row, as if the machine had lost power during a write."""
    rows = kill_with_rows(evaluation)
    if not rows:
        return TOO_LATE
    (evaluation.folder / ROWS).write_bytes(rows[: len(rows) - evaluation.rng.randint(1, 200)])
    return ""


def kill_with_rows(evaluation: Evaluation) -> bytes:
    """Kill the evaluation after it has written some rows, and return the rows.

    Return b"" if the evaluation ended before it could be killed.
    """
    command = evaluation.start_and_wait(least=3)
    if not command.runs():
        return b""
    command.process.kill()
    command.process.wait()
    return evaluation.rows()


def damage_line(evaluation: Evaluation) -> str:
    """Damage a line in the middle of the row file; an error must name the line, and the file must
    not change.
    """
    rows = kill_with_rows(evaluation)
    if not rows:
        return TOO_LATE
    file = evaluation.folder / ROWS
    damaged = rows.replace(b"\n{", b"\n\0", 1)
    file.write_bytes(damaged)
    problem = evaluation.start().message_problem("line 2 is not a JSON object")
    unchanged = evaluation.rows() == damaged
    file.write_bytes(rows)
    return problem or ("" if unchanged else "the damaged file was changed")


def plant_link(evaluation: Evaluation) -> str:
    """Replace the row file by a link; the evaluation must not write to the target of the link."""
    rows = kill_with_rows(evaluation)
    if not rows:
        return TOO_LATE
    file = evaluation.folder / ROWS
    outside = evaluation.folder.with_name(f"{evaluation.folder.name}-outside")
    os.replace(file, outside)
    file.symlink_to(outside)
    problem = evaluation.start().message_problem("must be a regular file, got a symbolic link")
    unchanged = outside.read_bytes() == rows
    os.replace(outside, file)
    return problem or ("" if unchanged else "the file behind the link was changed")


def remove_folder(evaluation: Evaluation) -> str:
    """Move the folder away during the evaluation, and back when it has ended."""
    command = evaluation.start_and_wait()
    if not command.runs():
        return TOO_LATE
    away = evaluation.folder.with_name(f"{evaluation.folder.name}-away")
    os.replace(evaluation.folder, away)
    problem = command.message_problem("removed or replaced")
    if evaluation.folder.exists():
        return problem or "it created the folder again"
    os.replace(away, evaluation.folder)
    return problem


def kill_on_cluster(
    evaluation: Evaluation, package: str, options: Words, word: bytes, message: str
) -> str:
    """Kill the process of a worker on a cluster; a different worker must repeat its jobs.

    Args:
        evaluation: The evaluation.
        package: The Python package that the launcher needs.
        options: Options of the launcher.
        word: A part of the command line of the process to kill.
        message: A part of the message that reports the lost worker.
    """
    if find_spec(package) is None:
        return f"not run: {package} is not installed"
    command = evaluation.start_and_wait(options)
    pids = descendants(command.process.pid, word)
    if not pids:
        return TOO_LATE
    os.kill(evaluation.rng.choice(pids), signal.SIGKILL)
    problem = command.problem(0)
    reported = message in command.output()
    return problem or ("" if reported else TOO_LATE)


def kill_ray_worker(evaluation: Evaluation) -> str:
    """Kill an actor of Ray."""
    return kill_on_cluster(evaluation, "ray", ["launcher=ray"], b"ray::Worker", "A worker was lost")


def kill_slurm_job(evaluation: Evaluation) -> str:
    """Kill a job that submitit runs on this machine instead of on SLURM."""
    folder = evaluation.folder.with_name("slurm")
    options = ["launcher=slurm", "launcher.cluster=local", f"launcher.folder={folder}"]
    options.append("launcher.processes=1")
    return kill_on_cluster(evaluation, "submitit", options, b"submitit.core._submit", "ended early")


def fill_disk(evaluation: Evaluation) -> str:
    """Fill the disk; the evaluation must report it, and must finish when there is space again."""
    with small_disk(evaluation.folder, DISK) as mounted:
        if not mounted:
            return "not run: no file system may be mounted here"
        with filled(evaluation.folder, evaluation.rng.randrange(4096, 8192)):
            command = evaluation.start()
            problem = command.problem(1)
            reported = "No space left" in command.output()
            problem = problem or ("" if reported else command.last_lines())
        problem = problem or evaluation.start().problem(0)
        if not problem:  # the folder is copied before its disk is unmounted
            shutil.copytree(evaluation.folder, evaluation.folder.with_name("kept"))
        return problem


FAULTS: dict[str, Callable[[Evaluation], str]] = {
    "SIGKILL": lambda e: send_signal(e, signal.SIGKILL),
    "SIGTERM": lambda e: send_signal(e, signal.SIGTERM),
    "SIGINT": lambda e: send_signal(e, signal.SIGINT),
    "worker killed": kill_worker,
    "worker stands still": pause_worker,
    "two in one folder": start_twice,
    "last row cut": cut_row,
    "clock jumps": lambda e: e.start(JUMPING_CLOCK).problem(0),
    "full disk": fill_disk,
    "folder removed": remove_folder,
    "damaged line": damage_line,
    "link instead of a file": plant_link,
    "closed stdout": lambda e: e.start(redirect=">&-").problem(0),
    "closed reader of stdout": lambda e: e.start(redirect="| head -n 1").problem(0),
    "output in ASCII": lambda e: e.start(ASCII_OUTPUT).problem(0),
    "Ray worker killed": kill_ray_worker,
    "SLURM job killed": kill_slurm_job,
}


def break_evaluation(out: Path, seed: int, faults: list[str]) -> dict[str, str]:
    """Return the outcome of each fault, which is "survived", "not run: ..." or the problem.

    Each fault is injected into a separate evaluation, which is then finished and compared.
    """
    rng = random.Random(f"{seed} evaluation")
    unbroken = Evaluation(out / "unbroken", rng)
    problem = unbroken.start().problem(0)
    if problem:
        return {UNBROKEN: problem}
    expected = unbroken.rows()
    if not expected:
        return {UNBROKEN: f"it wrote no {ROWS}"}
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
        # the folder is in use while the disturbed evaluation is still running
        if "is in use" not in command.output():
            return problem
        time.sleep(1.0)
    return problem
