"""What the settings of a training may be; a slip of the keyboard ends before anything is built."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

COUNT = 10**9  # steps; a training at 1000 a second would take 11 days (ours)
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


def check(settings: Mapping[str, Any]) -> None:
    """Raise ValueError for one of a trainer's ``settings`` that is out of its range."""
    for name, (low, high) in LIMITS.items():
        value = settings.get(name)
        if value is not None and not in_range(value, low, high):
            huge = isinstance(value, int) and value.bit_length() > 60  # a float may not hold it
            shown = "..." if huge else format(value, ".6g")
            raise ValueError(
                f"trainer.{name}={shown} must be a number from {low:g} to {high:g}"
                f"{MEANS.get(name, '')}. Set it on the command line, e.g. trainer.steps=100 "
                "trainer.lr=1e-3."
            )


def in_range(value: float, low: float, high: float) -> bool:
    """Whether ``value`` is a finite number from ``low`` to ``high``."""
    return low <= value <= high and math.isfinite(value)
