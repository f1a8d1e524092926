"""Arrange result rows by agent (the table column), condition and episode, and find gaps.

Rows with different splits, episode lists, suite versions or success rules are in different
:class:`Grid` objects.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain, count

import numpy as np

from mitigate.core.names import counted
from mitigate.corruptions.faults.temporal import GATE
from mitigate.corruptions.record import FAMILIES
from mitigate.corruptions.registry import (
    AND,
    UNSEEN,
    family,
    fault_names,
    names,
    parts,
    unseen_names,
)
from mitigate.evaluation import metrics
from mitigate.evaluation.episode_lists import by_list
from mitigate.evaluation.rows import Row, cuts, scene_of, unique

BLOCKS = {  # the blocks contain only this project's corruptions, not corruptions of other packages
    "RGB": names("rgb"),
    "Depth": names("depth"),
    "Instruction": names("instruction"),
    "unseen RGB": unseen_names("rgb"),
    "unseen depth": unseen_names("depth"),
    # intermittent corrupts nothing by itself; its pairs have the block "Pairs"
    **{f"{f} faults": tuple(n for n in fault_names(f) if n != GATE) for f in FAMILIES},
}
# corruptions of RGB and depth frames in the NavTrust paper
FRAMES = frozenset((*BLOCKS["RGB"], *BLOCKS["Depth"]))
# each of these kinds has its own table
SUITE, UNSEEN_KIND, PAIRS = "", "unseen corruptions", "pairs of corruptions"
KINDS = (SUITE, UNSEEN_KIND, *(f"{family} faults" for family in FAMILIES), PAIRS)
PROMPT_ONLY = "white_box"  # agents without a system prompt have no rows of this corruption


def kind(corruption: str) -> str:
    """Return the name of the table that shows a corruption, one of :data:`KINDS`.

    The table of the standard suite also shows corruptions that other packages define. A pair that
    contains ``intermittent`` counts as a temporal fault.
    """
    if AND in corruption and parts(corruption)[0] != GATE:
        return PAIRS
    if fault := family(corruption):
        return f"{fault} faults"
    return UNSEEN_KIND if corruption in UNSEEN else SUITE


def by_kind(rows: Iterable[Row]) -> dict[str, list[Row]]:
    """Return the rows of each table, including the clean rows of its agents.

    Each table uses only its own rows, so other measurements do not change the table of the standard
    suite. That table also lists agents that have only clean rows.
    """
    rows = list(rows)
    kinds = {row["corruption"]: kind(row["corruption"]) for row in rows}
    members: dict[tuple, set[str]] = defaultdict(set)
    for row in rows:
        if row["corruption"] != "clean":
            members[_column(row)].add(kinds[row["corruption"]])
    tables: dict[str, list[Row]] = {name: [] for name in KINDS}
    for row in rows:
        default = {kinds[row["corruption"]]}
        for name in (members[_column(row)] or default) if row["corruption"] == "clean" else default:
            tables[name].append(row)
    return {name: table for name, table in tables.items() if table}


def _column(row: Row) -> tuple:
    return tuple(row[key] for key in ("split", "suite", "rule", "name", "agent"))


def expected_corruptions(block: str, measured: Sequence[str]) -> tuple[str, ...]:
    """Return the corruptions that a complete PRS over ``block`` needs.

    :data:`PROMPT_ONLY` is needed only if it is in ``measured``. The unseen corruptions consist of a
    validation half and a test half. The corruptions of a half are needed only if ``measured``
    contains at least one corruption of that half.
    """
    every = tuple(n for n in BLOCKS.get(block, measured) if n in measured or n != PROMPT_ONLY)
    halves = {UNSEEN[name].half for name in measured if name in UNSEEN}
    return tuple(n for n in every if n not in UNSEEN or UNSEEN[n].half in halves)


def label_columns(
    measured: Iterable[tuple[str, str, int]],
) -> dict[str, tuple[str, tuple[str, ...]]]:
    """Return a dict that maps column labels to (name, agent hashes).

    ``measured`` lists the (name, agent hash, seed) of every measured agent.

    Agents with the same name but different seeds share one column. If two agents with the same name
    also have the same seed, every agent with this name has its own column, whose label contains the
    agent's hash.
    """
    seeds: dict[str, dict[str, set[int]]] = defaultdict(lambda: defaultdict(set))
    for name, agent, seed in measured:
        seeds[name][agent].add(seed)
    columns = {}
    for name, agents in seeds.items():
        if sum(map(len, agents.values())) == len(set().union(*agents.values())):
            columns[name] = (name, tuple(agents))
            continue
        # enough leading digits to tell all hashes apart
        digits = next(n for n in count(6) if len({agent[:n] for agent in agents}) == len(agents))
        columns |= {f"{name} ({agent[:digits]})": (name, (agent,)) for agent in agents}
    return columns


# A PRS omits a corruption measured on less than this fraction of the clean episodes (heuristic).
COVERAGE = 0.9
METRICS = {"SR": "success", "SPL": "spl"}
STEPS = "steps"  # number of steps, which the HTML page shows
# With fewer scenes, intervals from resampled scenes are too narrow (Cameron, Gelbach and Miller
# 2008), so episodes are resampled. The limit is heuristic.
LEAST_SCENES = 10
_Run = dict[tuple[str, float, str], np.ndarray]  # maps (corruption, severity, metric) to values [N]


@dataclass(frozen=True)
class Gap:
    """A table cell with missing episodes.

    The cell contains ``have`` episodes instead of ``want``.
    """

    column: str
    corruption: str
    severity: float
    have: int
    want: int


@dataclass(frozen=True, eq=False)
class Retention:
    """The values from which a PRS is computed.

    Attributes:
        corruptions: names of the K corruptions.
        clean: clean values of N episodes, shape [N].
        corrupted: values of the same episodes under each corruption, shape [K, N].
        units: for each episode, the number of its unit, such as its scene. The bootstrap resamples
            the episodes of a unit together.
    """

    corruptions: tuple[str, ...]
    clean: np.ndarray
    corrupted: np.ndarray
    units: np.ndarray

    @property
    def prs(self) -> float:
        """The PRS, or NaN if the clean value is 0."""
        return metrics.prs(float(self.clean.mean()), self.corrupted.mean(axis=1))


@dataclass(frozen=True, eq=False)
class Grid:
    """All results of one split, episode list, suite version and success rule.

    Attributes:
        split: name of the split.
        suite: version of the corruption suite.
        rule: success rule.
        columns: the pair (name, agent hashes) of each column, by label.
        agents: ``agents[label][seed]`` is the hash of the agent with that training seed.
        seeds: the seeds whose results are averaged, by (label, severity).
        unfinished: the incomplete seeds, which are excluded, by (label, severity). Each seed is
            mapped to its number of rows and the number of rows of a complete seed.
        episodes: ids of the N episodes.
        cells: the values of each episode by (label, corruption, severity, metric), as float64. A
            value is the mean over ``seeds``, or NaN if a row is missing. Each severity has its own
            clean cell, because the seeds may differ between severities.
        runs: ``runs[label][seed]`` holds the cells of a seed by (corruption, severity, metric).
        drawn: unit that the bootstrap resamples, "scene" or "episode".
        units: for each episode, the number of its unit. The episodes of a unit are resampled
            together.
        cut: for each label, a text that states how many episodes were ended by a step limit. Labels
            without such episodes are omitted.
        begins: id of the first episode if another grid has the same split, suite and rule but a
            different episode list; otherwise empty.
    """

    split: str
    suite: str
    rule: str
    columns: dict[str, tuple[str, tuple[str, ...]]]
    agents: dict[str, dict[int, str]]
    seeds: dict[tuple[str, float], tuple[int, ...]]
    unfinished: dict[tuple[str, float], dict[int, tuple[int, int]]]
    episodes: tuple[str, ...]
    cells: dict[tuple[str, str, float, str], np.ndarray]
    runs: dict[str, dict[int, _Run]]
    drawn: str
    units: np.ndarray
    cut: dict[str, str]
    begins: str = ""

    @property
    def resampled(self) -> str:
        """A text that names what the bootstrap resamples, such as "30 scenes with their
        episodes".
        """
        if self.drawn == "episode":
            return "episodes"
        return f"{counted(len(np.unique(self.units)), self.drawn)} with their episodes"

    @property
    def heading(self) -> str:
        """The name of the split.

        If there are several episode lists, the id of the first episode is added.
        """
        split = "unnamed split" if self.split == "unnamed" else self.split
        return f"{split} from {self.begins}" if self.begins else split

    def cell(self, label: str, corruption: str, severity: float, metric: str) -> np.ndarray:
        """Return the values of a cell, one per episode; all are NaN if nothing was measured."""
        empty = np.full(len(self.episodes), np.nan)
        return self.cells.get((label, corruption, severity, metric), empty)

    def by_severity(self, label: str, corruption: str, seed: int) -> dict[float, np.ndarray]:
        """Return the successes [N] of a seed at each severity; clean episodes have severity 0."""
        return {
            at: values
            for (name, at, metric), values in self.runs[label][seed].items()
            if metric == METRICS["SR"] and name in ("clean", corruption)
        }

    def over(self, labels: Iterable[str], seeds: Iterable[int], severity: float) -> Grid:
        """Return the grid of the columns ``labels`` at ``severity``, restricted to ``seeds``.

        All these columns must have results for these seeds.
        """
        seeds = tuple(seeds)
        runs = {label: [self.runs[label][seed] for seed in seeds] for label in labels}
        cells = {
            (label, name, severity, metric): values
            for label, chosen in runs.items()
            for (name, metric), values in _pooled(chosen, severity).items()
        }
        return replace(self, cells=cells)

    def paired(self, labels: Sequence[str], severity: float) -> Grid | None:
        """Return the grid of the columns ``labels``, restricted to the seeds that all have.

        For the same seed, all columns were evaluated with the same random keys of corruptions. If
        the columns have no common seed at ``severity``, return None.
        """
        common = set.intersection(*(set(self.seeds[label, severity]) for label in labels))
        return self.over(labels, sorted(common), severity) if common else None

    @cached_property
    def severities(self) -> list[float]:
        """The severities of the corrupted cells in ascending order, without 0."""
        return sorted({severity for _, _, severity, _ in self.cells if severity > 0})

    @cached_property
    def corruptions(self) -> list[str]:
        """The measured corruptions in the order of the blocks, then those that are in no block."""
        measured = {name for _, name, _, _ in self.cells if name != "clean"}
        known = [name for block in BLOCKS.values() for name in block if name in measured]
        return known + sorted(measured.difference(known))

    def columns_at(self, severity: float) -> list[str]:
        """Return the columns that have a cell at ``severity``."""
        measured = {label for label, _, at, _ in self.cells if at == severity}
        return [label for label in self.columns if label in measured]

    def agents_at(self, label: str, severity: float) -> list[str]:
        """Return the hashes of a column's agents at ``severity``, in the order of seeds."""
        return [*dict.fromkeys(self.agents[label][s] for s in self.seeds[label, severity])]

    def blocks_at(self, severity: float) -> dict[str, tuple[str, ...]]:
        """Return the corruptions measured at ``severity``, by block.

        The block "Pairs" holds pairs of corruptions. The block "Other" holds corruptions that other
        packages define.
        """
        measured = {name for _, name, at, _ in self.cells if at == severity and name != "clean"}
        rest = sorted(measured.difference(*BLOCKS.values()))
        more = {"Pairs": [n for n in rest if AND in n], "Other": [n for n in rest if AND not in n]}
        blocks = {
            block: tuple(name for name in names if name in measured)
            for block, names in {**BLOCKS, **more}.items()
        }
        return {block: names for block, names in blocks.items() if names}

    def measured(
        self, label: str, corruption: str, severity: float, metric: str = "success"
    ) -> np.ndarray:
        """Return a mask of the episodes that a cell contains."""
        return ~np.isnan(self.cell(label, corruption, severity, metric))

    def retention(
        self, labels: Sequence[str], names: Iterable[str], severity: float, metric: str
    ) -> list[Retention] | None:
        """Return the values for the PRS of each column over the corruptions ``names``.

        All columns use the same corruptions and episodes. Only episodes with a clean result in
        every column are used. A corruption is left out if less than a fraction :data:`COVERAGE` of
        these episodes has its result in every column. An episode is left out if a result of a
        remaining corruption is missing in any column. If no corruption or no episode remains,
        return None.
        """

        def complete_at(name: str) -> np.ndarray:
            return np.all([self.measured(x, name, severity, metric) for x in labels], axis=0)

        known = complete_at("clean")
        complete = {name: known & complete_at(name) for name in names}
        covered = tuple(n for n, mask in complete.items() if mask.sum() >= COVERAGE * known.sum())
        common = np.all([known, *(complete[name] for name in covered)], axis=0)
        if not covered or not common.any():
            return None
        return [
            Retention(
                covered,
                self.cell(label, "clean", severity, metric)[common],
                np.stack([self.cell(label, name, severity, metric)[common] for name in covered]),
                self.units[common],
            )
            for label in labels
        ]

    def gaps(self, severity: float) -> list[Gap]:
        """Return the cells of the table at ``severity`` that have missing episodes."""
        blocks = self.blocks_at(severity)
        conditions = ["clean", *(name for names in blocks.values() for name in names)]
        return [
            Gap(label, name, 0.0 if name == "clean" else severity, have, len(self.episodes))
            for label in self.columns_at(severity)
            for name in conditions
            if (have := int(self.measured(label, name, severity).sum())) < len(self.episodes)
        ]


