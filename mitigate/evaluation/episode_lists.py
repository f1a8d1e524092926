"""Which episodes of a list an evaluation takes, and which list its rows are of.

Rows say their split and not where its episodes were read from. So the hash of the list is kept
beside them, and rows that share no episode share no table.
"""

from __future__ import annotations

import re
import warnings
from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from numbers import Integral
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mitigate.core.files import atomic_text, find, sha256
from mitigate.core.names import counted, unknown
from mitigate.evaluation.rows import ROWS, Row, read

if TYPE_CHECKING:
    from mitigate.evaluation.config import EnvConfig
    from mitigate.worlds.episodes import Episode


GOLDEN = (5**0.5 - 1) / 2
TASKS = {"vln": "follow a route", "ogn": "find an object"}  # info["task"] of an episode, in words


def episodes(env: EnvConfig, split: str, count: int | None) -> list[Episode]:
    """Return ``count`` episodes of a split's shipped list (all, if None), as :func:`spread`.

    Raises ValueError for an unknown split, a count below 1, and a list that is empty, names an
    episode twice or has one without an instruction.
    """
    from mitigate.worlds.episodes import read_episodes

    check_count(count)
    if not env.episodes:
        raise ValueError(f"env={env.name} has no episodes, so nothing can be walked in it.")
    if split not in env.episodes:
        raise ValueError(unknown("split", split, env.episodes))
    listed = list(read_episodes(find(env.episodes[split])))
    check_episodes(env.episodes[split], listed)
    return spread(listed, count)


def spread(listed: Sequence[Episode], count: int | None) -> list[Episode]:
    """Return ``count`` of the episodes (all, if None), spread evenly over them, in their order.

    A list goes layout by layout: the first 40 of ``val_unseen`` would be 4 of its 30 layouts. Those
    whose multiples of the golden section have the smallest fractional parts are spread for any
    count, and fewer are always among more: rows of 40 episodes count towards 100.
    """
    chosen = sorted(range(len(listed)), key=lambda i: i * GOLDEN % 1)[:count]
    return [listed[i] for i in sorted(chosen)]


def check_count(count: Any) -> None:
    """Raise ValueError for what is no number of episodes, nor None for all."""
    if count is not None and not (isinstance(count, Integral) and int(count) >= 1):
        raise ValueError(
            f"episodes={count!r} is none: give a whole number, 1 or more, or null for all of the "
            "list."
        )


def check_episodes(source: str, listed: Sequence[Episode]) -> None:
    """Raise ValueError for a list that cannot be scored: rows name an episode by its id alone."""
    twice = [name for name, n in Counter(e.episode_id for e in listed).items() if n > 1]
    silent = [e.episode_id for e in listed if not e.instruction.text.strip()]
    if not listed:
        raise ValueError(f"{source} lists no episode.")
    if twice:
        raise ValueError(f"{source} has the episode {twice[0]} twice: give each an id of its own.")
    if silent:
        raise ValueError(f"The episode {silent[0]} of {source} has no instruction.")


def warn_of_tasks(agent: Any, chosen: Sequence[Episode], name: str, split: str) -> None:
    """Warn of episodes of a task that ``agent``, called ``name``, says it cannot do (``tasks`` in
    ``agents/agent.py``). split: the list to name in place of theirs, that of the agent's config."""
    from mitigate.agents.agent import as_agent

    able = as_agent(agent).tasks
    asked = [str(episode.info["task"]) for episode in chosen if "task" in episode.info]
    other = [] if able is None else [task for task in asked if task not in able]
    if able is not None and other:
        warnings.warn(
            f"{name} can {_in_words(able)}, not {_in_words(other)}, but {len(other)} of "
            f"{counted(len(chosen), 'episode')} ask for that: success there is chance. Choose a "
            f"list of its own, such as split={split}.",
            stacklevel=2,
        )


def _in_words(tasks: Sequence[str]) -> str:
    return " or ".join(TASKS.get(task, task) for task in sorted(set(tasks)))


LIST_HASH = "episodes-{split}.sha256"  # of the file that the episodes of a split came from
_SHA256 = re.compile(r"[0-9a-f]{64}")
OLD_LIST = "episodes.sha256"  # the same by an older version: a line a file, of whichever splits


def keep_list_hash(folder: Path, split: str, source: str) -> None:
    """Keep the hash of a split's episode file beside the rows, as ``sha256sum`` writes it; raise
    ValueError if it was another: a row names its episode by id alone, so another list's rows would
    count as done."""
    note, found = folder / LIST_HASH.format(split=split), sha256(find(source))
    held = _list_hashes(folder, split, source)
    if held and found not in held:
        raise ValueError(
            f"{folder} holds rows of another list of {split} than {source} is now. Name another "
            "folder (out=..., of a training folder=...), or delete this one."
        )
    with atomic_text(note) as file:
        file.write(f"{found}  {source}\n")


def _list_hashes(folder: Path, split: str, source: str) -> list[str]:
    """The hashes of the lists that the rows of ``split`` in ``folder`` may be of, none if it is not
    known; an older version kept those of all splits in one file, by their paths."""
    note, old = folder / LIST_HASH.format(split=split), folder / OLD_LIST
    if note.is_file():
        words = note.read_text(encoding="utf-8", errors="replace").split()[:1]
        if not words or not _SHA256.fullmatch(words[0]):
            raise ValueError(
                f"{note} must begin with a sha256, and is empty or damaged. Copy it back, or move "
                f"{folder} aside and evaluate again."
            )
        return words
    written = (folder / ROWS).is_file() and any(r["split"] == split for r in read(folder / ROWS))
    if not written or not old.is_file():
        return []
    lines = [line.partition("  ") for line in old.read_text(encoding="utf-8").splitlines()]
    return [d for d, _, name in lines if name == source] or [d for d, _, _ in lines]


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
