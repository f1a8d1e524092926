"""Compute the numbers of a table: clean values, PRS and paired differences with intervals."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mitigate.core.names import unknown
from mitigate.corruptions.registry import HALVES, UNSEEN
from mitigate.evaluation import bootstrap
from mitigate.evaluation.bootstrap import Estimate
from mitigate.evaluation.grid import (
    METRICS,
    SUITE,
    Gap,
    Grid,
    Retention,
    by_kind,
    expected_corruptions,
    grids,
)
from mitigate.evaluation.metrics import FLOOR
from mitigate.evaluation.rows import Row
from mitigate.worlds.seeded import RETURN

# a column with one of these names comes first, and the other columns are compared with it
REFERENCES = ("base", "before")


@dataclass(frozen=True)
class Retained:
    """A PRS, a mean SR, or a difference of two of these.

    Attributes:
        estimate: value and interval.
        corruptions: the corruptions over which the value is computed.
        episodes: number of episodes from which the value is computed.
        near_floor: whether a clean value is too low for a meaningful PRS.
    """

    estimate: Estimate
    corruptions: tuple[str, ...]
    episodes: int
    near_floor: bool


@dataclass(frozen=True)
class Difference:
    """Paired differences of one column from another, over the seeds that both have.

    Differences are computed only for common seeds, because corruptions with different seeds use
    different random keys.

    Attributes:
        clean: difference of clean SR, or None if it was not measured.
        corrupted: difference of the mean SR under corruption, or None if it was not measured.
        retained: differences of PRS by (part, metric), where a part is a key of ``Section.parts``.
    """

    clean: Estimate | None
    corrupted: Retained | None
    retained: dict[tuple[str, str], Retained]


NO_DIFFERENCE = Difference(None, None, {})


@dataclass(frozen=True)
class Section:
    """One table of results: a grid at one severity.

    The severity is 0 if there are only clean cells. The metrics are "SR" and "SPL".

    Attributes:
        grid: the results.
        kind: the kind of corruptions in the table; it is empty for the corruption suite.
        severity: severity of the corruptions.
        columns: labels of the columns; the others are compared with the first one.
    """

    grid: Grid
    kind: str
    severity: float
    columns: tuple[str, ...]

    @property
    def reference(self) -> str:
        """The column with which the others are compared."""
        return self.columns[0]

    @cached_property
    def blocks(self) -> dict[str, tuple[str, ...]]:
        """Measured corruptions by block."""
        return self.grid.blocks_at(self.severity)

    @cached_property
    def halves(self) -> dict[str, dict[str, tuple[str, ...]]]:
        """The validation half and the test half of each block of unseen corruptions.

        The outer keys are blocks, and the inner keys are headings of the halves. A block is left
        out if one of its halves was not measured.
        """
        of_half = [(half, {n for n in UNSEEN if UNSEEN[n].half == half}) for half in HALVES]
        by_block = {
            block: {
                f"{block}, {half}": tuple(n for n in names if n in members)
                for half, members in of_half
            }
            for block, names in self.blocks.items()
        }
        return {block: parts for block, parts in by_block.items() if all(parts.values())}

    @cached_property
    def parts(self) -> dict[str, tuple[str, ...]]:
        """For each part of the table, the corruptions over which its PRS is computed.

        The parts are the blocks, followed by the validation and test halves of blocks.
        """
        halves = {half: names for pair in self.halves.values() for half, names in pair.items()}
        return self.blocks | halves

    @cached_property
    def corruptions(self) -> tuple[str, ...]:
        """All measured corruptions, in the order of the blocks."""
        return tuple(name for names in self.blocks.values() for name in names)

    @cached_property
    def gaps(self) -> list[Gap]:
        """Cells with missing episodes."""
        return self.grid.gaps(self.severity)

    @cached_property
    def clean(self) -> dict[tuple[str, str], Estimate]:
        """The clean values, keyed by (column, metric)."""
        values = {}
        for column in self.columns:
            for metric, key in METRICS.items():
                mask = self.grid.measured(column, "clean", self.severity, key)
                if mask.any():
                    cell = self.grid.cell(column, "clean", self.severity, key)[mask]
                    values[column, metric] = bootstrap.share(cell, units=self.grid.units[mask])
        return values

    @cached_property
    def corrupted(self) -> dict[str, Retained]:
        """The mean SR over all corruptions, by column."""
        by_column = {column: self.mean_sr(column, self.corruptions) for column in self.columns}
        return {column: value for column, value in by_column.items() if value is not None}

    @cached_property
    def retained(self) -> dict[tuple[str, str, str], Retained]:
        """The PRS, keyed by (column, part, metric), where a part is a key of :attr:`parts`."""
        return {
            (column, part, metric): _retained(retentions)
            for column in self.columns
            for metric, key in METRICS.items()
            for part, names in self.parts.items()
            if (retentions := self.grid.retention([column], names, self.severity, key))
        }

    @cached_property
    def differences(self) -> dict[str, Difference]:
        """The differences of the other columns from the reference."""
        return {column: self.compare(column, self.reference) for column in self.columns[1:]}

    @cached_property
    def by_seed(self) -> dict[tuple[str, str], dict[int, float]]:
        """The clean SR and the PRS-SR of each seed; only columns with several seeds are included.

        The key (column, "clean") maps each seed to its clean SR. The key (column, block) maps each
        seed to its PRS-SR for the block.
        """
        values: dict[tuple[str, str], dict[int, float]] = defaultdict(dict)
        for column in self.columns:
            seeds = self.grid.seeds[column, self.severity]
            for seed in seeds if len(seeds) > 1 else ():
                run = self.grid.over([column], [seed], self.severity)
                clean = run.cell(column, "clean", self.severity, METRICS["SR"])
                values[column, "clean"][seed] = _mean(clean)
                for block, names in self.blocks.items():
                    retentions = run.retention([column], names, self.severity, METRICS["SR"])
                    if retentions:
                        values[column, block][seed] = retentions[0].prs
        return dict(values)

    def mean_sr(self, column: str, names: Sequence[str]) -> Retained | None:
        """Return a column's mean SR over ``names``, or None if none of them was measured."""
        retentions = self.grid.retention([column], names, self.severity, METRICS["SR"])
        return _mean_sr(retentions) if retentions else None

    def compare(self, column: str, reference: str) -> Difference:
        """Return ``column`` minus ``reference``; both can be any columns."""
        pair, severity = (column, reference), self.severity
        both = self.grid.paired(pair, severity)
        if both is None:
            return NO_DIFFERENCE
        first, second = (both.cell(name, "clean", severity, METRICS["SR"]) for name in pair)
        change = first - second
        mask = ~np.isnan(change)
        clean = bootstrap.mean(change[mask], units=both.units[mask]) if mask.any() else None
        corrupted = both.retention(pair, self.corruptions, severity, METRICS["SR"])
        retained = {
            (part, metric): _retained(retentions)
            for metric, key in METRICS.items()
            for part, names in self.parts.items()
            if (retentions := both.retention(pair, names, severity, key))
        }
        return Difference(clean, _mean_sr(corrupted) if corrupted else None, retained)

    def changes(self, column: str, corruption: str) -> dict[str, Retained]:
        """Return the paired differences of a column's SR under one corruption: from its clean SR
        ("clean"), and from the reference's SR under the same corruption (the reference's name).

        Differences that were not measured are left out.
        """
        pair, severity, key = (column, self.reference), self.severity, METRICS["SR"]
        changes = {}
        if retentions := self.grid.retention([column], (corruption,), severity, key):
            pairs = retentions[0]
            change = bootstrap.mean(pairs.corrupted[0] - pairs.clean, units=pairs.units)
            changes["clean"] = Retained(change, pairs.corruptions, len(pairs.clean), False)
        both = self.grid.paired(pair, severity) if column != self.reference else None
        if both and (retentions := both.retention(pair, (corruption,), severity, key)):
            changes[self.reference] = _mean_sr(retentions)
        return changes

    def value(self, column: str, corruption: str, metric: str = "SR") -> float:
        """Return the mean of a cell over its episodes, or NaN if the cell is empty."""
        return _mean(self.grid.cell(column, corruption, self.severity, METRICS[metric]))

    def partial(self, column: str, corruption: str) -> bool:
        """Return whether a cell has missing episodes."""
        return not self.grid.measured(column, corruption, self.severity).all()

    def whole(self, part: str) -> int:
        """Return the number of corruptions in ``part``, which is a key of :attr:`parts`."""
        block = part if part in self.blocks else part.rpartition(",")[0]
        return len(expected_corruptions(block, self.parts[part]))

    def marks(self, value: Retained, *parts: str) -> str:
        """Return the marks that the table shows next to a value.

        The mark * means missing episodes, † missing corruptions, and ‡ a low clean value.
        """
        measured, expected = len(value.corruptions), sum(map(self.whole, parts))
        fewer = "*" * (value.episodes < len(self.grid.episodes))
        return fewer + f" † {measured}/{expected}" * (measured < expected) + " ‡" * value.near_floor

    def notes(self, escape: Callable[[str], str] = str) -> list[str]:
        """Return a line per unfinished seed, and one per column with episodes that a limit ended.

        The function ``escape`` is applied to the column labels.
        """
        unfinished = [
            f"Seed {seed} of {escape(column)} is not finished and left out: {have:,} of {want:,} "
            "rows."
            for column in self.columns
            for seed, (have, want) in self.grid.unfinished[column, self.severity].items()
        ]
        cut = self.grid.cut
        return unfinished + [f"{escape(c)}: {cut[c]}" for c in self.columns if c in cut]


