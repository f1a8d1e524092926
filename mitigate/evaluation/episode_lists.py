"""Which episodes of a shipped list an evaluation takes."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Sequence
from numbers import Integral
from typing import TYPE_CHECKING, Any

from omegaconf import DictConfig

from mitigate.core.files import find
from mitigate.core.names import counted, unknown

if TYPE_CHECKING:
    from mitigate.worlds.episodes import Episode

GOLDEN = (5**0.5 - 1) / 2
TASKS = {"vln": "follow a route", "ogn": "find an object"}  # info["task"] of an episode, in words


def episodes(env: DictConfig, split: str, count: int | None) -> list:
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
