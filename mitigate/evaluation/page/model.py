"""Compute the content of the HTML report as plain data.

The data consists of sections, differences, curves and episodes. The scripts of the page read it as
JSON and draw it. A number is ``[value, low, high]`` with the bounds of its 95 % interval, or None
if nothing was measured.
"""

from __future__ import annotations

import base64
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from mitigate.corruptions import registry
from mitigate.evaluation import bootstrap
from mitigate.evaluation.bootstrap import LEVEL, NO_WIDTH, RESAMPLES, ROUNDING, Estimate
from mitigate.evaluation.curves import Curve, curves
from mitigate.evaluation.grid import METRICS, STEPS
from mitigate.evaluation.sections import Retained, Section

BASELINES = 12  # maximum number of columns, from the left, that can be the baseline (heuristic)
# A column has a fixed cost, so it counts as at least this number of values (heuristic).
LEAST_VALUES = 10
DIGITS = 6
CLEAN = "clean"
Numbers = list[Any] | None


def section_data(section: Section) -> dict[str, Any]:
    """Return the page's data of one section, except its episodes.

    ``columns`` lists the agents. ``measures`` lists the quantities that the table shows per agent.
    ``values[c][m]`` is the number for agent c and measure m; a fourth entry holds marks such as
    ``*``. ``corruptions`` lists the rows of the heatmap, starting with "clean". ``cells[c][k]``
    describes corruption k: [SR, SPL, number of episodes, fraction of the agent's clean SR, fraction
    of its clean SPL]. ``pairs["i-j"]`` holds the differences of agent i from agent j, where i > j
    and j < ``baselines``. The entry is None if the two agents have no common seed.
    """
    grid, at = section.grid, section.severity
    values = [_values(section, column) for column in section.columns]
    names = [CLEAN, *section.corruptions]
    blocks = ["", *(block for block, members in section.blocks.items() for _ in members)]
    pairs = _pairs(section, names)
    severity = f"severity {at:g}" if section.blocks else "clean"
    title = (grid.heading, section.kind, severity, f"suite {grid.suite}")
    intervals = f"{LEVEL:.0%}, paired bootstrap over {grid.resampled}, {RESAMPLES:,} resamples"
    return {
        "title": ", ".join(filter(None, title)),
        "facts": [
            ["Split", grid.heading],
            ["Episodes", f"{len(grid.episodes):,}"],
            ["Success", grid.rule],
            ["Corruption suite", grid.suite],
            ["Severity", f"{at:g}" if section.blocks else "clean only"],
            ["Intervals", intervals],
        ],
        "split": grid.split,
        "rule": grid.rule,
        "severity": at,
        "columns": [
            {
                "label": column,
                "place": list(grid.columns).index(column),
                "agents": grid.agents_at(column, at),
                "seeds": list(grid.seeds[column, at]),
            }
            for column in section.columns
        ],
        "measures": _measures(section),
        "values": values,
        "corruptions": [
            {
                "name": name,
                "title": "Clean" if name == CLEAN else registry.title(name),
                "block": block,
                "at": str(0.0 if name == CLEAN else float(at)),
            }
            for name, block in zip(names, blocks, strict=True)
        ],
        "cells": [_cells(section, column, names) for column in section.columns],
        "wanted": len(grid.episodes),
        "pairs": pairs,
        "baselines": min(len(section.columns), BASELINES) if any(pairs.values()) else 0,
        "notes": _notes(section, values, pairs),
    }


def number_count(section: Section) -> int:
    """Estimate how many values and differences the page shows for a section."""
    columns = len(section.columns)
    values = len(_measures(section)) + len(section.corruptions)
    return columns * (1 + min(columns, BASELINES)) * max(values, LEAST_VALUES)


def numbers(estimate: Estimate | None) -> Numbers:
    """Return an estimate in the format that the page reads."""
    if estimate is None or math.isnan(estimate.value):
        return None
    return [
        None if math.isnan(x) else shortened(x)
        for x in (estimate.value, estimate.low, estimate.high)
    ]


def has_width(values: Sequence[Any]) -> bool:
    """Return False if the interval of ``values``, which are [value, low, high], has zero width."""
    return None in values[1:3] or values[2] - values[1] > ROUNDING


