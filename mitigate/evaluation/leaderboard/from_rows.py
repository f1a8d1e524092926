"""An entry from the rows of an agent: its figures, and the sum by which the rows are known."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from mitigate.core.names import counted, unknown
from mitigate.core.observation import Sensor
from mitigate.corruptions.registry import UNSEEN
from mitigate.evaluation import bootstrap
from mitigate.evaluation.blocks import FRAMES, SUITE
from mitigate.evaluation.bootstrap import Estimate
from mitigate.evaluation.grid import METRICS
from mitigate.evaluation.labels import label_columns
from mitigate.evaluation.leaderboard.entry import LeaderboardEntry
from mitigate.evaluation.page.model import CLEAN, Numbers, numbers
from mitigate.evaluation.rows import Row, identity
from mitigate.evaluation.sections import Section, mean_sr, sections


def entry_of(
    rows: Iterable[Row],
    name: str,
    *,
    severity: float,
    split: str | None = None,
    sensors: Sequence[str] = (),
    training_data: str = "",
    link: str = "",
    file: str = "",
) -> LeaderboardEntry:
    """Return the entry of the rows whose column is ``name``, at one severity.

    ``split`` may be left out where the rows are of one. ``file``: where they are, as the entry
    says. Raises ValueError if there are none, if they are of several
    splits, lists, suites or rules, or of agents that are no training seeds of one another, and if a
    condition lacks episodes, or a seed rows, that others have.
    """
    own = chosen(rows, name, severity, split)
    found = [part for part in sections(own) if part.blocks] or sections(own)
    _check_one(name, own, found)
    _check_seeds(name, own, found)
    for gap in [gap for part in found for gap in part.gaps][:1]:
        held = f"{gap.have} of {counted(gap.want, 'episode')}"
        raise ValueError(
            f"The rows of {name} hold {held} under {gap.corruption}: an "
            "entry needs all of them under each. The evaluation's own command goes on from there."
        )
    scores, rates = _figures(found)
    grid = found[0].grid
    return LeaderboardEntry(
        name=name,
        agents=tuple(_agents(own)),
        sensors=tuple(sensors),
        training_data=training_data,
        split=grid.split,
        suite=grid.suite,
        rule=grid.rule,
        severity=severity,
        episodes=len(grid.episodes),
        listed=listed_sha(grid.episodes),
        scores=scores,
        SR=rates["SR"],
        SPL=rates["SPL"],
        rows={"file": file, "sha256": rows_sha(own), "count": len(own)},
        link=link,
    )


def chosen(rows: Iterable[Row], name: str, severity: float, split: str | None = None) -> list[Row]:
    """Return the rows of an entry: of the column ``name``, clean or at ``severity``. Raises
    ValueError if there are none."""
    held = list(rows)
    names = {row["name"] for row in held}
    if name not in names:
        raise ValueError(unknown("agent in these rows", name, names))
    own = [row for row in held if row["name"] == name and split in (None, row["split"])]
    own = [r for r in own if r["severity"] == (0 if r["corruption"] == CLEAN else severity)]
    if not any(row["severity"] == severity for row in own):
        raise ValueError(f"The rows of {name} hold no corruption at severity {severity:g}.")
    return own


def _check_one(name: str, own: Sequence[Row], found: Sequence[Section]) -> None:
    """Raise ValueError for rows of several tables, or of agents that are no seeds of one another in
    all of them."""
    grids = {(part.grid.heading, part.grid.suite, part.grid.rule) for part in found}
    if len(grids) > 1 or len(label_columns((r["name"], r["agent"], r["seed"]) for r in own)) > 1:
        raise ValueError(
            f"The rows of {name} are of several splits, lists, suites, rules or agents: "
            f"{'; '.join(', '.join(grid) for grid in sorted(grids))}. Name a split, or a file of "
            "one."
        )


def _check_seeds(name: str, own: Sequence[Row], found: Sequence[Section]) -> None:
    """Raise ValueError for a seed that lacks rows of a table that another seed has."""
    for part in found:
        shown = {CLEAN}.union(*part.blocks.values())
        met = [row for row in own if row["corruption"] in shown]
        every = {(row["corruption"], row["episode_id"]) for row in met}
        for seed in sorted({row["seed"] for row in own}):
            have = {(r["corruption"], r["episode_id"]) for r in met if r["seed"] == seed}
            lacking = sorted({corruption for corruption, _ in every - have})
            if lacking:
                more = f" and {len(lacking) - 3} more" * (len(lacking) > 3)
                raise ValueError(
                    f"Seed {seed} of {name} is not finished ({len(have):,} of {len(every):,} "
                    f"rows): it lacks some under {', '.join(lacking[:3])}{more}, which other seeds "
                    "have. The evaluation's own command goes on from there."
                )


def left_out(entry: LeaderboardEntry, rows: Iterable[Row]) -> str:
    """Return which seeds and conditions of the entry's name, split, suite, rule and severity
    ``rows`` hold and the entry leaves out; empty if none. Whoever chose may say why."""
    own = [
        row
        for row in chosen(rows, entry.name, entry.severity, entry.split)
        if (row["suite"], row["rule"]) == (entry.suite, entry.rule)
    ]
    agents = {(one["seed"], one["agent"]) for one in entry.agents}
    others = sorted({(row["seed"], row["agent"]) for row in own} - agents)
    conditions = sorted({row["corruption"] for row in own} - entry.SR.keys())
    parts = [f"seed {seed} (agent {agent})" for seed, agent in others] + conditions
    return ", ".join(parts)


def rows_sha(rows: Iterable[Row]) -> str:
    """Return the sha256 of rows in whatever order and file: their JSON with sorted keys, one a
    line, in the order of their identities."""
    ordered = sorted(rows, key=lambda row: tuple(map(str, identity(row))))
    digest = hashlib.sha256()
    for row in ordered:
        digest.update(json.dumps(row, sort_keys=True).encode() + b"\n")
    return digest.hexdigest()


def listed_sha(episodes: Iterable[str]) -> str:
    """Return the first 12 digits of the sha256 of episode ids in whatever order."""
    return hashlib.sha256("\n".join(sorted(episodes)).encode()).hexdigest()[:12]


def sensors_of(sensors: Mapping[str, Sensor], read: Any = None) -> tuple[str, ...]:
    """Return a line for each sensor of a world that an agent reads. ``read``: what the agent has as
    ``sensors``; unless these are names of the world's, all count."""
    own = read if isinstance(read, Sequence) and {*map(str, read)} & {*sensors} else sensors
    lines = []
    for name in [name for name in sensors if name in own]:
        sensor = sensors[name]
        several = len(sensor.yaws) > 1
        views = f"{len(sensor.yaws)} views of " if several else ""
        seen = f", {sensor.hfov:g} degrees wide" if sensor.hfov else ""
        unit = f", {sensor.unit}" if sensor.unit else ""
        shape = " x ".join(map(str, sensor.shape[several:]))
        lines.append(f"{name}: {views}{shape} {sensor.dtype}{unit}{seen}")
    return tuple(lines)


