"""One table's worth of numbers: clean values, PRS and paired PRS differences with intervals."""

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
    grids,
    halves,
    meant,
)
from mitigate.evaluation.metrics import FLOOR
from mitigate.evaluation.rows import Row

REFERENCES = ("base", "before")  # such a column comes first; the others are compared with it


@dataclass(frozen=True)
class Retained:
    """A PRS, a mean SR or a difference of two, what it covers, and whether a clean value is too
    low."""

    estimate: Estimate
    corruptions: tuple[str, ...]
    episodes: int
    near_floor: bool


@dataclass(frozen=True)
class Section:
    """One table: a grid at one severity (0 where only clean cells exist).

    ``kind`` says which corruptions it shows, empty for the suite's. ``halves`` are parts of a block
    that have a PRS of their own, by block and heading.
    ``clean`` is keyed by (column, metric), ``retained`` by (column, block or half, metric) and
    ``gained``, the paired PRS difference to the ``reference`` column, likewise; metrics are "SR"
    and "SPL". ``moved`` is the paired difference of clean SR, by column. Differences are over the
    seeds that both columns have. ``corrupted`` is the mean SR over all
    corruptions and ``raised`` its paired difference, by column. ``by_seed`` holds each seed's own
    clean SR (key: column, "clean") and PRS-SR (column, block), for columns with several seeds.
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
        """Return the mean of a cell over the episodes it holds, NaN if it holds none."""
        return _mean(self.grid.cell(column, corruption, self.severity, METRICS[metric]))

    def partial(self, column: str, corruption: str) -> bool:
        """Return whether a cell lacks episodes."""
        return any((gap.column, gap.corruption) == (column, corruption) for gap in self.gaps)

    def whole(self, block: str) -> int:
        """Return how many corruptions a PRS over ``block``, or a half of it, stands for, measured
        or not."""
        half = next((parts[block] for parts in self.halves.values() if block in parts), None)
        if half is not None:
            name = block.rpartition(",")[0]
            return len(meant(name, half))
        return len(meant(block, self.blocks[block]))

    def marks(self, found: Retained, *blocks: str) -> str:
        """Return the signs of a value that lacks corruptions or episodes, or is near the floor."""
        held, wanted = len(found.corruptions), sum(map(self.whole, blocks))
        fewer = "*" * (found.episodes < len(self.grid.episodes))
        return fewer + f" † {held}/{wanted}" * (held < wanted) + " ‡" * found.near_floor


@dataclass(frozen=True)
class Compared:
    """Paired differences of one column to another, over the seeds that both have: of clean SR
    (``moved``), of the mean SR under corruption (``raised``), and of PRS by (block or half,
    metric), each where it was measured."""

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

    Where a column was never corrupted (a control), a clean-only section comes first. ``against``:
    the column that comes first and that the others are compared with, where it is there; None:
    :data:`REFERENCES`. ``drawn``: what the bootstrap draws, as in :func:`grids`. Raises ValueError
    if a column to compare with is nowhere.
    """
    rows = list(rows)
    names = sorted({row["name"] for row in rows})
    if against is not None and against not in names:
        raise ValueError(unknown("column", against, names))
    first = REFERENCES if against is None else (against,)
    found = []
    for kind, held in (by_kind(rows) or {SUITE: []}).items():
        for grid in grids(held, drawn):
            corrupted = {label for label, _, severity, _ in grid.cells if severity > 0}
            clean_only = [] if corrupted == grid.columns.keys() else [0.0]
            found += [
                _section(grid, kind, severity, first) for severity in clean_only + grid.severities
            ]
    return found


label = title  # of a corruption, as the paper's table prints it


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
            found = _compared(grid, severity, (column, reference), blocks)
            gained |= {(column, *place): value for place, value in found.gained.items()}
            moved |= {column: found.moved} if found.moved else {}
            raised |= {column: found.raised} if found.raised else {}
        for metric, key in METRICS.items():
            held = grid.measured(column, severity, key)
            if held.any():
                values = grid.cell(column, "clean", severity, key)[held]
                clean[column, metric] = bootstrap.share(values, units=grid.units[held])
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
    """Return the blocks and, where both were measured, their halves."""
    own = halves(blocks).values()
    return blocks | {half: names for parts in own for half, names in parts.items()}


def _compared(
    grid: Grid, severity: float, pair: tuple[str, str], blocks: dict[str, tuple[str, ...]]
) -> Compared:
    """Return the differences of the first of ``pair`` to the second; none if no seed is common:
    on other seeds they met corruptions of other keys."""
    if not grid.common(pair, severity):
        return Compared(None, None, {})
    both = grid.paired(pair, severity)
    first, second = (both.cell(label, "clean", severity, METRICS["SR"]) for label in pair)
    change = first - second
    held = ~np.isnan(change)
    every = tuple(name for names in blocks.values() for name in names)
    parts = both.retention(pair, every, severity, METRICS["SR"])
    gained: dict[tuple[str, str], Retained] = {}
    for metric, key in METRICS.items():
        for block, names in _measured(blocks).items():
            if found := both.retention(pair, names, severity, key):
                gained[block, metric] = _retained(found)
    moved = bootstrap.mean(change[held], units=grid.units[held]) if held.any() else None
    return Compared(moved, mean_sr(parts) if parts else None, gained)


def _by_seed(
    grid: Grid, severity: float, blocks: dict[str, tuple[str, ...]]
) -> dict[tuple[str, str], dict[int, float]]:
    """Return the clean SR and the PRS-SR of every block, of each seed that is pooled."""
    found: dict[tuple[str, str], dict[int, float]] = defaultdict(dict)
    for column in grid.columns:
        seeds = grid.seeds.get((column, severity), ())
        for seed in seeds if len(seeds) > 1 else ():
            run = grid.over([column], [seed], severity)
            found[column, "clean"][seed] = _mean(run.cell(column, "clean", severity, METRICS["SR"]))
            for block, names in blocks.items():
                for part in run.retention([column], names, severity, METRICS["SR"]) or ():
                    found[column, block][seed] = part.prs
    return dict(found)


def _retained(parts: list[Retention]) -> Retained:
    """Return the PRS of one part, or the difference of the first's to the second's."""
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
