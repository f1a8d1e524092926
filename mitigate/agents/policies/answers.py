"""What a policy answers for a batch of frames, and how two answers are compared."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import torch
import torch.nn.functional as F
from torch import Tensor
from torch.distributions import (
    Categorical,
    Distribution,
    Independent,
    OneHotCategorical,
    TransformedDistribution,
    kl_divergence,
)

# Either one distribution per part of the action, or actions or action values [B, ...]
Answer = Sequence[Distribution] | Tensor


def mode(distribution: Any) -> Tensor:
    """Return the most probable value of a distribution, [B, ...]."""
    if isinstance(distribution, (Categorical, OneHotCategorical)):
        return distribution.logits.argmax(-1)
    if isinstance(distribution, Independent):
        return mode(distribution.base_dist)
    if isinstance(distribution, TransformedDistribution):
        value = mode(distribution.base_dist)
        for transform in distribution.transforms:
            value = transform(value)
        return value
    return distribution.mode


def divergence(teacher: Answer, student: Answer) -> Tensor:
    """Return the mean difference over the batch between the student's and the teacher's answers.

    For distributions it is the KL divergence KL(teacher || student), summed over the parts of an
    action. For plain actions or values it is the squared error divided by the teacher's variance
    over the batch.
    """
    if isinstance(teacher, Tensor) or isinstance(student, Tensor):
        assert isinstance(teacher, Tensor) and isinstance(student, Tensor)
        error = (student.float() - teacher.float()).square().mean()
        return error / teacher.float().var(0).mean().clamp(min=1e-6)
    total = torch.zeros((), device=student[0].sample().device)
    for one, other in zip(teacher, student, strict=True):
        try:
            kl = kl_divergence(_base(one), _base(other))
        except NotImplementedError:  # such as a fixed action given as a distribution
            return divergence(
                torch.cat([mode(t) for t in teacher], -1), torch.cat([mode(s) for s in student], -1)
            )
        total = total + kl.flatten(1).sum(1).mean() if kl.dim() > 1 else total + kl.mean()
    return total


def imitation(teacher: Answer, student: Answer) -> Tensor:
    """Return how badly the student predicts the teacher's likeliest action, mean over the batch.

    Cross-entropy for discrete actions. For continuous actions, and for values without a
    distribution, the squared error divided by the teacher's variance over the batch. Unlike the KL
    divergence, it matters where the teacher is undecided: a policy whose two best actions have
    probabilities of 0.50 and 0.48 acts differently if these change places.
    """
    if isinstance(teacher, Tensor) or isinstance(student, Tensor):
        return divergence(teacher, student)
    losses = []
    for one, other in zip(teacher, student, strict=True):
        action = mode(one)
        if isinstance(other, (Categorical, OneHotCategorical)):
            loss = F.cross_entropy(other.logits.flatten(0, -2), action.flatten())
        else:
            loss = divergence(action, mode(other))
        losses.append(loss)
    return torch.stack(losses).sum()


def _base(distribution: Any) -> Distribution:
    """Remove bijective transforms from a distribution, which do not change the divergence."""
    while isinstance(distribution, (Independent, TransformedDistribution)):
        distribution = distribution.base_dist
    return distribution


def parts(distributions: Any) -> list[Distribution]:
    """Return the distributions of the parts of an action."""
    return list(distributions) if isinstance(distributions, (list, tuple)) else [distributions]
