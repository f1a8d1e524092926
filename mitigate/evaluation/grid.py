"""Result rows arranged for tables: columns (agents) x conditions x episodes, with what is missing.

Rows of different split, list of episodes, suite version or success rule never share a
:class:`Grid`.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain

import numpy as np

from mitigate.corruptions.registry import AND, HALVES, UNSEEN, names, unseen_names
from mitigate.evaluation import metrics
from mitigate.evaluation.episode_lists import by_list
from mitigate.evaluation.rows import Row, cuts, scene_of, upsert

BLOCKS = {  # of ours; a corruption of another package is no part of them
    "RGB": names("rgb"),
    "Depth": names("depth"),
    "Instruction": names("instruction"),
    "unseen RGB": unseen_names("rgb"),
    "unseen depth": unseen_names("depth"),
}
FRAMES = frozenset((*BLOCKS["RGB"], *BLOCKS["Depth"]))  # the paper's twelve
SUITE, UNSEEN_KIND, PAIRS = "", "unseen corruptions", "pairs of corruptions"  # a table each
PROMPT_ONLY = "white_box"  # not applicable to agents without a system prompt: these have no row


def kind(corruption: str) -> str:
    """Return in which table a corruption stands: the suite's and what other packages bring, the
    unseen ones, or the pairs."""
    return PAIRS if AND in corruption else UNSEEN_KIND if corruption in UNSEEN else SUITE


def by_kind(rows: Iterable[Row]) -> dict[str, list[Row]]:
    """Return the rows of each table, with the clean ones of the agents that are in it.

    The suite's numbers are thus the same whatever else was measured, for whichever seeds. Agents
    that were never corrupted stand beside the suite.
    """
    rows = list(rows)
    kinds = {row["corruption"]: kind(row["corruption"]) for row in rows}
    members: dict[tuple, set[str]] = defaultdict(set)
    for row in rows:
        if row["corruption"] != "clean":
            members[_column(row)].add(kinds[row["corruption"]])
    found: dict[str, list[Row]] = {SUITE: [], UNSEEN_KIND: [], PAIRS: []}
    for row in rows:
        own = {kinds[row["corruption"]]}
        for name in (members[_column(row)] or own) if row["corruption"] == "clean" else own:
            found[name].append(row)
    return {name: held for name, held in found.items() if held}


def _column(row: Row) -> tuple:
    return tuple(row[key] for key in ("split", "suite", "rule", "name", "agent"))


def meant(block: str, held: Sequence[str]) -> tuple[str, ...]:
    """Return the corruptions that a PRS over ``block`` stands for where ``held`` are measured.

    One that does not apply (:data:`PROMPT_ONLY`) counts only where it was measured, and a half of
    the unseen ones only where one of it was.
    """
    every = tuple(n for n in BLOCKS.get(block, held) if n in held or n != PROMPT_ONLY)
    halves = {UNSEEN[name].half for name in held if name in UNSEEN}
    return tuple(n for n in every if n not in UNSEEN or UNSEEN[n].half in halves)


def halves(blocks: dict[str, tuple[str, ...]]) -> dict[str, dict[str, tuple[str, ...]]]:
    """Return by block what is measured of each half, by its heading, where both are."""
    found = {
        block: {
            f"{block}, {half}": tuple(n for n in names if n in UNSEEN and UNSEEN[n].half == half)
            for half in HALVES
        }
        for block, names in blocks.items()
    }
    return {block: parts for block, parts in found.items() if all(parts.values())}


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
            digits = _telling(agents)
            columns |= {f"{name} ({agent[:digits]})": (name, (agent,)) for agent in agents}
    return columns


def _telling(agents: Iterable[str]) -> int:
    """How many digits, 6 or more, tell ``agents`` apart."""
    digits, agents = 6, set(agents)
    while len({agent[:digits] for agent in agents}) < len(agents):
        digits += 1
    return digits


COVERAGE = 0.9  # share of the clean episodes a corruption must hold to enter a PRS (ours)
METRICS = {"SR": "success", "SPL": "spl"}
DRAWN = ("episode", "scene")  # what the bootstrap may draw
_Run = dict[tuple[str, float, str], np.ndarray]  # (corruption, severity, metric): values [N]


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
    """What a PRS is made of: ``clean`` [N] and ``corrupted`` [K, N] on the same N episodes, and
    with what the bootstrap draws each, ``units`` [N]."""

    corruptions: tuple[str, ...]
    clean: np.ndarray
    corrupted: np.ndarray
    units: np.ndarray

    @property
    def prs(self) -> float:
        """The PRS; NaN if nothing succeeds clean."""
        return metrics.prs(float(self.clean.mean()), self.corrupted.mean(axis=1))


@dataclass(frozen=True, eq=False)
class Grid:
    """All results of one split, list of episodes, suite version and success rule.

    ``columns`` maps a column's label to its (name, agent shas), ``agents[label][seed]`` says which
    of these a seed is of.
    ``cells[label, corruption, severity, metric]`` is float64 [N], one value an episode, the mean
    over ``seeds[label, severity]``, NaN where a row is missing; a clean cell is there once for each
    severity, over that one's seeds. ``unfinished[label, severity]`` holds the seeds that are left
    out, with the rows they have and the rows of a whole one. ``runs[label][seed]`` are the cells of
    one seed, by (corruption, severity, metric). ``units`` [N] are numbers: the bootstrap draws
    episodes of one number together, and ``drawn`` says what that is. ``cut[label]`` says
    how many episodes a limit cut, if it cut any. ``begins`` is the first
    episode's id where another grid differs in its list alone, else empty.
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
    def heading(self) -> str:
        """The split, and which of its lists, if there are several."""
        return f"{self.split} from {self.begins}" if self.begins else self.split

    def cell(self, label: str, corruption: str, severity: float, metric: str) -> np.ndarray:
        """Return the values [N] of a cell; all NaN if nothing was measured."""
        empty = np.full(len(self.episodes), np.nan)
        return self.cells.get((label, corruption, severity, metric), empty)

    def over(self, labels: Iterable[str], seeds: Iterable[int], severity: float) -> Grid:
        """Return the grid of some columns at ``severity`` with ``seeds`` alone, which all have."""
        seeds = tuple(seeds)
        cells = {
            (label, name, severity, metric): values
            for label in labels
            for (name, metric), values in _pooled(
                [self.runs[label][seed] for seed in seeds], severity
            ).items()
        }
        return replace(self, cells=cells)

    def paired(self, labels: Iterable[str], severity: float) -> Grid:
        """Return the grid to compare columns in: over the seeds that all have, if there are any,
        so that they meet corruptions of the same keys."""
        labels = tuple(labels)
        common = self.common(labels, severity)
        return self.over(labels, common, severity) if common else self

    def common(self, labels: Iterable[str], severity: float) -> list[int]:
        """Return the seeds that all of ``labels`` have at ``severity``."""
        return sorted(set.intersection(*(set(self.seeds[label, severity]) for label in labels)))

    @cached_property
    def severities(self) -> list[float]:
        """The severities of the corrupted cells, rising; never 0."""
        return sorted({severity for _, _, severity, _ in self.cells if severity > 0})

    @cached_property
    def corruptions(self) -> list[str]:
        """The measured corruptions, those of the blocks first."""
        measured = {name for _, name, _, _ in self.cells if name != "clean"}
        known = [name for block in BLOCKS.values() for name in block if name in measured]
        return known + sorted(measured.difference(known))

    def columns_at(self, severity: float) -> list[str]:
        """Return the columns with a cell at ``severity``."""
        measured = {label for label, _, at, _ in self.cells if at == severity}
        return [label for label in self.columns if label in measured]

    def agents_at(self, label: str, severity: float) -> list[str]:
        """Return the shas of the agents that a column's cells at ``severity`` are of, seed by
        seed."""
        return [*dict.fromkeys(self.agents[label][s] for s in self.seeds[label, severity])]

    def blocks_at(self, severity: float) -> dict[str, tuple[str, ...]]:
        """Return the measured corruptions at ``severity`` by block; "Pairs" holds the pairs of
        corruptions, "Other" the rest."""
        measured = {name for _, name, at, _ in self.cells if at == severity and name != "clean"}
        rest = sorted(measured.difference(*BLOCKS.values()))
        own = {"Pairs": [n for n in rest if AND in n], "Other": [n for n in rest if AND not in n]}
        blocks = {
            block: tuple(name for name in names if name in measured)
            for block, names in {**BLOCKS, **own}.items()
        }
        return {block: names for block, names in blocks.items() if names}

    def measured(self, label: str, severity: float, metric: str = "success") -> np.ndarray:
        """Return which episodes [N] the clean cell of a column holds, of the seeds at severity."""
        return ~np.isnan(self.cell(label, "clean", severity, metric))

    def retention(
        self, labels: Sequence[str], names: Iterable[str], severity: float, metric: str
    ) -> list[Retention] | None:
        """Return what each column's PRS over ``names`` is made of, or None if there is nothing.

        All have the same corruptions, those measured in every column on at least
        :data:`COVERAGE` of the episodes, and the same episodes, those with no gap among these.
        """
        known = np.all([self.measured(label, severity, metric) for label in labels], axis=0)
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
                self.cell(label, "clean", severity, metric)[common],
                np.stack([self.cell(label, name, severity, metric)[common] for name in kept]),
                self.units[common],
            )
            for label in labels
        ]

    def gaps(self, severity: float) -> list[Gap]:
        """Return the cells of the table at ``severity`` that lack episodes of the grid."""
        blocks = self.blocks_at(severity)
        wanted = ["clean", *(name for names in blocks.values() for name in names)]
        found = []
        for label in self.columns_at(severity):
            for name in wanted:
                have = int((~np.isnan(self.cell(label, name, severity, "success"))).sum())
                if have < len(self.episodes):
                    at = 0.0 if name == "clean" else severity
                    found.append(Gap(label, name, at, have, len(self.episodes)))
        return found


