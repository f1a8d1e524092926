"""Rows by the list of episodes that they are over: two lists that share no episode share no table.

Rows say their split and not where its episodes were read from. One split may have had several lists
(the editions of docs/base-agent.md), and one agent may have met a part of a list alone.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable

from mitigate.evaluation.rows import Row


def by_list(rows: Iterable[Row]) -> list[list[Row]]:
    """Return the rows of each list, in the order in which lists begin.

    Two agents are of one list if they met an episode both, or each met one with a third.
    """
    rows = list(rows)
    met: dict[tuple[str, str], set[str]] = defaultdict(set)
    for row in rows:
        met[row["name"], row["agent"]].add(row["episode_id"])
    lists: list[set[str]] = []
    for own in met.values():
        joined = [held for held in lists if not held.isdisjoint(own)]
        lists = [held for held in lists if held.isdisjoint(own)] + [own.union(*joined)]
    place = {episode: n for n, held in enumerate(lists) for episode in held}
    found: dict[int, list[Row]] = defaultdict(list)
    for row in rows:
        found[place[row["episode_id"]]].append(row)
    return list(found.values())
