"""The report: the paper's Table II as Markdown with paired intervals, and the pictures beside it.

Every number is computed from result rows. Partial rows give a partial table that lists its gaps.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mitigate.evaluation import bootstrap
from mitigate.evaluation.bootstrap import LEVEL, RESAMPLES, Estimate
from mitigate.evaluation.grid import METRICS, Gap, Grid, grids
from mitigate.evaluation.metrics import FLOOR
from mitigate.evaluation.rows import Row
from mitigate.files import atomic_text

REFERENCES = ("base", "before")  # a column of such a name is what the others are compared with
LABELS = {  # the paper's Table II
    "low_light": "L-L w/o noise",
    "low_light_noise": "L-L w/ noise",
    "black_out": "Black-out",
}


@dataclass(frozen=True)
class Retained:
    """A PRS or a difference of two, the corruptions it covers, and if a clean value is too low."""

    estimate: Estimate
    corruptions: tuple[str, ...]
    near_floor: bool


@dataclass(frozen=True)
class Section:
    """One table: a grid at one severity (0 where only clean cells exist).

    ``clean`` is keyed by (column, metric), ``retained`` by (column, block, metric) and ``gained``,
    the paired PRS difference to the ``reference`` column, likewise; metrics are "SR" and "SPL".
    """

    grid: Grid
    severity: float
    columns: tuple[str, ...]
    blocks: dict[str, tuple[str, ...]]
    reference: str
    clean: dict[tuple[str, str], Estimate]
    retained: dict[tuple[str, str, str], Retained]
    gained: dict[tuple[str, str, str], Retained]
    gaps: list[Gap]

    def value(self, column: str, corruption: str, metric: str = "SR") -> float:
        """Return the mean of a cell over the episodes it holds, NaN if it holds none."""
        severity = 0.0 if corruption == "clean" else self.severity
        return _mean(self.grid.cell(column, corruption, severity, METRICS[metric]))

    def partial(self, column: str, corruption: str) -> bool:
        """Return whether a cell lacks episodes."""
        return any((gap.column, gap.corruption) == (column, corruption) for gap in self.gaps)


def sections(rows: Iterable[Row]) -> list[Section]:
    """Return one section for each split, suite, rule and severity in ``rows``."""
    return [
        _section(grid, severity) for grid in grids(rows) for severity in grid.severities or [0.0]
    ]


def label(corruption: str) -> str:
    """Return the name of a corruption as the paper's table prints it."""
    return LABELS.get(corruption, corruption.replace("_", " ").capitalize())


def markdown(parts: Sequence[Section], pictures: Sequence[Sequence[str]] = ()) -> str:
    """Return the tables as Markdown; ``pictures[i]`` are file names to show under section i."""
    texts = []
    for index, section in enumerate(parts):
        names = pictures[index] if index < len(pictures) else ()
        shown = "\n".join(f"![{Path(name).stem}]({name})" for name in names)
        texts.append(f"{_heading(section)}\n\n{_table(section)}\n\n{_notes(section)}\n\n{shown}")
    return "\n\n".join(text.strip() for text in texts) + "\n"


def write(rows: Iterable[Row], folder: Path | str) -> list[Path]:
    """Write ``table.md``, ``heatmap.png`` and ``severity.png`` to ``folder``; return their paths.

    Further sections and grids get ``heatmap-2.png``, ``severity-2.png`` and so on.
    """
    from mitigate.evaluation import plots  # matplotlib is slow to import

    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    parts = sections(rows)
    pictures: list[list[str]] = [[] for _ in parts]
    drawn: list[Grid] = []
    for index, section in enumerate(parts):
        if not section.blocks:
            continue
        pictures[index].append(_numbered("heatmap", index))
        plots.heatmap(section, folder / pictures[index][-1])
        if section.grid not in drawn:
            pictures[index].append(_numbered("severity", len(drawn)))
            plots.severity_curves(section.grid, folder / pictures[index][-1])
            drawn.append(section.grid)
    with atomic_text(folder / "table.md") as file:
        file.write(markdown(parts, pictures))
    return [folder / "table.md", *(folder / name for names in pictures for name in names)]


def _section(grid: Grid, severity: float) -> Section:
    columns, blocks = tuple(grid.columns_at(severity)), grid.blocks_at(severity)
    named = [c for name in REFERENCES for c in columns if grid.columns[c][0] == name]
    reference = (named or columns)[0]
    clean, retained, gained = {}, {}, {}
    for column in columns:
        for metric, key in METRICS.items():
            values = grid.cell(column, "clean", 0.0, key)
            if grid.measured(column, key).any():
                clean[column, metric] = bootstrap.mean(values[~np.isnan(values)])
            for block, names in blocks.items():
                place = (column, block, metric)
                if found := _retained(grid, column, names, severity, key):
                    retained[place] = found
                if column != reference and (
                    change := _gained(grid, column, reference, names, severity, key)
                ):
                    gained[place] = change
    gaps = grid.gaps(severity)
    return Section(grid, severity, columns, blocks, reference, clean, retained, gained, gaps)


