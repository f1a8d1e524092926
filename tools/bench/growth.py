"""Whether a series of measurements grows: its slope with an interval, and a verdict."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

WARM = 0.25  # share of a series that is left out: what is built up once (ours)
RESAMPLES = 2000
LEVEL = 0.95
DAY = 24.0  # hours
MUCH = 0.1  # of the mean, in a day: what counts as growth (ours)
LEAST, SHORTEST = 20, 0.3  # measurements that a slope needs; hours that a verdict needs (ours)


@dataclass(frozen=True)
class Growth:
    """Mean of a series of so many ``hours``, and its slope an hour with a 95 % interval (``low``,
    ``high``)."""

    hours: float
    mean: float
    slope: float
    low: float
    high: float

    @property
    def verdict(self) -> str:
        """ "grows" and "flat" by what a day at either end of the interval would add; else the
        series is too short to say."""
        much = MUCH * max(self.mean, 1e-9) / DAY
        if self.hours < SHORTEST:  # slow waves look like slopes there
            return "too short to say"
        if self.low > much:
            return "grows"
        return "flat" if self.high <= much else "too short to say"


def growth(hours: np.ndarray, values: np.ndarray, seed: int = 0) -> Growth:
    """The growth of ``values`` [N] measured at ``hours`` [N], after the first ``WARM`` of them.

    The interval is a percentile interval of the residuals' moving-block bootstrap (Kuensch 1989),
    with blocks of about the square root of N, since measurements follow each other closely.
    Raises ValueError for fewer than ``LEAST``.
    """
    kept = hours >= hours[0] + WARM * (hours[-1] - hours[0]) if len(hours) else np.zeros(0, bool)
    x, y = np.asarray(hours, float)[kept], np.asarray(values, float)[kept]
    if len(x) < LEAST:
        raise ValueError(
            f"{len(x)} measurements after the first quarter are too few for a slope ({LEAST}): run "
            "longer, or measure more often."
        )
    centred = x - x.mean()
    slope = float(centred @ y / (centred @ centred))
    residual = y - y.mean() - slope * centred
    size = max(2, round(len(x) ** 0.5))
    rng = np.random.default_rng(seed)
    starts = rng.integers(0, len(x) - size + 1, (RESAMPLES, -(-len(x) // size)))
    drawn = (starts[..., None] + np.arange(size)).reshape(RESAMPLES, -1)[:, : len(x)]
    noise = residual[drawn]
    slopes = slope + noise @ centred / (centred @ centred)
    low, high = np.quantile(slopes, [(1 - LEVEL) / 2, (1 + LEVEL) / 2])
    return Growth(float(x[-1] - x[0]), float(y.mean()), slope, float(low), float(high))
