"""The leaderboard as the page of a report: a table for each split, suite, rule and severity."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Sequence
from typing import Any

from mitigate.corruptions.registry import AND, UNSEEN
from mitigate.evaluation import metrics
from mitigate.evaluation.blocks import BLOCKS, FRAMES, PROMPT_ONLY, SUITE, kind
from mitigate.evaluation.bootstrap import LEVEL, NO_WIDTH, RESAMPLES
from mitigate.evaluation.leaderboard.checks import titles
from mitigate.evaluation.leaderboard.entry import LeaderboardEntry
from mitigate.evaluation.page import document
from mitigate.evaluation.page.model import CLEAN, has_width, shortened
from mitigate.evaluation.sections import label

ABOUT = (
    "Agents under corruptions of what they see and hear. Every figure is computed from rows, one "
    "an episode, whose sha256 the entry states; mitigate leaderboard check computes them again."
)
NOTES = (
    "PRS is what an agent keeps of its own clean SR (or SPL): read it beside the clean value.",
    "Intervals are over episodes; paired differences of two agents are in a report of their rows.",
)


def render(entries: Sequence[LeaderboardEntry], title: str = "Leaderboard") -> str:
    """Return the HTML page of ``entries``, the largest table first; by falling mean SR in each,
    those whose mean is over other corruptions than the suite's last.

    Raises ValueError if there are none.
    """
    if not entries:
        raise ValueError("There is no entry to show: add one with `mitigate leaderboard add`.")
    groups: dict[tuple, list[LeaderboardEntry]] = defaultdict(list)
    for entry in entries:
        key = (entry.split, entry.suite, entry.rule, entry.severity, entry.listed)
        groups[key].append(entry)
    ordered = sorted(groups.values(), key=lambda held: -len(held))
    shown = [_section(held) for held in ordered]
    twice = Counter(section["title"] for section in shown)
    for held, section in zip(ordered, shown, strict=True):
        if twice[section["title"]] > 1:
            section["title"] += f", list {held[0].listed}, {held[0].rule}"
    return document.page(title, ABOUT, shown, notes=NOTES)


def _section(entries: list[LeaderboardEntry]) -> dict[str, Any]:
    held = sorted(entries, key=lambda entry: -_rank(entry))
    first = held[0]
    shown = [title for title in titles() if any(title in entry.scores for entry in held)]
    names = _conditions(held)
    values = [[_value(entry, title) for title in shown] for entry in held]
    return {
        "title": f"{first.split}, severity {first.severity:g}, suite {first.suite}",
        "facts": [
            ["Split", first.split],
            ["Episodes", f"{first.episodes:,}, list {first.listed}"],
            ["Success", first.rule],
            ["Corruption suite", first.suite],
            ["Severity", f"{first.severity:g}"],
            ["Intervals", f"{LEVEL:.0%}, bootstrap over episodes, {RESAMPLES:,} resamples"],
        ],
        "severity": first.severity,
        "columns": _columns(held),
        "measures": [{"title": title, "unit": _unit(title)} for title in shown],
        "values": values,
        "corruptions": [
            {"name": name, "title": "Clean" if name == CLEAN else label(name), "block": block}
            for name, block in names.items()
        ],
        "cells": [[_cell(entry, name) for name in names] for entry in held],
        "wanted": first.episodes,
        "pairs": {},
        "baselines": 0,
        "notes": _notes(values),
        "grid": None,
    }


def _cell(entry: LeaderboardEntry, name: str) -> list[Any]:
    """Return SR, SPL, episodes, and the shares of the clean SR and SPL, over the same episodes."""
    found = [(rates.get(name), rates[CLEAN]) for rates in (entry.SR, entry.SPL)]
    kept = [shortened(metrics.prs(b[0], [a[0]])) if a and b and b[0] else None for a, b in found]
    return [*(own for own, _ in found), entry.episodes, *kept]


def _notes(values: list[list[Any]]) -> list[str]:
    held = [value for line in values for value in line if value]
    marks = "".join(value[3] for value in held)
    alike = [] if all(map(has_width, held)) else [NO_WIDTH]
    other = "† k/K: over k corruptions, not the K that the score stands for; do not compare."
    return [other, *alike] if "†" in marks else alike


def _rank(entry: LeaderboardEntry) -> float:
    found = entry.scores.get("Mean SR")
    return found[0] - 2 * bool(_over(entry, "Mean SR")) if found else -2.0


def _value(entry: LeaderboardEntry, title: str) -> list[Any] | None:
    found = entry.scores.get(title)
    return found and [*found, _over(entry, title)]


def _over(entry: LeaderboardEntry, title: str) -> str:
    """Return the mark of a score that is over other corruptions than it stands for, else ""."""
    met = set(entry.SR) - {CLEAN}
    if title == "Mean SR":
        wanted = set(FRAMES)
        own = met & FRAMES or {name for name in met if kind(name) == SUITE}
    else:
        block, _, half = title.partition("(")[2].rstrip(")").partition(", ")
        wanted = {n for n in BLOCKS.get(block, ()) if not half or UNSEEN[n].half == half}
        own, wanted = met & wanted, wanted - {PROMPT_ONLY}
    if not wanted or own >= wanted:
        return ""
    return f" † {len(own)}/{len(wanted)}"


def _unit(title: str) -> str:
    return "%" if title in ("Clean SR", "Mean SR") else ""


def _conditions(entries: Sequence[LeaderboardEntry]) -> dict[str, str]:
    """Return the block of each condition of any entry, clean first, in the suite's order."""
    met = {name for entry in entries for name in entry.SR if name != CLEAN}
    found = {CLEAN: ""}
    for block, names in BLOCKS.items():
        found |= {name: block for name in names if name in met}
    rest = sorted(met.difference(found))
    return found | {name: "Pairs" if AND in name else "Other" for name in rest}


def _labels(entries: Sequence[LeaderboardEntry]) -> list[str]:
    """Return the names; of entries with one name each with its first agent, and numbered where that
    is one, too."""
    twice = Counter(entry.name for entry in entries)
    told = [f"{one.name} ({one.agents[0]['agent'][:6]})" for one in entries]
    own = [x if twice[one.name] > 1 else one.name for one, x in zip(entries, told, strict=True)]
    return [f"{x}, {own[:n].count(x) + 1}" if own.count(x) > 1 else x for n, x in enumerate(own)]


def _columns(entries: Sequence[LeaderboardEntry]) -> list[dict[str, Any]]:
    labels = _labels(entries)
    found: list[dict[str, Any]] = []
    for entry, name in zip(entries, labels, strict=True):
        agents = ", ".join(str(one["agent"]) for one in entry.agents)
        details = [
            ["hash", agents],
            ["seeds", ", ".join(str(one["seed"]) for one in entry.agents)],
            ["sensors", "; ".join(entry.sensors) or "not stated"],
            ["trained on", entry.training_data or "not stated"],
            ["episodes", f"{entry.episodes:,}"],
            ["rows", f"{entry.rows['count']:,} in {entry.rows['file'] or 'no file named'}"],
            ["sha256 of rows", entry.rows["sha256"]],
            ["link", entry.link],
        ]
        shown = [[key, value] for key, value in details if value]
        found.append({"label": name, "place": len(found), "seeds": [], "details": shown})
    return found
