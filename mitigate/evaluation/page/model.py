"""The page's content as plain data: numbers of sections, differences, curves and episodes.

The page's scripts read it as JSON and draw it. A number is ``[value, low, high]`` with its 95 %
interval, or None if nothing was measured.
"""

from __future__ import annotations

import base64
import math
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mitigate.evaluation import bootstrap
from mitigate.evaluation.bootstrap import LEVEL, NO_WIDTH, RESAMPLES, ROUNDING, Estimate
from mitigate.evaluation.curves import Curve, curves
from mitigate.evaluation.grid import METRICS, Grid
from mitigate.evaluation.rows import Row
from mitigate.evaluation.sections import Retained, Section, label

BASELINES = 12  # number of first columns that others can be compared with (heuristic)
DIGITS = 6
CLEAN = "clean"
Numbers = list[Any] | None


def section_data(section: Section) -> dict[str, Any]:
    """Return the page's data of one section, except its episodes.

    ``columns`` are the agents and ``measures`` the columns of the table. ``values[c][m]`` are their
    numbers, with marks as a fourth entry if needed. ``corruptions`` are those of the heatmap, clean
    first. ``cells[c][k]`` is [SR, SPL, number of episodes, share of the column's clean SR, share of
    its clean SPL]. ``pairs["i-j"]`` are the differences of column i to column j, for i > j and j
    among the first ``baselines``; None without a common seed.
    """
    grid = section.grid
    values = [_values(section, column) for column in section.columns]
    names = [CLEAN, *section.corruptions]
    blocks = ["", *(block for block, members in section.blocks.items() for _ in members)]
    pairs = _pairs(section, names)
    return {
        "title": _title(section),
        "facts": _facts(section),
        "split": grid.split,
        "rule": grid.rule,
        "severity": section.severity,
        "columns": [_column(section, column) for column in section.columns],
        "measures": _measures(section),
        "values": values,
        "corruptions": [
            {
                "name": name,
                "title": "Clean" if name == CLEAN else label(name),
                "block": block,
                "at": str(0.0 if name == CLEAN else float(section.severity)),
            }
            for name, block in zip(names, blocks, strict=True)
        ],
        "cells": [_cells(section, column, names) for column in section.columns],
        "wanted": len(grid.episodes),
        "pairs": pairs,
        "baselines": min(len(section.columns), BASELINES) if any(pairs.values()) else 0,
        "notes": _notes(section, values, pairs),
    }


def numbers(found: Estimate | None) -> Numbers:
    """Return an estimate as the page reads it."""
    if found is None or math.isnan(found.value):
        return None
    return [None if math.isnan(x) else shortened(x) for x in (found.value, found.low, found.high)]


def has_width(found: Sequence[Any]) -> bool:
    """Return whether numbers have an interval with a width, or no interval at all."""
    return None in found[1:3] or found[2] - found[1] > ROUNDING


def shortened(x: float) -> float:
    """Return ``x`` rounded to :data:`DIGITS` digits, or unchanged if that changes the page.

    The page shows per cent with one digit, or two digits.
    """
    short = round(x, DIGITS)
    same = f"{100 * x:.1f} {x:.2f}" == f"{100 * short:.1f} {short:.2f}"
    return short if same else x


def _title(section: Section) -> str:
    at = f"severity {section.severity:g}" if section.blocks else "clean"
    parts = (section.grid.heading, section.kind, at)
    title = ", ".join(part for part in parts if part)
    return f"{title}, suite {section.grid.suite}"


def _facts(section: Section) -> list[list[str]]:
    grid = section.grid
    return [
        ["Split", grid.heading],
        ["Episodes", f"{len(grid.episodes):,}"],
        ["Success", grid.rule],
        ["Corruption suite", grid.suite],
        ["Severity", f"{section.severity:g}" if section.blocks else "clean only"],
        ["Intervals", f"{LEVEL:.0%}, paired bootstrap over episodes, {RESAMPLES:,} resamples"],
    ]


def _column(section: Section, column: str) -> dict[str, Any]:
    seeds = section.grid.seeds[column, section.severity]
    agents = section.grid.agents_at(column, section.severity)
    return {
        "label": column,
        "place": list(section.grid.columns).index(column),
        "agents": list(agents),
        "seeds": list(seeds),
        "details": [["hash", ", ".join(agents)], ["seeds", ", ".join(map(str, seeds))]],
    }


def _prs_places(section: Section) -> list[tuple[str, str]]:
    """Return the (block or half, metric) that have a PRS, in the table's order."""
    parted = {block: [block, *section.halves.get(block, {})] for block in section.blocks}
    return [(part, metric) for parts in parted.values() for part in parts for metric in METRICS]


def _measures(section: Section) -> list[dict[str, str]]:
    measures = [{"title": "Clean SR", "unit": "%"}, {"title": "Clean SPL", "unit": ""}]
    if section.corrupted:
        measures.append({"title": f"Mean SR, {_whole(section)} corruptions", "unit": "%"})
    for part, metric in _prs_places(section):
        measures.append({"title": f"PRS-{metric} ({part})", "unit": ""})
    return measures


