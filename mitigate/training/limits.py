"""What the settings of a training may be; a slip of the keyboard ends before anything is built."""

from __future__ import annotations

import math
from collections.abc import Mapping
from numbers import Real
from typing import Any

from omegaconf import DictConfig, OmegaConf

from mitigate.core.names import short

COUNT = 10**9  # steps; a training at 1000 a second would take 11 days (ours)
EPISODES, PROCESSES = 100_000, 256  # most (ours)
WEIGHT = 1e9  # largest weight of a loss (ours)
LIMITS: dict[str, tuple[float, float]] = {  # least and greatest; all are finite numbers
    "steps": (1, COUNT),
    "keep": (1, 10**6),
    "lr": (1e-12, 100.0),
    "weight_decay": (0.0, 100.0),
    "grad_clip": (0.0, 1e9),
    "lag": (0, 64),
    **dict.fromkeys(("warmup", "log_every", "save_every"), (0, COUNT)),
    **dict.fromkeys(("eval_every", "figure_every"), (0, COUNT)),
}
MEANS = {
    "grad_clip": ": a norm above 0, or 0 to clip nothing",
    "steps": ", at least 1",
    "keep": ", at least 1",
    "lr": ", above 0",
}
OPTIONS: dict[str, tuple[float, float, str]] = {  # of a run: least, greatest and what it is
    "severity": (0, 1, "a severity from 0 (clean) to 1 (strongest), as severity=0.6"),
    "severity_depth": (0, 1, "a severity from 0 (clean) to 1 (strongest), or null: as severity"),
    "rollouts": (1, EPISODES, "a number of episodes a step, as rollouts=24"),
    "refresh_episodes": (
        1,
        EPISODES,
        "a number of episodes that a success rate is measured on, as refresh_episodes=8",
    ),
    "workers": (
        0,
        PROCESSES,
        "a number of processes that make batches, 0 for none beside this one, or null for one a "
        "core, 8 at most",
    ),
    "evaluation.workers": (1, PROCESSES, "a number of processes that walk, or null for one a core"),
}


def check(settings: Mapping[str, Any]) -> None:
    """Raise ValueError for one of a trainer's ``settings`` that is out of its range."""
    for name, (low, high) in LIMITS.items():
        value = settings.get(name)
        if value is not None and not in_range(value, low, high):
            raise ValueError(
                f"trainer.{name}={shown(value)} must be a number from {low:g} to {high:g}"
                f"{MEANS.get(name, '')}. Set it on the command line, e.g. trainer.steps=100 "
                "trainer.lr=1e-3."
            )


def check_options(cfg: DictConfig) -> None:
    """Raise ValueError for one of a run's ``OPTIONS`` that is out of its range."""
    for name, (low, high, meaning) in OPTIONS.items():
        value = OmegaConf.select(cfg, name)
        if value is not None and not in_range(value, low, high):
            raise ValueError(
                f"{name}={shown(value)} must be from {low:g} to {high:g}: it is {meaning}."
            )


def check_weights(**weights: float) -> None:
    """Raise ValueError for a weight of a loss that is not from 0 to ``WEIGHT``; 0 leaves the loss
    out."""
    for name, value in weights.items():
        if not in_range(value, 0, WEIGHT):
            raise ValueError(
                f"recipe.{name}={shown(value)} must be a number from 0 to {WEIGHT:g}: it is the "
                "weight of a loss, and 0 leaves that out."
            )


def check_share(name: str, value: float) -> None:
    """Raise ValueError for a share that is not from 0 to 1."""
    if not in_range(value, 0, 1):
        raise ValueError(f"recipe.{name}={shown(value)} must be a share from 0 to 1, as 0.5.")


def in_range(value: float, low: float, high: float) -> bool:
    """Whether ``value`` is a finite number from ``low`` to ``high``."""
    return isinstance(value, Real) and low <= value <= high and math.isfinite(value)


def shown(value: float) -> str:
    """A number as a message has it."""
    if not isinstance(value, Real):
        return short(value)
    huge = isinstance(value, int) and value.bit_length() > 60  # a float may not hold it
    return "..." if huge else format(value, ".6g")
