"""The paper's Performance Retention Score (PRS)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

FLOOR = 0.10  # a PRS is meaningless for a lower clean SR or SPL (heuristic; random walks: < 0.05)


def prs(clean: float, corrupted: ArrayLike) -> float:
    """Return the Performance Retention Score: the mean over K of ``corrupted[k] / clean``.

    The definition is the paper's; nothing is clipped.

    Args:
        clean: the agent's SR or SPL without corruption.
        corrupted: [K], the same under each corruption.

    Returns:
        The PRS; NaN if ``clean`` is 0.
    """
    values = np.asarray(corrupted, float)
    if values.ndim != 1 or not len(values):
        raise ValueError(f"corrupted must hold one value per corruption, got {values.shape}.")
    return float(np.mean(values / clean)) if clean else math.nan