def _whole(section: Section) -> int:
    return sum(map(section.whole, section.blocks))


def _values(section: Section, column: str) -> list[Numbers]:
    found = [numbers(section.clean.get((column, metric))) for metric in METRICS]
    fewer = "*" * section.partial(column, CLEAN)
    found = [value and [*value, fewer] for value in found]
    if section.corrupted:
        found.append(_marked(section, section.corrupted.get(column), *section.blocks))
    for part, metric in _prs_places(section):
        found.append(_marked(section, section.retained.get((column, part, metric)), part))
    return found


def _marked(section: Section, found: Retained | None, *blocks: str) -> Numbers:
    value = None if found is None else numbers(found.estimate)
    if found is None or value is None:
        return None
    return [*value, section.marks(found, *blocks).strip()]


def _cells(section: Section, column: str, names: Sequence[str]) -> list[list[Any]]:
    grid, at = section.grid, section.severity
    tables = {m: [grid.cell(column, n, at, key) for n in names] for m, key in METRICS.items()}
    found = {metric: bootstrap.means(table, shares=True) for metric, table in tables.items()}
    return [
        [
            *(numbers(found[metric][k]) for metric in METRICS),
            int((~np.isnan(tables["SR"][k])).sum()),
            *(_kept(section, column, name, metric) for metric in METRICS),
        ]
        for k, name in enumerate(names)
    ]


def _kept(section: Section, column: str, name: str, metric: str) -> float | None:
    """Return the PRS of one corruption, or None if it has too few episodes for a PRS."""
    parts = section.grid.retention([column], [name], section.severity, METRICS[metric])
    return None if parts is None or math.isnan(parts[0].prs) else shortened(parts[0].prs)


def _pairs(section: Section, names: Sequence[str]) -> dict[str, Any]:
    """Return the differences of all columns to each of the first ones.

    They are paired over common seeds, whose corruptions have the same keys, and common episodes.
    """
    found: dict[str, Any] = {}
    for j, second in enumerate(section.columns[:BASELINES]):
        for i, first in enumerate(section.columns[j + 1 :], start=j + 1):
            common = section.grid.common((first, second), section.severity)
            found[f"{i}-{j}"] = _pair(section, first, second, names) if common else None
    return found


def _pair(section: Section, first: str, second: str, names: Sequence[str]) -> dict[str, Any]:
    both, at = section.grid.paired((first, second), section.severity), section.severity
    changes = {
        metric: [both.cell(first, n, at, key) - both.cell(second, n, at, key) for n in names]
        for metric, key in METRICS.items()
    }
    cells = {m: [*map(numbers, bootstrap.means(change))] for m, change in changes.items()}
    compared = section.compare(first, second)
    measures = [cells["SR"][0], cells["SPL"][0]]
    if section.corrupted:
        measures.append(_marked(section, compared.corrupted, *section.blocks))
    for part, metric in _prs_places(section):
        measures.append(_marked(section, compared.retained.get((part, metric)), part))
    return {"measures": measures, "SR": cells["SR"], "SPL": cells["SPL"]}


def _notes(section: Section, values: list[list[Numbers]], pairs: Mapping[str, Any]) -> list[str]:
    notes = []
    lines = [*values, *(pair["measures"] for pair in pairs.values() if pair)]
    held = [value for line in lines for value in line if value]
    marks = "".join(value[3] for value in held if len(value) > 3)
    if not all(map(has_width, held)):
        notes.append(NO_WIDTH)
    if "‡" in marks:
        notes.append("‡ The clean value is so low that a PRS says little.")
    if "†" in marks:
        notes.append(
            "† k/K: over k of the K corruptions; the others are not measured or not complete."
        )
    if section.gaps:
        notes.append("* Over a part of the episodes: point at a cell to read how many it has.")
    for column in section.columns:
        for seed, (have, want) in section.grid.unfinished[column, section.severity].items():
            notes.append(
                f"Seed {seed} of {column} is not finished and left out: {have:,} of {want:,} rows."
            )
    cut = section.grid.cut
    notes += [f"{column}: {cut[column]}" for column in section.columns if column in cut]
    if None in pairs.values():
        notes.append("There is no difference of agents without a seed in common.")
    if len(section.columns) > BASELINES:
        notes.append(f"Only the first {BASELINES} agents can be chosen as a baseline.")
    return notes


