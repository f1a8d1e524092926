"""The episodes behind the cells, packed: success, SPL and steps of each, 6 bytes an episode.

The page lists them where a cell is opened. How many are embedded is bounded; a cell beyond the
bound is shown as a number alone, and the page says so.
"""

from __future__ import annotations

import base64
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mitigate.evaluation.grid import METRICS, Grid
from mitigate.evaluation.rows import Row
from mitigate.evaluation.sections import Section

MOST = 500_000  # episodes of cells in one page (ours): 4 MB
MISSING = 65_535
SCALE = 1000  # of success and SPL
_Place = tuple[str, str, float, int]  # column, corruption, severity, seed


@dataclass
class Packed:
    """Cells of any number of grids. ``grids`` are what the page reads: the episodes' ids, and where
    in the data each cell begins, by "column|corruption|severity|seed"; ``left_out`` are the cells
    that the bound leaves no room for, all seeds of each."""

    most: int = MOST
    grids: list[dict[str, Any]] = field(default_factory=list)
    left_out: set[tuple[int, str]] = field(default_factory=set)
    held: int = 0
    _parts: list[np.ndarray] = field(default_factory=list)
    _known: list[Grid] = field(default_factory=list)

    def add(self, section: Section, rows: Iterable[Row]) -> int:
        """Pack the cells of ``section`` that are not there yet; return the number of its grid.

        ``rows`` are all rows, of which the steps are read."""
        grid = section.grid
        if not any(grid is known for known in self._known):
            self._known.append(grid)
            self.grids.append({"episodes": list(grid.episodes), "cells": {}})
            self._steps = _steps(grid, rows)
        number = next(n for n, known in enumerate(self._known) if known is grid)
        columns = {label: n for n, label in enumerate(grid.columns)}
        names = ["clean", *(name for names in section.blocks.values() for name in names)]
        for label in section.columns:
            for name in names:
                at = 0.0 if name == "clean" else float(section.severity)
                seeds = grid.seeds[label, section.severity]
                places = [(label, name, at, seed) for seed in seeds]
                self._add(number, f"{columns[label]}|{name}|{at}", grid, places)
        return number

    def text(self) -> str:
        """Return the data in base64: little-endian uint16, [cell, field, episode]."""
        flat = np.concatenate(self._parts) if self._parts else np.empty(0, np.uint16)
        return base64.b64encode(flat.astype("<u2").tobytes()).decode()

    def _add(self, number: int, key: str, grid: Grid, places: Sequence[_Place]) -> None:
        """Pack what is not there yet of a cell that all its seeds measured, if all have room."""
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
        label, name, at, seed = place
        count, run = len(grid.episodes), grid.runs[label][seed]
        shares = [run[name, at, metric] for metric in METRICS.values()]
        steps = self._steps.get(place, np.full(count, np.nan))
        fields = [*(SCALE * values for values in shares), np.minimum(steps, MISSING - 1)]
        whole = np.rint(np.nan_to_num(np.stack(fields), nan=MISSING))
        self._parts.append(whole.astype(np.uint16).ravel())


def _steps(grid: Grid, rows: Iterable[Row]) -> dict[_Place, np.ndarray]:
    """Return the steps of each cell [N], NaN where a row does not say."""
    index = {episode: n for n, episode in enumerate(grid.episodes)}
    labels = {(name, agent): x for x, (name, own) in grid.columns.items() for agent in own}
    found: dict[_Place, np.ndarray] = defaultdict(lambda: np.full(len(index), np.nan))
    for row in rows:
        label = labels.get((row["name"], row["agent"]))
        same = (row["split"], row["suite"], row["rule"]) == (grid.split, grid.suite, grid.rule)
        spot, steps = index.get(row["episode_id"]), row.get("steps")
        if same and label is not None and spot is not None and isinstance(steps, (int, float)):
            place = (label, row["corruption"], float(row["severity"]), row["seed"])
            found[place][spot] = steps
    return dict(found)
