"""Define the options of a table and its cells.

A cell is one column with one seed. A cell consists of a training run and evaluations.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from omegaconf import MISSING, DictConfig

from mitigate.cluster import programs
from mitigate.core import build, conf
from mitigate.core.addresses import check_arguments
from mitigate.core.files import write_json
from mitigate.core.json_files import read_json
from mitigate.core.names import short
from mitigate.evaluation import config as evaluate_options
from mitigate.evaluation.conditions import conditions
from mitigate.evaluation.config import EvaluateConfig, SuiteConfig, open_entries
from mitigate.evaluation.episode_lists import episodes
from mitigate.evaluation.rows import ROWS
from mitigate.guards.text import choices
from mitigate.training import config as train_options

LOG, OPTIONS = "log.txt", "options.json"
EXAMPLES = {"columns": "agent=recurrent", "evaluations": "suite=pairs"}
# training options with these prefixes are passed on to evaluations
OF_AGENT = ("agent=", "env=", "env.", "+env.", "--config-dir=")
# options that an additional evaluation must not set, because the table sets them
CELLS = ("agent", "checkpoint", "name", "seed", "out")
# options that a table column must not set, because the table sets them
PLACES = ("seed", "folder", "out", "workers", "evaluation")
# options that, like those in PLACES, must not be set in a column without training
MEASURED = ("split", "episodes", "conditions", "severity")


@dataclass
class TablesConfig:
    """Types of the options in ``conf/table1.yaml`` and ``conf/table2.yaml``."""

    runs: str = "runs"
    out: str = "runs/table"
    rows: list[str] = field(default_factory=list)
    columns: dict[str, Any] = field(default_factory=dict)
    seeds: list[int] = field(default_factory=list)
    split: str = "val_unseen"
    episodes: int | None = None
    suite: Any = MISSING  # becomes a SuiteConfig when the options are read
    conditions: list[str] | None = None
    severity: float = 0.6
    evaluations: dict[str, Any] = field(default_factory=dict)
    train: list[str] = field(default_factory=list)
    jobs: int = 2
    launcher: Any = MISSING  # becomes a LauncherConfig when the options are read
    walks: list[str] = field(default_factory=list)
    paper: dict[str, Any] = field(default_factory=dict)


for _primary in ("table1", "table2"):
    conf.register(_primary, TablesConfig, schema="tables")


def read_options(cfg: DictConfig) -> TablesConfig:
    """Return the composed options of a table as typed data.

    Raises:
        ValueError: If an entry refers to a missing entry.
    """
    config: TablesConfig = conf.typed(cfg, "table2")
    config.suite = open_entries(SuiteConfig, config.suite)
    return config


@dataclass(frozen=True)
class Cell:
    """One table column with one seed. A cell has its own folder."""

    column: str
    options: tuple[str, ...]
    seed: int
    folder: Path
    train: tuple[str, ...] = ()  # additional options for the training of this cell

    @property
    def trains(self) -> bool:
        """Whether the agent is trained.

        If the agent is not trained, the options name existing weights.
        """
        return any(option.startswith("recipe=") for option in self.options)

    @property
    def agent(self) -> tuple[str, ...]:
        """The options of an evaluation that select the kind of agent, the world and the weights."""
        if not self.trains:
            return self.options
        kind = (option for option in self._agent_options if option.startswith(OF_AGENT))
        return (*kind, f"checkpoint={self.folder / 'run' / 'agent'}")

    @property
    def training(self) -> list[str]:
        """Options of the cell's training run."""
        return [
            *self._agent_options,
            f"seed={self.seed}",
            f"folder={self.folder / 'run'}",
            "evaluation.enabled=false",
            "workers=0",  # each cell uses one core
        ]

    @property
    def evaluation(self) -> Path:
        """The folder of the cell's result rows."""
        return self.evaluation_folder("")

    def evaluation_folder(self, name: str) -> Path:
        """Return the folder for the rows of the evaluation ``name``.

        "" is the name of the main evaluation.
        """
        return self.folder / (f"evaluation-{name}" if name else "evaluation")

    def commands(self, config: TablesConfig) -> list[tuple[str, list[str]]]:
        """Return the programs that compute the cell.

        Each program is a pair (title, arguments after ``python -m``). The title is "train",
        "evaluate" or "evaluate NAME".
        """
        commands = []
        if self.trains:
            commands.append(("train", ["mitigate.train", *self.training]))
        main = [f"conditions=[{','.join(measured(config))}]"]
        for name, options in {"": main, **listed(config.evaluations, "evaluations")}.items():
            kind = f"evaluate {name}" if name else "evaluate"
            commands.append((kind, ["mitigate.evaluate", *self.measurement(config, name, options)]))
        return commands

    def measurement(self, config: TablesConfig, name: str, options: Sequence[str]) -> list[str]:
        """Return all options for this cell's evaluation ``name``.

        ``options`` extend or override the options of the table. The number of episodes is at most
        ``config.episodes``.
        """
        return [
            f"name={self.column}",
            *self.agent,  # the agent's options may set another name
            f"seed={self.seed}",
            f"split={config.split}",
            f"episodes={'null' if config.episodes is None else config.episodes}",
            f"severity={config.severity}",
            *(_at_most(config.episodes, option) for option in options),
            f"out={self.evaluation_folder(name)}",
        ]

    def chain(self, config: TablesConfig) -> programs.Chain:
        """Return the chain of programs that compute the cell, one after another on one core."""
        return programs.Chain(
            f"{self.column}, seed {self.seed}",
            tuple((kind, programs.python(*words)) for kind, words in self.commands(config)),
            (self.folder / LOG).resolve(),
            Path.cwd(),
            {"OMP_NUM_THREADS": "1", "PYTHON_CPU_COUNT": "1"},
        )

    def keep(self) -> None:
        """Record the options that determine which agent the cell's rows belong to."""
        write_json(self.folder / OPTIONS, self._agent_options)

    def check_kept(self) -> None:
        """Raise ValueError if the cell's folder contains the rows of a different agent."""
        file = self.folder / OPTIONS
        started = (self.folder / "run").exists() or (self.evaluation / ROWS).is_file()
        if not (started and file.is_file()):
            return
        recorded = read_json(file, f"Delete {self.folder}, or choose another out=.")
        if recorded != self._agent_options:
            raise ValueError(
                f"{self.folder} holds rows of an agent with the options {short(recorded, 200)}, "
                f"but the column has {self._agent_options}: the table would mix both. "
                "Choose another out=, rename the column, or delete that folder."
            )

    @property
    def _agent_options(self) -> list[str]:
        return [*self.options, *(self.train if self.trains else ())]


