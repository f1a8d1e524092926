"""The paper's Performance Retention Score (PRS)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

FLOOR = 0.10  # a clean SR or SPL below it makes a PRS meaningless (ours; random walks get < 0.05)


def prs(clean: float, corrupted: ArrayLike) -> float:
    """Return the Performance Retention Score: the mean over K of ``corrupted[k] / clean``.

    ``clean`` is the agent's own SR or SPL without corruption, ``corrupted`` [K] the same under
    each corruption, as the paper defines it; nothing is clipped. NaN if ``clean`` is 0.
    """
    values = np.asarray(corrupted, float)
    if values.ndim != 1 or not len(values):
        raise ValueError(f"PRS needs one value a corruption, at least one; got {values.shape}.")
    return float(np.mean(values / clean)) if clean else math.nan