def grids(rows: Iterable[Row], drawn: str = DRAWN[0]) -> list[Grid]:
    """Return the grids of ``rows``, ordered by split, suite and rule, then as their lists begin.

    ``drawn``: of :data:`DRAWN`, what the bootstrap draws. Raises ValueError if there are no rows,
    or if scenes are to be drawn and rows do not say theirs.
    """
    groups: dict[tuple[str, str, str], list[Row]] = defaultdict(list)
    for row in upsert(rows):
        groups[row["split"], row["suite"], row["rule"]].append(row)
    if not groups:
        raise ValueError(
            "There are no result rows to show: the files are empty. Evaluate first, with "
            "`make evaluate`."
        )
    found = []
    for key in sorted(groups):
        made = [_grid(key, held, drawn) for held in by_list(groups[key])]
        several = len(made) > 1
        found += [replace(g, begins=g.episodes[0]) if several else g for g in made]
    return found


def _grid(key: tuple[str, str, str], rows: list[Row], drawn: str) -> Grid:
    columns = label_columns((row["name"], row["agent"], row["seed"]) for row in rows)
    labels = {(name, agent): x for x, (name, agents) in columns.items() for agent in agents}
    episodes = tuple(sorted({row["episode_id"] for row in rows}, key=_natural))
    place = {episode: index for index, episode in enumerate(episodes)}
    held: dict[str, dict[int, list[Row]]] = {label: defaultdict(list) for label in columns}
    for row in rows:
        held[labels[row["name"], row["agent"]]][row["seed"]].append(row)
    agents = {
        label: {seed: run[0]["agent"] for seed, run in found.items()}
        for label, found in held.items()
    }
    seeds, unfinished, runs = {}, {}, {}
    cells: dict[tuple[str, str, float, str], np.ndarray] = {}
    for label, found in held.items():
        measured = runs[label] = {seed: _cells(run, place) for seed, run in found.items()}
        for severity in {at for run in measured.values() for _, at, _ in run}:
            spot = (label, severity)
            seeds[spot], unfinished[spot] = _whole(measured, severity)
            pooled = _pooled([measured[seed] for seed in seeds[spot]], severity)
            cells |= {(label, name, severity, metric): v for (name, metric), v in pooled.items()}
    units = np.arange(len(episodes))
    if drawn != DRAWN[0]:
        scenes = {row["episode_id"]: scene_of(row) for row in rows}
        units = np.unique([scenes[episode] for episode in episodes], return_inverse=True)[1]
    texts = {label: cuts(chain.from_iterable(by_seed.values())) for label, by_seed in held.items()}
    cut = {label: text for label, text in texts.items() if text}
    return Grid(*key, columns, agents, seeds, unfinished, episodes, cells, runs, drawn, units, cut)