def _at_most(most: int | None, option: str) -> str:
    """Return ``option``; if it sets the number of episodes, limit the number to ``most``."""
    name, _, value = option.partition("=")
    if name != "episodes" or most is None or not (value == "null" or value.isdecimal()):
        return option
    return f"episodes={most if value == 'null' else min(most, int(value))}"


def cells(config: TablesConfig) -> list[Cell]:
    """Return all cells of the table, ordered by seed.

    The cells of the first seed come first, so even an unfinished table has every column.
    """
    columns = listed(config.columns, "columns")
    if not config.seeds or not columns or config.jobs < 1:
        raise ValueError(
            f"columns and seeds must not be empty and jobs must be >= 1, got {len(columns)} "
            f"columns, seeds={config.seeds} and jobs={config.jobs}."
        )
    out = Path(config.out)
    return [
        Cell(column, options, seed, out / "cells" / f"{column}-seed{seed}", tuple(config.train))
        for seed in config.seeds
        for column, options in columns.items()
    ]


def listed(entries: Mapping[str, Any], place: str) -> dict[str, tuple[str, ...]]:
    """Return the options of each entry of ``columns`` or ``evaluations``; skip null entries.

    Raises ValueError if an entry is not a list of options, or if an address contains a password.
    """
    lists = {str(name): options for name, options in entries.items() if options is not None}
    for name, options in lists.items():
        if not isinstance(options, list) or not all(isinstance(o, str) for o in options):
            raise ValueError(
                f"{place}.{name}={options} must be a list of options, in quotes for the shell: "
                f"'{place}.{name}=[\"{EXAMPLES[place]}\"]'."
            )
        check_arguments(options)
    return {name: tuple(options) for name, options in lists.items()}


def measured(config: TablesConfig) -> list[str]:
    """Return the names of the conditions under which every cell is evaluated."""
    return list(config.suite.conditions if config.conditions is None else config.conditions)


def check(table_cells: Sequence[Cell], config: TablesConfig) -> None:
    """Check the options of a table before any cell runs.

    Raises:
        ValueError: If a seed is repeated, or if an option, a split or a condition does not exist.
            It is also raised if the folder of a cell contains rows of a different agent.
    """
    from mitigate.training import plan  # brings torch

    if len({*config.seeds}) < len(config.seeds):
        raise ValueError(f"seeds must be different, got {config.seeds}. Remove the repeated one.")
    reason = "which gives each cell a seed, a folder and one core, and evaluates it."
    _check_own(config.train, PLACES, reason)
    conditions(measured(config), config.severity, None)
    for cell in table_cells:
        cell.check_kept()
        if cell.seed == config.seeds[0]:
            try:
                reserved = PLACES if cell.trains else (*PLACES, *MEASURED)
                _check_own(cell.options, reserved, "the same for all columns.")
                if cell.trains:
                    plan.check(train_options.read(conf.composed("train", cell.training)))
                evaluation = evaluation_of(cell.agent)
                episodes(evaluation.env, config.split, config.episodes)
                _check_guards(evaluation)
            except (ValueError, FileNotFoundError) as error:
                raise ValueError(f"Column {cell.column}: {error}") from error
    for name, options in listed(config.evaluations, "evaluations").items():
        try:
            reason = f"which takes {', '.join(CELLS)} from its columns and seeds."
            _check_own(options, CELLS, reason)
            evaluation = evaluation_of(table_cells[0].measurement(config, name, options))
            conditions(evaluation.condition_names, evaluation.severity, evaluation.severity_depth)
            episodes(evaluation.env, evaluation.split, evaluation.episodes)
            _check_guards(evaluation)
        except (ValueError, FileNotFoundError) as error:
            raise ValueError(f"Evaluation {name}: {error}") from error


def _check_own(options: Sequence[str], reserved: Sequence[str], why: str) -> None:
    """Raise ValueError for options that the table itself sets.

    Such an option would have no effect, change the agent of the rows, or write the rows to a folder
    that the table does not read.
    """
    for option in options:
        key = option.lstrip("+~").partition("=")[0]
        whole = "evaluation" if key.startswith("evaluation.") else key
        if whole in reserved:
            raise ValueError(f"{option} is set by the table, {why}")


def evaluation_of(options: Sequence[str]) -> EvaluateConfig:
    """Return the typed options of an evaluation.

    The kind of agent is read from the weights.
    """
    from mitigate.agents.building import with_kind  # brings torch

    return evaluate_options.read(conf.composed("evaluate", with_kind(options)))


def _check_guards(config: EvaluateConfig) -> None:
    """Raise ValueError or FileNotFoundError if a guard does not exist."""
    choices.check(config.safeguard)
    from mitigate.guards.opening import labels, open_restorer

    labels(None, None, config.adapt)  # rejects unknown adaptations
    if config.restore is not None:
        open_restorer(config.restore, build.maker(config.env.world)().sensors)
