"""Run a program of another project under the suite: ``mitigate run suite=full -- COMMAND``.

The command is run once for each condition, unchanged, clean first; what its processes see and hear
is corrupted on the way (``hook/mitigate_hook.py``). The rows, and the table with PRS, go to the
output folder; the same command again goes on where it stopped.
"""

from __future__ import annotations

import os
import shlex
import signal
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import ClassVar

import hydra
from omegaconf import DictConfig

from mitigate.bridge.attempt import Attempt
from mitigate.bridge.cell import Cell, check_finished, files_of
from mitigate.bridge.condition import NO_TOKENIZER, applicable, untold
from mitigate.bridge.config import RunConfig
from mitigate.bridge.plan import Plan, cells, make_plan
from mitigate.cluster.launcher import chosen, results
from mitigate.core import conf
from mitigate.core.output import output_folder
from mitigate.core.progress import Progress
from mitigate.core.signals import raise_ended
from mitigate.corruptions.language.text import is_english, passed_through
from mitigate.guards.text.addresses import check_arguments

EVERY = 15.0  # seconds between two lines of progress (ours)
PAUSE = 0.2  # seconds between two looks at a command that runs
REASON = 100  # characters of why a condition failed, before it is told in full (ours)


def split_command(arguments: Sequence[str]) -> tuple[list[str], list[str]]:
    """Return the options before ``--`` and the command behind it."""
    if "--" not in arguments:
        return list(arguments), []
    at = list(arguments).index("--")
    return list(arguments[:at]), list(arguments[at + 1 :])


def run(config: RunConfig, command: Sequence[str]) -> Path:
    """Run ``command`` under all conditions; return the output folder.

    Raises ValueError for options that make no sense and, behind all others, for conditions whose
    command failed.
    """
    plan = make_plan(config, command)
    made = cells(plan)
    check_finished(plan.out)
    with output_folder(plan.out):
        return _measure(plan, made)


def _measure(plan: Plan, made: Sequence[Cell]) -> Path:
    """Run the cells ``made`` and write the report; raise as :func:`run` does."""
    from mitigate.bridge.report import write_report

    out = plan.out
    clean = made[0]
    many = "1 condition" if len(made) == 1 else f"{len(made)} conditions"
    print(
        f"run: {shlex.join(plan.command)}\nrun: {many} at severity {plan.config.severity:g}, "
        f"rows in {out}",
        flush=True,
    )
    known = _warn_of_changes(made, out)
    before = clean.is_done()
    problems = _run_all(plan, [clean])
    if problems:
        raise ValueError("\n".join(problems))
    _check_rule([clean])
    strange = clean.depth_warning()
    if strange:
        print(strange, flush=True)  # before hours of the others, and at the end
    fitting, unheard = _fitting(made)
    if unheard:
        problems = [f"{', '.join(unheard)}: {NO_TOKENIZER}"]
        print(*problems, flush=True)  # before hours of the others
    _check_rule(fitting)
    nothing = before and all(cell.is_done() for cell in fitting)
    if nothing:
        print(
            f"run: nothing was left to run, all is in {out}; to measure anew, name another folder "
            "(out=...), or remove this one.",
            flush=True,
        )
    problems += _run_all(plan, fitting)
    _warn_of_changes([clean, *fitting], out, known if nothing else ())
    problems += _vanished(fitting, problems)
    if not clean.is_done():  # a condition showed that it is not whole
        raise ValueError("\n".join(problems) or f"{clean.name}: {clean.reason_to_repeat()}")
    try:
        write_report([clean, *fitting], out)
    except ValueError as error:  # conditions that failed are told first
        raise ValueError("\n".join([*problems, str(error)])) from error
    if strange:
        print(strange, flush=True)
    if problems:
        raise ValueError("Some conditions failed; run again to go on.\n" + "\n".join(problems))
    return out


def _vanished(made: Sequence[Cell], problems: Sequence[str]) -> list[str]:
    """Name the conditions that did not fail and whose result is missing all the same."""
    failed = {problem.partition(":")[0] for problem in problems}
    return [
        f"{cell.name}: its result in {cell.folder} was removed or replaced by another program."
        for cell in made
        if cell.name not in failed and cell.entries() is None
    ]


