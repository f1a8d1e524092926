"""Tables of columns and seeds, as the paper's Table I (all kinds of agent) and II (all methods).

Trains and evaluates every column for every seed, several cells at a time, each in processes of its
own, on this machine or on those of ``launcher``. The same command again goes on where the last one
stopped: trainings resume, evaluations go on, finished cells are kept. Then the report is written
from the rows of all cells. ``evaluations=beyond`` measures each cell under more than the table's
suite; each of these has a report of its own.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from omegaconf import DictConfig

from mitigate.cluster import programs
from mitigate.core import build
from mitigate.core.files import atomic_text
from mitigate.core.json_files import read_object
from mitigate.core.names import short
from mitigate.core.output import is_regular, output_folder
from mitigate.core.progress import say
from mitigate.evaluation.episode_lists import episodes
from mitigate.evaluation.evaluate import load
from mitigate.evaluation.rows import ROWS, Row, gather, read
from mitigate.evaluation.sections import sections
from mitigate.training.cells import (
    Cell,
    TablesConfig,
    cells,
    check,
    evaluation_of,
    listed,
    read_options,
)
from mitigate.training.sweep import run_chains

COST, REPORT = "cost.json", "overview.md"


def run(cfg: DictConfig) -> Path:
    """Make the table of composed options (:func:`make_table`)."""
    return make_table(read_options(cfg))


def make_table(config: TablesConfig) -> Path:
    """Make all cells and the report; return the report's path.

    With ``config.rows`` the report is made of those rows, and no cell is run. Raises ValueError for
    settings that make no sense, before a cell is run, and if a cell failed (after the others are
    done), with the end of its log; FileNotFoundError for rows that are not there.
    """
    out = Path(config.out)
    if config.rows:
        return write_report(config, out, list(config.rows))
    made = cells(config)
    check(made, config)
    with output_folder(out):
        return _make_cells(made, config, out)


def _make_cells(made: Sequence[Cell], config: TablesConfig, out: Path) -> Path:
    """Make the cells and write the report into ``out``; raise as :func:`make_table` does."""
    failed = make(made, config) or [
        f"{cell.column}, seed {cell.seed}: its rows in {cell.evaluation} were removed by another "
        "program after they were measured."
        for cell in made
        if not _rows(cell.evaluation)
    ]
    if len(failed) == len(made):
        raise ValueError("Every cell failed. " + " ".join(failed))
    problem = "Some cells failed; run again to go on with them. " + " ".join(failed)
    measured = [cell.evaluation for cell in made if _rows(cell.evaluation)]
    if failed and not measured:
        raise ValueError(problem)
    report = write_report(config, out, measured)
    written = [report, *write_further(made, config, out)]
    if failed:
        raise ValueError(problem)
    print("\n".join(f"wrote {path}" for path in (*written, *draw_walks(config, out))), flush=True)
    return report


def make(made: Sequence[Cell], config: TablesConfig) -> list[str]:
    """Train and evaluate all cells, ``config.jobs`` at a time; return what went wrong."""
    chains = [cell.chain(config) for cell in made]
    for cell in made:
        cell.keep()
    before = [
        {kind: cell.left(kind) for kind, _ in chain.programs}
        for cell, chain in zip(made, chains, strict=True)
    ]

    def ended(number: int, outcome: programs.Outcome) -> None:
        cell = made[number]
        idle = {kind for kind, left in before[number].items() if left == cell.left(kind) != []}
        failed = bool(outcome.problem)
        spent = {k: s for k, s in outcome.seconds.items() if failed or k not in idle}
        _add_cost(cell.folder / COST, spent)

    return run_chains("cells", "cell", chains, config.jobs, config.launcher, ended)


def _add_cost(path: Path, spent: dict[str, float]) -> None:
    """Add CPU seconds to a cell's account, which counts all its runs that had something to do."""
    cost = _read_cost(path) if is_regular(path) else {}
    for kind, seconds in spent.items():
        cost[kind] = round(cost.get(kind, 0.0) + seconds, 2)
    with atomic_text(path) as file:
        json.dump(cost, file)


def _read_cost(path: Path) -> dict[str, float]:
    """Return a cell's CPU seconds by program. Raises ValueError if the file is damaged."""
    again = "Delete the file: the cell's CPU time is then counted from the next run on."
    cost = read_object(path, again)
    for kind, seconds in cost.items():
        if isinstance(seconds, bool) or not isinstance(seconds, (int, float)):
            raise ValueError(
                f"{path}: {short(kind)} must be seconds, got {short(seconds)}. {again}"
            )
    return cost


