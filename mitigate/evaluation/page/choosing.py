"""Which episodes' walks a page shows: by a rule, by turns of what can come of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import count, islice
from typing import Any

from mitigate.corruptions import Corruption
from mitigate.evaluation.rows import Row

KINDS = {  # (the first agent succeeds, the last one does): what the page calls it
    (False, True): "won back",
    (False, False): "lost by both",
    (True, True): "won by both",
    (True, False): "lost by the last",
}
ALONE = {True: "won", False: "lost"}  # where there is one agent


def outcome(won: Sequence[bool]) -> str:
    """Return what the page calls it that the agents won or not, in their order."""
    return KINDS[won[0], won[-1]] if len(won) > 1 else ALONE[won[0]]


def choose(rows: Sequence[Row], agents: Sequence[str], most: int) -> list[tuple[str, Corruption]]:
    """Return at most ``most`` pairs (episode id, corruption) that the first and the last of
    ``agents`` both met.

    By turns of the kinds of :data:`KINDS`, and of each kind by turns of the corruptions, in the
    order of ``rows``; no episode twice. It is a choice to look at, not a sample: how often each
    kind comes is in the tables.
    """
    first, last = _won(rows, agents[0]), _won(rows, agents[-1])
    found: dict[tuple[bool, bool], dict[tuple[str, float], list[str]]] = {k: {} for k in KINDS}
    for place, won in first.items():
        if place in last:
            episode, corruption, severity = place
            kind = (bool(won), bool(last[place]))
            found[kind].setdefault((corruption, severity), []).append(episode)
    turns = [_turns(held, offset) for offset, held in enumerate(found.values())]
    return list(islice(_once(turns), most))


def _won(rows: Sequence[Row], name: str) -> dict[tuple[str, str, float], float]:
    """Return the success of an agent under each corruption, of the lowest seed that it ran with."""
    own = [row for row in rows if row["name"] == name and row["corruption"] != "clean"]
    seed = min((row["seed"] for row in own), default=0)
    kept = [row for row in own if row["seed"] == seed]
    return {(r["episode_id"], r["corruption"], float(r["severity"])): r["success"] for r in kept}


def _turns(
    held: Mapping[tuple[str, float], Sequence[str]], offset: int
) -> Iterator[tuple[str, Corruption]]:
    """Yield the first of each corruption, then the second of each and so on; ``offset``: which
    corruption begins."""
    names = [*held][offset:] + [*held][:offset]
    for turn in count():
        left = [at for at in names if len(held[at]) > turn]
        if not left:
            return
        for at in left:
            yield held[at][turn], Corruption(*at)


def _once(turns: Sequence[Iterator[Any]]) -> Iterator[tuple[str, Corruption]]:
    """Yield from each of ``turns`` in turn what is of an episode not yet seen."""
    seen: set[str] = set()
    waiting = list(turns)
    while waiting:
        for turn in list(waiting):
            found = next((pair for pair in turn if pair[0] not in seen), None)
            if found is None:
                waiting.remove(turn)
            else:
                seen.add(found[0])
                yield found
