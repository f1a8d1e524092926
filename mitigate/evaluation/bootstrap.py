"""Paired bootstrap over episodes: intervals for SR, SPL, PRS and differences of PRS.

Values are ``[..., N]``, one column an episode. Every condition and agent sees the same resamples
of the episodes, so what is easy or hard about an episode cancels. Several seeds of an episode must
be averaged first: the unit drawn is the episode. Episodes in one scene are alike, so intervals for
scenes that nobody saw are wider: ``units`` [N] names what an episode is drawn with (a cluster
bootstrap: Davison and Hinkley 1997, section 3.8).
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
Z = 1.959964  # of the normal distribution at LEVEL
_BOUNDS = ((1 - LEVEL) / 2, (1 + LEVEL) / 2)
ROUNDING = 1e-9  # by which resamples that are alike may differ (ours)
NO_INTERVAL = "[–]"
NO_WIDTH = f"{NO_INTERVAL}: no interval, as no resample differs (one episode alone, or all alike)."
CHUNK = 1 << 20  # draws made at a time (ours): 8 MiB of indices
PART = 1 << 14  # of them in one product (ours): as 128 KiB of float64 they stay in a core's cache


@dataclass(frozen=True)
class Estimate:
    """A value and its percentile interval; NaN bounds mean that it cannot be told. One without a
    width says nothing either: of one episode, or where no resample differs."""

    value: float
    low: float
    high: float

    @property
    def excludes_zero(self) -> bool:
        """Whether the interval lies on one side of zero."""
        return self.has_width and (self.low > 0 or self.high < 0)

    @property
    def has_width(self) -> bool:
        """Whether the interval says anything."""
        return self.high - self.low > ROUNDING

    def interval(self, form: str, scale: float = 1.0) -> str:
        """The interval as tables show it, each bound times ``scale`` in ``form``; ``NO_INTERVAL``
        where it says nothing."""
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
    """Return the means of ``values`` [C, N] over resampled episodes, float64 [resamples, C].

    units: numbers [N]; episodes of one number are drawn together. None: each alone. The draws
    depend on how many are drawn and ``seed`` alone, so calls on the same episodes are paired.
    """
    table = np.atleast_2d(np.asarray(values, float))
    if table.ndim != 2 or not table.size or not np.isfinite(table).all():
        raise ValueError(
            f"The bootstrap needs finite values [conditions, episodes], not {table.shape} with "
            f"{int(np.isnan(table).sum())} NaN: leave out the episodes that lack a result."
        )
    own = np.arange(table.shape[1]) if units is None else np.unique(units, return_inverse=True)[1]
    times = _times_drawn(int(own.max()) + 1, resamples, seed)
    count = np.bincount(own).astype(float)
    parts = np.array_split(times, min(resamples, math.ceil(times.size / PART)))
    sums = np.stack([np.bincount(own, row) for row in table], axis=1)
    return np.concatenate([part @ sums / (part @ count)[:, None] for part in parts])


@lru_cache(maxsize=4)
def _times_drawn(units: int, resamples: int, seed: int) -> np.ndarray:
    """Return how often each resample draws each unit, uint16 [resamples, units]."""
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
    return _estimate(
        float(np.asarray(values, float).mean()), resampled_means(values, **options)[:, 0]
    )


def share(values: ArrayLike, **options: Any) -> Estimate:
    """Return the mean of ``values`` [N] in 0..1 (successes, SPLs) with its interval.

    If all are 0 or all 1, no resample differs; the bound is then that of Wilson's score interval.
    """
    found, known = mean(values, **options), np.asarray(values, float)
    units = options.get("units")
    drawn = len(known) if units is None else len(np.unique(units))
    reach = Z * Z / (drawn + Z * Z)
    if (known == 0).all():
        return Estimate(found.value, 0.0, reach)
    return Estimate(found.value, 1 - reach, 1.0) if (known == 1).all() else found


def means(table: ArrayLike, *, shares: bool = False, **options: Any) -> list[Estimate | None]:
    """Return the mean of each row of ``table`` [K, N] with its interval, None for a row of NaN.

    Each is over the episodes that the row holds, as :func:`mean`, or :func:`share` with ``shares``,
    of these alone; rows that hold the same ones are resampled at once.
    """
    values = np.asarray(table, float)
    groups: dict[bytes, list[int]] = {}
    for place, known in enumerate(~np.isnan(values)):
        groups.setdefault(known.tobytes(), []).append(place)
    found: list[Estimate | None] = [None] * len(values)
    for places in groups.values():
        held = values[np.ix_(places, ~np.isnan(values[places[0]]))]
        if not held.size:
            continue
        low, high = np.quantile(resampled_means(held, **options), _BOUNDS, axis=0)
        for k, place in enumerate(places):
            even = shares and held[k].min() == held[k].max() and held[k, 0] in (0, 1)
            own = Estimate(float(held[k].mean()), float(low[k]), float(high[k]))
            found[place] = share(held[k], **options) if even else own
    return found


def prs(clean: ArrayLike, corrupted: ArrayLike, **options: Any) -> Estimate:
    """Return PRS with its interval; ``clean`` [N] and ``corrupted`` [K, N] share their episodes."""
    value, samples = _prs(clean, corrupted, options)
    return _estimate(value, samples)


def ratio(parts: ArrayLike, wholes: ArrayLike, **options: Any) -> Estimate:
    """Return the sum of ``parts`` [N] over that of ``wholes`` [N], with its interval."""
    return prs(wholes, parts, **options)


def prs_difference(
    first: tuple[ArrayLike, ArrayLike], second: tuple[ArrayLike, ArrayLike], **options: Any
) -> Estimate:
    """Return PRS(first) - PRS(second), paired; each is a (clean [N], corrupted [K, N]) of one N."""
    counts = {np.shape(part)[-1] for pair in (first, second) for part in pair}
    if len(counts) > 1:
        raise ValueError(f"A paired difference needs the same episodes; counts: {sorted(counts)}.")
    (a, samples_a), (b, samples_b) = _prs(*first, options), _prs(*second, options)
    return _estimate(a - b, samples_a - samples_b)


def _prs(
    clean: ArrayLike, corrupted: ArrayLike, options: dict[str, Any]
) -> tuple[float, np.ndarray]:
    """PRS as ``metrics.prs`` defines it, and that of each resample."""
    clean, corrupted = np.asarray(clean, float), np.atleast_2d(np.asarray(corrupted, float))
    means = resampled_means(np.stack([clean, corrupted.mean(axis=0)]), **options)
    with np.errstate(divide="ignore", invalid="ignore"):
        samples = means[:, 1] / means[:, 0]
    return metrics.prs(clean.mean(), corrupted.mean(axis=1)), samples


def _estimate(value: float, samples: np.ndarray) -> Estimate:
    """Return percentiles, leaving out resamples whose clean value is 0: PRS is undefined there."""
    known = samples[np.isfinite(samples)]
    if not len(known) or math.isnan(value):
        return Estimate(value, math.nan, math.nan)
    low, high = np.quantile(known, _BOUNDS)
    return Estimate(value, float(low), float(high))
