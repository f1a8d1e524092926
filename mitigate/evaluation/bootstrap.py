"""Compute intervals for SR, SPL, PRS and PRS differences by a paired bootstrap over scenes or
episodes.

Values have the shape ``[..., N]``, with one column per episode. All conditions and agents use the
same resamples, so that the difficulty of an episode cancels in differences. If an episode was run
with several seeds, the caller must average over the seeds. Episodes in one scene are similar, so
intervals that also hold for new scenes are wider. For such intervals, ``units`` [N] contains the
number of each episode's scene, and the episodes of a scene are resampled together (cluster
bootstrap: Davison and Hinkley 1997, section 3.8). Without ``units``, each episode is resampled.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from mitigate.evaluation import metrics

RESAMPLES = 10_000
LEVEL = 0.95
Z = 1.959964  # quantile of the normal distribution at LEVEL
_BOUNDS = ((1 - LEVEL) / 2, (1 + LEVEL) / 2)
ROUNDING = 1e-9  # tolerance for the equality of resamples (heuristic)
NO_INTERVAL = "[–]"
NO_WIDTH = f"{NO_INTERVAL}: no interval, as no resample differs (only one episode, or all equal)."
CHUNK = 1 << 20  # number of indices per block of resamples (heuristic); a block takes 8 MiB
# number of entries per matrix product (heuristic); 128 KiB of float64 fit into a core's cache
PART = 1 << 14


@dataclass(frozen=True)
class Estimate:
    """A value with its percentile interval.

    The interval is undefined if its bounds are NaN or equal. This happens with a single episode, or
    if all resamples are equal.
    """

    value: float
    low: float
    high: float

    @property
    def excludes_zero(self) -> bool:
        """Whether the interval is entirely above or below zero."""
        return self.has_width and (self.low > 0 or self.high < 0)

    @property
    def has_width(self) -> bool:
        """Whether the interval is defined."""
        return self.high - self.low > ROUNDING

    def text(self, form: str, scale: float = 1.0) -> str:
        """Return the value and its interval as text."""
        return f"{scale * self.value:{form}} {self.interval(form, scale)}"

    def interval(self, form: str, scale: float = 1.0) -> str:
        """Return the interval as text; its bounds are multiplied by ``scale`` and formatted with
        ``form``.

        If the interval is undefined, the text is ``NO_INTERVAL``.
        """
        if not self.has_width:
            return NO_INTERVAL
        return f"[{scale * self.low:{form}}, {scale * self.high:{form}}]"


def resampled_means(
    values: ArrayLike,
    *,
    resamples: int = RESAMPLES,
    seed: int = 0,
    units: ArrayLike | None = None,
) -> np.ndarray:
    """Return, for each resample of the episodes, the mean of each row of ``values`` [C, N]: float64
    [resamples, C].

    The resamples depend only on the number of units and on ``seed``, so calls with the same
    episodes use the same resamples.

    Args:
        values: array [C, N] or [N].
        resamples: number of resamples.
        seed: seed of the resampling.
        units: one number per episode [N]; episodes with the same number form one unit, which is
            resampled as a whole. If None, each episode is a unit.

    Raises:
        ValueError: If there are no values, or some values are not finite.
    """
    table = np.atleast_2d(np.asarray(values, float))
    if table.ndim != 2 or not table.size or not np.isfinite(table).all():
        raise ValueError(
            f"values must be a finite array [conditions, episodes], got the shape {table.shape} "
            f"with {int(np.isnan(table).sum())} NaN. Leave out the episodes that lack a result."
        )
    count = table.shape[1]
    unit = np.arange(count) if units is None else np.asarray(units)
    if (np.diff(unit) > 0).all():  # each episode is a unit, so all resamples have equal size
        return _sums(_times_drawn(count, resamples, seed), table.T) / count
    unit = np.unique(unit, return_inverse=True)[1]
    times = _times_drawn(int(unit.max()) + 1, resamples, seed)
    sums = np.stack([np.bincount(unit, row) for row in table], axis=1)
    return _sums(times, sums) / (times @ np.bincount(unit).astype(float))[:, None]


def _sums(times: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return the product of two matrices, computed in parts that fit into a core's cache."""
    parts = np.array_split(times, min(len(times), math.ceil(times.size / PART)))
    return np.concatenate([part @ values for part in parts])


@lru_cache(maxsize=4)
def _times_drawn(units: int, resamples: int, seed: int) -> np.ndarray:
    """Return, for each resample, how often it contains each unit, uint16 [resamples, units]."""
    generator = np.random.Generator(np.random.PCG64(seed))
    times = np.empty((resamples, units), np.uint16)
    for part in np.array_split(times, math.ceil(times.size / CHUNK)):
        draws = generator.integers(units, size=part.shape)
        draws += np.arange(len(part))[:, None] * units
        part[:] = np.bincount(draws.ravel(), minlength=part.size).reshape(part.shape)
    times.setflags(write=False)
    return times


