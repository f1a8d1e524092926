"""Decide whether a series of measurements grows, based on its slope and the confidence interval of
the slope."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

# fraction of a series that is skipped, because memory grows while caches fill (heuristic)
WARM_UP = 0.25
RESAMPLES = 2000
LEVEL = 0.95
DAY = 24.0  # hours
LIMIT = 0.1  # growth per day, as a fraction of the mean, that counts as growth (heuristic)
MIN_COUNT = 20  # minimum number of measurements for a slope (heuristic)
MIN_HOURS = 0.3  # minimum hours for a result (heuristic)


@dataclass(frozen=True)
class Growth:
    """The slope of a series of measurements.

    Attributes:
        hours: Duration of the series.
        mean: Mean of the values.
        slope: Slope per hour.
        low: Lower end of the slope's 95 % interval.
        high: Upper end of the slope's 95 % interval.
    """

    hours: float
    mean: float
    slope: float
    low: float
    high: float

    @property
    def verdict(self) -> str:
        """Return "grows", "flat" or "too short to say"; the result depends on both ends of the
        interval.
        """
        limit = LIMIT * max(self.mean, 1e-9) / DAY
        if self.hours < MIN_HOURS:  # slow waves look like a slope in a short series
            return "too short to say"
        if self.low > limit:
            return "grows"
        return "flat" if self.high <= limit else "too short to say"


def growth(hours: np.ndarray, values: np.ndarray, seed: int = 0) -> Growth:
    """Return the growth of a series after its first quarter.

    Measurements are correlated in time, so the interval is a percentile interval of a moving-block
    bootstrap of the residuals (Kuensch 1989). The block length is about the square root of N.

    Args:
        hours: Times [N].
        values: Measurements [N].
        seed: Seed of the bootstrap.

    Raises:
        ValueError: There are fewer than ``MIN_COUNT`` measurements.
    """
    used = hours >= hours[0] + WARM_UP * (hours[-1] - hours[0]) if len(hours) else np.zeros(0, bool)
    x = np.asarray(hours, float)[used]
    y = np.asarray(values, float)[used]
    if len(x) < MIN_COUNT:
        raise ValueError(
            f"A slope needs >= {MIN_COUNT} measurements after the first quarter, got {len(x)}. "
            "Run longer, or measure more often."
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
