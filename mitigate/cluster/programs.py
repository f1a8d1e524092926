"""Run chains of programs, such as a training run and its evaluation, as jobs of any launcher.

Each chain has a folder that all machines can access, and its programs can resume from that folder.
If a machine dies, its chain starts again on a different machine and keeps its finished work.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, nullcontext, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar

from mitigate.cluster import launcher as launchers
from mitigate.cluster import tied
from mitigate.cluster.config import LauncherConfig
from mitigate.core.files import last_lines, make_folder
from mitigate.core.output import open_output
from mitigate.core.progress import Progress

PAUSE = 0.1  # seconds between two checks of running programs
GRACE = 30.0  # seconds between SIGTERM and SIGKILL, for saving the state (heuristic)
# maximum length of a program's last line in an error message, in characters (heuristic)
REASON_WIDTH = 400


@dataclass(frozen=True)
class Chain:
    """Programs that run one after the other. The chain ends when a program exits with an error."""

    name: str
    # for each program, its kind and its command line (the program and its arguments)
    programs: tuple[tuple[str, tuple[str, ...]], ...]
    log: Path  # file for the output of the programs
    folder: Path
    environment: dict[str, str] = field(default_factory=dict)  # additional environment variables


class Running:
    """A chain that runs on this machine; call :meth:`poll` until it returns a string."""

    def __init__(self, chain: Chain) -> None:
        self.chain = chain
        self.left = list(chain.programs)
        make_folder(chain.log.parent)
        self._next()

    def _next(self) -> None:
        self.what, words = self.left.pop(0)
        chain = self.chain
        with open_output(chain.log, "a", encoding="utf-8") as log:
            self.process = subprocess.Popen(
                tied.words(list(words)),
                cwd=chain.folder,
                env={**os.environ, **chain.environment},
                # a new session, so that Ctrl-C reaches the program only through this process
                start_new_session=True,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
            )

    def poll(self) -> str | None:
        """Return None while a program runs; then return an error message, or ""."""
        code = self.process.poll()
        if code:
            return f"{self.what} ended with {code} ({_last_line(self.chain.log)})"
        if code == 0 and self.left:
            self._next()
            return None
        return None if code is None else ""

    def end(self) -> None:
        """Ask the running program to save and exit, and kill it after ``GRACE`` seconds."""
        if self.process.returncode is not None:
            return
        with suppress(ProcessLookupError):
            self.process.send_signal(signal.SIGTERM)
        try:
            self.process.wait(GRACE)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()


def _last_line(log: Path) -> str:
    if not log.is_file():
        return "its log is lost"
    with open(log, "rb") as file:
        return "".join(last_lines(file, 1, REASON_WIDTH))


class ChainTask:
    """Task that runs chains in workers; the result of a chain is its problem, or ""."""

    preload: ClassVar[str] = "mitigate.cluster.programs"

    def ready(self) -> AbstractContextManager[None]:
        return nullcontext()

    def work(self, jobs: Sequence[Chain]) -> Iterator[str]:
        """Run each chain to its end and yield its result."""
        for chain in jobs:
            running = Running(chain)
            try:
                while (problem := running.poll()) is None:
                    time.sleep(PAUSE)
            finally:
                running.end()
            yield problem

    def name(self, job: Chain) -> str:
        return job.name


def run(
    chains: Sequence[Chain],
    jobs: int,
    launcher: LauncherConfig,
    progress: Progress,
    ended: Callable[[int, str], None],
) -> None:
    """Run ``chains`` on the machines of ``launcher``, at most ``jobs`` chains at a time.

    When a chain has ended, ``ended`` is called with the chain's number and its problem, or "" after
    success. If this function is interrupted, all chains are stopped. Programs on this machine can
    save their state first.

    Raises:
        WorkersDied: If the worker process that ran a chain died too often.
    """
    if launcher.name == "local":
        return _run_here(list(enumerate(chains)), jobs, progress, ended)
    groups = [[chain] for chain in chains]
    for item in launchers.results(launcher, ChainTask(), groups, jobs, progress):
        if item is not None:
            ended(*item)


def _run_here(
    waiting: list[tuple[int, Chain]],
    jobs: int,
    progress: Progress,
    ended: Callable[[int, str], None],
) -> None:
    running: dict[int, Running] = {}
    try:
        while waiting or running:
            while waiting and len(running) < jobs:
                number, chain = waiting.pop(0)
                running[number] = Running(chain)
            for number, one in list(running.items()):
                problem = one.poll()
                if problem is not None:
                    del running[number]
                    ended(number, problem)
            progress.advance(0)
            time.sleep(PAUSE)
    finally:
        # signal all programs before waiting, so that they save their states in parallel
        for one in running.values():
            with suppress(ProcessLookupError):
                one.process.send_signal(signal.SIGTERM)
        for one in running.values():
            one.end()


def python(*arguments: str) -> tuple[str, ...]:
    """Return the command line ``python -m ...`` for the Python interpreter of this process."""
    return (sys.executable, "-m", *arguments)