def mean(values: ArrayLike, **options: Any) -> Estimate:
    """Return the mean of ``values`` [N] with its interval."""
    samples = resampled_means(values, **options)[:, 0]
    return with_interval(float(np.asarray(values, float).mean()), samples)


def share(values: ArrayLike, **options: Any) -> Estimate:
    """Return the mean, with its interval, of ``values`` [N] that are between 0 and 1, such as
    successes and SPLs.

    If all values are 0 or all are 1, all resamples are equal. Then Wilson's score interval is used
    instead.
    """
    known = np.asarray(values, float)
    estimate = mean(known, **options)
    if known.min() < known.max() or known[0] not in (0, 1):
        return estimate
    units = options.get("units")
    count = len(known) if units is None else len(np.unique(units))
    return Estimate(estimate.value, *wilson(estimate.value, count))


def wilson(value: float, count: int) -> tuple[float, float]:
    """Return Wilson's score interval (1927) for the fraction ``value`` of ``count`` observations.

    Without observations, the interval of the value 0 is (0, 1).
    """
    reach = Z * Z / (count + Z * Z)
    if value in (0, 1):
        return (1 - reach, 1.0) if value else (0.0, reach)
    middle = (value + Z * Z / (2 * count)) / (1 + Z * Z / count)
    half = Z * math.sqrt(value * (1 - value) / count + Z * Z / (4 * count * count))
    half /= 1 + Z * Z / count
    return max(0.0, middle - half), min(1.0, middle + half)


def means(
    table: ArrayLike, *, units: np.ndarray | None = None, shares: bool = False, **options: Any
) -> list[Estimate | None]:
    """Return, for each row of ``table`` [K, N], the mean with its interval, or None if all entries
    are NaN.

    Entries that are NaN are left out. The mean is computed with :func:`mean`, or with :func:`share`
    if ``shares`` is true. Rows with the same episodes use the same resamples of ``units`` [N].
    """
    values = np.asarray(table, float)
    groups: dict[bytes, list[int]] = {}
    for place, known in enumerate(~np.isnan(values)):
        groups.setdefault(known.tobytes(), []).append(place)
    estimates: list[Estimate | None] = [None] * len(values)
    for places in groups.values():
        known = ~np.isnan(values[places[0]])
        group = values[np.ix_(places, known)]
        if not group.size:
            continue
        options["units"] = None if units is None else units[known]
        low, high = np.quantile(resampled_means(group, **options), _BOUNDS, axis=0)
        for k, place in enumerate(places):
            constant = shares and group[k].min() == group[k].max() and group[k, 0] in (0, 1)
            estimate = Estimate(float(group[k].mean()), float(low[k]), float(high[k]))
            estimates[place] = share(group[k], **options) if constant else estimate
    return estimates


def prs(clean: ArrayLike, corrupted: ArrayLike, **options: Any) -> Estimate:
    """Return PRS with its interval, from the values ``clean`` [N] and ``corrupted`` [K, N] of the
    same episodes.
    """
    value, samples = _prs(clean, corrupted, options)
    return with_interval(value, samples)


def prs_difference(
    first: tuple[ArrayLike, ArrayLike], second: tuple[ArrayLike, ArrayLike], **options: Any
) -> Estimate:
    """Return the paired difference PRS(first) - PRS(second); each argument is a pair (clean [N],
    corrupted [K, N]).
    """
    counts = {np.shape(part)[-1] for pair in (first, second) for part in pair}
    if len(counts) > 1:
        raise ValueError(
            "A paired difference needs the same episodes in both arguments, got "
            f"{' and '.join(map(str, sorted(counts)))} episodes."
        )
    (a, samples_a), (b, samples_b) = _prs(*first, options), _prs(*second, options)
    with np.errstate(invalid="ignore"):  # a clean value of 0 makes a PRS infinite
        return with_interval(a - b, samples_a - samples_b)


def _prs(
    clean: ArrayLike, corrupted: ArrayLike, options: dict[str, Any]
) -> tuple[float, np.ndarray]:
    """Return the PRS (``metrics.prs``) of all episodes, and the PRS of each resample."""
    clean, corrupted = np.asarray(clean, float), np.atleast_2d(np.asarray(corrupted, float))
    means = resampled_means(np.stack([clean, corrupted.mean(axis=0)]), **options)
    with np.errstate(divide="ignore", invalid="ignore"):
        samples = means[:, 1] / means[:, 0]
    return metrics.prs(clean.mean(), corrupted.mean(axis=1)), samples


def with_interval(value: float, samples: np.ndarray) -> Estimate:
    """Return ``value`` with the percentile interval of ``samples``.

    Samples are ignored if they are undefined because their clean value is 0.
    """
    known = samples[np.isfinite(samples)]
    if not len(known) or math.isnan(value):
        return Estimate(value, math.nan, math.nan)
    low, high = np.quantile(known, _BOUNDS)
    return Estimate(value, float(low), float(high))
