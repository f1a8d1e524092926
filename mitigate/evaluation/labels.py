"""What the columns of a table are called, whose rows name agents and seeds."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable


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
