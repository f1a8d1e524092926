"""``mitigate.benchmark(agent)``: an agent under the suite, in one call; returns its entry."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from mitigate.corruptions import CLEAN
from mitigate.evaluation.leaderboard.entry import LeaderboardEntry, entry_of, sensors_of
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import World

EPISODES = 20  # of a first look (ours): an SR is then known to about 17 points
OUT = Path("runs/benchmark")
TIMED = 2  # walks by which the time is told, after one that loads what is needed (ours)


def benchmark(
    agent: Any,
    *,
    name: str | None = None,
    split: str | None = None,
    episodes: int | None = EPISODES,
    suite: str | Sequence[str] = "full",
    severity: float = 0.6,
    seed: int = 0,
    workers: int | None = None,
    options: Sequence[str] = (),
    world: Callable[[], World] | None = None,
    listed: Sequence[Episode] | None = None,
    training_data: str = "",
    link: str = "",
    out: Path | str | None = None,
) -> LeaderboardEntry:
    """Evaluate ``agent`` clean and under a suite of corruptions, and return its entry.

    It says first about how long that takes. The rows are in ``out``; the same call goes on where
    it was stopped.

    Args:
        agent: any object of the contract (``mitigate/agents/agent.py``), or a path of weights,
            such as "checkpoints/base".
        name: heading of the entry; None: of the weights' folder, or the agent's class.
        split: list of episodes of the world; None: its own first. episodes: how many, spread over
            the list; None: all, as entries of the leaderboard have.
        suite: a name of ``conf/suite`` or a list of corruptions. severity: from 0 to 1. seed: of
            the corruptions. workers: processes, None: one a core if there is work for them.
        options: of ``mitigate evaluate``, such as "agent=recurrent" or "env.views=1".
        world, listed: makes a world of your own, and its episodes, in place of those of
            ``options``.
        training_data, link: for the entry. out: folder of the rows; None: one in
            ``runs/benchmark``.
    Raises ValueError for unknown names and numbers out of range, FileNotFoundError for missing
    weights.
    """
    from mitigate.core import conf, seeding
    from mitigate.core.build import maker
    from mitigate.core.locks import FolderLock
    from mitigate.evaluation import evaluate as evaluation
    from mitigate.evaluation.evaluator import evaluate

    seeding.check(seed)
    cfg = conf.load_config("evaluate", [*options, *_suite(suite)])
    if isinstance(agent, (str, Path)):
        name = name or evaluation.name_of(str(agent))
        agent = evaluation.load(cfg.agent, str(agent), seed)
    name = name or type(agent).__name__
    names = list(cfg.suite.conditions) if isinstance(suite, str) else list(suite)
    met = evaluation.conditions(list(dict.fromkeys(["clean", *names])), severity, None)
    split = split or cfg.split
    made = world or maker(cfg.env.world)
    chosen = evaluation.episodes(cfg.env, split, episodes) if listed is None else list(listed)
    folder = Path(out or OUT / f"{name}-{split}-s{severity:g}")
    _tell(agent, made(), chosen, len(met), workers)
    file = folder / evaluation.ROWS
    with FolderLock(folder):
        rows = evaluate(
            agent,
            made,
            chosen,
            met,
            name=name,
            out=file,
            split=split,
            seed=seed,
            workers=workers,
        )
    return entry_of(
        rows,
        name,
        severity=severity,
        sensors=sensors_of(made().sensors),
        training_data=training_data,
        link=link,
        file="" if file.is_absolute() else file.as_posix(),
    )


def _suite(suite: str | Sequence[str]) -> list[str]:
    return [f"suite={suite}"] if isinstance(suite, str) else []


def _tell(
    agent: Any, world: World, episodes: Sequence[Episode], conditions: int, workers: int | None
) -> None:
    """Print how much there is to walk, and about how long it takes, from a few clean walks."""
    from mitigate.core.progress import duration
    from mitigate.evaluation.episode import run_episode
    from mitigate.evaluation.evaluator import LOCAL, WORTH
    from mitigate.scale.launcher import count

    total = len(episodes) * conditions
    getattr(agent, "eval", lambda: None)()
    run_episode(agent, world, episodes[0], CLEAN, 0)
    started = time.monotonic()
    for episode in episodes[:TIMED]:
        run_episode(agent, world, episode, CLEAN, 0)
    each = (time.monotonic() - started) / len(episodes[:TIMED])
    processes = min(count(LOCAL, workers, total, WORTH), len(episodes))
    print(
        f"benchmark: {len(episodes)} episodes x {conditions} conditions = {total} walks of about "
        f"{each:.2g} s on {processes} process{'es' * (processes > 1)}: about "
        f"{duration(each * total / processes)}",
        flush=True,
    )
