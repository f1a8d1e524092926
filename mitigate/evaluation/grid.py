"""Result rows arranged for tables: columns (agents) x conditions x episodes, with what is missing.

Rows of different split, suite version or success rule never share a :class:`Grid`.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mitigate.corruptions import DEPTH, INSTRUCTION, RGB
from mitigate.evaluation.rows import Row, upsert

BLOCKS = {"RGB": RGB, "Depth": DEPTH, "Instruction": INSTRUCTION}  # the paper's, in its order
PROMPT_ONLY = "white_box"  # not applicable to agents without a system prompt: these have no row
COVERAGE = 0.9  # share of the clean episodes a corruption must hold to enter a PRS (ours)
METRICS = {"SR": "success", "SPL": "spl"}


@dataclass(frozen=True)
class Gap:
    """A cell that lacks episodes: it has ``have`` of ``want``."""

    column: str
    corruption: str
    severity: float
    have: int
    want: int


@dataclass(frozen=True, eq=False)
class Retention:
    """What a PRS is made of: ``clean`` [N] and ``corrupted`` [K, N] on the same N episodes."""

    corruptions: tuple[str, ...]
    clean: np.ndarray
    corrupted: np.ndarray


@dataclass(frozen=True, eq=False)
class Grid:
    """All results of one split, suite version and success rule.

    ``columns`` maps a column's label to its (name, agent shas); ``seeds`` to the seeds it ran with.
    ``cells[label, corruption, severity, metric]`` is float64 [N], one value an episode, the mean
    over the column's seeds, NaN where a row is missing.
    """

    split: str
    suite: str
    rule: str
    columns: dict[str, tuple[str, tuple[str, ...]]]
    seeds: dict[str, tuple[int, ...]]
    episodes: tuple[str, ...]
    cells: dict[tuple[str, str, float, str], np.ndarray]

    def cell(self, label: str, corruption: str, severity: float, metric: str) -> np.ndarray:
        """Return the values [N] of a cell; all NaN if nothing was measured."""
        empty = np.full(len(self.episodes), np.nan)
        return self.cells.get((label, corruption, severity, metric), empty)

    @cached_property
    def severities(self) -> list[float]:
        """The severities of the corrupted cells, rising; never 0."""
        return sorted({severity for _, _, severity, _ in self.cells if severity > 0})

    def columns_at(self, severity: float) -> list[str]:
        """Return the columns with a cell at ``severity``."""
        measured = {label for label, _, at, _ in self.cells if at == severity}
        return [label for label in self.columns if label in measured]

    def blocks_at(self, severity: float) -> dict[str, tuple[str, ...]]:
        """Return the measured corruptions at ``severity`` by block; "Other" holds the rest."""
        measured = {name for _, name, at, _ in self.cells if at == severity and name != "clean"}
        other = tuple(sorted(measured.difference(*BLOCKS.values())))
        blocks = {
            block: tuple(name for name in names if name in measured)
            for block, names in (BLOCKS | {"Other": other}).items()
        }
        return {block: names for block, names in blocks.items() if names}

    def measured(self, label: str, metric: str = "success") -> np.ndarray:
        """Return which episodes [N] the clean cell of a column holds."""
        return ~np.isnan(self.cell(label, "clean", 0.0, metric))

    def retention(
        self, labels: Sequence[str], names: Iterable[str], severity: float, metric: str
    ) -> list[Retention] | None:
        """Return what each column's PRS over ``names`` is made of, or None if there is nothing.

        All have the same corruptions, those measured in every column on at least
        :data:`COVERAGE` of the episodes, and the same episodes, those with no gap among these.
        """
        known = np.all([self.measured(label, metric) for label in labels], axis=0)
        held = {
            name: known & ~np.isnan([self.cell(x, name, severity, metric) for x in labels]).any(0)
            for name in names
        }
        kept = tuple(name for name in held if held[name].sum() >= COVERAGE * known.sum())
        common = np.all([known, *(held[name] for name in kept)], axis=0)
        if not kept or not common.any():
            return None
        return [
            Retention(
                kept,
                self.cell(label, "clean", 0.0, metric)[common],
                np.stack([self.cell(label, name, severity, metric)[common] for name in kept]),
            )
            for label in labels
        ]

    def gaps(self, severity: float) -> list[Gap]:
        """Return the cells of the table at ``severity`` that lack episodes of the grid."""
        blocks = self.blocks_at(severity)
        wanted = [("clean", 0.0)]
        wanted += [(name, severity) for names in blocks.values() for name in names]
        found = []
        for label in self.columns_at(severity):
            for name, at in wanted:
                have = int((~np.isnan(self.cell(label, name, at, "success"))).sum())
                if have < len(self.episodes):
                    found.append(Gap(label, name, at, have, len(self.episodes)))
        return found


def grids(rows: Iterable[Row]) -> list[Grid]:
    """Return the grids of ``rows``, ordered by split, suite and rule.

    Raises ValueError if there are no rows.
    """
    groups: dict[tuple[str, str, str], list[Row]] = defaultdict(list)
    for row in upsert(rows):
        groups[row["split"], row["suite"], row["rule"]].append(row)
    if not groups:
        raise ValueError(
            "There are no result rows to show: the files are empty. Evaluate first, with "
            "`make evaluate`."
        )
    return [_grid(key, groups[key]) for key in sorted(groups)]


def label_columns(
    measured: Iterable[tuple[str, str, int]],
) -> dict[str, tuple[str, tuple[str, ...]]]:
    """Return label -> (name, agents) of all (name, agent sha, seed).

    Agents of one name that ran with a seed each of their own are the training seeds of one column.
    Otherwise each is a column, with its sha in the label.
    """
    seeds: dict[str, dict[str, set[int]]] = defaultdict(lambda: defaultdict(set))
    for name, agent, seed in measured:
        seeds[name][agent].add(seed)
    columns = {}
    for name, agents in seeds.items():
        apart = sum(len(s) for s in agents.values()) == len(set().union(*agents.values()))
        if apart:
            columns[name] = (name, tuple(agents))
        else:
            columns |= {f"{name} ({agent[:6]})": (name, (agent,)) for agent in agents}
    return columns


def _grid(key: tuple[str, str, str], rows: list[Row]) -> Grid:
    columns = label_columns((row["name"], row["agent"], row["seed"]) for row in rows)
    labels = {(name, agent): x for x, (name, agents) in columns.items() for agent in agents}
    episodes = tuple(sorted({row["episode_id"] for row in rows}, key=_natural))
    place = {episode: index for index, episode in enumerate(episodes)}
    seeds: dict[str, set[int]] = defaultdict(set)
    sums: dict[tuple[str, str, float, str], np.ndarray] = {}
    counts: dict[tuple[str, str, float, str], np.ndarray] = {}
    for row in rows:
        label = labels[row["name"], row["agent"]]
        seeds[label].add(row["seed"])
        for metric in METRICS.values():
            cell = (label, row["corruption"], float(row["severity"]), metric)
            total = sums.setdefault(cell, np.zeros(len(episodes)))
            total[place[row["episode_id"]]] += row[metric]
            count = counts.setdefault(cell, np.zeros(len(episodes), int))
            count[place[row["episode_id"]]] += 1
    cells = {
        cell: np.where(counts[cell] == len(seeds[cell[0]]), total / len(seeds[cell[0]]), np.nan)
        for cell, total in sums.items()
    }
    ordered = {label: tuple(sorted(seeds[label])) for label in columns}
    return Grid(*key, columns, ordered, episodes, cells)


def _natural(text: str) -> tuple[bool, int, str]:
    return (not text.isdecimal(), int(text) if text.isdecimal() else 0, text)
