"""Define what policies return for a batch of frames, and losses between two such answers."""

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

# torchrl's OneHotCategorical is a subclass of Categorical
DISCRETE = (Categorical, OneHotCategorical)
# one distribution per part of the action, or a tensor [B, ...] of actions or of action values
Answer = Sequence[Distribution] | Tensor


def mode(distribution: Any) -> Tensor:
    """Return the most probable value of a distribution, [B, ...]."""
    if isinstance(distribution, DISCRETE):
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

    For distributions, the difference is the KL divergence KL(teacher || student), summed over the
    parts of an action. For actions or action values without a distribution, it is the squared error
    divided by the variance of the teacher's answers over the batch.
    """
    if isinstance(teacher, Tensor) or isinstance(student, Tensor):
        assert isinstance(teacher, Tensor) and isinstance(student, Tensor)
        error = (student.float() - teacher.float()).square().mean()
        return error / teacher.float().var(0).mean().clamp(min=1e-6)
    total = torch.zeros((), device=student[0].sample().device)
    for one, other in zip(teacher, student, strict=True):
        try:
            kl = _divergence(_base(one), _base(other))
        except NotImplementedError:
            # raised, for example, if a fixed action is represented as a distribution
            return divergence(
                torch.cat([mode(t) for t in teacher], -1), torch.cat([mode(s) for s in student], -1)
            )
        total = total + kl.flatten(1).sum(1).mean() if kl.dim() > 1 else total + kl.mean()
    return total


def imitation(teacher: Answer, student: Answer) -> Tensor:
    """Return the student's mean error in predicting the teacher's most likely action.

    For discrete actions, the error is the cross-entropy. For continuous actions, and for values
    without a distribution, it is the squared error divided by the variance of the teacher's answers
    over the batch. Unlike the KL divergence, this error also counts differences where the teacher
    is undecided: if the teacher's two best actions have probabilities of 0.50 and 0.48, a student
    that swaps these probabilities acts differently.
    """
    if isinstance(teacher, Tensor) or isinstance(student, Tensor):
        return divergence(teacher, student)
    losses = []
    for one, other in zip(teacher, student, strict=True):
        action = mode(one)
        if isinstance(other, DISCRETE):
            loss = F.cross_entropy(other.logits.flatten(0, -2), action.flatten())
        else:
            loss = divergence(action, mode(other))
        losses.append(loss)
    return torch.stack(losses).sum()


def _divergence(one: Distribution, other: Distribution) -> Tensor:
    """Return KL(one || other), [B, ...]."""
    # for discrete actions, torch's function gives infinity if a probability is rounded to 0
    if isinstance(one, DISCRETE) and isinstance(other, DISCRETE):
        each = one.probs * (one.logits - other.logits)
        return torch.where(one.probs == 0, 0.0, each).sum(-1)
    return kl_divergence(one, other)


def _base(distribution: Any) -> Distribution:
    """Remove bijective transforms, because they do not change the divergence."""
    while isinstance(distribution, (Independent, TransformedDistribution)):
        distribution = distribution.base_dist
    return distribution


def parts(distributions: Any) -> list[Distribution]:
    """Return one distribution per part of an action."""
    return list(distributions) if isinstance(distributions, (list, tuple)) else [distributions]
