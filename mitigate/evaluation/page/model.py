"""What the page shows, as plain data: the numbers of sections, and their paired differences.

The page's scripts read these as JSON, draw them and compute nothing but signs. A number is
``[value, low, high]`` with its 95 % interval, or None where nothing was measured.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from mitigate.evaluation import bootstrap
from mitigate.evaluation.bootstrap import LEVEL, NO_WIDTH, RESAMPLES, ROUNDING, Estimate
from mitigate.evaluation.grid import METRICS
from mitigate.evaluation.sections import Retained, Section, compare, label

BASELINES = 12  # columns that the others can be compared with, the first ones (ours)
DIGITS = 6
CLEAN = "clean"
Numbers = list[Any] | None


def section_data(section: Section) -> dict[str, Any]:
    """Return all that the page shows of one section but its episodes.

    ``columns`` are the agents, ``measures`` the columns of the table, ``values[c][m]`` their
    numbers, where one may need marks with these as the fourth entry. ``corruptions`` are those of
    the heatmap, clean first, ``cells[c][k]`` is [SR, SPL, episodes held, shares of the column's own
    clean SR and SPL]. ``pairs["i-j"]`` are the
    differences of column i to column j, i > j, j one of the first ``baselines``; None for two
    without a common seed.
    """
    grid = section.grid
    values = [_values(section, column) for column in section.columns]
    names = [CLEAN, *(name for held in section.blocks.values() for name in held)]
    blocks = ["", *(block for block, held in section.blocks.items() for _ in held)]
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
    """Whether numbers have an interval that says anything, or none that is shown."""
    return None in found[1:3] or found[2] - found[1] > ROUNDING


def shortened(x: float) -> float:
    """Return ``x`` with :data:`DIGITS` digits, or whole where that would show another number: shown
    is percent with one digit, or two digits."""
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
    shown = [{"title": "Clean SR", "unit": "%"}, {"title": "Clean SPL", "unit": ""}]
    if section.corrupted:
        shown.append({"title": f"Mean SR, {_whole(section)} corruptions", "unit": "%"})
    for part, metric in _prs_places(section):
        shown.append({"title": f"PRS-{metric} ({part})", "unit": ""})
    return shown


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
    """Return the PRS of one corruption alone: over the episodes that are measured clean, too, and
    None where these are too few for a PRS."""
    parts = section.grid.retention([column], [name], section.severity, METRICS[metric])
    return None if parts is None or math.isnan(parts[0].prs) else shortened(parts[0].prs)


def _pairs(section: Section, names: Sequence[str]) -> dict[str, Any]:
    """Return the differences of all columns to each of the first ones, paired over the seeds and
    the episodes that both have: on other seeds they met corruptions of other keys."""
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
    compared = compare(section, first, second)
    measures = [cells["SR"][0], cells["SPL"][0]]
    if section.corrupted:
        measures.append(_marked(section, compared.raised, *section.blocks))
    for part, metric in _prs_places(section):
        measures.append(_marked(section, compared.gained.get((part, metric)), part))
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
            "† k/K: over k of the K corruptions; the others are not measured or not whole."
        )
    if section.gaps:
        notes.append(
            "* Over fewer episodes than there are: point at a cell to read how many it holds."
        )
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
