"""The cells of a table: a column under one seed, what trains it, and what measures it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from omegaconf import DictConfig

from mitigate.core import conf
from mitigate.evaluation.conditions import conditions
from mitigate.evaluation.episode_lists import episodes
from mitigate.safeguard.addresses import check_choice
from mitigate.scale import programs

LOG = "log.txt"


@dataclass(frozen=True)
class Cell:
    """One column under one seed, in a folder of its own."""

    column: str
    options: tuple[str, ...]
    seed: int
    folder: Path
    train: tuple[str, ...] = ()  # further options of its training

    @property
    def trains(self) -> bool:
        """Whether the agent is trained; else its options name one that is there already."""
        return any(option.startswith("recipe=") for option in self.options)

    @property
    def agent(self) -> tuple[str, ...]:
        """What an evaluation must know of the agent: its kind, its world and its weights."""
        if self.trains:
            given = (*self.options, *self.train)
            kind = tuple(o for o in given if o.startswith(("agent=", "env=", "env.", "+env.")))
            return (*kind, f"checkpoint={self.folder / 'run' / 'agent'}")
        return self.options

    @property
    def evaluation(self) -> Path:
        """The folder of the cell's result rows."""
        return self.further("")

    def further(self, name: str) -> Path:
        """The folder of the rows of a further evaluation."""
        return self.folder / (f"evaluation-{name}" if name else "evaluation")

    def commands(self, cfg: DictConfig) -> list[tuple[str, list[str]]]:
        """What makes the cell: ("train", "evaluate" or "evaluate NAME", arguments after
        ``python -m``)."""
        found = []
        if self.trains:
            found.append(
                (
                    "train",
                    [
                        "mitigate.train",
                        *self.options,
                        *self.train,
                        f"seed={self.seed}",
                        f"folder={self.folder / 'run'}",
                        "evaluation.enabled=false",
                        "workers=0",  # a cell has one core
                    ],
                )
            )
        main = [f"conditions=[{','.join(measured(cfg))}]"]
        for name, options in {"": main, **cfg.evaluations}.items():
            kind = f"evaluate {name}" if name else "evaluate"
            found.append((kind, ["mitigate.evaluate", *self.measurement(cfg, name, options)]))
        return found

    def measurement(self, cfg: DictConfig, name: str, options: Sequence[str]) -> list[str]:
        """The options of one of the cell's evaluations; ``options`` are those that it has beside,
        or in place of, the table's."""
        return [
            f"name={self.column}",
            *self.agent,  # which may have a name of its own
            f"seed={self.seed}",
            f"split={cfg.split}",
            f"episodes={'null' if cfg.episodes is None else cfg.episodes}",
            f"severity={cfg.severity}",
            *options,
            f"out={self.further(name)}",
        ]

    def chain(self, cfg: DictConfig) -> programs.Chain:
        """The programs that make the cell, on one core."""
        return programs.Chain(
            f"{self.column}, seed {self.seed}",
            tuple((kind, programs.python(*words)) for kind, words in self.commands(cfg)),
            (self.folder / LOG).resolve(),
            Path.cwd(),
            {"OMP_NUM_THREADS": "1", "PYTHON_CPU_COUNT": "1"},
        )


def cells(cfg: DictConfig) -> list[Cell]:
    """All cells of the table, seed by seed, so that a partial table holds every column."""
    if not cfg.seeds or not cfg.columns or cfg.jobs < 1:
        raise ValueError(
            f"columns, seeds ({list(cfg.seeds)}) and jobs ({cfg.jobs}) must not be empty or 0."
        )
    for place, example in (("columns", "agent=recurrent"), ("evaluations", "suite=pairs")):
        for name, options in cfg[place].items():
            if isinstance(options, str):
                raise ValueError(
                    f"{place}.{name}={options} must be a list of options, in quotes for the shell: "
                    f"'{place}.{name}=[\"{example}\"]'."
                )
    out = Path(cfg.out)
    return [
        Cell(
            str(column),
            tuple(options),
            seed,
            out / "cells" / f"{column}-seed{seed}",
            tuple(cfg.train),
        )
        for seed in cfg.seeds
        for column, options in cfg.columns.items()
    ]


def measured(cfg: DictConfig) -> list[str]:
    """The names of the conditions that every cell is evaluated under."""
    return list(cfg.suite.conditions if cfg.conditions is None else cfg.conditions)


def check(made: Sequence[Cell], cfg: DictConfig) -> None:
    """Raise ValueError for options of a column or a further evaluation, a split and conditions that
    there are not."""
    conditions(measured(cfg), cfg.severity, None)
    for cell in made:
        if cell.seed == cfg.seeds[0]:
            try:
                if cell.trains:
                    conf.composed("train", [*cell.options, *cell.train])
                episodes(conf.composed("evaluate", cell.agent).env, cfg.split, cfg.episodes)
            except ValueError as error:
                raise ValueError(f"Column {cell.column}: {error}") from error
    for name, options in cfg.evaluations.items():
        try:
            node = conf.composed("evaluate", made[0].measurement(cfg, name, options))
            chosen = node.suite.conditions if node.conditions is None else node.conditions
            conditions(list(chosen), node.severity, node.severity_depth)
            check_choice(node.safeguard)
            episodes(node.env, node.split, node.episodes)
        except ValueError as error:
            raise ValueError(f"Evaluation {name}: {error}") from error
