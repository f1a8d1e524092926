"""Reliability-weighted fusion of the views of a panorama (the paper's section on adapters)."""

from __future__ import annotations

import torch
from torch import Tensor

RATE = 4.0  # k: decay for each relative deviation of 1 (ours, chosen on val_seen)
CAP = 3.0  # largest exponent: no view weighs less than exp(-3) = 0.05 of a typical one (ours)
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


def fuse(
    views: Tensor, rate: float = RATE, cap: float = CAP, valid: Tensor | None = None
) -> tuple[Tensor, Tensor]:
    """Weighted average of views ``[..., V, F]``: (fused ``[..., F]``, weights ``[..., V]``).

    Arguments and errors as :func:`reliability`; ``rate = 0`` is the plain mean.
    """
    weights = reliability(views, rate, cap, valid)
    return (views * weights.unsqueeze(-1)).sum(-2), weights
