"""Success rates by corruption, which a success-distributed schedule draws by."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from mitigate.core import workers as processes
from mitigate.core.progress import Progress, say
from mitigate.core.seeding import generator
from mitigate.corruptions import Schedule
from mitigate.evaluation.evaluator import WORTH, EpisodeTask
from mitigate.evaluation.rows import read
from mitigate.training.parts import hold_statistics
from mitigate.worlds.world import TrainingEpisodes, World


class DrawsBySuccess:
    """What sources of batches share whose schedule may draw by the success rates of their agent."""

    agent: Any
    world: Callable[[], Any]
    training: TrainingEpisodes
    schedule: Schedule
    seed: int
    refresh_episodes: int

    def refresh(self, step: int, workers: int | None = None) -> None:
        """Measure the success under every corruption on training episodes, for the schedule."""
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
        """Draw as the schedule did when a job was ordered."""
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
    """Success of ``agent`` under every corruption of ``schedule``, in [0, 1] by name.

    ``episodes`` of ``training`` are drawn from (seed, step), the same ones under every corruption,
    and walked in what ``world`` makes. ``agent`` is a module with reset and act; it is left in eval
    mode. ``workers``: processes, on which the rates do not depend; 0: this one alone; None: one a
    core if there is work for them, and this one alone for an agent on a GPU.
    """
    rng = generator(seed, "refresh", step)
    drawn = [training.draw(rng, (0, 1)) for _ in range(episodes)]
    met = [schedule.corruption(name) for name in schedule.names]
    groups = [[(e, c, {"corruption": c.name, "seed": seed}) for c in met] for e in drawn]
    task = EpisodeTask(agent.eval(), world)
    on_gpu = any(p.device.type != "cpu" for p in agent.parameters())
    if workers == 0 or (workers is None and on_gpu):
        workers = 1
    total = len(drawn) * len(met)
    started = processes.count(workers, total, WORTH)
    with Progress(f"success at step {step}", total, unit="walk") as progress:
        found = []
        for item in processes.results(task, groups, started, progress):
            if item is not None:
                found.append(item[1])
                progress.advance()
    return success_rates(found)


def refuse(schedule: Schedule | None) -> None:
    """Raise ValueError for a schedule by success, in a recipe that measures none."""
    if schedule is not None and schedule.mode == "success_distributed":
        raise ValueError(
            "Nothing in this recipe measures success, by which schedule=success_distributed draws: "
            "choose schedule=per_episode or per_frame."
        )


def prior_rates(path: Path | str) -> dict[str, float]:
    """Success by corruption in a file of result rows. Says of which split they are: a training that
    draws by them has seen it.

    Raises FileNotFoundError or ValueError for a file that is not there or broken, and ValueError
    if it mixes agents, splits or severities.
    """
    found = read(path)
    kinds = {
        "agents": {f"{row['name']} {row['agent']}" for row in found},
        "splits": {row["split"] for row in found},
        "severities": {f"{row['severity']:g}" for row in found} - {"0"},
    }
    for what, held in kinds.items():
        if len(held) > 1:
            raise ValueError(
                f"{path} holds rows of several {what} ({', '.join(sorted(held))}), so its success "
                "rates say nothing about one agent. Name a file of one evaluation (prior=...)."
            )
    say(f"draws by the success on {', '.join(kinds['splits'])} in {path}: report on other episodes")
    return success_rates(found)


def success_rates(results: list[dict[str, Any]]) -> dict[str, float]:
    """Mean success by corruption of rows or measures; clean ones are left out."""
    names = {row["corruption"] for row in results} - {"clean"}
    return {
        n: float(np.mean([r["success"] for r in results if r["corruption"] == n]))
        for n in sorted(names)
    }