def grids(rows: Iterable[Row], drawn: str | None = None) -> list[Grid]:
    """Return the grids of ``rows``, ordered by split, suite, success rule and episode list.

    Args:
        rows: result rows.
        drawn: unit that the bootstrap resamples, "scene" or "episode". If None, it is "scene" for a
            grid with at least ``LEAST_SCENES`` scenes, and otherwise "episode".

    Raises:
        ValueError: If there are no rows, or if ``drawn`` is "scene" but rows do not name their
            scene.
    """
    groups: dict[tuple[str, str, str], list[Row]] = defaultdict(list)
    for row in unique(rows):
        groups[row["split"], row["suite"], row["rule"]].append(row)
    if not groups:
        raise ValueError(
            "There are no result rows to show: the files are empty. Evaluate first, with "
            "`make evaluate`."
        )
    results = []
    for key in sorted(groups):
        by_lists = [_grid(key, list_rows, drawn) for list_rows in by_list(groups[key])]
        several = len(by_lists) > 1
        results += [replace(g, begins=g.episodes[0]) if several else g for g in by_lists]
    return results


def _grid(key: tuple[str, str, str], rows: list[Row], drawn: str | None) -> Grid:
    columns = label_columns((row["name"], row["agent"], row["seed"]) for row in rows)
    labels = {(name, agent): x for x, (name, agents) in columns.items() for agent in agents}
    episodes = tuple(sorted({row["episode_id"] for row in rows}, key=_natural))
    place = {episode: index for index, episode in enumerate(episodes)}
    grouped: dict[str, dict[int, list[Row]]] = {label: defaultdict(list) for label in columns}
    for row in rows:
        grouped[labels[row["name"], row["agent"]]][row["seed"]].append(row)
    agents = {
        label: {seed: run[0]["agent"] for seed, run in by_seed.items()}
        for label, by_seed in grouped.items()
    }
    seeds, unfinished, runs = {}, {}, {}
    cells: dict[tuple[str, str, float, str], np.ndarray] = {}
    for label, by_seed in grouped.items():
        measured = runs[label] = {seed: _cells(run, place) for seed, run in by_seed.items()}
        for severity in {at for run in measured.values() for _, at, _ in run}:
            spot = (label, severity)
            seeds[spot], unfinished[spot] = _complete_seeds(measured, severity)
            pooled = _pooled([measured[seed] for seed in seeds[spot]], severity)
            cells |= {(label, name, severity, metric): v for (name, metric), v in pooled.items()}
    unit, units = _units(rows, episodes, drawn)
    texts = {label: cuts(chain.from_iterable(runs.values())) for label, runs in grouped.items()}
    split, suite, rule = key
    return Grid(
        split=split,
        suite=suite,
        rule=rule,
        columns=columns,
        agents=agents,
        seeds=seeds,
        unfinished=unfinished,
        episodes=episodes,
        cells=cells,
        runs=runs,
        drawn=unit,
        units=units,
        cut={label: text for label, text in texts.items() if text},
    )


