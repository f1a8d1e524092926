"""Hand-made result rows for the tests of rows, tables and reports."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any


def row(episode: int | str, success: float, **changes: Any) -> dict[str, Any]:
    """Return a clean row of the agent ``base``; its SPL is half of ``success``."""
    output = {
        "agent": "0123456789ab",
        "name": "base",
        "corruption": "clean",
        "severity": 0.0,
        "split": "val_unseen",
        "episode_id": str(episode),
        "seed": 0,
        "suite": "1.0",
        "rule": "vln: STOP and geodesic < 2.0 m",
        "success": int(success),
        "spl": success / 2,
    }
    return output | changes


def cell(wins: int, count: int = 10, **changes: Any) -> list[dict[str, Any]]:
    """Return rows of ``count`` episodes; the first ``wins`` are successes."""
    return [row(episode, episode < wins, **changes) for episode in range(count)]


def column(clean: int, corrupted: dict[str, int], severity: float = 0.6, **changes: Any) -> list:
    """Return the rows of a clean cell and of one cell per corruption, with ten episodes each."""
    cells: Iterable = (
        cell(wins, corruption=name, severity=severity, **changes)
        for name, wins in corrupted.items()
    )
    return cell(clean, **changes) + [records for rows in cells for records in rows]