def _cells(rows: list[Row], place: dict[str, int]) -> _Run:
    """Return the cells of one seed; ``place`` is where an episode stands."""
    cells: _Run = {}
    for row in rows:
        for metric in METRICS.values():
            cell = (row["corruption"], float(row["severity"]), metric)
            values = cells.setdefault(cell, np.full(len(place), np.nan))
            values[place[row["episode_id"]]] = row[metric]
    return cells


def _whole(
    runs: dict[int, _Run], severity: float
) -> tuple[tuple[int, ...], dict[int, tuple[int, int]]]:
    """Return the seeds to pool at ``severity``, and those left out with (rows held, rows of all).

    A seed counts if it holds :data:`COVERAGE` of the rows of the one that holds most, of the clean
    ones and of the corrupted. One with nothing at ``severity`` is not mentioned.
    """

    def rows(run: _Run, at: float) -> int:
        found = (
            values
            for (name, s, metric), values in run.items()
            if s == at and (name == "clean") == (at == 0.0) and metric == METRICS["SR"]
        )
        return sum(int((~np.isnan(values)).sum()) for values in found)

    have = {s: np.array([rows(run, 0.0), rows(run, severity)]) for s, run in sorted(runs.items())}
    most = np.max(list(have.values()), axis=0)
    kept = [seed for seed, counts in have.items() if (counts >= COVERAGE * most).all()]
    kept = kept or [max(have, key=lambda seed: have[seed].sum())]
    left = {
        seed: (int(counts.sum()), int(most.sum()))
        for seed, counts in have.items()
        if seed not in kept and counts[1]
    }
    return tuple(kept), left


def _pooled(runs: list[_Run], severity: float) -> dict[tuple[str, str], np.ndarray]:
    """Return the mean over seeds of the clean and the corrupted cells of ``severity``."""
    wanted = {
        (name, at, metric)
        for run in runs
        for name, at, metric in run
        if at == (0.0 if name == "clean" else severity)
    }
    empty = np.full_like(next(iter(runs[0].values())), np.nan)
    return {
        (name, metric): np.mean([run.get((name, at, metric), empty) for run in runs], axis=0)
        for name, at, metric in wanted
    }


def _natural(text: str) -> tuple[bool, int, str]:
    return (not text.isdecimal(), int(text) if text.isdecimal() else 0, text)
