"""Compute a leaderboard entry from the rows of an agent."""

from __future__ import annotations

import hashlib
import json
from collections import Counter
from collections.abc import Iterable, Sequence
from typing import Any

from mitigate.core.names import unknown
from mitigate.corruptions.registry import UNSEEN
from mitigate.evaluation import bootstrap
from mitigate.evaluation.grid import FRAMES, METRICS, SUITE, label_columns
from mitigate.evaluation.leaderboard.entry import LeaderboardEntry
from mitigate.evaluation.page.model import CLEAN, Numbers, numbers
from mitigate.evaluation.rows import Row, identity
from mitigate.evaluation.sections import Section, sections


def entry_of(
    rows: Iterable[Row],
    name: str,
    *,
    severity: float,
    split: str | None = None,
    file: str = "",
    **texts: Any,
) -> LeaderboardEntry:
    """Return the leaderboard entry of the agent ``name`` at one severity.

    Args:
        rows: result rows, which may include other agents, splits and severities.
        name: name of the agent in the rows.
        severity: severity of the corruptions.
        split: name of the split; it may be None if the rows contain only one split.
        file: path of the rows, relative to the current folder.
        **texts: sensors, training_data and link of the entry.

    Raises:
        ValueError: If no rows match, or if a condition lacks episodes. It is also raised if the
            rows mix several splits, episode lists, suites or success rules, or if two of their
            agents have the same training seed.
    """
    chosen = _chosen(rows, name, severity, split)
    parts = [part for part in sections(chosen) if part.blocks] or sections(chosen)
    tables = {", ".join((part.grid.heading, part.grid.suite, part.grid.rule)) for part in parts}
    columns = label_columns((row["name"], row["agent"], row["seed"]) for row in chosen)
    if len(tables) > 1 or len(columns) > 1:
        raise ValueError(
            f"The rows of {name} belong to several splits, lists, suites, rules or agents: "
            f"{'; '.join(sorted(tables))}. Name a split, or a file with the rows of only one."
        )
    for part in parts:
        _check_whole(name, chosen, part)
    grid = parts[0].grid
    agents = sorted({(row["seed"], row["agent"]) for row in chosen})
    values = {"sensors": (), "training_data": "", **_figures(parts), **texts}
    return LeaderboardEntry(
        name=name,
        agents=tuple({"agent": agent, "seed": seed} for seed, agent in agents),
        split=grid.split,
        suite=grid.suite,
        rule=grid.rule,
        severity=severity,
        episodes=len(grid.episodes),
        listed=hashlib.sha256("\n".join(sorted(grid.episodes)).encode()).hexdigest()[:12],
        rows={"file": file, "sha256": rows_sha(chosen), "count": len(chosen)},
        **values,
    )


def left_out(entry: LeaderboardEntry, rows: Iterable[Row]) -> str:
    """Return a text that lists the seeds and conditions in ``rows`` that the entry omits.

    Only rows with the name, split, severity, suite and success rule of the entry are considered. If
    the entry omits nothing, the text is empty.
    """
    comparable = [
        row
        for row in _chosen(rows, entry.name, entry.severity, entry.split)
        if (row["suite"], row["rule"]) == (entry.suite, entry.rule)
    ]
    agents = {(one["seed"], one["agent"]) for one in entry.agents}
    others = sorted({(row["seed"], row["agent"]) for row in comparable} - agents)
    conditions = sorted({row["corruption"] for row in comparable} - entry.SR.keys())
    return ", ".join([*(f"seed {seed} (agent {agent})" for seed, agent in others), *conditions])


def rows_sha(rows: Iterable[Row]) -> str:
    """Return a sha256 of rows that depends on neither their order nor the file format.

    Each row is written as one line of JSON with sorted keys. The lines are sorted by row identity
    before they are hashed.
    """
    digest = hashlib.sha256()
    for row in sorted(rows, key=lambda row: tuple(map(str, identity(row)))):
        digest.update(json.dumps(row, sort_keys=True).encode() + b"\n")
    return digest.hexdigest()


def _chosen(rows: Iterable[Row], name: str, severity: float, split: str | None) -> list[Row]:
    """Return the clean rows of the agent ``name`` and its rows at ``severity``."""
    rows = list(rows)
    if name not in (names := {row["name"] for row in rows}):
        raise ValueError(unknown("agent in these rows", name, names))
    chosen = [
        row
        for row in rows
        if row["name"] == name
        and split in (None, row["split"])
        and row["severity"] == (0 if row["corruption"] == CLEAN else severity)
    ]
    if not any(row["severity"] == severity for row in chosen):
        raise ValueError(f"The rows of {name} hold no corruption at severity {severity:g}.")
    return chosen


def _check_whole(name: str, rows: Sequence[Row], part: Section) -> None:
    """Raise ValueError if a training seed lacks rows of a table."""
    conditions = [CLEAN, *part.corruptions]
    cells = Counter((row["seed"], row["corruption"]) for row in rows)
    episodes = len(part.grid.episodes)
    for seed in sorted({row["seed"] for row in rows}):
        have = {condition: cells[seed, condition] for condition in conditions}
        if lacking := [condition for condition in conditions if have[condition] < episodes]:
            more = f" and {len(lacking) - 3} more" * (len(lacking) > 3)
            raise ValueError(
                f"Seed {seed} of {name} is not finished ({sum(have.values()):,} of "
                f"{episodes * len(conditions):,} rows): it lacks some under "
                f"{', '.join(lacking[:3])}{more}. Run the evaluation again to continue."
            )


def _figures(parts: Sequence[Section]) -> dict[str, dict[str, Numbers]]:
    """Return the scores by title, and the SR and SPL of each condition."""
    figures: dict[str, dict[str, Numbers]] = {"scores": {}, "SR": {}, "SPL": {}}
    scores = figures["scores"]
    for part in parts:
        (column,) = part.columns
        names = [CLEAN, *part.corruptions]
        for metric, key in METRICS.items():
            scores.setdefault(f"Clean {metric}", numbers(part.clean.get((column, metric))))
            cells = [part.grid.cell(column, name, part.severity, key) for name in names]
            estimates = bootstrap.means(cells, units=part.grid.units, shares=True)
            for name, estimate in zip(names, estimates, strict=True):
                figures[metric].setdefault(name, numbers(estimate))
        if part.kind == SUITE and column in part.corrupted:
            scores["Mean SR"] = _mean_sr(part, column)
        for (_, block, metric), retained in part.retained.items():
            halves = {UNSEEN[name].half for name in retained.corruptions if name in UNSEEN}
            half = f", {halves.pop()}" if len(halves) == 1 and "," not in block else ""
            scores[f"PRS-{metric} ({block}{half})"] = numbers(retained.estimate)
    return figures


def _mean_sr(part: Section, column: str) -> Numbers:
    """Return the mean SR over the measured frame corruptions of the suite.

    Instruction corruptions are excluded, so that entries with and without them can be compared.
    If no frame corruption was measured, the mean is over all measured corruptions.
    """
    frames = sorted(FRAMES.intersection(part.corruptions))
    mixed = 0 < len(frames) < len(part.corruptions)
    mean = part.mean_sr(column, frames) if mixed else None
    return numbers((mean or part.corrupted[column]).estimate)
