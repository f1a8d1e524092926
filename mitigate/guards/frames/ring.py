"""Compare the overlapping views of a panorama, and fill pixels of a view from other views.

All views have the same optical centre. Each point is visible in up to four other views.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import lru_cache

import torch
import torch.nn.functional as F
from torch import Tensor

from mitigate.agents.adapter_layers import neighbour_grid
from mitigate.core.observation import HFOV_DEGREES, VIEW_STEP_DEGREES, VIEWS

# a 90-degree view overlaps with the views that are 1 and 2 steps (30 and 60 degrees) away
STEPS = (1, 2)
# sum of the neighbours' squared weights at which their mean has a confidence of 1/2 (heuristic)
SURE = 0.05
# weight of the coarser level if a hole is filled from the pixels around it (heuristic)
FAINT = 0.02


@lru_cache(maxsize=8)
@torch.inference_mode(False)  # inference mode is off, because training also uses the cached tensors
def neighbours(size: int) -> tuple[Tensor, Tensor]:
    """Return the geometry of the neighbouring views at -1, +1, -2 and +2 steps.

    Returns:
        ``grid`` [4, size, size, 2] as in ``neighbour_grid``, and ``ahead`` [4, size, size], the
        ratio of a point's depth along the neighbour's axis to its depth along the view's own axis.
    """
    half = math.tan(math.radians(HFOV_DEGREES) / 2)
    x = ((torch.arange(size) + 0.5) / size * 2 - 1) * half
    grids, aheads = [], []
    for step in STEPS:
        grids.append(neighbour_grid(size, size, step * VIEW_STEP_DEGREES, HFOV_DEGREES))
        for sign in (-1, 1):
            angle = math.radians(sign * step * VIEW_STEP_DEGREES)
            ahead = x * math.sin(angle) + math.cos(angle)
            aheads.append(ahead.clamp(min=1e-3).expand(size, size))
    return torch.cat(grids), torch.stack(aheads)


def is_ring(views: int, height: int, width: int) -> bool:
    """Return whether frames form a panorama of 12 square views.

    Views can be compared only in such a panorama, because its geometry is known.
    """
    return views == VIEWS and height == width


def compared(values: Tensor, valid: Tensor, depth: bool) -> tuple[Tensor, Tensor, Tensor]:
    """Return the smallest and the largest value that other views show at every pixel.

    At least three views show each direction. A value outside this range contradicts other views.

    Args:
        values: float [P * 12, c, s, s] in [0, 1]. Depth is measured along the axis of each view.
        valid: mask [P * 12, 1, s, s] with 1 for valid pixels.
        depth: whether ``values`` is depth.

    Returns:
        The smallest and the largest values [P * 12, c, s, s], and a mask [P * 12, 1, s, s]. The
        mask is 1 where another view has a valid pixel; elsewhere, both values equal ``values``.
    """
    low, high = torch.full_like(values, torch.inf), torch.full_like(values, -torch.inf)
    for value, weight, scale in _turned(values * valid, valid):
        other = (value / weight.clamp(min=0.5) / (scale if depth else 1.0)).clamp(max=1)
        low = torch.where(weight > 0.5, torch.minimum(low, other), low)
        high = torch.where(weight > 0.5, torch.maximum(high, other), high)
    has_reading = torch.isfinite(low)
    return (
        torch.where(has_reading, low, values),
        torch.where(has_reading, high, values),
        has_reading[:, :1].float(),
    )


def _turned(values: Tensor, weights: Tensor) -> Iterator[tuple[Tensor, Tensor, Tensor]]:
    """Yield each neighbour's values and weights, resampled into the view, and its depth scale.

    The values have shape [P * 12, c, s, s], and the weights [P * 12, 1 or c, s, s]. The depth scale
    [s, s] is the array ``ahead`` that :func:`neighbours` returns.
    """
    grid, ahead = (part.to(values.device) for part in neighbours(values.shape[-1]))
    parts = [values.shape[1], weights.shape[1]]
    ring = torch.cat([values, weights], 1).unflatten(0, (-1, VIEWS))
    shifts = [sign * step for step in STEPS for sign in (1, -1)]
    for shift, resampling, scale in zip(shifts, grid, ahead, strict=True):
        rolled = ring.roll(shift, 1).flatten(0, 1)
        neighbour = F.grid_sample(
            rolled, resampling.expand(len(rolled), -1, -1, -1), align_corners=False
        )
        yield *neighbour.split(parts, 1), scale


def from_neighbours(values: Tensor, trust: Tensor, depth: bool) -> tuple[Tensor, Tensor]:
    """Return the weighted mean of the values that other views show at every pixel.

    Args:
        values: float [P * 12, c, s, s]. The values are colours, or depth along the axis of each
            view in any unit.
        trust: the weights in [0, 1], with shape [P * 12, 1 or c, s, s].
        depth: whether ``values`` is depth.

    Returns:
        The mean [P * 12, c, s, s] and its confidence in [0, 1). The confidence has the shape of
        ``trust``.
    """
    total = torch.zeros_like(values)
    weight = torch.zeros_like(trust)
    for value, confidence, scale in _turned(values * trust, trust):
        total = total + value * confidence / (scale if depth else 1.0)
        weight = weight + confidence.square()
    return total / (weight + 1e-4), weight / (weight + SURE)


def from_around(values: Tensor, trust: Tensor) -> Tensor:
    """Fill untrusted pixels from trusted pixels around them; nearer pixels have more weight.

    The frame is halved repeatedly, and pixels are filled starting from the coarsest level.

    Args:
        values: float [n, c, h, w].
        trust: weights [n, 1 or c, h, w] in [0, 1]. Pixels with the weight 1 keep their values.
    """
    sums, weights = [values * trust], [trust]
    while min(sums[-1].shape[-2:]) > 1:
        sums.append(F.avg_pool2d(sums[-1], 2, ceil_mode=True, count_include_pad=False))
        weights.append(F.avg_pool2d(weights[-1], 2, ceil_mode=True, count_include_pad=False))
    filled = sums[-1].mean((2, 3), keepdim=True) / (weights[-1].mean((2, 3), keepdim=True) + 1e-4)
    for total, weight in zip(reversed(sums), reversed(weights), strict=True):
        coarser = F.interpolate(filled, total.shape[-2:], mode="nearest")
        filled = (total + FAINT * coarser) / (weight + FAINT)
    return filled
