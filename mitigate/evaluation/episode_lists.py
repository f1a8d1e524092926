"""Choose the episodes of an evaluation, and separate the rows of different episode lists.

Rows contain the split but not the episode file. Therefore rows without common episodes appear in
different tables.
"""

from __future__ import annotations

import warnings
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Sequence
from numbers import Integral
from typing import TYPE_CHECKING, Any

from mitigate.core.files import find
from mitigate.core.names import counted, unknown
from mitigate.core.progress import say
from mitigate.core.seeding import generator
from mitigate.evaluation.rows import Row

if TYPE_CHECKING:
    from mitigate.evaluation.config import EnvConfig
    from mitigate.worlds.episodes import Episode
    from mitigate.worlds.world import World


GOLDEN = (5**0.5 - 1) / 2
TASKS = {"vln": "follow a route", "ogn": "find an object"}  # descriptions of info["task"]


def episodes(env: EnvConfig, split: str, count: int | None) -> list[Episode]:
    """Return ``count`` episodes of a split's shipped list, chosen by :func:`spread`.

    If ``count`` is None, all episodes are returned.

    Raises:
        ValueError: If the split is unknown, or if the count is below 1. It is also raised if the
            list is empty, contains an id twice or has an episode without an instruction.
    """
    from mitigate.worlds.episodes import read_episodes

    check_count(count)
    if not env.episodes:
        raise ValueError(f"env={env.name} has no episodes to run. Choose another world.")
    if split not in env.episodes:
        raise ValueError(unknown("split", split, env.episodes))
    listed = list(read_episodes(find(env.episodes[split])))
    check_episodes(env.episodes[split], listed)
    return spread(listed, count)


def training_episodes(world: World, training: Any) -> Callable[[int], Episode]:
    """Return a function that maps a number to a training episode.

    Guards that measure the agent before an evaluation use this function.

    Args:
        world: the world.
        training: the config of the world's training episodes, or None if it is unknown.
    """

    def draw(number: int) -> Episode:
        from mitigate.core import build
        from mitigate.worlds.seeded import FIRST_TRAINING_SEED, SeededWorld, seeded_episodes

        if isinstance(world, SeededWorld):
            return seeded_episodes([FIRST_TRAINING_SEED + number])[0]
        if training is None:
            raise ValueError(
                f"adapt=recentre needs training episodes, but those of {type(world).__name__} are "
                "unknown. Create the guard with `guard = Recentre()` "
                "(mitigate.guards.adaptation.recentre). Calibrate it on your own episodes with "
                "`guard.calibrate(agent, world, lambda number: episodes[number])`. Then pass "
                "adapt=guard."
            )
        return build.maker(training)().draw(generator(0, "calibration", number), (0, 1))

    return draw


def spread(listed: Sequence[Episode], count: int | None) -> list[Episode]:
    """Return ``count`` episodes that are spread evenly over the list, in list order.

    If ``count`` is None, all episodes are returned.

    Lists are ordered by layout, so the first 40 episodes of ``val_unseen`` cover only 4 of its 30
    layouts. The chosen indices i are those for which i times the golden ratio has the smallest
    fractional part. These indices are spread evenly for any count. A smaller selection is always a
    subset of a larger one, so an evaluation of 100 episodes can reuse the rows of an earlier
    evaluation of 40.
    """
    if count is not None and count > len(listed):
        say(f"episodes={count}, but the list holds only {len(listed)}: all of them run")
    chosen = sorted(range(len(listed)), key=lambda i: i * GOLDEN % 1)[:count]
    return [listed[i] for i in sorted(chosen)]


def check_count(count: Any) -> None:
    """Raise ValueError unless ``count`` is a number of episodes, or None for all."""
    if count is not None and not (isinstance(count, Integral) and int(count) >= 1):
        raise ValueError(
            f"episodes must be a whole number >= 1, or null for the whole list, got {count!r}."
        )


def episode_list(argument: str, listed: Any) -> list[Episode]:
    """Return the value of ``argument`` as a list of episodes.

    Raises:
        ValueError: If an element is not an Episode.
    """
    from mitigate.worlds.episodes import Episode

    entries = list(listed) if isinstance(listed, Iterable) else [listed]
    if others := [entry for entry in entries if not isinstance(entry, Episode)]:
        raise ValueError(
            f"{argument} must contain only Episode objects, got {others[0]!r:.80}. For seeds, pass "
            f"{argument}=seeded_episodes(range(5)) (mitigate.worlds.seeded)."
        )
    return entries


def check_episodes(source: str, listed: Sequence[Episode]) -> None:
    """Raise ValueError for a list that cannot be evaluated.

    Ids must be unique, because rows name an episode only by its id.
    """
    twice = [name for name, n in Counter(e.episode_id for e in listed).items() if n > 1]
    silent = [e.episode_id for e in listed if not e.instruction.text.strip()]
    if not listed:
        raise ValueError(f"{source} must list at least one episode.")
    if twice:
        raise ValueError(f"{source} has the episode {twice[0]} twice. Each id must be unique.")
    if silent:
        raise ValueError(f"The episode {silent[0]} of {source} has no instruction.")


def warn_of_tasks(agent: Any, chosen: Sequence[Episode], name: str, split: str) -> None:
    """Warn about episodes whose task is not in the agent's ``tasks`` (``agents/agent.py``).

    Args:
        agent: the agent.
        chosen: the episodes.
        name: name of the agent.
        split: name of a split with tasks that the agent supports; the warning suggests this split.
    """
    from mitigate.agents.agent import as_agent

    supported = as_agent(agent).tasks
    if supported is None:
        return
    tasks = [str(episode.info["task"]) for episode in chosen if "task" in episode.info]
    if other := [task for task in tasks if task not in supported]:
        warnings.warn(
            f"{name} can {_in_words(supported)}, not {_in_words(other)}, but {len(other)} of "
            f"{counted(len(chosen), 'episode')} need that. Choose a list such as split={split}.",
            stacklevel=2,
        )


def _in_words(tasks: Sequence[str]) -> str:
    return " or ".join(TASKS.get(task, task) for task in sorted(set(tasks)))


def by_list(rows: Iterable[Row]) -> list[list[Row]]:
    """Return the rows grouped by episode list; the lists are ordered by their first rows.

    Two agents belong to the same list if both were evaluated on at least one common episode, or if
    a chain of other agents connects them in this way.
    """
    rows = list(rows)
    by_agent: dict[tuple[str, str], set[str]] = defaultdict(set)
    for row in rows:
        by_agent[row["name"], row["agent"]].add(row["episode_id"])
    lists: list[set[str]] = []
    for episodes_of_agent in by_agent.values():
        overlapping = [one for one in lists if not one.isdisjoint(episodes_of_agent)]
        separate = [one for one in lists if one.isdisjoint(episodes_of_agent)]
        lists = [*separate, episodes_of_agent.union(*overlapping)]
    index = {episode: n for n, one in enumerate(lists) for episode in one}
    groups: dict[int, list[Row]] = defaultdict(list)
    for row in rows:
        groups[index[row["episode_id"]]].append(row)
    return list(groups.values())
