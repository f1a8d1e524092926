"""Compute the Performance Retention Score (PRS) of the NavTrust paper."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

FLOOR = 0.10  # minimum clean SR or SPL for a meaningful PRS (heuristic; random walks have < 0.05)


def prs(clean: float, corrupted: ArrayLike) -> float:
    """Return the Performance Retention Score: the mean over K of ``corrupted[k] / clean``.

    The definition is the paper's; nothing is clipped.

    Args:
        clean: the agent's SR or SPL without corruption.
        corrupted: [K], the SR or SPL under each corruption.

    Returns:
        The PRS, or NaN if ``clean`` is 0.
    """
    values = np.asarray(corrupted, float)
    if values.ndim != 1 or not len(values):
        raise ValueError(f"corrupted must hold one value per corruption, got {values.shape}.")
    return float(np.mean(values / clean)) if clean else math.nan
