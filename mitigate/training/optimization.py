"""Set up AdamW for the trained parameters, and the schedule of its learning rate."""

from __future__ import annotations

import math
from typing import Any

from torch.optim import AdamW
from torch.optim.lr_scheduler import LambdaLR


def adamw(groups: list[dict[str, Any]], name: str, lr: float, weight_decay: float) -> AdamW:
    """Return an AdamW optimizer of the parameters in ``groups`` that are not frozen.

    Args:
        groups: parameter groups, which may set ``lr`` and ``weight_decay``.
        name: name of the stage, used in the error message.
        lr: learning rate of groups that do not set ``lr``.
        weight_decay: weight decay of groups that do not set ``weight_decay``.

    Raises:
        ValueError: If every parameter is frozen.
    """
    trained = [{**g, "params": [p for p in g["params"] if p.requires_grad]} for g in groups]
    trained = [group for group in trained if group["params"]]
    if not trained:
        raise ValueError(
            f"{name} has nothing to train: every parameter is frozen. Unfreeze a part of the agent."
        )
    return AdamW(trained, lr=lr, weight_decay=weight_decay)


def scheduler(optimizer: AdamW, steps: int, warmup: int) -> LambdaLR:
    """Return the schedule of the learning rate.

    The learning rate rises from 0 during ``warmup`` updates. It then follows a cosine, and is 0
    after ``steps`` updates.
    """
    return LambdaLR(optimizer, lambda step: _rate(step, steps, warmup))


def _rate(step: int, steps: int, warmup: int) -> float:
    """Return the factor by which the learning rate is multiplied at update ``step`` (counted from
    0).
    """
    if step < warmup:
        return (step + 1) / (warmup + 1)
    share = min(1.0, (step - warmup) / max(1, steps - warmup))
    return 0.5 * (1.0 + math.cos(math.pi * share))
