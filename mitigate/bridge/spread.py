"""Conditions of ``mitigate run`` on other machines: a command under one condition is a job.

Its folder is on a file system that all machines see. A condition that ended is kept; one whose
machine died is measured anew on another, since a program that nobody may change cannot go on.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, ClassVar

from omegaconf import DictConfig, OmegaConf

from mitigate.bridge import verdict
from mitigate.bridge.cell import Cell
from mitigate.bridge.conditions import cells
from mitigate.core.progress import Progress
from mitigate.scale.launcher import chosen, results

PAUSE = 0.2  # seconds between two looks at a command that runs


class ConditionTask:
    """Runs conditions by name (``core/workers.py``); the result is what went wrong, empty if
    nothing did.

    settings: the run's config as plain data. command: as typed. out: folder of the run. name: of
    its column. here: the folder in which the command is to run.
    """

    preload: ClassVar[str] = "mitigate.bridge.spread"

    def __init__(
        self, settings: dict[str, Any], command: Sequence[str], out: Path, name: str, here: Path
    ) -> None:
        self.settings, self.command, self.out, self.column = settings, list(command), out, name
        self.here = here
        self.cells: dict[str, Cell] = {}

    @contextmanager
    def ready(self) -> Iterator[None]:
        before = os.getcwd()
        os.chdir(self.here)
        try:
            made = cells(OmegaConf.create(self.settings), self.command, self.out, self.column)
            self.cells = {cell.name: cell for cell in made}
            yield
        finally:
            os.chdir(before)

    def work(self, jobs: Sequence[str]) -> Iterator[str]:
        """Run the command under each condition to its end."""
        for name in jobs:
            cell = self.cells[name]
            try:
                cell.start()
                while (problem := cell.poll()) is None:
                    time.sleep(PAUSE)
            except ValueError as error:  # it cannot be started: the others can
                problem = str(error)
            finally:
                cell.kill()
            yield problem

    def name(self, job: str) -> str:
        return job


def run_there(
    cfg: DictConfig, command: Sequence[str], out: Path, name: str, waiting: Sequence[Cell]
) -> list[str]:
    """Run ``waiting`` on the machines of ``cfg.launcher``, ``cfg.jobs`` at a time; return what went
    wrong. Raises WorkersDied for a condition that no worker survives."""
    left = [cell for cell in waiting if not cell.is_done()]
    for cell in waiting:
        if cell not in left:
            print(f"{cell.name}: done before, {cell.summary()}", flush=True)
    if not left:
        return []
    settings = OmegaConf.to_container(cfg, resolve=True)
    assert isinstance(settings, dict)
    task = ConditionTask(
        {str(key): value for key, value in settings.items()},
        command,
        out.resolve(),
        name,
        Path.cwd(),
    )
    groups, launcher = [[cell.name] for cell in left], chosen(cfg.launcher)
    problems = []
    with Progress("conditions", len(left), unit="condition") as progress:
        for found in results(launcher, task, groups, cfg.jobs, progress):
            if found is None:
                continue
            cell, problem = left[found[0]], str(found[1])
            progress.say(f"{cell.name}: {verdict.outcome(cell, problem, len(waiting) == 1)}")
            problems += [f"{cell.name}: {problem}"] if problem else []
            progress.advance()
    return problems
