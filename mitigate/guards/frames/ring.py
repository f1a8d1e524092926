"""What the views of a panorama say of each other: where they disagree, and what one has lost.

The views share one centre and overlap, so up to four others show a point that a view should show.
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

STEPS = (1, 2)  # views away that still overlap: of 90 degrees, 30 and 60 apart
SURE = 0.05  # of trust squared at which what the neighbours show is half believed (ours)
FAINT = 0.02  # weight of the coarser level where a hole is filled from around it (ours)


@lru_cache(maxsize=8)
@torch.inference_mode(False)  # what is kept serves training, too
def neighbours(size: int) -> tuple[Tensor, Tensor]:
    """Of the views at -1, +1, -2 and +2 steps: ``grid`` [4, size, size, 2] as ``neighbour_grid``,
    and ``ahead`` [4, size, size]: metres along the neighbour's axis for one along the own."""
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
    """Whether frames are a panorama of 12 square views, whose geometry is known."""
    return views == VIEWS and height == width


def compared(values: Tensor, valid: Tensor, depth: bool) -> tuple[Tensor, Tensor, Tensor]:
    """The least and the greatest of what the other views of each panorama show of every pixel.

    A direction is seen by three views or more, so whoever lies outside of the two is alone with it.

    Args: values float [P * 12, c, s, s] in [0, 1], of depth along each view's axis. valid
    [P * 12, 1, s, s]: which of them are a reading.
    Returns least, greatest [P * 12, c, s, s], the values themselves where no other view has a
    reading, and whether one has, [P * 12, 1, s, s] in 0 and 1.
    """
    low, high = torch.full_like(values, torch.inf), torch.full_like(values, -torch.inf)
    for value, sure, scale in _turned(values * valid, valid):
        shown = (value / sure.clamp(min=0.5) / (scale if depth else 1.0)).clamp(max=1)
        low = torch.where(sure > 0.5, torch.minimum(low, shown), low)
        high = torch.where(sure > 0.5, torch.maximum(high, shown), high)
    seen = torch.isfinite(low)
    return torch.where(seen, low, values), torch.where(seen, high, values), seen[:, :1].float()


def _turned(values: Tensor, weights: Tensor) -> Iterator[tuple[Tensor, Tensor, Tensor]]:
    """Of each neighbour, in the view's own frame: its ``values`` [P * 12, c, s, s]; how much they
    count, ``weights`` [P * 12, 1 or c, s, s]; the metres along its axis for one along the own."""
    grid, ahead = (part.to(values.device) for part in neighbours(values.shape[-1]))
    parts = [values.shape[1], weights.shape[1]]
    ring = torch.cat([values, weights], 1).unflatten(0, (-1, VIEWS))
    shifts = [sign * step for step in STEPS for sign in (1, -1)]
    for shift, turned, scale in zip(shifts, grid, ahead, strict=True):
        rolled = ring.roll(shift, 1).flatten(0, 1)
        seen = F.grid_sample(rolled, turned.expand(len(rolled), -1, -1, -1), align_corners=False)
        yield *seen.split(parts, 1), scale


def from_neighbours(values: Tensor, trust: Tensor, depth: bool) -> tuple[Tensor, Tensor]:
    """What the other views of each panorama say of every pixel.

    Args: values float [P * 12, c, s, s]: colours, or (``depth``) metres along each view's axis over
    anything. trust [P * 12, 1 or c, s, s] in [0, 1]: which of them are to be believed.
    Returns their mean [P * 12, c, s, s] and how sure it is, as ``trust`` in [0, 1).
    """
    total = torch.zeros_like(values)
    weight = torch.zeros_like(trust)
    for value, sure, scale in _turned(values * trust, trust):
        total = total + value * sure / (scale if depth else 1.0)
        weight = weight + sure.square()
    return total / (weight + 1e-4), weight / (weight + SURE)


def from_around(values: Tensor, trust: Tensor) -> Tensor:
    """``values`` [n, c, h, w] where ``trust`` [n, 1 or c, h, w] is 1, and elsewhere the mean of
    what is trusted around, the nearer the more: a pyramid of halvings, filled from its top."""
    sums, weights = [values * trust], [trust]
    while min(sums[-1].shape[-2:]) > 1:
        sums.append(F.avg_pool2d(sums[-1], 2, ceil_mode=True, count_include_pad=False))
        weights.append(F.avg_pool2d(weights[-1], 2, ceil_mode=True, count_include_pad=False))
    filled = sums[-1].mean((2, 3), keepdim=True) / (weights[-1].mean((2, 3), keepdim=True) + 1e-4)
    for total, weight in zip(reversed(sums), reversed(weights), strict=True):
        coarser = F.interpolate(filled, total.shape[-2:], mode="nearest")
        filled = (total + FAINT * coarser) / (weight + FAINT)
    return filled
