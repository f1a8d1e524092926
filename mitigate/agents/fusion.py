"""Reliability-weighted fusion of the views of a panorama (the paper's section on adapters), by its
rule of feature magnitudes or by a score that is learned."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import torch
from torch import Tensor, nn

RATE = 4.0  # k: decay for each relative deviation of 1 (ours, chosen on val_seen)
CAP = 3.0  # largest exponent: no view weighs less than exp(-3) = 0.05 of a typical one (ours)
HIDDEN = 32  # width of the layer that a learned score reads with (ours)
_TINY = 1e-6


def reliability(
    views: Tensor, rate: float = RATE, cap: float = CAP, valid: Tensor | None = None
) -> Tensor:
    """Weights of views from how far their magnitude is from the panorama's.

    With m_v = |f_v| (Euclidean) and M = mean of m_v over the valid views,

        d_v = | m_v - M | / M,     w_v = exp(-min(rate * d_v, cap)) / sum over valid views.

    Args:
        views: features ``[..., V, F]``. rate, cap: k and cap, both >= 0. valid: bool ``[..., V]``;
            views that do not count.
    Returns weights ``[..., V]`` that add up to 1. If every view is blank (M = 0) or none is valid,
    nothing tells them apart and the weights are equal.
    Raises ValueError for a negative rate or cap.
    """
    if rate < 0 or cap < 0:
        raise ValueError(f"rate ({rate}) and cap ({cap}) of the reliability must be at least 0.")
    counts = torch.ones_like(views[..., 0]) if valid is None else valid.to(views.dtype)
    counts = torch.where(counts.sum(-1, keepdim=True) > 0, counts, torch.ones_like(counts))
    size = views.norm(dim=-1)
    mean = (size * counts).sum(-1, keepdim=True) / counts.sum(-1, keepdim=True)
    deviation = (size - mean).abs() / mean.clamp(min=_TINY)
    weights = torch.exp(-(rate * deviation).clamp(max=cap)) * counts
    return weights / weights.sum(-1, keepdim=True)


class LearnedReliability(nn.Module):
    """Weights of views by a learned score of their features and of how these differ from the
    panorama's:

        w_v = softmax over views of cap * tanh(score([f_v, f_v - mean f])).

    ``score`` starts at zero: all views weigh the same until it has learned, by whatever loss trains
    what the views are fused for. Args: width: F. cap: >= 0, so that no two weights differ by more
    than exp(2 cap). Raises ValueError for a negative cap.

    Source: ours; the paper's rule reads one number of a view, its magnitude.
    """

    def __init__(self, width: int, cap: float = CAP) -> None:
        super().__init__()
        if cap < 0:
            raise ValueError(f"cap ({cap}) of the reliability must be at least 0.")
        self.cap = cap
        self.norm = nn.LayerNorm(2 * width)
        self.hidden, self.score = nn.Linear(2 * width, HIDDEN), nn.Linear(HIDDEN, 1)
        nn.init.zeros_(self.score.weight)
        nn.init.zeros_(self.score.bias)

    def forward(self, views: Tensor) -> Tensor:
        """Features ``[..., V, F]`` to weights ``[..., V]`` that add up to 1."""
        x = self.norm(torch.cat([views, views - views.mean(-2, keepdim=True)], -1))
        score = self.score(nn.functional.gelu(self.hidden(x))).squeeze(-1)
        return (self.cap * score.float().tanh()).softmax(-1)


def weigher(
    width: int, *, learned: bool = False, rate: float | None = None, cap: float = CAP
) -> Callable[[Tensor], Tensor]:
    """What gives the weights of views with features of ``width`` numbers: :func:`reliability`, or,
    ``learned``, a :class:`LearnedReliability`. Raises ValueError for a rate of a learned one."""
    if learned and rate is not None:
        raise ValueError(
            f"rate={rate} belongs to the rule of magnitudes; a learned reliability has a cap alone."
        )
    if learned:
        return LearnedReliability(width, cap)
    return partial(reliability, rate=RATE if rate is None else rate, cap=cap)