def write_report(config: TablesConfig, out: Path, paths: Sequence[Path | str]) -> Path:
    """Write ``table.md`` with its pictures, and ``overview.md`` with the paper beside it, from
    the rows under ``paths``."""
    from mitigate.evaluation import report  # brings matplotlib

    found = gather(paths)
    report.write(found, out)
    made = [
        section
        for section in sections(found)
        if section.grid.split == config.split
        and (section.severity == config.severity or not section.blocks)  # clean rows have none
    ]
    if not made:
        held = sorted({f"{row['split']} at {row['severity']:g}" for row in found})
        raise ValueError(
            f"There are no rows of {config.split} at severity {config.severity:g}, only of "
            f"{', '.join(held)}. Set split= and severity=."
        )
    figures = {name: list(values) for name, values in config.paper.items()}
    spent = {} if config.rows else costs(out)
    with atomic_text(out / REPORT) as file:
        file.write("\n".join(report.beside(section, figures, spent) for section in made))
    print((out / REPORT).read_text(encoding="utf-8"), flush=True)
    return out / REPORT


def write_further(made: Sequence[Cell], config: TablesConfig, out: Path) -> list[Path]:
    """Write ``NAME/table.md`` with its pictures for each further evaluation, and return their
    paths. Each has a table of its own: its episodes need not be those of the others."""
    from mitigate.evaluation import report  # brings matplotlib

    written = []
    for name in listed(config.evaluations, "evaluations"):
        paths = [cell.further(name) for cell in made if _rows(cell.further(name))]
        if paths:
            written.append(report.write(gather(paths), out / name)[0])
    return written


def draw_walks(config: TablesConfig, out: Path) -> list[Path]:
    """Write pictures of episodes that the last of ``config.walks`` wins back for the first, by the
    agents of the first seed, behind what their cells put in front of them; nothing if one of them
    has no cell."""
    from mitigate.evaluation.trajectories import write_pictures  # brings matplotlib
    from mitigate.guards.opening import open_guards

    held = {cell.column: cell for cell in cells(config) if cell.seed == config.seeds[0]}
    missing = [column for column in config.walks if column not in held]
    if missing:
        say(f"no pictures of walks: {', '.join(missing)} of walks= is no column")
    if not config.walks or missing:
        return []
    made = {_named(held[column].folder): held[column] for column in config.walks}
    nodes = {name: evaluation_of(cell.agent) for name, cell in made.items()}
    agents: dict[str, Any] = {
        n: load(c.agent, c.checkpoint, overrides=made[n].agent) for n, c in nodes.items()
    }
    env = next(iter(nodes.values())).env
    world, chosen = build.maker(env.world)(), episodes(env, config.split, config.episodes)
    guards = {
        name: open_guards(node.safeguard, node.restore, world.sensors)
        for name, node in nodes.items()
    }
    drawn = {episode.episode_id for episode in chosen}
    found = [
        row
        for row in gather([cell.evaluation for cell in made.values()])
        if row["split"] == config.split
        and row["severity"] in (0.0, config.severity)
        and row["episode_id"] in drawn
    ]
    folder, seed = out / "pictures", config.seeds[0]
    return write_pictures(agents, world, chosen, found, folder, seed=seed, guards=guards)


def costs(out: Path) -> dict[str, dict[str, float]]:
    """Mean CPU minutes of a cell by what they were spent on ("train", "evaluate", ...), and by
    the column that its rows name."""
    spent: dict[str, dict[str, list[float]]] = {}
    for path in sorted((out / "cells").glob(f"*/{COST}")):
        column = _named(path.parent)
        for kind, seconds in _read_cost(path).items():
            spent.setdefault(kind, {}).setdefault(column, []).append(seconds / 60)
    return {
        kind: {column: sum(held) / len(held) for column, held in columns.items()}
        for kind, columns in sorted(spent.items(), key=lambda item: (item[0] != "train", item[0]))
    }


def _named(folder: Path) -> str:
    """The column of a cell's rows, which names what stands in front of the agent, too; of a cell
    without rows that of the folder."""
    found = _rows(folder / "evaluation")
    return str(found[0]["name"]) if found else folder.name.rpartition("-seed")[0]


def _rows(folder: Path) -> list[Row]:
    """The rows that an evaluation has left in ``folder`` so far."""
    return read(folder / ROWS) if is_regular(folder / ROWS) else []