def _units(rows: list[Row], episodes: tuple[str, ...], drawn: str | None) -> tuple[str, np.ndarray]:
    """Return the unit that the bootstrap resamples, and the number of each episode's unit."""
    each = "episode", np.arange(len(episodes))
    if drawn == "episode":
        return each
    row_of = {row["episode_id"]: row for row in rows}
    try:
        scenes = [scene_of(row_of[episode]) for episode in episodes]
    except ValueError:
        if drawn is None:
            return each
        raise
    units = np.unique(scenes, return_inverse=True)[1]
    if drawn is None and units.max() + 1 < LEAST_SCENES:
        return each
    return "scene", units


def _cells(rows: list[Row], place: dict[str, int]) -> _Run:
    """Return the cells of one seed; ``place`` maps each episode id to its index."""
    cells: _Run = {}
    for row in rows:
        for metric in (*METRICS.values(), STEPS):
            cell = (row["corruption"], float(row["severity"]), metric)
            values = cells.setdefault(cell, np.full(len(place), np.nan))
            values[place[row["episode_id"]]] = row.get(metric)  # None becomes NaN
    return cells


def _complete_seeds(
    runs: dict[int, _Run], severity: float
) -> tuple[tuple[int, ...], dict[int, tuple[int, int]]]:
    """Return the complete seeds at ``severity``, and the row counts of each incomplete seed.

    The row counts of a seed are the pair (actual, expected). A seed is complete if its row count is
    at least :data:`COVERAGE` times the largest row count of any seed. This must hold separately for
    clean rows and for corrupted rows. If no seed is complete, the seed with the most rows counts as
    complete. Seeds without rows at ``severity`` are omitted from both returned values.
    """

    def rows(run: _Run, at: float) -> int:
        matching = (
            values
            for (name, s, metric), values in run.items()
            if s == at and (name == "clean") == (at == 0.0) and metric == METRICS["SR"]
        )
        return sum(int((~np.isnan(values)).sum()) for values in matching)

    have = {s: np.array([rows(run, 0.0), rows(run, severity)]) for s, run in sorted(runs.items())}
    most = np.max(list(have.values()), axis=0)
    pooled = [seed for seed, counts in have.items() if (counts >= COVERAGE * most).all()]
    pooled = pooled or [max(have, key=lambda seed: have[seed].sum())]
    others = {
        seed: (int(counts.sum()), int(most.sum()))
        for seed, counts in have.items()
        if seed not in pooled and counts[1]
    }
    return tuple(pooled), others


def _pooled(runs: list[_Run], severity: float) -> dict[tuple[str, str], np.ndarray]:
    """Return the clean cells and the corrupted cells at ``severity``, averaged over seeds."""
    keys = {
        (name, at, metric)
        for run in runs
        for name, at, metric in run
        if at == (0.0 if name == "clean" else severity)
    }
    empty = np.full_like(next(iter(runs[0].values())), np.nan)
    return {
        (name, metric): np.mean([run.get((name, at, metric), empty) for run in runs], axis=0)
        for name, at, metric in keys
    }


def _natural(text: str) -> tuple[bool, int, str]:
    return (not text.isdecimal(), int(text) if text.isdecimal() else 0, text)
