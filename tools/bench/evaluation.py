"""Measure how many evaluation episodes run per CPU second if conditions run separately, and if they
run together.
"""

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
from mitigate.evaluation.evaluator import EpisodeJob, EpisodeTask, evaluate, run_episode

CHECKPOINTS = ("checkpoints/base", "checkpoints/hardened/stacked")
SEVERITY = 0.6


@dataclass(frozen=True)
class Pace:
    """The CPU seconds of the same episodes, run in two ways.

    Attributes:
        count: Number of runs, each of one episode under one condition.
        alone: CPU seconds if every episode runs separately.
        together: CPU seconds if the conditions of an episode run together, as in an evaluation.
        same: Whether both ways give equal rows.
    """

    count: int
    alone: float
    together: float
    same: bool


def paces(count: int) -> dict[str, Pace]:
    """Measure ``count`` episodes of each checkpoint under the suite, in this process."""
    cfg = read(conf.load_config("evaluate"))
    by_checkpoint = {}
    for weights in CHECKPOINTS:
        task = EpisodeTask(load(cfg.agent, weights), build.maker(cfg.env.world))
        suite = conditions(list(cfg.suite.conditions), SEVERITY, None)
        groups: list[list[EpisodeJob]] = [
            [EpisodeJob(episode, c, {"seed": 0, "corruption": c.name}) for c in suite]
            for episode in episodes(cfg.env, cfg.split, count + 1)
        ]
        with task.ready():
            by_checkpoint[weights] = _pace(task, groups)
    return by_checkpoint


def _pace(task: EpisodeTask, groups: list[list[EpisodeJob]]) -> Pace:
    """Measure the time of all groups of runs except the first group, which is a warm-up."""

    def alone(group: list[EpisodeJob]) -> list[dict[str, Any]]:
        assert task.world is not None
        return [
            {**label, **run_episode(task.agent, task.world, episode, condition, 0)}
            for episode, condition, label in group
        ]

    ways: dict[str, Callable] = {"alone": alone, "together": lambda group: list(task.work(group))}
    seconds = dict.fromkeys(ways, 0.0)
    same = True
    for number, group in enumerate(groups):
        rows = {}
        for way in list(ways)[:: 1 if number % 2 else -1]:
            start = time.process_time()
            rows[way] = ways[way](group)
            seconds[way] += (time.process_time() - start) * (number > 0)
        same = same and rows["alone"] == rows["together"]
    return Pace(sum(map(len, groups[1:])), seconds["alone"], seconds["together"], same)


def seconds_by_workers(count: int) -> dict[int, float]:
    """Return the wall time in seconds of evaluating ``count`` episodes under the suite.

    The keys are the numbers of workers: 1, and also 2 if there are two cores. Each time is the
    faster of two runs.
    """
    with tempfile.TemporaryDirectory() as folder:
        return {
            number: min(
                _time_evaluation(count, number, Path(folder) / f"{number}-{run}") for run in "ab"
            )
            for number in range(1, 1 + min(2, workers.cores()))
        }


def _time_evaluation(count: int, number: int, folder: Path) -> float:
    cfg = read(conf.load_config("evaluate"))
    agent = load(cfg.agent, CHECKPOINTS[0])
    start = time.perf_counter()
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
    return time.perf_counter() - start