def _retained(
    grid: Grid, column: str, names: tuple[str, ...], severity: float, key: str
) -> Retained | None:
    parts = grid.retention(column, names, severity, key)
    if parts is None:
        return None
    estimate = bootstrap.prs(parts.clean, parts.corrupted)
    return Retained(estimate, parts.corruptions, bool(parts.clean.mean() < FLOOR))


def _gained(
    grid: Grid, column: str, reference: str, names: tuple[str, ...], severity: float, key: str
) -> Retained | None:
    """Return PRS(column) - PRS(reference) on the episodes and corruptions that both hold."""
    both = grid.measured(column, key) & grid.measured(reference, key)
    theirs = grid.retention(reference, names, severity, key, both)
    ours = grid.retention(column, theirs.corruptions, severity, key, both) if theirs else None
    theirs = grid.retention(reference, ours.corruptions, severity, key, both) if ours else None
    if ours is None or theirs is None:
        return None
    return bootstrap.prs_difference((ours.clean, ours.corrupted), (theirs.clean, theirs.corrupted))


def _heading(section: Section) -> str:
    grid, columns = section.grid, section.columns
    at = f"severity {section.severity:g}" if section.blocks else "clean only"
    seeds = sorted({seed for column in columns for seed in grid.seeds[column]})
    agents = ", ".join(f"{column} `{grid.columns[column][1]}`" for column in columns)
    return (
        f"## {grid.split}, {at}\n\n"
        f"N = {len(grid.episodes)} episodes, seed {', '.join(map(str, seeds))}, corruption suite "
        f"{grid.suite}. Success: {grid.rule}. Agents: {agents}.\n"
        f"SR in %. PRS = mean over the block's corruptions of SR (SPL) / the same agent's clean "
        f"SR (SPL). Brackets: {100 * LEVEL:.0f} % paired bootstrap over episodes, {RESAMPLES:,} "
        f"resamples."
    )


def _table(section: Section) -> str:
    lines = [["Corruption", *section.columns]]
    for metric in METRICS:
        cells = [_interval(section.clean.get((c, metric)), metric) for c in section.columns]
        lines.append([f"Clean {metric}", *cells])
    for block, names in section.blocks.items():
        for metric in METRICS:
            cells = [_prs(section, (c, block, metric)) for c in section.columns]
            lines.append([f"**PRS-{metric} ({block})**", *cells])
        if len(section.columns) > 1:
            for metric in METRICS:
                cells = [_change(section, (c, block, metric)) for c in section.columns]
                lines.append([f"PRS-{metric} against {section.reference}", *cells])
        for name in names:
            lines.append([label(name), *(_rate(section, c, name) for c in section.columns)])
    lines.insert(1, ["---", *["---:"] * len(section.columns)])
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def _notes(section: Section) -> str:
    notes = []
    if any(r.near_floor for r in section.retained.values()):
        notes.append(
            f"‡ clean value below {FLOOR:g}: PRS saturates near the performance floor and says "
            "little."
        )
    found = section.retained.items()
    if any(len(r.corruptions) < len(section.blocks[block]) for (_, block, _), r in found):
        notes.append("† over the corruptions named k/K only: the others are not complete.")
    if section.gained:
        notes.append("Differences of PRS in bold have intervals that exclude zero.")
    if section.gaps:
        notes.append("\\* over the episodes at hand. Missing cells:")
        notes += [
            f"- {gap.column}, {gap.corruption} at {gap.severity:g}: {gap.have} of {gap.want} "
            "episodes"
            for gap in section.gaps
        ]
    return "\n".join(notes)


def _rate(section: Section, column: str, corruption: str) -> str:
    value = section.value(column, corruption)
    if math.isnan(value):
        return "–"
    return f"{100 * value:.1f}" + ("\\*" if section.partial(column, corruption) else "")


def _interval(estimate: Estimate | None, metric: str) -> str:
    if estimate is None:
        return "–"
    if metric == "SR":
        return f"{100 * estimate.value:.1f} [{100 * estimate.low:.1f}, {100 * estimate.high:.1f}]"
    return f"{estimate.value:.2f} [{estimate.low:.2f}, {estimate.high:.2f}]"


def _prs(section: Section, place: tuple[str, str, str]) -> str:
    found = section.retained.get(place)
    if found is None:
        return "–"
    wanted = len(section.blocks[place[1]])
    some = f" † {len(found.corruptions)}/{wanted}" if len(found.corruptions) < wanted else ""
    return f"**{found.estimate.value:.2f}** [{found.estimate.low:.2f}, " + (
        f"{found.estimate.high:.2f}]{some}{' ‡' if found.near_floor else ''}"
    )


def _change(section: Section, place: tuple[str, str, str]) -> str:
    change = section.gained.get(place)
    if change is None:
        return "–"
    text = f"{change.value:+.2f}"
    text = f"**{text}**" if change.excludes_zero else text
    return f"{text} [{change.low:+.2f}, {change.high:+.2f}]"


def _mean(values: np.ndarray) -> float:
    known = values[~np.isnan(values)]
    return float(known.mean()) if len(known) else math.nan


def _numbered(stem: str, index: int) -> str:
    return f"{stem}.png" if index == 0 else f"{stem}-{index + 1}.png"
