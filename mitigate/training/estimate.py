"""What a training is going to do, and about how long that takes: said before the first step.

Costs are those of the topological agent on the machine of ``precision.REFERENCE``: a stage of a
recipe says seconds a step (``cost``), and another kind of agent how many times as long that takes
with it (``cost`` of its config), from trainings of it that were timed.
"""

from __future__ import annotations

import math
from pathlib import Path

from omegaconf import DictConfig

from mitigate.core import precision
from mitigate.core.names import counted
from mitigate.core.progress import duration
from mitigate.core.workers import cores
from mitigate.evaluation.evaluate import REPORT, times
from mitigate.training import states
from mitigate.training.stages import trainer_settings

EPISODE_COST = 0.12  # seconds of one core for an evaluated episode
EPISODES = 300  # of a list, which need not be opened


def plan(cfg: DictConfig, folder: Path) -> str:
    """Return what a run is going to do and how long that will take here, for all of it."""
    parts = [f"{name} {count} steps" for name, count in _steps(cfg).items()]
    if _walked(cfg):
        count = cfg.evaluation.episodes
        listed = "all episodes" if count is None else counted(count, "episode")
        agents, conditions = 1 + has_base(cfg), len(cfg.suite.conditions)
        parts.append(f"{agents} x {listed} x {counted(conditions, 'condition')}")
    total = estimate(cfg, folder)
    about = "no estimate" if math.isnan(total) else f"about {duration(60 * math.ceil(total / 60))}"
    return f"{cfg.name}: {', '.join(parts)}: {about} on this machine; all goes to {folder}"


def estimate(cfg: DictConfig, folder: Path) -> float:
    """Return the seconds that the rest of a run takes here, NaN if a cost of them is not known."""
    costs: list[tuple[float, float | None]] = []  # how many, and seconds of each
    for name, count in _steps(cfg).items():
        done = states.checkpoints(folder / name)
        left = count - (states.steps_done(done[-1]) if done else 0)
        costs.append((max(0, left), cfg.stages[name].cost))
    walk = times(EPISODE_COST / (cfg.evaluation.workers or cores()), cfg.cost.evaluation)
    costs.append((_walked(cfg), walk))
    seconds = sum(count * (math.nan if cost is None else cost) for count, cost in costs if count)
    return seconds * precision.probe().fp32 / precision.REFERENCE


def has_base(cfg: DictConfig) -> bool:
    """Whether a run starts from whole weights, which are evaluated beside the trained ones."""
    return bool(cfg.init and not cfg.init_parts)


def _steps(cfg: DictConfig) -> dict[str, int]:
    """Steps of each stage by name."""
    stages = {str(name): stage for name, stage in cfg.stages.items() if stage is not None}
    return {name: trainer_settings(cfg, stage).get("steps", 0) for name, stage in stages.items()}


def _walked(cfg: DictConfig) -> int:
    """How many episodes are walked after the training; 0 where another report is made."""
    if not cfg.evaluation.enabled or cfg.report != REPORT:
        return 0
    return (1 + has_base(cfg)) * len(cfg.suite.conditions) * (cfg.evaluation.episodes or EPISODES)
