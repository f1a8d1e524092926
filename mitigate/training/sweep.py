"""Run many training runs or evaluations: ``mitigate sweep recipe=imitation,stacked seed=0,1``.

Each combination of values is run in its own folder, on this machine or on the machines of
``launcher``. A failed run does not stop the others. Run the same command again to resume the
missing runs. All results are written to one table. ``--config-dir FOLDER`` names a folder with your
own configs.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
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

COMMANDS = ("train", "evaluate")
LOGS = "logs"
LONGEST = 100  # maximum length of a log's name in characters (heuristic)


@dataclass
class SweepConfig:
    """Types of the options in ``conf/sweep.yaml``. That file documents each option."""

    command: str = "train"
    runs: str = "sweeps/default"
    jobs: int = 1
    launcher: Any = MISSING  # becomes a LauncherConfig when the options are read


conf.register("sweep", SweepConfig)
OWN = re.compile(r"(command|runs|jobs|launcher(\.[\w.]+)?)=")


def run_all(config: SweepConfig, options: Sequence[str]) -> None:
    """Run every combination of ``options``, then write and print the table of ``config.runs``.

    Raises:
        ValueError: If an option is unknown, or if runs failed. An unknown option is reported before
            anything runs. Failed runs are reported after all other runs are finished and the table
            is written.
    """
    if config.command not in COMMANDS:
        raise ValueError(unknown("command", config.command, COMMANDS))
    if config.jobs < 1:
        raise ValueError(f"jobs must be >= 1 (the number of simultaneous runs), got {config.jobs}.")
    configs, options = without_config_folder(options)
    runs = [[*configs, *chosen] for chosen in combinations(options)]
    _check_own(options)
    from mitigate.agents.building import with_kind  # imports torch, which is slow
    from mitigate.evaluation import evaluate  # noqa: F401 - registers its options
    from mitigate.training import train  # noqa: F401 - registers its options

    for chosen in runs:
        conf.composed(config.command, with_kind(chosen) if config.command == "evaluate" else chosen)
    chains = [chain(config, chosen, runs) for chosen in runs]
    problems = run_chains("sweep", "run", chains, config.jobs, config.launcher)
    if len(problems) < len(chains):
        write_table([Path(config.runs)], Path(config.runs))
    if problems:
        raise ValueError(
            f"{len(problems)} of {len(chains)} runs failed. Run the same command again to resume "
            f"them; their output is in {config.runs}/{LOGS}. {' '.join(problems)}"
        )


def run_chains(
    title: str, unit: str, chains: Sequence[programs.Chain], jobs: int, place: Any
) -> list[str]:
    """Run ``chains`` on the machines of the launcher ``place``, at most ``jobs`` at a time.

    Print a line for each chain of programs that has ended.

    Returns:
        A list with one line for each chain of programs that failed.
    """
    problems = []
    with Progress(title, len(chains), unit=unit) as progress:

        def report(number: int, problem: str) -> None:
            line = f"{chains[number].name}: {problem or 'done'}"
            if problem:
                problems.append(line)
            progress.say(line)
            progress.advance()

        programs.run(chains, jobs, launcher.chosen(place), progress, report)
    return problems


def _check_own(options: Sequence[str]) -> None:
    """Raise ValueError for an option that would write all runs into the same folder."""
    for option in options:
        if option.lstrip("+~").partition("=")[0] in ("out", "folder"):
            raise ValueError(
                f"{option} is a single folder, but every run of a sweep has its own. Set "
                "runs=FOLDER for the folder that contains them."
            )


def combinations(options: Sequence[str]) -> list[list[str]]:
    """Return each combination of values, using Hydra's grammar: ``seed=0,1``, ``range(3)``.

    Raises ValueError for an option that Hydra cannot parse.
    """
    try:
        overrides = OverridesParser.create().parse_overrides(list(options))
    except HydraException as error:
        raise ValueError(conf.explain(error, "train")) from error
    values = [
        [f"{option.get_key_element()}={value}" for value in option.sweep_string_iterator()]
        if option.is_sweep_override()
        else [text]
        for text, option in zip(options, overrides, strict=True)
    ]
    return [list(chosen) for chosen in product(*values)]


def _name(options: Sequence[str]) -> str:
    """Return options as text that is valid in a file name."""
    named = ",".join(without_config_folder(options)[1])
    return re.sub(r"[^A-Za-z0-9._+-]+", "_", named.replace("=", "-")) or "default"


def chain(
    config: SweepConfig, options: Sequence[str], combined: Sequence[Sequence[str]] = ()
) -> programs.Chain:
    """Return the programs of one combination.

    Different combinations may give the same name, for example ``checkpoint=a/b`` and
    ``checkpoint=a_b``. Then a digest is appended to the name.
    """
    _, named = without_config_folder(options)
    name = _name(options)
    if len(name) > LONGEST or [*map(_name, combined)].count(name) > 1:
        name = f"{name[:LONGEST]}-{seeding.digest(*named):032x}"[: LONGEST + 9]
    words = [f"mitigate.{config.command}", *options, f"runs={config.runs}"]
    if config.command == "evaluate":  # the default folder does not contain the seed
        words.append(f"out={Path(config.runs) / name}")
    share = config.jobs > 1 or config.launcher.name != "local"
    count = max(1, cores() // config.jobs) if config.launcher.name == "local" else 1
    cpus = config.launcher.cpus if isinstance(config.launcher, RayConfig) else 1
    count = max(count, int(cpus))
    return programs.Chain(
        " ".join(named) or "default options",
        ((config.command, programs.python(*words)),),
        (Path(config.runs) / LOGS / f"{name}.txt").resolve(),
        Path.cwd(),
        {"OMP_NUM_THREADS": f"{count}", "PYTHON_CPU_COUNT": f"{count}"} if share else {},
    )


def main() -> int:
    """Run from the command line and return the exit status.

    If there are no options to combine, print the help and return 2.
    """
    words = sys.argv[1:]
    sweep_options = [option for option in words if OWN.match(option)]
    options = [option for option in words if not OWN.match(option)]
    if not without_config_folder(options)[1]:
        print(conf.help_text(__doc__ or "", "sweep"))
        print("sweep: set options to combine, such as seed=0,1.", file=sys.stderr)
        return 2

    def program() -> None:
        run_all(conf.typed(conf.load_config("sweep", sweep_options), "sweep"), options)

    conf.main(program, "sweep")
    return 0