def references(rows: Iterable[Row], against: str | None) -> Sequence[str]:
    """Return the names of the reference columns.

    The result is ``against``, or :data:`REFERENCES` if ``against`` is None.

    Raises:
        ValueError: If the rows contain no column with the name ``against``.
    """
    names = sorted({row["name"] for row in rows})
    if against is not None and against not in names:
        raise ValueError(unknown("column", against, names))
    return REFERENCES if against is None else (against,)


def sections(
    rows: Iterable[Row], against: str | None = None, drawn: str | None = None
) -> list[Section]:
    """Return one section for each kind of corruption, split, suite, rule and severity in ``rows``.

    If a column, such as a control, has only clean rows, its grid has an additional first section
    that shows only clean rows.

    Args:
        rows: result rows.
        against: name of the reference column. Sections without it use their first column. The
            default is :data:`REFERENCES`.
        drawn: unit that the bootstrap resamples, as in :func:`grids`.

    Raises:
        ValueError: If the rows contain no column with the name ``against``.
    """
    rows = list(rows)
    if any(row["rule"] == RETURN for row in rows):
        raise ValueError(
            "These rows hold the return of a task without a success criterion, so SR is undefined. "
            "Use mitigate.evaluation.comparison.compare(rows), as mitigate.benchmark does."
        )
    first = references(rows, against)
    rank = {name: place for place, name in enumerate(first)}
    results = []
    for kind, table_rows in (by_kind(rows) or {SUITE: []}).items():
        for grid in grids(table_rows, drawn):
            corrupted = {label for label, _, severity, _ in grid.cells if severity > 0}
            clean_only = [] if corrupted == grid.columns.keys() else [0.0]
            for severity in clean_only + grid.severities:
                columns = sorted(
                    grid.columns_at(severity), key=lambda x: rank.get(grid.columns[x][0], len(rank))
                )
                results.append(Section(grid, kind, severity, tuple(columns)))
    return results


def _retained(columns: list[Retention]) -> Retained:
    """Return the PRS of the first column, minus the PRS of the second column if it exists."""
    pairs = [(column.clean, column.corrupted) for column in columns]
    first = columns[0]
    estimate = (
        bootstrap.prs(*pairs[0], units=first.units)
        if len(pairs) == 1
        else bootstrap.prs_difference(*pairs, units=first.units)
    )
    near_floor = min(column.clean.mean() for column in columns) < FLOOR
    return Retained(estimate, first.corruptions, len(first.clean), bool(near_floor))


def _mean_sr(columns: list[Retention]) -> Retained:
    """Return the mean SR of the first column, minus that of the second column if it exists."""
    means = [column.corrupted.mean(axis=0) for column in columns]
    first = columns[0]
    estimate = (
        bootstrap.share(means[0], units=first.units)
        if len(means) == 1
        else bootstrap.mean(means[0] - means[1], units=first.units)
    )
    return Retained(estimate, first.corruptions, len(first.clean), False)


def _mean(values: np.ndarray) -> float:
    known = values[~np.isnan(values)]
    return float(known.mean()) if len(known) else math.nan
