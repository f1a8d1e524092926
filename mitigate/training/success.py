"""Measure success rates per corruption, for schedules that sample corruptions by success rate."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from mitigate.core import workers as processes
from mitigate.core.progress import Progress
from mitigate.core.seeding import generator
from mitigate.corruptions import Schedule
from mitigate.evaluation.evaluator import WORTH, EpisodeTask
from mitigate.training.parts import hold_statistics
from mitigate.worlds.world import TrainingEpisodes, World


class DrawsBySuccess:
    """Base class of batch sources whose schedule may sample corruptions by the agent's success
    rates.
    """

    agent: Any
    world: Callable[[], Any]
    training: TrainingEpisodes
    schedule: Schedule
    seed: int
    refresh_episodes: int

    def refresh(self, step: int, workers: int | None = None) -> None:
        """Measure the success rate under every corruption on training episodes, and update the
        schedule.
        """
        rates = measure(
            self.agent,
            self.schedule,
            self.world,
            self.training,
            episodes=self.refresh_episodes,
            seed=self.seed,
            step=step,
            workers=workers,
        )
        self.schedule.refresh(rates)
        hold_statistics(self.agent.train())

    def set_schedule(self, state: dict[str, Any]) -> None:
        """Restore the state that the schedule had when the job was created."""
        if state != self.schedule.state_dict():
            self.schedule.load_state_dict(state)


def measure(
    agent: Any,
    schedule: Schedule,
    world: Callable[[], World],
    training: TrainingEpisodes,
    *,
    episodes: int,
    seed: int,
    step: int,
    workers: int | None = None,
) -> dict[str, float]:
    """Measure the success rate of ``agent`` under every corruption of ``schedule``.

    The same episodes, which are sampled from (seed, step), are run under every corruption.

    Args:
        agent: a module with ``reset`` and ``act``; it stays in eval mode.
        schedule: the schedule whose corruptions are measured.
        world: function that constructs a world.
        training: source of the episodes.
        episodes: number of episodes per corruption.
        seed: seed of episodes and corruptions.
        step: training step.
        workers: number of processes, which does not affect the rates; with 0, only this process is
            used. None means one process per core if that saves time, but only this process if the
            agent is on a GPU.

    Returns:
        The success rate in [0, 1] by corruption.
    """
    rng = generator(seed, "refresh", step)
    drawn_episodes = [training.draw(rng, (0, 1)) for _ in range(episodes)]
    corruptions = [schedule.corruption(name) for name in schedule.names]
    groups = [
        [(e, c, {"corruption": c.name, "seed": seed}) for c in corruptions] for e in drawn_episodes
    ]
    task = EpisodeTask(agent.eval(), world)
    on_gpu = any(p.device.type != "cpu" for p in agent.parameters())
    if workers == 0 or (workers is None and on_gpu):
        workers = 1
    total = len(drawn_episodes) * len(corruptions)
    started = processes.count(workers, total, WORTH)
    with Progress(f"success at step {step}", total, unit="episode") as progress:
        measures = []
        for item in processes.results(task, groups, started, progress):
            if item is not None:
                measures.append(item[1])
                progress.advance()
    return success_rates(measures)


def refuse(schedule: Schedule | None) -> None:
    """Raise ValueError if ``schedule`` samples by success rate, because the calling recipe measures
    no success rates.
    """
    if schedule is not None and schedule.mode == "success_distributed":
        raise ValueError(
            "schedule=success_distributed needs success rates, which this recipe does not measure. "
            "Choose schedule=per_episode or per_frame."
        )


def success_rates(results: list[dict[str, Any]]) -> dict[str, float]:
    """Return the mean success rate per corruption, from result rows or measures; clean episodes are
    left out.
    """
    names = {row["corruption"] for row in results} - {"clean"}
    return {
        n: float(np.mean([r["success"] for r in results if r["corruption"] == n]))
        for n in sorted(names)
    }
