"""Many trainings or evaluations: ``mitigate sweep recipe=imitation,stacked seed=0,1``.

Each combination of values is a run in a folder of its own, on this machine or on those of
``launcher``. A failed one does not stop the others; the same command again goes on with what is
missing. All end in one table. ``--config-dir FOLDER`` names configs of your own, for all runs.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.errors import HydraException
from omegaconf import MISSING

from mitigate.cluster import launcher, programs
from mitigate.cluster.launcher import RayConfig
from mitigate.core import conf, seeding
from mitigate.core.names import unknown
from mitigate.core.options import without_config_folder
from mitigate.core.progress import Progress
from mitigate.core.workers import cores
from mitigate.evaluation.evaluate import write_table
from mitigate.guards.text.addresses import check_arguments

COMMANDS = ("train", "evaluate")
LOGS = "logs"
LONGEST = 100  # characters of a log's name (ours)


@dataclass
class SweepConfig:
    """Types of ``conf/sweep.yaml``; the meaning of each entry is written there."""

    command: str = "train"
    runs: str = "sweeps/default"
    jobs: int = 1
    launcher: Any = MISSING  # read: a LauncherConfig


conf.register("sweep", SweepConfig)
OWN = re.compile(r"(command|runs|jobs|launcher(\.[\w.]+)?)=")


def run_all(config: SweepConfig, options: Sequence[str]) -> None:
    """Run every combination of ``options``, then write and print the table of ``config.runs``.

    Raises ValueError for options that the command does not have, before anything runs, and for
    runs that failed, after the others are done and the table is written.
    """
    if config.command not in COMMANDS:
        raise ValueError(unknown("command", config.command, COMMANDS))
    if config.jobs < 1:
        raise ValueError(f"jobs={config.jobs} is none: give 1 or more runs at a time.")
    configs, options = without_config_folder(options)
    made = [[*configs, *chosen] for chosen in combinations(options)]
    _check_own(options)
    from mitigate.agents.building import with_kind  # brings torch
    from mitigate.evaluation import evaluate  # noqa: F401 - registers its options
    from mitigate.training import train  # noqa: F401 - registers its options

    for chosen in made:
        conf.composed(config.command, with_kind(chosen) if config.command == "evaluate" else chosen)
    chains = [chain(config, chosen, made) for chosen in made]
    problems = run_chains("sweep", "run", chains, config.jobs, config.launcher)
    if len(problems) < len(chains):
        write_table([Path(config.runs)], Path(config.runs))
    if problems:
        again = "Run again to go on with them; their output is in"
        raise ValueError(
            f"{len(problems)} of {len(chains)} runs failed. {again} {config.runs}/{LOGS}. "
            + " ".join(problems)
        )


def run_chains(
    title: str,
    unit: str,
    chains: Sequence[programs.Chain],
    jobs: int,
    place: Any,
    ended: Callable[[int, programs.Outcome], None] = lambda *_: None,
) -> list[str]:
    """Run ``chains``, ``jobs`` at a time, on the machines of the launcher ``place``.

    Print a line for each that ended, call ``ended`` with its number, and return what went wrong.
    """
    problems = []
    with Progress(title, len(chains), unit=unit) as progress:

        def told(number: int, outcome: programs.Outcome) -> None:
            ended(number, outcome)
            line = f"{chains[number].name}: {outcome.problem or 'done'}"
            if outcome.problem:
                problems.append(line)
            progress.say(line)
            progress.advance()

        programs.run(chains, jobs, launcher.chosen(place), progress, told)
    return problems


def _check_own(options: Sequence[str]) -> None:
    """Raise ValueError for an option that would put all runs into one folder."""
    for option in options:
        if option.lstrip("+~").partition("=")[0] in ("out", "folder"):
            raise ValueError(
                f"{option} is one folder, and every run of a sweep has its own: set runs=FOLDER, "
                "in which they are."
            )


def combinations(options: Sequence[str]) -> list[list[str]]:
    """Each combination of the options' values, by Hydra's grammar: ``seed=0,1``, ``range(3)``.

    Raises ValueError for what cannot be read.
    """
    try:
        found = OverridesParser.create().parse_overrides(list(options))
    except HydraException as error:
        raise ValueError(conf.explain(error, "train")) from error
    values = [
        [f"{option.get_key_element()}={value}" for value in option.sweep_string_iterator()]
        if option.is_sweep_override()
        else [given]
        for given, option in zip(options, found, strict=True)
    ]
    return [list(chosen) for chosen in product(*values)]


def _name(options: Sequence[str]) -> str:
    """Options in signs that a file name may have."""
    named = ",".join(without_config_folder(options)[1])
    return re.sub(r"[^A-Za-z0-9._+-]+", "_", named.replace("=", "-")) or "default"


def chain(
    config: SweepConfig, options: Sequence[str], combined: Sequence[Sequence[str]] = ()
) -> programs.Chain:
    """The run of one combination; a digest tells it from one of ``combined`` whose name would be
    the same (``checkpoint=a/b`` and ``a_b``)."""
    _, named = without_config_folder(options)
    name = _name(options)
    if len(name) > LONGEST or [*map(_name, combined)].count(name) > 1:
        name = f"{name[:LONGEST]}-{seeding.digest(*named):032x}"[: LONGEST + 9]
    words = [f"mitigate.{config.command}", *options, f"runs={config.runs}"]
    if config.command == "evaluate":  # which would put two seeds into one folder
        words.append(f"out={Path(config.runs) / name}")
    share = config.jobs > 1 or config.launcher.name != "local"
    count = max(1, cores() // config.jobs) if config.launcher.name == "local" else 1
    cpus = config.launcher.cpus if isinstance(config.launcher, RayConfig) else 1
    count = max(count, int(cpus))
    return programs.Chain(
        " ".join(named) or "as it is",
        ((config.command, programs.python(*words)),),
        (Path(config.runs) / LOGS / f"{name}.txt").resolve(),
        Path.cwd(),
        {"OMP_NUM_THREADS": f"{count}", "PYTHON_CPU_COUNT": f"{count}"} if share else {},
    )


def main() -> int:
    """Run from the command line; return the exit status: 2, and the help, where there is nothing
    to combine."""
    given = sys.argv[1:]
    own = [option for option in given if OWN.match(option)]
    options = [option for option in given if not OWN.match(option)]
    if not without_config_folder(options)[1]:
        print(conf.help_text(__doc__ or "", "sweep"))
        print("sweep: give options to combine, such as seed=0,1.", file=sys.stderr)
        return 2

    def program() -> None:
        run_all(conf.typed(conf.load_config("sweep", own), "sweep"), options)

    conf.main(program, "sweep", lambda: check_arguments(options))
    return 0
