"""Run a program of another project under the corruption suite: ``mitigate run suite=full --
COMMAND``.

The command runs unchanged, once per condition; the first condition is "clean". The frames and
instructions of its processes are corrupted (``hook/mitigate_hook.py``). Rows and a table with PRS
are written to the output folder. If the same command is run again, it skips finished conditions.
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

from omegaconf import DictConfig

from mitigate.bridge.attempt import Attempt
from mitigate.bridge.cell import Cell, hash_files, read_done
from mitigate.bridge.condition import NO_TOKENIZER, needs_tokenizer, why_not_applicable
from mitigate.bridge.config import RunConfig
from mitigate.bridge.events import DONE
from mitigate.bridge.plan import Plan, make_cells, make_plan
from mitigate.cluster.launcher import chosen, results
from mitigate.core import conf
from mitigate.core.names import counted
from mitigate.core.output import output_folder
from mitigate.core.progress import Progress, say
from mitigate.core.signals import raise_ended
from mitigate.corruptions.language.text import is_english, passed_through

PROGRESS_INTERVAL = 15.0  # seconds between two lines of progress (heuristic)
PAUSE = 0.2  # seconds between two polls of a running command
# maximum length of an error message in a progress line, in characters (heuristic)
MAX_REASON = 100


def split_command(arguments: list[str]) -> tuple[list[str], list[str]]:
    """Return the options before ``--`` and the command after it."""
    index = arguments.index("--") if "--" in arguments else len(arguments)
    return arguments[:index], arguments[index + 1 :]


def run(config: RunConfig, command: Sequence[str]) -> Path:
    """Run ``command`` under all conditions; return the output folder.

    Raises:
        ValueError: If an option is invalid, or the command failed under some conditions. In that
            case, the error is raised after all other conditions have been measured.
    """
    plan = make_plan(config, command)
    cells = make_cells(plan)
    for file in sorted((plan.out / "conditions").glob(f"*/{DONE}")):
        read_done(file.parent)  # raises ValueError if the folder is damaged
    with output_folder(plan.out):
        _measure(plan, cells)
    return plan.out


def _measure(plan: Plan, cells: Sequence[Cell]) -> None:
    """Run all conditions and write the report. Raises the same errors as :func:`run`."""
    from mitigate.bridge.report import write_report

    out = plan.out
    clean = cells[0]
    say(
        f"run: {shlex.join(plan.command)}\nrun: {counted(len(cells), 'condition')} at severity "
        f"{plan.config.severity:g}, rows in {out}"
    )
    known = _warn_changed_files(cells, out)
    was_done = clean.is_done()
    problems = run_all(plan, [clean])
    if problems:
        raise ValueError("\n".join(problems))
    _check_rule([clean])
    if depth_warning := clean.depth_warning():
        # check it now, before hours of measuring, and again at the end
        say(depth_warning)
    applicable, untokenized = _select_applicable(cells)
    if untokenized:
        problems = [f"{', '.join(untokenized)}: {NO_TOKENIZER}"]
        print(*problems, flush=True)  # print them now, before hours of measuring
    _check_rule(applicable)
    all_done = was_done and all(cell.is_done() for cell in applicable)
    if all_done:
        say(
            f"run: nothing was left to run, all results are in {out}. To measure again, choose "
            "another folder (out=...), or remove this one."
        )
    problems += run_all(plan, applicable)
    _warn_changed_files([clean, *applicable], out, known if all_done else ())
    problems += _describe_removed(applicable, problems)
    if not clean.is_done():  # a corrupted condition had episodes that the clean condition lacks
        raise ValueError("\n".join(problems) or f"{clean.name}: {clean.reason_to_repeat()}")
    try:
        write_report([clean, *applicable], out)
    except ValueError as error:  # list the failed conditions before this error
        raise ValueError("\n".join([*problems, str(error)])) from error
    if depth_warning:
        say(depth_warning)
    if problems:
        raise ValueError(
            "Some conditions failed. Run the same command again to continue.\n"
            + "\n".join(problems)
        )


def _describe_removed(cells: Sequence[Cell], problems: Sequence[str]) -> list[str]:
    """Return a description for each condition that did not fail but has no result."""
    failed = {problem.partition(":")[0] for problem in problems}
    return [
        f"{cell.name}: its result in {cell.folder} was removed or replaced by another program."
        for cell in cells
        if cell.name not in failed and cell.entries() is None
    ]


def _check_rule(cells: Sequence[Cell]) -> None:
    """Raise ValueError if ``rule=`` cannot judge a condition that an earlier run measured."""
    for cell in cells:
        if cell.is_done() and (problem := cell.rule_problem()):
            raise ValueError(
                f"{cell.name}: {problem} This condition has already been measured. To measure it "
                "again, choose another folder (out=...)."
            )


def _select_applicable(cells: Sequence[Cell]) -> tuple[list[Cell], list[str]]:
    """Return the conditions whose corruption can reach the agent.

    The function prints the other conditions, and the number of instructions in other languages.

    Returns:
        The conditions, and the names of conditions that need a tokenizer but have none.
    """
    applicable: list[Cell] = []
    untokenized: list[str] = []
    reports = cells[0].reports()
    for cell in cells[1:]:
        reason = why_not_applicable(cell.corruption, reports)
        if reason:
            say(f"{cell.name}: not applicable, {reason}")
        elif needs_tokenizer(cell.corruption, reports, cell.condition.words):
            untokenized.append(cell.name)
        else:
            applicable.append(cell)
    others = Counter(str(name) for name in reports.languages.values() if not is_english(name))
    if others and any("instruction" in cell.corruption.modalities for cell in applicable):
        say(f"run: {passed_through(others)}")
    return applicable, untokenized


def _warn_changed_files(cells: Sequence[Cell], out: Path, known: Sequence[str] = ()) -> list[str]:
    """Print and return the files that have changed since a condition finished.

    Only the files that the command line names are compared. Files in ``known``, and files that the
    command created, are returned but not printed.
    """
    changed: dict[str, list[str]] = {}
    created: set[str] = set()
    now = hash_files(cells[0].command)
    for cell in cells:
        if entries := cell.entries():
            created.update(entries["created"])
            for file, before in entries["files"].items():
                if now.get(file) != before:
                    changed.setdefault(file, []).append(cell.name)
    for file, names in changed.items():
        if file in known or file in created:
            continue
        more = f" and {len(names) - 3} more" if len(names) > 3 else ""
        was = "was" if len(names) == 1 else "were"
        say(
            f"run: {file} changed since {', '.join(names[:3])}{more} {was} run. One table holds "
            f"old and new results. To measure again, remove {out / 'conditions'}, choose another "
            f"folder (out=...), or set watch=[{file}]. If the command writes this file, name it "
            f"{{out}}/{Path(file).name} in the command."
        )
    return list(changed)


def run_all(plan: Plan, cells: Sequence[Cell]) -> list[str]:
    """Run unfinished conditions with the launcher, ``plan.config.jobs`` at a time.

    Return the problems.
    """
    waiting = [cell for cell in cells if not cell.is_done()]
    for cell in cells:
        if cell not in waiting:
            say(f"{cell.name}: done before, {cell.summary()}")
    if plan.config.launcher.name == "local":
        return _run_here(waiting, plan.config.jobs)
    return _run_on_launcher(plan, waiting)


def _run_here(cells: Sequence[Cell], jobs: int) -> list[str]:
    """Run conditions on this machine, ``jobs`` at a time; return the problems."""
    waiting = list(cells)
    problems: list[str] = []
    running: list[Attempt] = []
    last_print = time.monotonic()
    try:
        while waiting or running:
            while waiting and len(running) < jobs:
                attempt = Attempt(waiting.pop(0))
                # append the attempt first, so that it is also killed if _start() is interrupted
                running.append(attempt)
                if start_problem := _start(attempt):  # the other conditions continue
                    running.remove(attempt)
                    problems.append(f"{attempt.cell.name}: {start_problem}")
            time.sleep(PAUSE)
            for attempt in list(running):
                problem = attempt.poll()
                if problem is not None:
                    running.remove(attempt)
                    problems += _report(attempt.cell, problem, len(cells) == 1)
            if running and time.monotonic() - last_print > PROGRESS_INTERVAL:
                last_print = time.monotonic()
                for attempt in running:
                    say(f"{attempt.cell.name}, so far: {attempt.cell.summary()}")
    finally:
        for attempt in running:
            attempt.kill()
    return problems


def _start(attempt: Attempt) -> str:
    """Start an attempt; return the reason why it cannot be started, or ""."""
    cell = attempt.cell
    again = f", measured again: {reason}" if (reason := cell.reason_to_repeat()) else ""
    try:
        attempt.start()
    except ValueError as error:
        attempt.kill()
        say(f"{cell.name}: {error}")
        return str(error)
    say(f"{cell.name}: started{again}; its output is in {cell.log}")
    return ""


def _report(cell: Cell, problem: str, single: bool) -> list[str]:
    """Print one line about a condition that ended: its summary or its error message.

    The error message is cut to ``MAX_REASON`` characters. It is omitted if the run has only this
    condition (``single``), because the full message is then printed next.

    Returns:
        A list with the error message, preceded by the condition's name; empty if there is none.
    """
    if not problem:
        say(f"{cell.name}: {cell.summary()}")
        return []
    line = problem.splitlines()[0]
    reason = "" if single else f": {line[:MAX_REASON]}{'...' * (len(line) > MAX_REASON)}"
    say(f"{cell.name}: failed{reason}")
    return [f"{cell.name}: {problem}"]


class ConditionTask:
    """Task for running conditions on other machines (``core/workers.py``).

    Each job is the name of a condition; its result is a description of its problem, or "". All
    machines must share the file system of the run's folder, whose path must be absolute. If a
    machine dies, its condition is measured again from the start, because the user's program cannot
    resume. The command runs in ``folder``.
    """

    preload: ClassVar[str] = "mitigate.bridge.run"

    def __init__(self, plan: Plan, folder: Path) -> None:
        self.plan = plan
        self.folder = folder
        self.cells: dict[str, Cell] = {}

    @contextmanager
    def ready(self) -> Iterator[None]:
        before = os.getcwd()
        os.chdir(self.folder)
        try:
            self.cells = {cell.name: cell for cell in make_cells(self.plan)}
            yield
        finally:
            os.chdir(before)

    def work(self, jobs: Sequence[str]) -> Iterator[str]:
        """Run the command to its end under each condition."""
        for name in jobs:
            attempt = Attempt(self.cells[name])
            try:
                attempt.start()
                while (problem := attempt.poll()) is None:
                    time.sleep(PAUSE)
            # if one command cannot be started, other conditions continue
            except ValueError as error:
                problem = str(error)
            finally:
                attempt.kill()
            yield problem

    def name(self, job: str) -> str:
        return job


def _run_on_launcher(plan: Plan, cells: Sequence[Cell]) -> list[str]:
    """Run conditions on the launcher's machines, ``jobs`` at a time; return the problems.

    Raises:
        WorkersDied: If several workers died while running the same condition.
    """
    if not cells:
        return []
    task = ConditionTask(replace(plan, out=plan.out.resolve()), Path.cwd())
    groups = [[cell.name] for cell in cells]
    launcher = chosen(plan.config.launcher)
    problems = []
    with Progress("conditions", len(cells), unit="condition") as progress:
        for result in results(launcher, task, groups, plan.config.jobs, progress):
            if result is None:
                continue
            problems += _report(cells[result[0]], result[1], len(cells) == 1)
            progress.advance()
    return problems


def main() -> None:
    """Run from the command line."""
    options, command = split_command(sys.argv[1:])
    # SIGHUP is sent when the terminal closes; core/conf.py handles SIGTERM
    signal.signal(signal.SIGHUP, raise_ended)
    options = ["check=true" if option == "--check" else option for option in options]
    sys.argv[1:] = options

    def program(cfg: DictConfig) -> None:
        config = conf.typed(cfg, "run")
        if config.check:
            from mitigate.bridge.check import check

            check(config, command)
        else:
            run(config, command)

    behind = ["--", *command] if command else ()
    conf.main(conf.hydra_program("run", program), "run", lambda: _check_line(options), behind)


def _check_line(options: Sequence[str]) -> None:
    """Raise ValueError for a command without ``--``."""
    words = [option for option in options if "=" not in option and option[:1] not in ("-", "~")]
    if words:
        raise ValueError(
            f"Options must be key=value, got {words[0]}. If this is the start of the command to "
            "run, write -- before it: mitigate run conditions=[spatter] -- python agent.py"
        )
