"""Weight the views of a panorama by their reliability, as in the NavTrust paper.

The weights are computed by the paper's rule on feature magnitudes or by a learned score.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import torch
from torch import Tensor, nn

# how fast a view's weight falls as the view deviates from the mean (chosen on val_seen)
RATE = 4.0
# largest exponent (heuristic); the weight is at least exp(-3) = 0.05 times that of a typical view
CAP = 3.0
HIDDEN = 32  # width of the hidden layer of the learned score (heuristic)
_TINY = 1e-6


def reliability(views: Tensor, rate: float = RATE, cap: float = CAP) -> Tensor:
    """Return the weights of views; a feature magnitude far from the mean gives a lower weight.

    In the formulas, m_v = |f_v| is the Euclidean norm of a view's features, and M is the mean of
    m_v over the views:

        d_v = | m_v - M | / M,     w_v = exp(-min(rate * d_v, cap)) / sum over the views.

    Args:
        views: features ``[..., V, F]``.
        rate: the decay rate, >= 0.
        cap: the largest exponent, >= 0.

    Returns:
        Weights ``[..., V]`` that sum to 1. All weights are equal if every view is blank (M = 0).

    Raises:
        ValueError: If ``rate`` or ``cap`` is negative.
    """
    if rate < 0 or cap < 0:
        raise ValueError(f"reliability rate and cap must be >= 0, got {rate} and {cap}.")
    size = views.norm(dim=-1)
    mean = size.sum(-1, keepdim=True) / size.shape[-1]
    deviation = (size - mean).abs() / mean.clamp(min=_TINY)
    weights = torch.exp(-(rate * deviation).clamp(max=cap))
    return weights / weights.sum(-1, keepdim=True)


class LearnedReliability(nn.Module):
    """Weight views by a learned score of their features and of the features' deviation from the
    mean.

        w_v = softmax over views of cap * tanh(score([f_v, f_v - mean f])).

    ``score`` is initialised to zero, so all weights are equal before training. ``score`` is trained
    together with the agent.

    Args:
        width: number of features F.
        cap: must be >= 0; the weights of two views differ at most by a factor of exp(2 cap).

    Raises:
        ValueError: If ``cap`` is negative.

    Source: this project. The paper's rule differs from this score: it uses only the magnitude of a
    view's features.
    """

    def __init__(self, width: int, cap: float = CAP) -> None:
        super().__init__()
        if cap < 0:
            raise ValueError(f"reliability cap must be >= 0, got {cap}.")
        self.cap = cap
        self.norm = nn.LayerNorm(2 * width)
        self.hidden, self.score = nn.Linear(2 * width, HIDDEN), nn.Linear(HIDDEN, 1)
        nn.init.zeros_(self.score.weight)
        nn.init.zeros_(self.score.bias)

    def forward(self, views: Tensor) -> Tensor:
        """Return weights ``[..., V]`` that sum to 1, for features ``[..., V, F]``."""
        x = self.norm(torch.cat([views, views - views.mean(-2, keepdim=True)], -1))
        score = self.score(nn.functional.gelu(self.hidden(x))).squeeze(-1)
        return (self.cap * score.float().tanh()).softmax(-1)


def weigher(
    width: int, *, learned: bool = False, rate: float | None = None, cap: float = CAP
) -> Callable[[Tensor], Tensor]:
    """Return a function that computes one weight per view from the view's ``width`` features.

    The function is :func:`reliability`, or a :class:`LearnedReliability` if ``learned`` is set.

    Raises:
        ValueError: If ``learned`` and ``rate`` are both set.
    """
    if learned and rate is not None:
        raise ValueError(
            f"rate must be null if the reliability is learned, got {rate}. Leave out rate; cap may "
            "be set."
        )
    if learned:
        return LearnedReliability(width, cap)
    return partial(reliability, rate=RATE if rate is None else rate, cap=cap)
