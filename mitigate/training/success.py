"""Measure success rates per corruption, for schedules that sample corruptions by success rate."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from mitigate.core import workers as processes
from mitigate.core.progress import Progress
from mitigate.core.seeding import generator
from mitigate.corruptions import Schedule
from mitigate.evaluation.evaluator import WORTH, EpisodeJob, EpisodeTask
from mitigate.training.objective import divide
from mitigate.training.parts import hold_statistics
from mitigate.worlds.world import TrainingEpisodes


class ScheduledJob(NamedTuple):
    """A job (``objective.Job``) with the state of the schedule that samples its corruptions."""

    step: int
    number: int
    jobs: int
    items: int
    schedule: dict[str, Any]


class DrawsBySuccess:
    """Base class of batch sources whose schedule may sample corruptions by success rate."""

    agent: Any
    world: Callable[[], Any]
    training: TrainingEpisodes
    schedule: Schedule
    seed: int
    refresh_episodes: int

    def refresh_if_needed(self, step: int, workers: int | None, due: bool = False) -> None:
        """Measure success rates (:meth:`refresh`) if the schedule uses them.

        They are measured only if there are none yet, or if new ones are ``due``.
        """
        if self.schedule.mode == "success_distributed" and (due or self.schedule.success is None):
            self.refresh(step, workers)

    def scheduled_jobs(self, step: int, items: int, jobs: int) -> list[ScheduledJob]:
        """Divide the ``items`` of a step evenly among ``jobs`` jobs."""
        state = self.schedule.state_dict()
        return [ScheduledJob(*job, state) for job in divide(step, items, jobs)]

    def refresh(self, step: int, workers: int | None = None) -> None:
        """Measure the success rate under every corruption, and update the schedule.

        The same training episodes, which are sampled from (seed, step), are run under every
        corruption. The agent is in training mode afterwards.

        Args:
            step: training step.
            workers: number of processes, which does not affect the rates; with 0, only this process
                is used. None means one process per core if that saves time, but only this process
                if the agent is on a GPU.
        """
        rng = generator(self.seed, "refresh", step)
        episodes = [self.training.draw(rng, (0, 1)) for _ in range(self.refresh_episodes)]
        corruptions = [self.schedule.corruption(name) for name in self.schedule.names]
        groups = [
            [
                EpisodeJob(episode, corruption, {"corruption": corruption.name, "seed": self.seed})
                for corruption in corruptions
            ]
            for episode in episodes
        ]
        task = EpisodeTask(self.agent.eval(), self.world)
        on_gpu = any(p.device.type != "cpu" for p in self.agent.parameters())
        if workers == 0 or (workers is None and on_gpu):
            workers = 1
        total = len(episodes) * len(corruptions)
        started = processes.count(workers, total, WORTH)
        successes: dict[str, list[int]] = {c.name: [] for c in corruptions}
        with Progress(f"success at step {step}", total, unit="episode") as progress:
            for item in processes.results(task, groups, started, progress):
                if item is not None:
                    _, row = item
                    successes[row["corruption"]].append(row["success"])
                    progress.advance()
        self.schedule.refresh({name: float(np.mean(won)) for name, won in successes.items()})
        hold_statistics(self.agent.train())


def reject_success_distributed(schedule: Schedule | None) -> None:
    """Raise ValueError if ``schedule`` samples by success rate.

    Objectives and sources that measure no success rates call this function.
    """
    if schedule is not None and schedule.mode == "success_distributed":
        raise ValueError(
            "schedule=success_distributed needs success rates, which this recipe does not measure. "
            "Choose schedule=per_episode or per_frame."
        )
