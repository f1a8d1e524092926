"""The numbers of one table: clean values, PRS and paired PRS differences with intervals."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from mitigate.core.names import unknown
from mitigate.corruptions.registry import title
from mitigate.evaluation import bootstrap
from mitigate.evaluation.bootstrap import Estimate
from mitigate.evaluation.grid import (
    DRAWN,
    METRICS,
    SUITE,
    Gap,
    Grid,
    Retention,
    by_kind,
    expected_corruptions,
    grids,
    halves,
)
from mitigate.evaluation.metrics import FLOOR
from mitigate.evaluation.rows import RETURN, Row

REFERENCES = ("base", "before")  # columns with these names come first and are the reference


@dataclass(frozen=True)
class Retained:
    """A PRS, a mean SR or a difference of two, with the corruptions and episodes that it covers.

    ``near_floor``: whether a clean value is too low for a meaningful PRS.
    """

    estimate: Estimate
    corruptions: tuple[str, ...]
    episodes: int
    near_floor: bool


@dataclass(frozen=True)
class Section:
    """One table: a grid at one severity (0 if there are only clean cells).

    Metrics are "SR" and "SPL". Differences are paired differences to the ``reference`` column, over
    the seeds that both columns have.

    Attributes:
        grid: the results.
        kind: the corruptions of the table; empty for the suite.
        severity: of the corruptions.
        columns: labels of the columns, the reference first.
        blocks: corruptions by block.
        halves: parts of a block with a separate PRS, by block and heading.
        reference: the column that the others are compared with.
        clean: clean values by (column, metric).
        moved: difference of clean SR by column.
        retained: PRS by (column, block or half, metric).
        gained: difference of PRS by (column, block or half, metric).
        corrupted: mean SR over all corruptions by column.
        raised: difference of that mean SR by column.
        gaps: cells with missing episodes.
        by_seed: values of each seed for columns with several seeds: clean SR by (column, "clean"),
            PRS-SR by (column, block).
    """

    grid: Grid
    kind: str
    severity: float
    columns: tuple[str, ...]
    blocks: dict[str, tuple[str, ...]]
    halves: dict[str, dict[str, tuple[str, ...]]]
    reference: str
    clean: dict[tuple[str, str], Estimate]
    moved: dict[str, Estimate]
    retained: dict[tuple[str, str, str], Retained]
    gained: dict[tuple[str, str, str], Retained]
    corrupted: dict[str, Retained]
    raised: dict[str, Retained]
    gaps: list[Gap]
    by_seed: dict[tuple[str, str], dict[int, float]]

    def value(self, column: str, corruption: str, metric: str = "SR") -> float:
        """Return the mean of a cell over its episodes; NaN if it is empty."""
        return _mean(self.grid.cell(column, corruption, self.severity, METRICS[metric]))

    def partial(self, column: str, corruption: str) -> bool:
        """Return whether a cell has missing episodes."""
        return any((gap.column, gap.corruption) == (column, corruption) for gap in self.gaps)

    def whole(self, block: str) -> int:
        """Return how many corruptions a complete PRS over ``block``, or a half of it, covers."""
        half = next((parts[block] for parts in self.halves.values() if block in parts), None)
        if half is not None:
            name = block.rpartition(",")[0]
            return len(expected_corruptions(name, half))
        return len(expected_corruptions(block, self.blocks[block]))

    def marks(self, value: Retained, *blocks: str) -> str:
        """Return the marks of a value: missing episodes (*) or corruptions (†), near floor (‡)."""
        measured, expected = len(value.corruptions), sum(map(self.whole, blocks))
        fewer = "*" * (value.episodes < len(self.grid.episodes))
        return fewer + f" † {measured}/{expected}" * (measured < expected) + " ‡" * value.near_floor


@dataclass(frozen=True)
class Compared:
    """Paired differences of one column to another, over the seeds that both have.

    Attributes:
        moved: difference of clean SR; None if not measured.
        raised: difference of the mean SR under corruption; None if not measured.
        gained: difference of PRS by (block or half, metric).
    """

    moved: Estimate | None
    raised: Retained | None
    gained: dict[tuple[str, str], Retained]


def compare(section: Section, column: str, reference: str) -> Compared:
    """Return how ``column`` differs from ``reference``, any two columns of ``section``."""
    return _compared(section.grid, section.severity, (column, reference), section.blocks)


def sections(
    rows: Iterable[Row], against: str | None = None, drawn: str = DRAWN[0]
) -> list[Section]:
    """Return one section for each kind of corruption, split, suite, rule and severity in ``rows``.

    If a column has only clean rows (a control), a clean-only section comes first.

    Args:
        rows: result rows.
        against: the reference column, in sections that have it; None: :data:`REFERENCES`.
        drawn: what the bootstrap draws, as in :func:`grids`.

    Raises:
        ValueError: No row belongs to the column ``against``.
    """
    rows = list(rows)
    if any(row["rule"] == RETURN for row in rows):
        raise ValueError(
            "These rows hold the return of a task without a success, so that SR is undefined. Use "
            "mitigate.evaluation.returns.returns(rows), as mitigate.benchmark does."
        )
    names = sorted({row["name"] for row in rows})
    if against is not None and against not in names:
        raise ValueError(unknown("column", against, names))
    first = REFERENCES if against is None else (against,)
    results = []
    for kind, table_rows in (by_kind(rows) or {SUITE: []}).items():
        for grid in grids(table_rows, drawn):
            corrupted = {label for label, _, severity, _ in grid.cells if severity > 0}
            clean_only = [] if corrupted == grid.columns.keys() else [0.0]
            results += [
                _section(grid, kind, severity, first) for severity in clean_only + grid.severities
            ]
    return results


label = title  # name of a corruption in the paper's table


def _section(grid: Grid, kind: str, severity: float, first: Sequence[str]) -> Section:
    rank = {name: place for place, name in enumerate(first)}
    columns = sorted(
        grid.columns_at(severity), key=lambda label: rank.get(grid.columns[label][0], len(rank))
    )
    blocks, reference = grid.blocks_at(severity), columns[0]
    parted = halves(blocks)
    measured = _measured(blocks)
    clean, retained, corrupted = {}, {}, {}
    gained: dict[tuple[str, str, str], Retained] = {}
    moved: dict[str, Estimate] = {}
    raised: dict[str, Retained] = {}
    every = tuple(name for names in blocks.values() for name in names)
    for column in columns:
        if parts := grid.retention([column], every, severity, METRICS["SR"]):
            corrupted[column] = mean_sr(parts)
        if column != reference:
            compared = _compared(grid, severity, (column, reference), blocks)
            gained |= {(column, *place): value for place, value in compared.gained.items()}
            moved |= {column: compared.moved} if compared.moved else {}
            raised |= {column: compared.raised} if compared.raised else {}
        for metric, key in METRICS.items():
            mask = grid.measured(column, severity, key)
            if mask.any():
                values = grid.cell(column, "clean", severity, key)[mask]
                clean[column, metric] = bootstrap.share(values, units=grid.units[mask])
            for block, names in measured.items():
                place = (column, block, metric)
                if parts := grid.retention([column], names, severity, key):
                    retained[place] = _retained(parts)
    return Section(
        grid,
        kind,
        severity,
        tuple(columns),
        blocks,
        parted,
        reference,
        clean,
        moved,
        retained,
        gained,
        corrupted,
        raised,
        grid.gaps(severity),
        _by_seed(grid, severity, blocks),
    )


def _measured(blocks: dict[str, tuple[str, ...]]) -> dict[str, tuple[str, ...]]:
    """Return the blocks and, if both were measured, their halves."""
    parted = halves(blocks).values()
    return blocks | {half: names for parts in parted for half, names in parts.items()}


def _compared(
    grid: Grid, severity: float, pair: tuple[str, str], blocks: dict[str, tuple[str, ...]]
) -> Compared:
    """Return the differences of the first of ``pair`` to the second.

    There are none without a common seed, because corruptions of other seeds have other keys.
    """
    if not grid.common(pair, severity):
        return Compared(None, None, {})
    both = grid.paired(pair, severity)
    first, second = (both.cell(label, "clean", severity, METRICS["SR"]) for label in pair)
    change = first - second
    mask = ~np.isnan(change)
    every = tuple(name for names in blocks.values() for name in names)
    parts = both.retention(pair, every, severity, METRICS["SR"])
    gained: dict[tuple[str, str], Retained] = {}
    for metric, key in METRICS.items():
        for block, names in _measured(blocks).items():
            if retention := both.retention(pair, names, severity, key):
                gained[block, metric] = _retained(retention)
    moved = bootstrap.mean(change[mask], units=grid.units[mask]) if mask.any() else None
    return Compared(moved, mean_sr(parts) if parts else None, gained)


def _by_seed(
    grid: Grid, severity: float, blocks: dict[str, tuple[str, ...]]
) -> dict[tuple[str, str], dict[int, float]]:
    """Return the clean SR and the PRS-SR of every block for each pooled seed."""
    values: dict[tuple[str, str], dict[int, float]] = defaultdict(dict)
    for column in grid.columns:
        seeds = grid.seeds.get((column, severity), ())
        for seed in seeds if len(seeds) > 1 else ():
            run = grid.over([column], [seed], severity)
            clean = run.cell(column, "clean", severity, METRICS["SR"])
            values[column, "clean"][seed] = _mean(clean)
            for block, names in blocks.items():
                for part in run.retention([column], names, severity, METRICS["SR"]) or ():
                    values[column, block][seed] = part.prs
    return dict(values)


def _retained(parts: list[Retention]) -> Retained:
    """Return the PRS of one part, or the difference of the first to the second."""
    pairs, units = [(part.clean, part.corrupted) for part in parts], parts[0].units
    estimate = (
        bootstrap.prs(*pairs[0], units=units)
        if len(pairs) == 1
        else bootstrap.prs_difference(*pairs, units=units)
    )
    near_floor = min(part.clean.mean() for part in parts) < FLOOR
    return Retained(estimate, parts[0].corruptions, len(parts[0].clean), bool(near_floor))


def mean_sr(parts: list[Retention]) -> Retained:
    """Return the mean SR under corruption of one part, or the first's minus the second's."""
    means, units = [part.corrupted.mean(axis=0) for part in parts], parts[0].units
    estimate = (
        bootstrap.share(means[0], units=units)
        if len(means) == 1
        else bootstrap.mean(means[0] - means[1], units=units)
    )
    return Retained(estimate, parts[0].corruptions, len(parts[0].clean), False)


def _mean(values: np.ndarray) -> float:
    known = values[~np.isnan(values)]
    return float(known.mean()) if len(known) else math.nan
