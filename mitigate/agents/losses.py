"""Losses and figures of what encoders are taught: what shows in a view, where one can go."""

from __future__ import annotations

import torch
import torch.nn.functional as F
from torch import Tensor

POSITIVE = 2.0  # weight of what is there against what is not: most concepts are not


def presence_loss(logits: Tensor, truth: Tensor) -> Tensor:
    """Mean binary cross-entropy of logits against labels in {0, 1} of the same shape."""
    return F.binary_cross_entropy_with_logits(
        logits.float(), truth, pos_weight=torch.tensor(POSITIVE, device=logits.device)
    )


def f1(logits: Tensor, targets: Tensor) -> Tensor:
    """Micro F1 at probability 0.5."""
    predicted, true = logits > 0, targets > 0.5
    return 2 * (predicted & true).sum() / torch.clamp(predicted.sum() + true.sum(), min=1)


def free_loss(logits: Tensor, target: Tensor) -> Tensor:
    """Mean binary cross-entropy of logits ``[..., directions, distances]`` of free space."""
    return F.binary_cross_entropy_with_logits(logits.float(), target)


def agreement(logits: Tensor, target: Tensor) -> Tensor:
    """Intersection over union of predicted and true free cells."""
    predicted, true = logits > 0, target > 0.5
    return (predicted & true).sum() / torch.clamp((predicted | true).sum(), min=1)
