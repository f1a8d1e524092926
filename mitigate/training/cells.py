"""The cells of a table: a column under one seed, what trains it, and what measures it."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from omegaconf import DictConfig, ListConfig

from mitigate.cluster import programs
from mitigate.core import build, conf
from mitigate.core.files import atomic_text
from mitigate.core.json_files import read_json
from mitigate.core.names import short
from mitigate.evaluation.conditions import conditions
from mitigate.evaluation.episode_lists import episodes
from mitigate.evaluation.rows import ROWS
from mitigate.guards.text import choices
from mitigate.training import train

LOG, OPTIONS = "log.txt", "options.json"
EXAMPLES = {"columns": "agent=recurrent", "evaluations": "suite=pairs"}
OF_AGENT = ("agent=", "env=", "env.", "+env.", "--config-dir=")  # of a training, for evaluations
CELLS = ("agent", "checkpoint", "name", "seed", "out")  # a further evaluation does not say these
PLACES = ("seed", "folder", "out", "workers", "evaluation")  # nor a column these
MEASURED = ("split", "episodes", "conditions", "severity")  # nor, if it does not train, these


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
            kind = tuple(o for o in given if o.startswith(OF_AGENT))
            return (*kind, f"checkpoint={self.folder / 'run' / 'agent'}")
        return self.options

    @property
    def training(self) -> list[str]:
        """The options of its training."""
        return [
            *self.options,
            *self.train,
            f"seed={self.seed}",
            f"folder={self.folder / 'run'}",
            "evaluation.enabled=false",
            "workers=0",  # a cell has one core
        ]

    @property
    def evaluation(self) -> Path:
        """The folder of the cell's result rows."""
        return self.further("")

    def further(self, name: str) -> Path:
        """The folder of the rows of a further evaluation."""
        return self.folder / (f"evaluation-{name}" if name else "evaluation")

    def left(self, kind: str) -> list[tuple[str, int]]:
        """The files that a program of ``commands`` adds to, with their times: one that had nothing
        to do leaves them as they were."""
        rows = self.further(kind.removeprefix("evaluate").strip()) / ROWS
        files = [*(self.folder / "run").glob("*/step-*.pt")] if kind == "train" else [rows]
        return sorted((str(file), file.stat().st_mtime_ns) for file in files if file.is_file())

    def commands(self, cfg: DictConfig) -> list[tuple[str, list[str]]]:
        """What makes the cell: ("train", "evaluate" or "evaluate NAME", arguments after
        ``python -m``)."""
        found = []
        if self.trains:
            found.append(("train", ["mitigate.train", *self.training]))
        main = [f"conditions=[{','.join(measured(cfg))}]"]
        for name, options in {"": main, **listed(cfg, "evaluations")}.items():
            kind = f"evaluate {name}" if name else "evaluate"
            found.append((kind, ["mitigate.evaluate", *self.measurement(cfg, name, options)]))
        return found

    def measurement(self, cfg: DictConfig, name: str, options: Sequence[str]) -> list[str]:
        """The options of one of the cell's evaluations; ``options`` are those that it has beside,
        or in place of, the table's; of episodes at most as many as that has."""
        return [
            f"name={self.column}",
            *self.agent,  # which may have a name of its own
            f"seed={self.seed}",
            f"split={cfg.split}",
            f"episodes={'null' if cfg.episodes is None else cfg.episodes}",
            f"severity={cfg.severity}",
            *(_at_most(cfg.episodes, option) for option in options),
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

    def keep(self) -> None:
        """Write down what the agent of its rows is made by."""
        with atomic_text(self.folder / OPTIONS) as file:
            json.dump(self._made_by, file)

    def check_kept(self) -> None:
        """Raise ValueError if its folder holds the rows of another agent."""
        file = self.folder / OPTIONS
        begun = (self.folder / "run").exists() or (self.evaluation / ROWS).is_file()
        if not (begun and file.is_file()):
            return
        held = read_json(file, f"Delete {self.folder}, or choose another out=.")
        if not isinstance(held, list):
            raise ValueError(
                f"{file} must hold a list of options, got {short(held)}. Delete {self.folder}, or "
                "choose another out=."
            )
        if held != self._made_by:
            raise ValueError(
                f"{self.folder} holds rows of an agent that was made by {held}, and the column is "
                f"{self._made_by}: they would stand beside each other. Choose another out=, give "
                "the column another name, or delete that folder."
            )

    @property
    def _made_by(self) -> list[str]:
        return [*self.options, *(self.train if self.trains else ())]


def _at_most(most: int | None, option: str) -> str:
    """An option of an evaluation: one that asks for more than ``most`` episodes asks for these."""
    name, _, value = option.partition("=")
    if name != "episodes" or most is None or not (value == "null" or value.isdecimal()):
        return option
    return f"episodes={most if value == 'null' else min(most, int(value))}"


def cells(cfg: DictConfig) -> list[Cell]:
    """All cells of the table, seed by seed, so that a partial table holds every column."""
    columns = listed(cfg, "columns")
    if not cfg.seeds or not columns or cfg.jobs < 1:
        raise ValueError(
            f"columns, seeds ({list(cfg.seeds)}) and jobs ({cfg.jobs}) must not be empty or 0."
        )
    out = Path(cfg.out)
    return [
        Cell(column, options, seed, out / "cells" / f"{column}-seed{seed}", tuple(cfg.train))
        for seed in cfg.seeds
        for column, options in columns.items()
    ]


def listed(cfg: DictConfig, place: str) -> dict[str, tuple[str, ...]]:
    """The options of each of the ``columns`` or ``evaluations``; one that is null is left out.
    Raises ValueError for what is no list of options."""
    found = {str(name): options for name, options in cfg[place].items() if options is not None}
    for name, options in found.items():
        if not isinstance(options, ListConfig) or not all(isinstance(o, str) for o in options):
            raise ValueError(
                f"{place}.{name}={options} must be a list of options, in quotes for the shell: "
                f"'{place}.{name}=[\"{EXAMPLES[place]}\"]'."
            )
    return {name: tuple(options) for name, options in found.items()}


def measured(cfg: DictConfig) -> list[str]:
    """The names of the conditions that every cell is evaluated under."""
    return list(cfg.suite.conditions if cfg.conditions is None else cfg.conditions)


def check(made: Sequence[Cell], cfg: DictConfig) -> None:
    """Raise ValueError for seeds that come twice, for options of a column or a further evaluation,
    a split and conditions that there are not, and for a cell that holds another agent's rows."""
    from mitigate.agents import loading  # brings torch

    if len({*cfg.seeds}) < len(cfg.seeds):
        raise ValueError(f"seeds={list(cfg.seeds)} names one twice: two cells would be one folder.")
    own = "which gives each cell a seed, a folder and one core, and evaluates it itself."
    _check_own(cfg.train, PLACES, own)
    conditions(measured(cfg), cfg.severity, None)
    for cell in made:
        cell.check_kept()
        if cell.seed == cfg.seeds[0]:
            try:
                taken = PLACES if cell.trains else (*PLACES, *MEASURED)
                _check_own(cell.options, taken, "for all columns alike.")
                if cell.trains:
                    train.check(conf.composed("train", cell.training))
                node = conf.composed("evaluate", loading.with_kind(cell.agent))
                episodes(node.env, cfg.split, cfg.episodes)
                _check_fronts(node)
            except (ValueError, FileNotFoundError) as error:
                raise ValueError(f"Column {cell.column}: {error}") from error
    for name, options in listed(cfg, "evaluations").items():
        try:
            _check_own(
                options,
                CELLS,
                f"which has {', '.join(CELLS)} from its columns and seeds. A further evaluation "
                "may have suite, conditions, severity, severity_depth, split, episodes, safeguard, "
                "restore and entries of env and agent.",
            )
            node = conf.composed(
                "evaluate", loading.with_kind(made[0].measurement(cfg, name, options))
            )
            chosen = node.suite.conditions if node.conditions is None else node.conditions
            conditions(list(chosen), node.severity, node.severity_depth)
            episodes(node.env, node.split, node.episodes)
            _check_fronts(node)
        except (ValueError, FileNotFoundError) as error:
            raise ValueError(f"Evaluation {name}: {error}") from error


def _check_own(options: Sequence[str], taken: Sequence[str], why: str) -> None:
    """Raise ValueError for options that the table sets: they would do nothing, make rows another
    agent's, or put them where the table does not look."""
    for option in options:
        key = option.lstrip("+~").partition("=")[0]
        whole = "evaluation" if key.startswith("evaluation.") else key
        if whole in taken:
            raise ValueError(f"{option} is for the table to say, {why}")


def _check_fronts(node: DictConfig) -> None:
    """Raise ValueError or FileNotFoundError for a safeguard or a restorer that there is not."""
    choices.check(node.safeguard)
    if node.restore is not None:
        from mitigate.guards.opening import open_restorer

        open_restorer(node.restore, build.maker(node.env.world)().sensors)
