"""Search for critical severities, and compute areas under retention curves.

The critical severity of a corruption is the severity at which an agent has lost a fraction ``loss``
of its clean success rate. SR is noisy and not strictly monotone in severity, so the value is read
from a decreasing (isotonic) fit of SR over all measured severities. If an agent has lost less than
the fraction ``loss`` at severity 1, its critical severity is above 1 (censored), and is ``inf``
here. The area is the mean retention over severities from 0 to 1. Definitions:
``docs/reference/metrics.md``.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain

import numpy as np
from numpy.typing import ArrayLike

from mitigate.corruptions import CLEAN, Corruption
from mitigate.evaluation.bootstrap import LEVEL, ROUNDING, Estimate, resampled_means
from mitigate.evaluation.grid import COVERAGE, Grid, grids
from mitigate.evaluation.rows import Row
from mitigate.evaluation.sections import references
from mitigate.worlds.seeded import RETURN

# The search stops when the two measured severities around a crossing are at most this far apart.
# In a simulation with 100 episodes, the error was then similar to that of a grid with step 0.05.
# The simulation is in docs/results/critical-severity.md#simulation.
WIDTH = 0.1

Curve = dict[float, np.ndarray]  # maps each severity to the success of the N episodes of one seed


def check_losses(losses: Sequence[float]) -> list[float]:
    """Return ``losses`` in ascending order, without repeats.

    Raises:
        ValueError: If the list is empty, or a loss is not between 0 and 1.
    """
    if not losses or not all(0 < loss < 1 for loss in losses):
        raise ValueError(
            "critical must hold fractions of the clean success between 0 and 1, such as [0.1,0.5], "
            f"got {list(losses)}. A fraction of 0.1 asks for the severity at which 10 % is lost."
        )
    return sorted(set(losses))


def decreasing(values: ArrayLike) -> np.ndarray:
    """Return the least-squares decreasing fit of ``values`` [..., K] (isotonic regression).

    Uses the min-max formula of Barlow et al. (1972): fit[k] is the minimum over a <= k of the
    maximum over b >= k of mean(values[a], ..., values[b]).
    """
    values = np.asarray(values, float)
    count = values.shape[-1]
    sums = np.concatenate([np.zeros_like(values[..., :1]), np.cumsum(values, axis=-1)], axis=-1)
    fit = np.full_like(values, np.inf)
    for a in range(count):
        means = (sums[..., a + 1 :] - sums[..., a : a + 1]) / np.arange(1, count - a + 1)
        greatest = np.maximum.accumulate(means[..., ::-1], axis=-1)[..., ::-1]
        fit[..., a:] = np.minimum(fit[..., a:], greatest)
    return fit


def crossing(severities: Sequence[float], rates: ArrayLike, loss: float) -> np.ndarray:
    """Return the critical severity for the fraction ``loss``.

    The function fits a decreasing curve to ``rates`` (:func:`decreasing`). The result is the lowest
    severity at which the curve is at most ``1 - loss`` times the clean rate. Between measured
    severities, the curve is interpolated linearly.

    Args:
        severities: K severities in ascending order; the first severity is 0 (clean).
        rates: success rates [..., K].
        loss: fraction of the clean success rate, between 0 and 1.

    Returns:
        The critical severities. A value is ``inf`` if the loss is smaller at every severity, and
        NaN if the clean rate is 0.
    """
    rates, at = np.asarray(rates, float), np.asarray(severities, float)
    fit = decreasing(rates)
    target = (1 - loss) * rates[..., :1]
    lost = fit <= target + ROUNDING
    # index 0 is excluded, because the fit at severity 0 is never below the clean rate
    after = np.maximum(lost.argmax(axis=-1), 1)
    high = np.take_along_axis(fit, after[..., None] - 1, axis=-1)[..., 0]
    low = np.take_along_axis(fit, after[..., None], axis=-1)[..., 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        part = np.clip((high - target[..., 0]) / (high - low), 0, 1)
    severity = at[after - 1] + part * (at[after] - at[after - 1])
    return np.where(rates[..., 0] > 0, np.where(lost.any(axis=-1), severity, np.inf), np.nan)


def area(severities: Sequence[float], rates: ArrayLike) -> np.ndarray:
    """Return the mean retention over the severities from 0 to 1, by the trapezoidal rule.

    Args:
        severities: K severities in ascending order, from 0 (clean) to 1.
        rates: success rates [..., K], as measured and not as fitted.
    """
    rates = np.asarray(rates, float)
    steps = np.diff(np.asarray(severities, float))
    with np.errstate(divide="ignore", invalid="ignore"):
        return ((rates[..., 1:] + rates[..., :-1]) / 2 * steps).sum(axis=-1) / rates[..., 0]


def next_severities(rates: dict[float, float], losses: Iterable[float]) -> list[float]:
    """Return the severities to measure next.

    ``rates`` maps each measured severity, including 0 and 1, to the success rate.

    For each of ``losses``, the target rate is ``1 - loss`` times the clean rate. If the
    fitted curve falls to this target between two neighbouring measured severities that are more
    than :data:`WIDTH` apart, their midpoint is measured next.
    """
    severities = sorted(rates)
    fit = decreasing([rates[at] for at in severities])
    chosen = set()
    for loss in losses if rates[0.0] > 0 else ():
        lost = fit <= (1 - loss) * rates[0.0] + ROUNDING
        after = int(lost.argmax())
        if lost.any() and severities[after] - severities[after - 1] > WIDTH + ROUNDING:
            # rounding makes the severity in the rows the same on every computer
            chosen.add(round((severities[after - 1] + severities[after]) / 2, 6))
    return sorted(chosen)


def first_conditions(conditions: Sequence[Corruption], rule: str) -> list[Corruption]:
    """Return the conditions with which a search starts.

    The search starts with the clean condition, the given ``conditions``, and each of their
    corruptions at severity 1.

    Raises:
        ValueError: If ``conditions`` contains no corruption, if a corruption has severity 0, or if
            the world has no success criterion.
    """
    corrupted = [one for one in conditions if one.name != "clean"]
    if rule == RETURN:
        raise ValueError(
            "critical needs a world with a success criterion, but this one measures only the "
            "return. Leave critical out."
        )
    if not corrupted or any(one.severity == 0 for one in corrupted):
        raise ValueError(
            "critical needs corruptions and a severity above 0, at which the search starts. Name "
            "conditions such as [clean,spatter], and keep severity=0.6."
        )
    ends = [replace(one, severity=1.0) for one in corrupted]
    return [*dict.fromkeys([CLEAN, *corrupted, *ends])]


def search(
    measure: Callable[..., list[Row]], conditions: Sequence[Corruption], losses: Sequence[float]
) -> list[Row]:
    """Measure ``conditions``, and bisect severities until all critical severities are located.

    All severities use the same episodes and random keys. The next severities depend only on rows
    that the search requested earlier, so an interrupted search continues with the same severities.

    Args:
        measure: function that runs the episodes under its argument ``conditions`` and returns the
            rows.
        conditions: the conditions from :func:`first_conditions`.
        losses: fractions of the clean success.

    Returns:
        All rows.
    """
    rows: list[Row] = []
    new = [*conditions]
    while new:
        rows += measure(conditions=new)
        values: dict[str, dict[float, list[float]]] = defaultdict(lambda: defaultdict(list))
        for row in rows:
            values[row["corruption"]][float(row["severity"])].append(row["success"])
        clean = values.pop("clean")
        new = [
            Corruption(name, severity)
            for name, by_severity in values.items()
            for severity in next_severities(
                {at: float(np.mean(one)) for at, one in (clean | by_severity).items()}, losses
            )
        ]
        if new:
            listed = ", ".join(f"{one.name} {one.severity:g}" for one in new)
            print(f"critical: next severities: {listed}", flush=True)
    return rows


@dataclass(frozen=True)
class Score:
    """A critical severity, or the area under a retention curve.

    The score may be a mean over corruptions and seeds, or a difference between two columns.

    Attributes:
        estimate: value and interval; ``inf`` means above 1.
        episodes: number of episodes. All severities, columns and seeds use the same episodes.
        bound: "" if the value is exact. Means and differences count critical severities above 1 as
            1, so ``estimate`` may only be a "lower" or an "upper" bound of the true value. The
            bound is "unknown" if both columns of a difference have critical severities above 1.
    """

    estimate: Estimate
    episodes: int
    bound: str = ""


@dataclass(frozen=True, eq=False)
class Scores:
    """The scores of a grid's columns.

    Attributes:
        grid: the results.
        losses: the losses to search for, as fractions of the clean success rate.
        columns: labels of the columns; differences are relative to the first one.
        corruptions: corruptions for which at least one column has clean results and results at
            severity 1.
    """

    grid: Grid
    losses: tuple[float, ...]
    columns: tuple[str, ...]
    corruptions: tuple[str, ...]

    @property
    def measures(self) -> tuple[float | None, ...]:
        """The losses to search for, followed by None, which stands for the area under the curve."""
        return (*self.losses, None)

    @property
    def groups(self) -> list[tuple[str, ...]]:
        """The groups of corruptions that have scores.

        Each corruption is a group. If two or more corruptions have scores in all columns, the last
        group contains all these corruptions, and its scores are means over them.
        """
        every = tuple(
            n for n in self.corruptions if all(self.seeds((c,), (n,)) for c in self.columns)
        )
        return [*((name,) for name in self.corruptions), *([every] if len(every) > 1 else [])]

    @property
    def comparisons(self) -> list[tuple[str, ...]]:
        """The keys of the scores: each single column, and pairs of columns to compare.

        Each column except the first is paired with the first one.
        """
        first, *others = self.columns
        return [(first,), *((c,) for c in others), *((c, first) for c in others)]

    def seeds(self, columns: Sequence[str], names: Sequence[str]) -> list[int]:
        """Return the seeds for which every column has a curve for every corruption in ``names``."""
        runs = [set(self.grid.runs[column]) for column in columns]
        return [
            seed
            for seed in sorted(set.intersection(*runs))
            if all(self.curve(column, name, seed) for column in columns for name in names)
        ]

    def curve(self, column: str, name: str, seed: int) -> Curve:
        """Return the curve of a seed.

        The curve is empty if there are no clean successes or if severity 1 was not measured. The
        curve omits a severity if the fraction of episodes with results is below :data:`COVERAGE`.
        """
        curve = self.grid.by_severity(column, name, seed)
        if not {0.0, 1.0} <= curve.keys():
            return {}
        ends = ~np.isnan(curve[0.0] + curve[1.0])
        if not curve[0.0][ends].any():
            return {}
        covered = {at: (~np.isnan(values[ends])).mean() for at, values in curve.items()}
        return {at: curve[at] for at in sorted(curve) if covered[at] >= COVERAGE}

    @cached_property
    def results(self) -> dict[tuple[tuple[str, ...], tuple[str, ...], float | None], Score]:
        """All scores, keyed by (columns, corruptions, loss).

        The score of a pair of columns is the score of the first minus the score of the second.
        """
        return {
            (columns, names, loss): self.score(columns, names, loss)
            for columns in self.comparisons
            for names in self.groups
            for loss in (self.measures if self.seeds(columns, names) else ())
        }

    def score(self, columns: Sequence[str], names: Sequence[str], loss: float | None) -> Score:
        """Return the mean score over corruptions and seeds of one column, or the difference of two.

        The difference is the first column's mean minus the second column's mean. Both means use the
        same seeds, episodes and bootstrap resamples.

        Args:
            columns: one or two labels, which must have seeds in common.
            names: corruptions.
            loss: fraction of the clean success, or None for the area.
        """
        seeds = self.seeds(columns, names)
        lines = [[(c, n, seed) for n in names for seed in seeds] for c in columns]
        every = [values for line in chain(*lines) for values in self.curve(*line).values()]
        common = ~np.isnan(np.stack(every)).any(axis=0)
        parts = [np.stack([self._scored(line, common)[loss] for line in group]) for group in lines]
        count = int(common.sum())
        above = tuple(bool(np.isinf(part[:, 0]).any()) for part in parts)
        # critical severities above 1 are clipped to 1; areas are not clipped
        first, *others = (np.minimum(x, 1 if loss else np.inf).mean(axis=0) for x in parts)
        if not others:
            mean = np.where(np.isinf(parts[0]).all(axis=0), np.inf, first)
            return Score(_estimate(mean), count, "lower" if above[0] else "")
        bounds = {(True, False): "lower", (False, True): "upper", (True, True): "unknown"}
        return Score(_estimate(first - others[0]), count, bounds.get((above[0], above[1]), ""))

    def _scored(
        self, line: tuple[str, str, int], common: np.ndarray
    ) -> dict[float | None, np.ndarray]:
        """Return each measure of one curve [1 + resamples]: the value of the data comes first.

        ``line`` is the column, corruption and seed; ``common`` [N] masks the episodes to use.
        """
        key = (line, common.tobytes())
        if key not in self._scores_of_curves:
            curve = self.curve(*line)
            table = np.stack([values[common] for values in curve.values()])
            draws = resampled_means(table, units=self.grid.units[common])
            means = np.concatenate([table.mean(axis=1)[None], draws])
            self._scores_of_curves[key] = {
                loss: area([*curve], means) if loss is None else crossing([*curve], means, loss)
                for loss in self.measures
            }
        return self._scores_of_curves[key]

    @cached_property
    def _scores_of_curves(self) -> dict[tuple, dict[float | None, np.ndarray]]:
        """Measures of curves, because several comparisons and groups need the same curve."""
        return {}


def _estimate(values: np.ndarray) -> Estimate:
    """Return the first value with the percentile interval of the others, which are resamples.

    Each bound is one of the values and is not interpolated, because values may be infinite.
    """
    known = np.sort(values[1:][~np.isnan(values[1:])])  # a resample may contain no clean success
    if not len(known):
        return Estimate(float(values[0]), math.nan, math.nan)
    tail = int((1 - LEVEL) / 2 * len(known))
    return Estimate(float(values[0]), float(known[tail]), float(known[-1 - tail]))


def scores(
    rows: Iterable[Row],
    losses: Sequence[float],
    against: str | None = None,
    drawn: str | None = None,
) -> list[Scores]:
    """Return one Scores object per split, episode list, suite version and success rule in ``rows``.

    Args:
        rows: result rows of clean episodes and of corruptions at severity 1 and at other
            severities.
        losses: fractions of the clean success.
        against: the column with which the other columns are compared. The default is the column
            "base" or "before" if it exists, and otherwise the first column.
        drawn: unit that the bootstrap resamples, as in :func:`grids`.

    Raises:
        ValueError: If a loss or ``against`` is invalid, or no column has results at severity 1.
    """
    chosen, rows = tuple(check_losses(losses)), list(rows)
    first = references(rows, against)
    results = []
    for grid in grids((row for row in rows if row["rule"] != RETURN), drawn):
        order = sorted(grid.columns, key=lambda label: grid.columns[label][0] not in first)
        every = Scores(grid, chosen, tuple(order), tuple(grid.corruptions))
        measured = {(c, n) for c in order for n in grid.corruptions if every.seeds((c,), (n,))}
        columns = tuple(c for c in order if any(column == c for column, _ in measured))
        usable = tuple(n for n in grid.corruptions if any(name == n for _, name in measured))
        if usable:
            results.append(replace(every, columns=columns, corruptions=usable))
    if not results:
        raise ValueError(
            "A critical severity needs clean rows with successes and rows of a corruption at "
            "severity 1. Run `mitigate evaluate checkpoint=... critical=[0.1,0.5]` first."
        )
    return results
