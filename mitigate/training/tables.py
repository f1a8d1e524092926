"""Compute a table of results, such as Table I (agents) or Table II (methods) of the paper.

A cell of the table is one column with one seed; it is trained and evaluated in its own processes.
Several cells run at a time, on this machine or on the machines of ``launcher``. If the command is
run again, it resumes unfinished training runs and evaluations and keeps finished cells. At the end,
the report is written from the rows of all cells. ``evaluations=beyond`` also evaluates each cell
under other corruption suites, and writes one report per suite.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from omegaconf import DictConfig

from mitigate.core import build
from mitigate.core.files import write_text
from mitigate.core.markdown import plain_text
from mitigate.core.output import is_regular, output_folder
from mitigate.core.progress import say
from mitigate.evaluation.episode_lists import episodes, training_episodes
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

REPORT = "overview.md"


def run(cfg: DictConfig) -> Path:
    """Compute the table from the options that Hydra composed; see :func:`make_table`."""
    return make_table(read_options(cfg))


def make_table(config: TablesConfig) -> Path:
    """Compute all cells and the report; return the path of the report.

    If ``config.rows`` is set, the report is computed from those rows, and no cell is run.

    Raises:
        ValueError: If settings are invalid, or if a cell failed. Invalid settings are reported
            before any cell runs. A failed cell is reported after the others are finished; the
            message contains the end of its log.
        FileNotFoundError: If rows are missing.
    """
    out = Path(config.out)
    if config.rows:
        return write_report(config, out, list(config.rows))
    table_cells = cells(config)
    check(table_cells, config)
    with output_folder(out):
        return _make_cells(table_cells, config, out)


def _make_cells(table_cells: Sequence[Cell], config: TablesConfig, out: Path) -> Path:
    """Compute the cells and write the report into ``out``.

    Raises the same errors as :func:`make_table`.
    """
    chains = [cell.chain(config) for cell in table_cells]
    for cell in table_cells:
        cell.keep()
    failed = run_chains("cells", "cell", chains, config.jobs, config.launcher) or [
        f"{cell.column}, seed {cell.seed}: its rows in {cell.evaluation} were removed by another "
        "program after they were measured."
        for cell in table_cells
        if not _rows(cell.evaluation)
    ]
    if len(failed) == len(table_cells):
        raise ValueError("Every cell failed. " + " ".join(failed))
    problem = "Some cells failed. Run the same command again to resume them. " + " ".join(failed)
    measured = [cell.evaluation for cell in table_cells if _rows(cell.evaluation)]
    if not measured:
        raise ValueError(problem)
    report = write_report(config, out, measured)
    reports = [report, *write_additional_reports(table_cells, config, out)]
    if failed:
        raise ValueError(problem)
    print("\n".join(f"wrote {path}" for path in (*reports, *draw_walks(config, out))), flush=True)
    return report


def write_report(config: TablesConfig, out: Path, paths: Sequence[Path | str]) -> Path:
    """Write a report that summarizes the rows found under ``paths``.

    ``table.md`` contains all tables and plots. ``overview.md`` contains short tables that also show
    the results of the paper.
    """
    from mitigate.evaluation import report  # imports matplotlib

    rows = gather(paths)
    report.write(rows, out)
    chosen = [
        section
        for section in sections(rows)
        if section.grid.split == config.split
        # rows of clean episodes have no corruption
        and (section.severity == config.severity or not section.blocks)
    ]
    if not chosen:
        available = sorted({f"{row['split']} at {row['severity']:g}" for row in rows})
        raise ValueError(
            f"There are no rows of {config.split} at severity {config.severity:g}, only of "
            f"{', '.join(available)}. Set split= and severity=."
        )
    figures = {name: list(values) for name, values in config.paper.items()}
    text = "\n".join(report.beside(section, figures) for section in chosen)
    write_text(out / REPORT, text)
    print(plain_text(text), flush=True)
    return out / REPORT


def write_additional_reports(
    table_cells: Sequence[Cell], config: TablesConfig, out: Path
) -> list[Path]:
    """Write ``NAME/table.md`` and its pictures for each additional evaluation; return the paths.

    Each evaluation has its own table, because evaluations may use different episodes.
    """
    from mitigate.evaluation import report  # brings matplotlib

    reports = []
    for name in listed(config.evaluations, "evaluations"):
        folders = [cell.evaluation_folder(name) for cell in table_cells]
        if paths := [folder for folder in folders if _rows(folder)]:
            reports.append(report.write(gather(paths), out / name)[0])
    return reports


def draw_walks(config: TablesConfig, out: Path) -> list[Path]:
    """Plot episodes in which the first column of ``config.walks`` fails and the last succeeds.

    These episodes are run again with the agents of the first training seed, each with the guards of
    its column. Nothing is plotted if one of these columns has no cell.
    """
    from mitigate.evaluation.trajectories import write_pictures  # brings matplotlib
    from mitigate.guards.opening import open_guards

    by_column = {cell.column: cell for cell in cells(config) if cell.seed == config.seeds[0]}
    missing = [column for column in config.walks if column not in by_column]
    if missing:
        say(f"no pictures of episodes: {', '.join(missing)} in walks= is not a column")
    if not config.walks or missing:
        return []
    by_name = {_named(by_column[column].folder): by_column[column] for column in config.walks}
    nodes = {name: evaluation_of(cell.agent) for name, cell in by_name.items()}
    agents: dict[str, Any] = {
        n: load(c.agent, c.checkpoint, overrides=by_name[n].agent) for n, c in nodes.items()
    }
    env = next(iter(nodes.values())).env
    world, chosen = build.maker(env.world)(), episodes(env, config.split, config.episodes)
    guards = {
        name: open_guards(node.safeguard, node.restore, world.sensors, adapt=node.adapt)
        for name, node in nodes.items()
    }
    for name, chain in guards.items():
        chain.calibrate(agents[name], world, training_episodes(world, env.training))
    episode_ids = {episode.episode_id for episode in chosen}
    rows = [
        row
        for row in gather([cell.evaluation for cell in by_name.values()])
        if row["split"] == config.split
        and row["severity"] in (0.0, config.severity)
        and row["episode_id"] in episode_ids
    ]
    folder, seed = out / "pictures", config.seeds[0]
    return write_pictures(agents, world, chosen, rows, folder, seed=seed, guards=guards)


def _named(folder: Path) -> str:
    """Return the agent name in the result rows of a cell. The name includes guards.

    If the cell has no rows, return the name of its folder.
    """
    rows = _rows(folder / "evaluation")
    return str(rows[0]["name"]) if rows else folder.name.rpartition("-seed")[0]


def _rows(folder: Path) -> list[Row]:
    """Return the rows in ``folder``, or an empty list."""
    return read(folder / ROWS) if is_regular(folder / ROWS) else []