def _check_rule(made: Sequence[Cell]) -> None:
    """Raise ValueError for a condition that was measured before and that ``rule=`` cannot judge."""
    for cell in made:
        if cell.is_done() and (lacking := cell.unjudged()):
            raise ValueError(
                f"{cell.name}: {lacking} It was measured before; out=... names another folder."
            )


def _fitting(made: Sequence[Cell]) -> tuple[list[Cell], list[str]]:
    """The conditions beside clean that reach the agent, and the names of those whose words it would
    not hear; say which do not, and which words are in other languages."""
    fitting, unheard, told = [], [], made[0].told()
    for cell in made[1:]:
        reason = applicable(cell.corruption, told)
        if reason:
            print(f"{cell.name}: not applicable, {reason}", flush=True)
        elif untold(cell.corruption, told, cell.condition.words):
            unheard.append(cell.name)
        else:
            fitting.append(cell)
    others = Counter(str(spoken) for spoken in told.languages.values() if not is_english(spoken))
    if others and any("instruction" in cell.corruption.modalities for cell in fitting):
        print(f"run: {passed_through(others)}", flush=True)
    return fitting, unheard


def _warn_of_changes(made: Sequence[Cell], out: Path, known: Sequence[str] = ()) -> list[str]:
    """Say which files of the command, but those that are ``known``, are others than conditions were
    finished with; return these."""
    changed: dict[str, list[str]] = {}
    now = files_of(made[0].command)
    for cell in made:
        for file in cell.changed_files(now):
            changed.setdefault(file, []).append(cell.name)
    for file, names in changed.items():
        if file in known:
            continue
        more = f" and {len(names) - 3} more" if len(names) > 3 else ""
        was = "was" if len(names) == 1 else "were"
        print(
            f"run: {file} changed since {', '.join(names[:3])}{more} {was} run, whose old results "
            "are kept, and stand in one table with new ones: out=... measures the new one, or "
            f"remove {out / 'conditions'}. watch=[{file}] makes it another agent.",
            flush=True,
        )
    return list(changed)


def _run_all(plan: Plan, waiting: Sequence[Cell]) -> list[str]:
    """Run cells, ``plan.config.jobs`` at a time, where the launcher says; return what went "
    "wrong."""
    if plan.config.launcher.name == "local":
        return _run_here(waiting, plan.config.jobs)
    return run_there(plan, waiting)


def _run_here(waiting: Sequence[Cell], jobs: int) -> list[str]:
    left = list(waiting)
    problems: list[str] = []
    running: list[Attempt] = []
    spoke = time.monotonic()
    try:
        while left or running:
            while left and len(running) < jobs:
                cell = left.pop(0)
                if cell.is_done():
                    print(f"{cell.name}: done before, {cell.summary()}", flush=True)
                    continue
                attempt = Attempt(cell)
                running.append(attempt)  # before: whatever interrupts its start, it is ended
                if refused := _begin(attempt):  # the others go on
                    running.remove(attempt)
                    problems.append(f"{cell.name}: {refused}")
            time.sleep(PAUSE)
            for attempt in list(running):
                problem = attempt.poll()
                if problem is None:
                    continue
                running.remove(attempt)
                cell = attempt.cell
                print(f"{cell.name}: {_outcome(cell, problem, len(waiting) == 1)}", flush=True)
                problems += [f"{cell.name}: {problem}"] if problem else []
            if running and time.monotonic() - spoke > EVERY:
                spoke = time.monotonic()
                for attempt in running:
                    print(f"{attempt.cell.name}: {attempt.cell.summary()}", flush=True)
    finally:
        for attempt in running:
            attempt.kill()
    return problems


def _begin(attempt: Attempt) -> str:
    """Start an attempt; return why it cannot be, empty if it was."""
    cell = attempt.cell
    again = f", measured anew: {why}" if (why := cell.reason_to_repeat()) else ""
    try:
        attempt.start()
    except ValueError as error:
        attempt.kill()
        print(f"{cell.name}: {error}", flush=True)
        return str(error)
    print(f"{cell.name}: started{again}; its output is in {cell.log}", flush=True)
    return ""


