"""Chains of programs, such as a training and its evaluation, as jobs of any launcher.

Each chain has a folder that all machines see and whose programs go on where they stopped: a chain
whose machine died is begun again on another, and what it had finished is kept.
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
from mitigate.core.files import make_folder
from mitigate.core.output import open_output
from mitigate.core.progress import Progress

PAUSE = 0.1  # seconds between two looks at programs that run
GRACE = 30.0  # seconds in which a program that was asked to end may save (ours)


@dataclass(frozen=True)
class Chain:
    """Programs that are run one after the other while each ends with 0.

    name: for lines about it. programs: (what it is, its words). log: gets their output. folder:
    where they run. environment: beside that of whoever runs them.
    """

    name: str
    programs: tuple[tuple[str, tuple[str, ...]], ...]
    log: Path
    folder: Path
    environment: dict[str, str] = field(default_factory=dict)


@dataclass
class Outcome:
    """``problem``: what went wrong, empty if nothing did. ``seconds``: of CPUs, by program."""

    problem: str = ""
    seconds: dict[str, float] = field(default_factory=dict)


class Running:
    """A chain that runs on this machine; :meth:`poll` until it gives an outcome."""

    def __init__(self, chain: Chain) -> None:
        self.chain, self.outcome = chain, Outcome()
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
                start_new_session=True,  # Ctrl-C reaches it once, through us
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
            )

    def poll(self) -> Outcome | None:
        """The outcome; None while it runs."""
        ended, status, used = os.wait4(self.process.pid, os.WNOHANG)
        if not ended:
            return None
        self.process.returncode = os.waitstatus_to_exitcode(status)
        spent = self.outcome.seconds
        spent[self.what] = spent.get(self.what, 0.0) + used.ru_utime + used.ru_stime
        if self.process.returncode:
            log = self.chain.log
            said = log.read_text("utf-8", "replace").strip() if log.is_file() else "its log is lost"
            last = " ".join(said.splitlines()[-1:])[-400:]
            self.outcome.problem = f"{self.what} ended with {self.process.returncode} ({last})"
        elif self.left:
            self._next()
            return None
        return self.outcome

    def end(self) -> None:
        """Ask the program that runs to save and end, and see to it that it does."""
        if self.process.returncode is not None:
            return
        with suppress(ProcessLookupError):
            self.process.send_signal(signal.SIGTERM)
        try:
            self.process.wait(GRACE)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()


class ChainTask:
    """Chains as what workers do (``core/workers.py``): the result is (problem, seconds)."""

    preload: ClassVar[str] = "mitigate.cluster.programs"

    def ready(self) -> AbstractContextManager[None]:
        return nullcontext()

    def work(self, jobs: Sequence[Chain]) -> Iterator[tuple[str, dict[str, float]]]:
        """Run each chain to its end."""
        for chain in jobs:
            running = Running(chain)
            try:
                while (outcome := running.poll()) is None:
                    time.sleep(PAUSE)
            finally:
                running.end()
            yield outcome.problem, outcome.seconds

    def name(self, job: Chain) -> str:
        return job.name


def run(
    chains: Sequence[Chain],
    jobs: int,
    launcher: LauncherConfig,
    progress: Progress,
    told: Callable[[int, Outcome], None],
) -> None:
    """Run ``chains``, ``jobs`` at a time, on the machines of ``launcher``; call ``told`` with the
    number of each that ended and its outcome. When it is stopped, so are they, on this machine
    after they saved. Raises WorkersDied for a chain that no worker survives."""
    if launcher.name == "local":
        return _run_here(list(enumerate(chains)), jobs, told)
    groups = [[chain] for chain in chains]
    for found in launchers.results(launcher, ChainTask(), groups, jobs, progress):
        if found is not None:
            problem, seconds = found[1]
            told(found[0], Outcome(problem, dict(seconds)))


def _run_here(
    waiting: list[tuple[int, Chain]], jobs: int, told: Callable[[int, Outcome], None]
) -> None:
    running: dict[int, Running] = {}
    try:
        while waiting or running:
            while waiting and len(running) < jobs:
                number, chain = waiting.pop(0)
                running[number] = Running(chain)
            for number, one in list(running.items()):
                outcome = one.poll()
                if outcome is not None:
                    del running[number]
                    told(number, outcome)
            time.sleep(PAUSE)
    finally:
        for one in running.values():  # all at once, so that they save side by side
            with suppress(ProcessLookupError):
                one.process.send_signal(signal.SIGTERM)
        for one in running.values():
            one.end()


def python(*arguments: str) -> tuple[str, ...]:
    """The words of ``python -m ...`` in this very Python."""
    return (sys.executable, "-m", *arguments)