def shortened(x: float) -> float:
    """Return ``x`` rounded to ``DIGITS`` decimal places.

    If rounding would change the number that the page shows, return ``x`` unchanged.

    The page shows percentages with one decimal place, and other values with two.
    """
    short = round(x, DIGITS)
    same = f"{100 * x:.1f} {x:.2f}" == f"{100 * short:.1f} {short:.2f}"
    return short if same else x


def _prs_places(section: Section) -> list[tuple[str, str]]:
    """Return the pairs (part, metric) that have a PRS; a part is a block or a half of a block."""
    parts = [part for block in section.blocks for part in (block, *section.halves.get(block, ()))]
    return [(part, metric) for part in parts for metric in METRICS]


def _measures(section: Section) -> list[dict[str, str]]:
    measures = [{"title": "Clean SR", "unit": "%"}, {"title": "Clean SPL", "unit": ""}]
    if section.corrupted:
        count = sum(map(section.whole, section.blocks))
        measures.append({"title": f"Mean SR, {count} corruptions", "unit": "%"})
    places = _prs_places(section)
    return measures + [{"title": f"PRS-{metric} ({part})", "unit": ""} for part, metric in places]


def _values(section: Section, column: str) -> list[Numbers]:
    clean = [numbers(section.clean.get((column, metric))) for metric in METRICS]
    fewer = "*" * section.partial(column, CLEAN)
    retained = {place: section.retained.get((column, *place)) for place in _prs_places(section)}
    corrupted = section.corrupted.get(column)
    return _in_order(section, [v and [*v, fewer] for v in clean], corrupted, retained)


def _in_order(
    section: Section,
    clean: list[Numbers],
    corrupted: Retained | None,
    retained: Mapping[tuple[str, str], Retained | None],
) -> list[Numbers]:
    """Return the numbers in the order of :func:`_measures`."""
    mean_sr = [_marked(section, corrupted, *section.blocks)] if section.corrupted else []
    places = _prs_places(section)
    return clean + mean_sr + [_marked(section, retained.get(p), p[0]) for p in places]


def _marked(section: Section, retained: Retained | None, *blocks: str) -> Numbers:
    value = None if retained is None else numbers(retained.estimate)
    if retained is None or value is None:
        return None
    return [*value, section.marks(retained, *blocks).strip()]


def _cells(section: Section, column: str, names: Sequence[str]) -> list[list[Any]]:
    grid, at = section.grid, section.severity
    tables = {m: [grid.cell(column, n, at, key) for n in names] for m, key in METRICS.items()}
    estimates = {
        metric: bootstrap.means(table, units=grid.units, shares=True)
        for metric, table in tables.items()
    }
    return [
        [
            *(numbers(estimates[metric][k]) for metric in METRICS),
            int((~np.isnan(tables["SR"][k])).sum()),
            *(_single_prs(section, column, name, metric) for metric in METRICS),
        ]
        for k, name in enumerate(names)
    ]


def _single_prs(section: Section, column: str, name: str, metric: str) -> float | None:
    """Return the PRS of one corruption, or None if too few episodes were measured."""
    parts = section.grid.retention([column], [name], section.severity, METRICS[metric])
    return None if parts is None or math.isnan(parts[0].prs) else shortened(parts[0].prs)


def _pairs(section: Section, names: Sequence[str]) -> dict[str, Any]:
    """Return each column's differences from those earlier columns that can be the baseline."""
    return {
        f"{i}-{j}": _pair(section, first, second, names)
        for j, second in enumerate(section.columns[:BASELINES])
        for i, first in enumerate(section.columns[j + 1 :], start=j + 1)
    }


def _pair(section: Section, first: str, second: str, names: Sequence[str]) -> dict | None:
    """Return the differences, or None if the columns have no common seed."""
    pair, at = (first, second), section.severity
    both = section.grid.paired(pair, at)
    if both is None:
        return None
    changes = {
        metric: [both.cell(first, n, at, key) - both.cell(second, n, at, key) for n in names]
        for metric, key in METRICS.items()
    }
    cells = {
        metric: [*map(numbers, bootstrap.means(change, units=both.units))]
        for metric, change in changes.items()
    }
    compared = section.compare(first, second)
    clean = [cells[metric][0] for metric in METRICS]
    return {"measures": _in_order(section, clean, compared.corrupted, compared.retained), **cells}


