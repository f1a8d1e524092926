"""Compute the curves of SR against severity that ``severity.png`` and the HTML page show."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mitigate.evaluation import bootstrap
from mitigate.evaluation.bootstrap import Estimate
from mitigate.evaluation.grid import METRICS, Grid

RESAMPLES = 2000  # number of bootstrap resamples for the interval of each point (heuristic)


@dataclass(frozen=True)
class Curve:
    """SR as a function of severity, for one column and one corruption.

    Attributes:
        column: label of the column.
        count: number of episodes; all points use the same seeds and episodes.
        severities: severities in ascending order, starting with 0 if clean episodes were measured.
        points: SR at each severity.
    """

    column: str
    count: int
    severities: list[float]
    points: list[Estimate]


def curves(grid: Grid, corruption: str, least: int = 1) -> list[Curve]:
    """Return the curve of each column that was measured under ``corruption``.

    A column is left out if it was measured at fewer than ``least`` severities above 0, or if its
    severities have no seed or no episode in common.
    """
    lines = (_curve(grid, column, corruption, least) for column in grid.columns)
    return [line for line in lines if line is not None]


def _curve(grid: Grid, column: str, name: str, least: int) -> Curve | None:
    key = METRICS["SR"]
    severities = [
        at for at in grid.severities if not np.isnan(grid.cell(column, name, at, key)).all()
    ]
    if len(severities) < least or not severities:
        return None
    seeds = set.intersection(*(set(grid.seeds[column, at]) for at in severities))
    if not seeds:
        return None
    pooled = [grid.over([column], sorted(seeds), at) for at in severities]
    cells = [one.cell(column, name, at, key) for one, at in zip(pooled, severities, strict=True)]
    clean = pooled[0].cell(column, "clean", severities[0], key)
    if not np.isnan(clean).all():
        cells, severities = [clean, *cells], [0.0, *severities]
    values = np.stack(cells)
    common = ~np.isnan(values).any(axis=0)
    if not common.any():
        return None
    estimates = bootstrap.means(
        values[:, common], units=grid.units[common], shares=True, resamples=RESAMPLES
    )
    points = [estimate for estimate in estimates if estimate is not None]
    return Curve(column, int(common.sum()), severities, points)
