"""Compute the Performance Retention Score (PRS) of the NavTrust paper."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

# minimum clean SR or SPL for a meaningful PRS (heuristic; random agents reach less than 0.05)
FLOOR = 0.10


def prs(clean: float, corrupted: ArrayLike) -> float:
    """Return the Performance Retention Score: the mean over K of ``corrupted[k] / clean``.

    As in the paper's formula, values are not clipped, so they may exceed 1.

    Args:
        clean: the agent's SR or SPL without corruption.
        corrupted: the SR or SPL under each of K corruptions, shape [K].

    Returns:
        The PRS, or NaN if ``clean`` is 0.
    """
    values = np.asarray(corrupted, float)
    if values.ndim != 1 or not len(values):
        raise ValueError(f"corrupted must hold one value per corruption, got {values.shape}.")
    return float(np.mean(values / clean)) if clean else math.nan