def _figures(found: Sequence[Section]) -> tuple[dict[str, Numbers], dict[str, dict[str, Numbers]]]:
    """Return the scores by title, and SR and SPL of each condition by metric."""
    scores: dict[str, Numbers] = {}
    rates: dict[str, dict[str, Numbers]] = {metric: {} for metric in METRICS}
    for part in found:
        (column,) = part.columns
        for metric in METRICS:
            scores.setdefault(f"Clean {metric}", numbers(part.clean.get((column, metric))))
        if part.kind == SUITE and column in part.corrupted:
            scores["Mean SR"] = numbers(_mean_sr(part, column))
        for (_, block, metric), held in part.retained.items():
            title = f"PRS-{metric} ({_heading(block, held.corruptions)})"
            scores[title] = numbers(held.estimate)
        names = [CLEAN, *(name for block in part.blocks.values() for name in block)]
        for metric, key in METRICS.items():
            table = [part.grid.cell(column, name, part.severity, key) for name in names]
            for name, estimate in zip(names, bootstrap.means(table, shares=True), strict=True):
                rates[metric].setdefault(name, numbers(estimate))
    return scores, rates


def _mean_sr(part: Section, column: str) -> Estimate:
    """Return the mean SR over the suite's corruptions of frames that were measured, so that entries
    with corrupted instructions compare with those without; of none, over what was measured."""
    met = {name for names in part.blocks.values() for name in names}
    if met & FRAMES and met - FRAMES:
        held = part.grid.retention([column], sorted(met & FRAMES), part.severity, METRICS["SR"])
        if held:
            return mean_sr(held).estimate
    return part.corrupted[column].estimate


def _heading(block: str, names: Iterable[str]) -> str:
    """Return what a PRS over ``names`` is of: a block, or the one half of it that was measured."""
    own = {UNSEEN[name].half for name in names if name in UNSEEN}
    return f"{block}, {own.pop()}" if len(own) == 1 and "," not in block else block


def _agents(rows: Iterable[Row]) -> list[dict[str, Any]]:
    held = sorted({(row["seed"], row["agent"]) for row in rows})
    return [{"agent": agent, "seed": seed} for seed, agent in held]
