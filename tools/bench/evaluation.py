"""Episodes of an evaluation a CPU second: each by itself, and an episode's conditions together."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mitigate.core import build, conf, workers
from mitigate.evaluation.conditions import conditions
from mitigate.evaluation.config import read
from mitigate.evaluation.episode_lists import episodes
from mitigate.evaluation.evaluate import load
from mitigate.evaluation.evaluator import EpisodeTask, Job, evaluate, run_episode

CHECKPOINTS = ("checkpoints/base", "checkpoints/hardened/stacked")
SEVERITY = 0.6


@dataclass(frozen=True)
class Pace:
    """``count`` episodes, each under one condition: CPU seconds of both ways of running them, and
    whether these gave the same rows."""

    count: int
    alone: float
    together: float
    same: bool


def paces(count: int) -> dict[str, Pace]:
    """By checkpoint: ``count`` episodes under the suite in this process, both ways in turns."""
    cfg = read(conf.load_config("evaluate"))
    found = {}
    for weights in CHECKPOINTS:
        task = EpisodeTask(load(cfg.agent, weights), build.maker(cfg.env.world))
        met = conditions(list(cfg.suite.conditions), SEVERITY, None)
        groups: list[list[Job]] = [
            [(episode, c, {"seed": 0, "corruption": c.name}) for c in met]
            for episode in episodes(cfg.env, cfg.split, count + 1)
        ]
        with task.ready():
            found[weights] = _pace(task, groups)
    return found


def _pace(task: EpisodeTask, groups: list[list[Job]]) -> Pace:
    """Time all groups but the first, which warms up."""

    def alone(group: list[Job]) -> list[dict[str, Any]]:
        assert task.world is not None
        return [{**job, **run_episode(task.agent, task.world, e, c, 0)} for e, c, job in group]

    ways: dict[str, Callable] = {"alone": alone, "together": lambda group: list(task.work(group))}
    spent, same = dict.fromkeys(ways, 0.0), True
    for number, group in enumerate(groups):
        rows = {}
        for way in list(ways)[:: 1 if number % 2 else -1]:
            started = time.process_time()
            rows[way] = ways[way](group)
            spent[way] += (time.process_time() - started) * (number > 0)
        same = same and rows["alone"] == rows["together"]
    return Pace(sum(map(len, groups[1:])), spent["alone"], spent["together"], same)


def seconds_by_workers(count: int) -> dict[int, float]:
    """Wall seconds of an evaluation of ``count`` episodes under the suite by its number of workers:
    1, and 2 where there are two cores, started before."""
    with tempfile.TemporaryDirectory() as folder:
        return {
            number: min(
                _evaluation(count, number, Path(folder) / f"{number}-{turn}") for turn in "ab"
            )
            for number in range(1, 1 + min(2, workers.cores()))
        }


def _evaluation(count: int, number: int, folder: Path) -> float:
    cfg = read(conf.load_config("evaluate"))
    agent = load(cfg.agent, CHECKPOINTS[0])
    started = time.perf_counter()
    evaluate(
        agent,
        build.maker(cfg.env.world),
        episodes(cfg.env, cfg.split, count),
        conditions(list(cfg.suite.conditions), SEVERITY, None),
        name=f"{number} workers",
        out=folder / "rows.jsonl",
        split=cfg.split,
        workers=number,
    )
    return time.perf_counter() - started
