"""Compute the curves of SR against severity that ``severity.png`` and the HTML page show."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mitigate.evaluation import bootstrap
from mitigate.evaluation.bootstrap import Estimate
from mitigate.evaluation.grid import COVERAGE, Grid

RESAMPLES = 2000  # number of bootstrap resamples for the interval of each point (heuristic)


@dataclass(frozen=True)
class Curve:
    """SR as a function of severity, for one column and one corruption.

    Attributes:
        column: label of the column.
        count: number of episodes; all points use the same seeds and episodes.
        severities: severities in ascending order, starting with 0 if clean episodes were measured.
        points: SR at each severity, interpolated for seeds that did not measure it.
    """

    column: str
    count: int
    severities: list[float]
    points: list[Estimate]


def curves(grid: Grid, corruption: str, least: int = 1) -> list[Curve]:
    """Return the curve of each column that was measured under ``corruption``.

    A curve averages the seeds that were measured at the column's lowest and highest severity. A
    search for critical severities measures other severities with each seed. So the results of a
    seed are interpolated linearly between its severities, separately for each episode.

    A column is left out if it was measured at fewer than ``least`` severities above 0, or if its
    severities have no seed or no episode in common.
    """
    lines = (_curve(grid, column, corruption, least) for column in grid.columns)
    return [line for line in lines if line is not None]


def _curve(grid: Grid, column: str, name: str, least: int) -> Curve | None:
    by_seed = _by_seed(grid, column, name)
    measured = set().union(*by_seed)
    if not measured:
        return None
    by_seed = [line for line in by_seed if {min(measured), max(measured)} <= line.keys()]
    severities = sorted(set().union(*by_seed))
    if not by_seed or sum(at > 0 for at in severities) < least:
        return None
    values = np.mean([_interpolated(line, severities) for line in by_seed], axis=0)
    common = ~np.isnan(values).any(axis=0)
    if not common.any():
        return None
    estimates = bootstrap.means(
        values[:, common], units=grid.units[common], shares=True, resamples=RESAMPLES
    )
    points = [estimate for estimate in estimates if estimate is not None]
    return Curve(column, int(common.sum()), severities, points)


def _by_seed(grid: Grid, column: str, name: str) -> list[dict[float, np.ndarray]]:
    """Return the successes of the N episodes at each severity, for each seed with corrupted rows.

    A severity of a seed is left out if it has results of fewer than the fraction ``COVERAGE`` of
    the episodes that another seed has there.
    """
    lines = [grid.by_severity(column, name, seed) for seed in grid.runs[column]]
    lines = [line for line in lines if any(at > 0 for at in line)]
    counts = [{at: int((~np.isnan(x)).sum()) for at, x in line.items()} for line in lines]
    most = {at: max(count.get(at, 0) for count in counts) for at in set().union(*counts)}
    return [
        {at: x for at, x in line.items() if count[at] >= COVERAGE * most[at]}
        for line, count in zip(lines, counts, strict=True)
    ]


def _interpolated(line: Mapping[float, np.ndarray], severities: Sequence[float]) -> np.ndarray:
    """Return the values of a seed at ``severities`` [K, N]; NaN if a row is missing."""
    measured = sorted(line)
    values = np.stack([line[at] for at in measured])
    weights = np.stack([np.interp(severities, measured, row) for row in np.eye(len(values))], 1)
    missing = weights @ np.isnan(values) > 0
    return np.where(missing, np.nan, weights @ np.nan_to_num(values))
