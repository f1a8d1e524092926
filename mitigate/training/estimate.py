"""Estimate how long a training run takes; the run prints this in its first line."""

from __future__ import annotations

import math
from pathlib import Path

from mitigate.core import precision
from mitigate.core.names import counted
from mitigate.core.progress import duration
from mitigate.core.workers import cores
from mitigate.evaluation.config import REPORT, times
from mitigate.training import states
from mitigate.training.config import TrainConfig

EPISODE_COST = 0.12  # seconds per evaluated episode on one core, measured on the reference machine
EPISODES = 300  # assumed length of episode lists; the estimate does not open them


def describe(config: TrainConfig, folder: Path) -> str:
    """Return a line with the steps, episodes, estimated duration and initial weights of a run."""
    parts = [f"{name} {count} steps" for name, count in _steps(config).items()]
    if _episodes(config):
        count = config.evaluation.episodes
        listed = "all episodes" if count is None else counted(count, "episode")
        measured = counted(len(config.suite.conditions), "condition")
        parts.append(f"{1 + config.has_base} x {listed} x {measured}")
    total = estimate(config, folder)
    about = "no estimate" if math.isnan(total) else f"about {duration(60 * math.ceil(total / 60))}"
    start = config.init or "those that the agent is built with"
    return (
        f"{config.name}: {', '.join(parts)}: {about} on this machine; initial weights: {start}; "
        f"output in {folder}"
    )


def estimate(config: TrainConfig, folder: Path) -> float:
    """Return the remaining seconds of a run on this machine, or NaN if a cost is unknown.

    Costs are in seconds on the machine of ``precision.REFERENCE``. The costs were measured in
    training runs. The cost of a stage is the time per step with the topological agent. For other
    kinds of agent, the recipe may multiply it by a factor from the agent's config (``cost.views``
    or ``cost.episodes``).
    """
    # pairs (number of steps or episodes, seconds for each)
    costs: list[tuple[float, float | None]] = []
    for name, count in _steps(config).items():
        done = states.checkpoints(folder / name)
        left = count - (states.steps_done(done[-1]) if done else 0)
        costs.append((max(0, left), config.active_stages[name].cost))
    episode = times(EPISODE_COST / (config.evaluation.workers or cores()), config.cost.evaluation)
    costs.append((_episodes(config), episode))
    seconds = sum(count * (math.nan if cost is None else cost) for count, cost in costs if count)
    # The speed factor is at least 1: faster matrix products do not make rendering faster.
    # Without this limit, a bf16 run of 13 minutes was estimated at 6 minutes.
    return seconds * max(1.0, precision.probe() / precision.REFERENCE)


def _steps(config: TrainConfig) -> dict[str, int]:
    """Return the number of steps of each stage, by name."""
    stages = config.active_stages.items()
    return {name: stage.settings(config.trainer).get("steps", 0) for name, stage in stages}


def _episodes(config: TrainConfig) -> int:
    """Return how many episodes are run after training.

    If the number of episodes is not set, ``EPISODES`` is assumed. For other kinds of report, the
    result is 0.
    """
    if not config.evaluation.enabled or config.report != REPORT:
        return 0
    count = config.evaluation.episodes or EPISODES
    return (1 + config.has_base) * len(config.suite.conditions) * count
