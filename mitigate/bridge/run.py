"""Run a program of another project under the suite: ``mitigate run suite=full -- COMMAND``.

The command is run once for each condition, unchanged, clean first; what its processes see and hear
is corrupted on the way (``hook/mitigate_hook.py``). The rows, and the table with PRS, go to the
output folder; the same command again goes on where it stopped.
"""

from __future__ import annotations

import shlex
import signal
import sys
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import hydra
from omegaconf import MISSING, DictConfig

from mitigate.bridge import verdict
from mitigate.bridge.options import check_options, name_of
from mitigate.cluster import launcher  # noqa: F401 - registers the kinds of conf/launcher
from mitigate.core import conf
from mitigate.core.output import output_folder
from mitigate.core.signals import raise_ended
from mitigate.guards.text.addresses import check_arguments

if TYPE_CHECKING:  # torch and the corruptions are slow to import
    from mitigate.bridge.cell import Cell

EVERY = 15.0  # seconds between two lines of progress (ours)


@dataclass
class RunConfig:
    """Types of ``conf/run.yaml``; the meaning of each entry is written there."""

    name: str | None = None
    out: str | None = None
    runs: str = "runs"
    corruption: str | None = None
    conditions: list[str] | None = None
    severity: float = 0.6
    severity_depth: float | None = None
    seed: int = 0
    episodes: int | None = None
    repeats: int = 1
    jobs: int = 1
    launcher: Any = MISSING
    split: str = "unnamed"
    rule: str | None = None
    safeguard: str = "none"
    restore: str | None = None
    tokenizer: str | None = None
    token_length: int | None = None
    missing: float = 0.0
    turn: str = "left"
    patience: float = 25.0
    record: str | None = None
    adapters: str | None = None
    watch: list[str] | None = None
    count_closed: bool = False
    check: bool = False
    suite: Any = MISSING


conf.register("run", RunConfig)


def split_command(arguments: Sequence[str]) -> tuple[list[str], list[str]]:
    """Return the options before ``--`` and the command behind it."""
    if "--" not in arguments:
        return list(arguments), []
    at = list(arguments).index("--")
    return list(arguments[:at]), list(arguments[at + 1 :])


def run(cfg: DictConfig, command: Sequence[str]) -> Path:
    """Run ``command`` under all conditions; return the output folder.

    Raises ValueError for options that make no sense and, behind all others, for conditions whose
    command failed.
    """
    from mitigate.bridge.conditions import cells
    from mitigate.bridge.finished import check_finished
    from mitigate.bridge.identity import default_folder

    check_options(cfg, command)
    name = cfg.name or name_of(command)
    out = Path(cfg.out or default_folder(cfg, name))
    made = cells(cfg, command, out, name)
    check_finished(out)
    with output_folder(out):
        return _measure(cfg, command, out, name, made)


def _measure(
    cfg: DictConfig, command: Sequence[str], out: Path, name: str, made: Sequence[Cell]
) -> Path:
    """Run the cells ``made`` and write the report into ``out``; raise as :func:`run` does."""
    from mitigate.bridge.report import write_report
    from mitigate.bridge.words import NO_TOKENIZER

    clean = made[0]
    many = "1 condition" if len(made) == 1 else f"{len(made)} conditions"
    print(
        f"run: {shlex.join(command)}\nrun: {many} at severity {cfg.severity:g}, rows in {out}",
        flush=True,
    )
    known = _warn_of_changes(made, out)
    before = clean.is_done()
    problems = _run_all(cfg, command, out, name, [clean])
    if problems:
        raise ValueError("\n".join(problems))
    _check_rule([clean])
    strange = verdict.strange(clean)
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
    problems += _run_all(cfg, command, out, name, fitting)
    _warn_of_changes([clean, *fitting], out, known if nothing else ())
    problems += _vanished(fitting, problems)
    if not clean.is_done():  # a condition showed that it is not whole
        raise ValueError("\n".join(problems) or f"{clean.name}: {clean.why_anew()}")
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
        if cell.name not in failed and cell.held() is None
    ]


def _check_rule(made: Sequence[Cell]) -> None:
    """Raise ValueError for a condition that was measured before and that ``rule=`` cannot judge."""
    for cell in made:
        if cell.is_done() and (lacking := verdict.lacks(cell)):
            raise ValueError(
                f"{cell.name}: {lacking} It was measured before; out=... names another folder."
            )


def _fitting(made: Sequence[Cell]) -> tuple[list[Cell], list[str]]:
    """The conditions beside clean that reach the agent, and the names of those whose words it would
    not hear; say which do not, and which words are in other languages."""
    from mitigate.bridge.conditions import applicable, untold
    from mitigate.corruptions.language.text import is_english, passed_through

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
    from mitigate.bridge.identity import files_of

    changed: dict[str, list[str]] = {}
    now = files_of(made[0].command)
    for cell in made:
        for file in cell.changed(now):
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


def _run_all(
    cfg: DictConfig, command: Sequence[str], out: Path, name: str, waiting: Sequence[Cell]
) -> list[str]:
    """Run cells, ``cfg.jobs`` at a time, where the launcher says; return what went wrong."""
    if cfg.launcher.name == "local":
        return _run_here(waiting, cfg.jobs)
    from mitigate.bridge.spread import run_there

    return run_there(cfg, command, out, name, waiting)


def _run_here(waiting: Sequence[Cell], jobs: int) -> list[str]:
    left, problems = list(waiting), []
    running: list[Cell] = []
    spoke = time.monotonic()
    try:
        while left or running:
            while left and len(running) < jobs:
                cell = left.pop(0)
                if cell.is_done():
                    print(f"{cell.name}: done before, {cell.summary()}", flush=True)
                else:
                    running.append(cell)  # before: whatever interrupts its start, it is ended
                    if refused := _begin(cell):  # the others go on
                        running.remove(cell)
                        problems.append(f"{cell.name}: {refused}")
            time.sleep(0.2)
            for cell in list(running):
                problem = cell.poll()
                if problem is None:
                    continue
                running.remove(cell)
                print(
                    f"{cell.name}: {verdict.outcome(cell, problem, len(waiting) == 1)}", flush=True
                )
                problems += [f"{cell.name}: {problem}"] if problem else []
            if running and time.monotonic() - spoke > EVERY:
                spoke = time.monotonic()
                print("\n".join(f"{cell.name}: {cell.summary()}" for cell in running), flush=True)
    finally:
        for cell in running:
            cell.kill()
    return problems


def _begin(cell: Cell) -> str:
    """Start a condition; return why it cannot be, empty if it was."""
    again = f", measured anew: {why}" if (why := cell.why_anew()) else ""
    try:
        cell.start()
    except ValueError as error:
        print(f"{cell.name}: {error}", flush=True)
        return str(error)
    print(f"{cell.name}: started{again}; its output is in {cell.log}", flush=True)
    return ""


@hydra.main(version_base="1.3", config_path=str(conf.CONF), config_name="run")
def hydra_main(cfg: DictConfig) -> None:
    """Hydra's entry."""
    if cfg.check:
        from mitigate.bridge.check import check

        check(cfg, _command)
    else:
        run(cfg, _command)


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