def curve_figures(parts: Sequence[Section]) -> list[dict[str, Any]]:
    """Return a figure for each grid of ``parts`` with a corruption at two or more severities.

    ``panels[p]["lines"]`` have "column", "count" and "points" [severity, SR, low, high].
    """
    figures: list[dict[str, Any]] = []
    for grid, kind in {id(part.grid): (part.grid, part.kind) for part in parts}.values():
        panels: list[dict[str, Any]] = [
            {"name": name, "title": label(name), "lines": [_line(curve) for curve in lines]}
            for name in grid.corruptions
            if (lines := curves(grid, name, least=2))
        ]
        if panels:
            title = f"{grid.heading}, suite {grid.suite}" + (f", {kind}" if kind else "")
            drawn = {line["column"] for panel in panels for line in panel["lines"]}
            columns = [column for column in grid.columns if column in drawn]
            figures.append({"title": title, "columns": columns, "panels": panels})
    return figures


def _line(curve: Curve) -> dict[str, Any]:
    points = zip(curve.severities, map(numbers, curve.points), strict=True)
    points_data = [[severity, *(values or [])] for severity, values in points]
    return {"column": curve.column, "count": curve.count, "points": points_data}


MOST_EPISODES = 500_000  # episodes of cells in one page (heuristic): 4 MB
MISSING = 65_535
SCALE = 1000  # factor of success and SPL
_Place = tuple[str, str, float, int]  # column, corruption, severity, seed


@dataclass
class Packed:
    """Cells of any number of grids, packed for the page.

    Attributes:
        most: largest number of episodes of cells.
        grids: per grid the ids of its episodes, and the offset of each cell in the data, by
            "column|corruption|severity|seed".
        left_out: cells that exceed ``most``, with all their seeds.
        held: number of packed episodes.
    """

    most: int = MOST_EPISODES
    grids: list[dict[str, Any]] = field(default_factory=list)
    left_out: set[tuple[int, str]] = field(default_factory=set)
    held: int = 0
    _parts: list[np.ndarray] = field(default_factory=list)
    _known: list[Grid] = field(default_factory=list)

    def add(self, section: Section, rows: Iterable[Row]) -> int:
        """Pack the cells of ``section`` that are not packed yet; return the number of its grid.

        ``rows`` are all result rows, from which steps are read.
        """
        grid = section.grid
        if not any(grid is known for known in self._known):
            self._known.append(grid)
            self.grids.append({"episodes": list(grid.episodes), "cells": {}})
            self._steps = _steps(grid, rows)
        number = next(n for n, known in enumerate(self._known) if known is grid)
        columns = {column: n for n, column in enumerate(grid.columns)}
        names = [CLEAN, *section.corruptions]
        for column in section.columns:
            for name in names:
                at = 0.0 if name == CLEAN else float(section.severity)
                seeds = grid.seeds[column, section.severity]
                places = [(column, name, at, seed) for seed in seeds]
                self._add(number, f"{columns[column]}|{name}|{at}", grid, places)
        return number

    def text(self) -> str:
        """Return the data in base64: little-endian uint16, [cell, field, episode]."""
        flat = np.concatenate(self._parts) if self._parts else np.empty(0, np.uint16)
        return base64.b64encode(flat.astype("<u2").tobytes()).decode()

    def _add(self, number: int, key: str, grid: Grid, places: Sequence[_Place]) -> None:
        """Pack all seeds of a cell that are not packed yet, or none if they exceed the limit."""
        cells, count = self.grids[number]["cells"], len(grid.episodes)
        if not all((name, at, METRICS["SR"]) in grid.runs[x][seed] for x, name, at, seed in places):
            return
        new = [place for place in places if f"{key}|{place[3]}" not in cells]
        if self.held + len(new) * count > self.most:
            self.left_out.add((number, key))
            return
        for place in new:
            cells[f"{key}|{place[3]}"] = self.held
            self.held += count
            self._pack(grid, place)

    def _pack(self, grid: Grid, place: _Place) -> None:
        column, name, at, seed = place
        count, run = len(grid.episodes), grid.runs[column][seed]
        shares = [run[name, at, metric] for metric in METRICS.values()]
        steps = self._steps.get(place, np.full(count, np.nan))
        fields = [*(SCALE * values for values in shares), np.minimum(steps, MISSING - 1)]
        whole = np.rint(np.nan_to_num(np.stack(fields), nan=MISSING))
        self._parts.append(whole.astype(np.uint16).ravel())


def _steps(grid: Grid, rows: Iterable[Row]) -> dict[_Place, np.ndarray]:
    """Return the steps of each cell [N]; NaN where a row lacks them."""
    index = {episode: n for n, episode in enumerate(grid.episodes)}
    labels = {(name, agent): x for x, (name, own) in grid.columns.items() for agent in own}
    found: dict[_Place, np.ndarray] = defaultdict(lambda: np.full(len(index), np.nan))
    for row in rows:
        column = labels.get((row["name"], row["agent"]))
        same = (row["split"], row["suite"], row["rule"]) == (grid.split, grid.suite, grid.rule)
        spot, steps = index.get(row["episode_id"]), row.get("steps")
        if same and column is not None and spot is not None and isinstance(steps, (int, float)):
            place = (column, row["corruption"], float(row["severity"]), row["seed"])
            found[place][spot] = steps
    return dict(found)