def _notes(section: Section, values: list[list[Numbers]], pairs: Mapping[str, Any]) -> list[str]:
    notes = []
    rows = [*values, *(pair["measures"] for pair in pairs.values() if pair)]
    cells = [value for line in rows for value in line if value]
    marks = "".join(value[3] for value in cells if len(value) > 3)
    if not all(map(has_width, cells)):
        notes.append(NO_WIDTH)
    if "‡" in marks:
        notes.append("‡ The clean value is so low that a PRS says little.")
    if "†" in marks:
        notes.append(
            "† k/K: over k of the K corruptions; the others are not measured or not complete."
        )
    if section.gaps:
        notes.append("* Over a part of the episodes: point at a cell to read how many it has.")
    notes += section.notes()
    if None in pairs.values():
        notes.append("There is no difference of agents without a seed in common.")
    if len(section.columns) > BASELINES:
        notes.append(f"Only the first {BASELINES} agents can be chosen as a baseline.")
    return notes


def curve_figures(parts: Sequence[Section]) -> list[dict[str, Any]]:
    """Return a figure for each grid that has results for a corruption at two or more severities.

    Each item of ``panels[p]["lines"]`` has "column", "count" and "points" [severity, SR, low,
    high].
    """
    figures: list[dict[str, Any]] = []
    for grid, kind in {id(part.grid): (part.grid, part.kind) for part in parts}.values():
        panels: list[dict[str, Any]] = [
            {
                "name": name,
                "title": registry.title(name),
                "lines": [_line(curve) for curve in lines],
            }
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
    return {
        "column": curve.column,
        "count": curve.count,
        "points": [[severity, *(values or [])] for severity, values in points],
    }


# maximum number of episodes in one page, summed over all cells (heuristic); they take 4 MB
MOST_EPISODES = 500_000
MISSING = 65_535
SCALE = 1000  # factor that converts success and SPL to integers


class Packed:
    """The episodes of cells from several grids, packed for the page.

    Attributes:
        most: maximum number of episodes, summed over all cells.
        count: number of packed episodes.
        grids: for each grid, the ids of its episodes, and the offset of each cell in the packed
            data. The key of a cell is "column|corruption|severity|seed".
        left_out: cells that are not packed, because the number of episodes would exceed ``most``.
    """

    def __init__(self, most: int = MOST_EPISODES) -> None:
        self.most = most
        self.count = 0
        self.grids: list[dict[str, Any]] = []
        self.left_out: set[tuple[int, str]] = set()
        self._numbers: dict[int, int] = {}  # maps the id() of each grid to its index
        self._parts: list[np.ndarray] = []

    def add(self, section: Section) -> int:
        """Pack the cells of ``section`` that are not packed yet; return the index of its grid.

        If the seeds of a cell together exceed the limit, none of them is packed.
        """
        grid = section.grid
        number = self._numbers.setdefault(id(grid), len(self.grids))
        if number == len(self.grids):
            self.grids.append({"episodes": list(grid.episodes), "cells": {}})
        cells, size = self.grids[number]["cells"], len(grid.episodes)
        for column in section.columns:
            runs = {seed: grid.runs[column][seed] for seed in grid.seeds[column, section.severity]}
            for name in (CLEAN, *section.corruptions):
                at = 0.0 if name == CLEAN else float(section.severity)
                if not all((name, at, STEPS) in run for run in runs.values()):
                    continue
                key = f"{list(grid.columns).index(column)}|{name}|{at}"
                new = {f"{key}|{seed}": run for seed, run in runs.items()}
                new = {cell: run for cell, run in new.items() if cell not in cells}
                if self.count + len(new) * size > self.most:
                    self.left_out.add((number, key))
                    continue
                for cell, run in new.items():
                    cells[cell] = self.count
                    self.count += size
                    shares = [SCALE * run[name, at, metric] for metric in METRICS.values()]
                    fields = np.stack([*shares, np.minimum(run[name, at, STEPS], MISSING - 1)])
                    whole = np.rint(np.nan_to_num(fields, nan=MISSING))
                    self._parts.append(whole.astype("<u2").ravel())
        return number

    def text(self) -> str:
        """Return the data in base64, as little-endian uint16 [cell, field, episode]."""
        return base64.b64encode(b"".join(part.tobytes() for part in self._parts)).decode()
