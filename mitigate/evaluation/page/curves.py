"""Success against severity: for each corruption met at several, a line for each agent."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from mitigate.evaluation import bootstrap
from mitigate.evaluation.blocks import BLOCKS
from mitigate.evaluation.grid import METRICS, Grid
from mitigate.evaluation.page.model import numbers
from mitigate.evaluation.sections import Section, label

RESAMPLES = 2000  # of a point's interval (ours)


def curves(parts: Sequence[Section]) -> list[dict[str, Any]]:
    """Return a figure for each grid of ``parts`` where a corruption was met at two severities.

    ``panels[p]["lines"]`` hold "column", "count" and "points" [severity, SR, low, high]. All points
    of a line, the clean one at 0 too, are over the same seeds and episodes, those that each of them
    holds: ``count`` episodes.
    """
    found: list[dict[str, Any]] = []
    done: list[Grid] = []
    for section in parts:
        if any(section.grid is grid for grid in done):
            continue
        done.append(section.grid)
        panels = _panels(section.grid)
        if panels:
            grid = section.grid
            title = f"{grid.heading}, suite {grid.suite}"
            columns = [x for x in grid.columns if any(_has(panel, x) for panel in panels)]
            title += f", {section.kind}" if section.kind else ""
            found.append({"title": title, "columns": columns, "panels": panels})
    return found


def _has(panel: dict[str, Any], column: str) -> bool:
    return any(line["column"] == column for line in panel["lines"])


def _panels(grid: Grid) -> list[dict[str, Any]]:
    held = {name for _, name, at, _ in grid.cells if at > 0 and name != "clean"}
    met = [name for block in BLOCKS.values() for name in block if name in held]
    met += sorted(held.difference(met))
    panels = []
    for name in met:
        lines = [_line(grid, column, name) for column in grid.columns]
        kept = [line for line in lines if line is not None]
        if kept:
            panels.append({"name": name, "title": label(name), "lines": kept})
    return panels


def _line(grid: Grid, column: str, name: str) -> dict[str, Any] | None:
    key = METRICS["SR"]
    measured = [at for at in grid.severities if (column, name, at, key) in grid.cells]
    measured = [at for at in measured if not np.isnan(grid.cell(column, name, at, key)).all()]
    if len(measured) < 2:
        return None
    seeds = set.intersection(*(set(grid.seeds[column, at]) for at in measured))
    if not seeds:
        return None
    pooled = [grid.over([column], sorted(seeds), at) for at in measured]
    cells = [one.cell(column, name, at, key) for one, at in zip(pooled, measured, strict=True)]
    clean = pooled[0].cell(column, "clean", measured[0], key)
    severities = measured
    if not np.isnan(clean).all():
        cells, severities = [clean, *cells], [0.0, *measured]
    values = np.stack(cells)
    common = ~np.isnan(values).any(axis=0)
    if not common.any():
        return None
    found = bootstrap.means(values[:, common], shares=True, resamples=RESAMPLES)
    points = [[at, *(numbers(e) or [])] for at, e in zip(severities, found, strict=True)]
    return {"column": column, "count": int(common.sum()), "points": points}
