"""Evaluations broken in many ways; their rows must be the bytes of an unbroken one's."""

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
from tools.faults.training import NOTICED, STATUS, TRIES, one_refused

OPTIONS = ("checkpoint=checkpoints/base", "episodes=8", "suite=quick", "workers=2")
ROWS = "rows.jsonl"
DISK = 60  # MB
LATE = "not run: the evaluation was done before"


class Evaluation:
    """An evaluation in ``folder``."""

    def __init__(self, folder: Path, rng: random.Random) -> None:
        self.folder, self.rng, self.started = folder, rng, 0
        self.arguments = ["mitigate.evaluate", *OPTIONS, f"out={folder}", f"runs={folder}"]

    def start(self, environment: dict[str, str] | None = None) -> Command:
        """Start it, or let it go on."""
        self.started += 1
        name = f"{self.folder.name}-{self.started}.txt"
        return Command(self.arguments, self.folder.parent / name, environment)

    def under_way(self, environment: dict[str, str] | None = None) -> Command:
        """As :meth:`start`, and wait until some rows, drawn at random, are written."""
        command, some = self.start(environment), self.rng.randint(1, 9)
        command.wait_for(lambda: self.rows().count(b"\n") >= some)
        return command

    def rows(self) -> bytes:
        """The rows that are written."""
        path = self.folder / ROWS
        return path.read_bytes() if path.is_file() else b""


def signalled(evaluation: Evaluation, number: int) -> str:
    command = evaluation.under_way()
    if not command.runs():
        return LATE
    command.process.send_signal(number)
    problem = command.problem(STATUS[signal.Signals(number)], 0)
    return LATE if not problem and command.process.returncode == 0 else problem


def worker_killed(evaluation: Evaluation) -> str:
    command = evaluation.under_way()
    found = workers(command)
    if not found:
        return LATE
    os.kill(evaluation.rng.choice(found), signal.SIGKILL)
    told = command.wait_for(lambda: "A worker process was" in command.said(), NOTICED)
    return "" if told else f"not noticed within {NOTICED:g} s: {command.end()}"


def worker_stopped(evaluation: Evaluation) -> str:
    command = evaluation.under_way()
    found = workers(command)
    if not found:
        return LATE
    os.kill(found[0], signal.SIGSTOP)
    time.sleep(3.0)
    os.kill(found[0], signal.SIGCONT)
    return ""


def jumping_clock(evaluation: Evaluation) -> str:
    clock = {"PYTHONPATH": str(Path(__file__).parent / "clock")}
    return evaluation.start(clock).problem(0)


def second(evaluation: Evaluation) -> str:
    return one_refused([evaluation.start(), evaluation.start()])


def cut(evaluation: Evaluation) -> str:
    """The last row is cut off, as when a machine loses power while it is written."""
    command = evaluation.under_way()
    command.process.kill()
    command.process.wait()
    rows = evaluation.rows()
    (evaluation.folder / ROWS).write_bytes(rows[: len(rows) - evaluation.rng.randint(1, 200)])
    return ""


def full_disk(evaluation: Evaluation) -> str:
    with small_disk(evaluation.folder, DISK) as there:
        if not there:
            return "not run: no file system may be mounted here"
        with filled(evaluation.folder, evaluation.rng.randrange(4096, 8192)):
            command = evaluation.start()
            problem = command.problem(1)
            problem = problem or ("" if "No space left" in command.said() else command.end())
        return problem or evaluation.start().problem(0) or kept(evaluation)


def kept(evaluation: Evaluation) -> str:
    """Rows of a disk that is about to go."""
    rows = evaluation.rows()
    shutil.copytree(evaluation.folder, evaluation.folder.with_name("kept"))
    return "" if rows else "no rows"


FAULTS: dict[str, Callable[[Evaluation], str]] = {
    "SIGKILL": lambda e: signalled(e, signal.SIGKILL),
    "SIGTERM": lambda e: signalled(e, signal.SIGTERM),
    "SIGINT": lambda e: signalled(e, signal.SIGINT),
    "worker killed": worker_killed,
    "worker stands still": worker_stopped,
    "two in one folder": second,
    "last row cut": cut,
    "clock jumps": jumping_clock,
    "full disk": full_disk,
}


def break_evaluation(out: Path, seed: int, faults: list[str]) -> dict[str, str]:
    """What each fault came to, each in an evaluation of its own that is ended afterwards."""
    rng = random.Random(f"{seed} evaluation")
    unbroken = Evaluation(out / "unbroken", rng)
    problem = unbroken.start().problem(0)
    if problem:
        return {"unbroken": problem}
    wanted, found = unbroken.rows(), {}
    if not wanted:
        return {"unbroken": f"it wrote no {ROWS}"}
    for name in faults:
        for again in range(TRIES):
            evaluation = Evaluation(out / f"{name.replace(' ', '-')}-{again}", rng)
            problem = FAULTS[name](evaluation)
            if problem != LATE:
                break
        if name == "full disk" and not problem:
            evaluation.folder = evaluation.folder.with_name("kept")
        elif not problem:
            problem = ended(evaluation)
        if not problem and evaluation.rows() != wanted:
            problem = "other rows than unbroken"
        found[name] = problem or "survived"
    shutil.rmtree(out, ignore_errors=True)
    return found


def ended(evaluation: Evaluation) -> str:
    """Let what runs come to its end, and then the command once more."""
    for _ in range(600):
        command = evaluation.start()
        problem = command.problem(0)
        if "is in use" not in command.said():  # else the broken one is still at work
            return problem
        time.sleep(1.0)
    return problem