def _outcome(cell: Cell, problem: str, alone: bool) -> str:
    """One line on a condition that ended: its summary, or that it failed. Why is told in full at
    the end, which is now where it ran ``alone``."""
    if not problem:
        return cell.summary()
    first = problem.splitlines()[0]
    return "failed" if alone else f"failed: {first[:REASON]}{'...' * (len(first) > REASON)}"


class ConditionTask:
    """Runs conditions by name (``core/workers.py``) as jobs on other machines.

    The result of a job is what went wrong, empty if nothing did. The folder of the run is on a file
    system that all machines see. A condition that ended is kept; one whose machine died is measured
    again on another, since a program that no one may change cannot be resumed.

    Args:
        plan: The run; its output folder is absolute.
        here: The folder in which the command is to run.
    """

    preload: ClassVar[str] = "mitigate.bridge.run"

    def __init__(self, plan: Plan, here: Path) -> None:
        self.plan = plan
        self.here = here
        self.cells: dict[str, Cell] = {}

    @contextmanager
    def ready(self) -> Iterator[None]:
        before = os.getcwd()
        os.chdir(self.here)
        try:
            self.cells = {cell.name: cell for cell in cells(self.plan)}
            yield
        finally:
            os.chdir(before)

    def work(self, jobs: Sequence[str]) -> Iterator[str]:
        """Run the command under each condition to its end."""
        for name in jobs:
            attempt = Attempt(self.cells[name])
            try:
                attempt.start()
                while (problem := attempt.poll()) is None:
                    time.sleep(PAUSE)
            except ValueError as error:  # it cannot be started: the others can
                problem = str(error)
            finally:
                attempt.kill()
            yield problem

    def name(self, job: str) -> str:
        return job


def run_there(plan: Plan, waiting: Sequence[Cell]) -> list[str]:
    """Run ``waiting`` on the machines of the launcher, ``jobs`` at a time; return what went wrong.
    Raises WorkersDied for a condition that no worker survives."""
    left = [cell for cell in waiting if not cell.is_done()]
    for cell in waiting:
        if cell not in left:
            print(f"{cell.name}: done before, {cell.summary()}", flush=True)
    if not left:
        return []
    task = ConditionTask(replace(plan, out=plan.out.resolve()), Path.cwd())
    groups, launcher = [[cell.name] for cell in left], chosen(plan.config.launcher)
    problems = []
    with Progress("conditions", len(left), unit="condition") as progress:
        for found in results(launcher, task, groups, plan.config.jobs, progress):
            if found is None:
                continue
            cell, problem = left[found[0]], str(found[1])
            progress.say(f"{cell.name}: {_outcome(cell, problem, len(waiting) == 1)}")
            problems += [f"{cell.name}: {problem}"] if problem else []
            progress.advance()
    return problems


@hydra.main(version_base="1.3", config_path=str(conf.CONF), config_name="run")
def hydra_main(cfg: DictConfig) -> None:
    """Hydra's entry."""
    config = conf.typed(cfg, "run")
    assert isinstance(config, RunConfig)
    if config.check:
        from mitigate.bridge.check import check

        check(config, _command)
    else:
        run(config, _command)


_command: list[str] = []  # behind --


def main() -> None:
    """Run from the command line."""
    options, command = split_command(sys.argv[1:])
    _command[:] = command
    signal.signal(signal.SIGHUP, raise_ended)  # of a terminal: as Ctrl-C; SIGTERM is conf's
    options = ["check=true" if option == "--check" else option for option in options]
    sys.argv[1:] = options
    conf.main(hydra_main, "run", lambda: _check_line(options), ["--", *command] if command else ())


def _check_line(options: Sequence[str]) -> None:
    """Raise ValueError for a safeguard's address that is none, and for a command without ``--``."""
    check_arguments(options)
    words = [option for option in options if "=" not in option and option[:1] not in ("-", "~")]
    if words:
        raise ValueError(
            f"{words[0]} is no option, which is written key=value. If it begins the command to "
            "run, put -- before it: mitigate run corruption=spatter -- python agent.py"
        )
