"""Whether depth can be metres."""

from __future__ import annotations

import numpy as np

FARTHEST = 100.0  # metres: half of an indoor frame's readings are nearer (ours)


def check_metres(depth: np.ndarray, whose: str, fix: str) -> None:
    """Raise ValueError, with ``fix`` behind it, for ``depth`` (0: no reading) of ``whose`` frames
    half of the readings are farther than ``FARTHEST``."""
    known = depth[depth > 0]
    if len(known) and float(np.median(known)) > FARTHEST:
        middle = np.median(known)
        raise ValueError(
            f"Half of {whose} is farther than {middle:.0f} m: that is not metres. {fix}"
        )
