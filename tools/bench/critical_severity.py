"""Simulate the search for critical severities, and compare it with a full grid of severities.

``python -m tools.bench.critical_severity`` prints the number of severities, the error and the
coverage of the 95 % intervals for agents with known success curves (about 2 CPU minutes).

A simulated agent succeeds in a clean episode with probability 0.9. Each of these episodes has a
limit: under corruption, the agent succeeds at severities below the limit. Some episodes have an
infinite limit: the agent succeeds at every severity. In some cases, success is random instead.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np

from mitigate.core.markdown import markdown_table
from mitigate.core.seeding import generator
from mitigate.evaluation.bootstrap import LEVEL
from mitigate.evaluation.critical import crossing, next_severities

CLEAN, RANDOM_SUCCESS = 0.9, 0.6
FIRST = 0.6  # severity at which a search starts
LOSSES = (0.1, 0.5)
GRID = np.linspace(0, 1, 21).round(2)
RESAMPLES = 1000
CENSORED = 1.0  # replaces a critical severity above 1 when errors are computed


@dataclass(frozen=True)
class Curve:
    """Parameters of a simulated agent's success curve.

    Attributes:
        mean, deviation: mean and standard deviation of the limits, which are normally distributed.
        tough: fraction of the episodes that have an infinite limit.
        random: fraction of the corrupted episodes in which success is random.
    """

    mean: float
    deviation: float
    tough: float
    random: float

    def rates(self, severities: np.ndarray) -> np.ndarray:
        """Return the probability of success at severities [K]."""
        limits = NormalDist(self.mean, self.deviation)
        below = np.array([1 - limits.cdf(at) for at in severities])
        rates = CLEAN * (self.tough + (1 - self.tough) * below)
        return np.where(
            severities > 0, (1 - self.random) * rates + self.random * RANDOM_SUCCESS, rates
        )

    def critical(self, loss: float) -> float:
        """Return the true critical severity."""
        severities = np.linspace(0, 1, 10_001)
        lost = self.rates(severities) <= (1 - loss) * self.rates(severities[:1])
        return float(severities[lost.argmax()]) if lost.any() else np.inf


CURVES = (
    Curve(0.5, 0.2, 0.1, 0.05),
    Curve(0.3, 0.15, 0.3, 0.1),
    Curve(0.9, 0.2, 0.2, 0.05),
    Curve(0.5, 0.3, 0.7, 0.08),
    Curve(0.15, 0.1, 0.0, 0.05),
    Curve(1.2, 0.2, 0.2, 0.05),
)


class Episodes:
    """The episodes of one simulated agent; repeating a severity gives the same successes."""

    def __init__(self, curve: Curve, count: int, random: np.random.Generator) -> None:
        self.curve = curve
        self.random = random
        self.clean = random.random(count) < CLEAN
        limits = random.normal(curve.mean, curve.deviation, count)
        self.limits = np.where(random.random(count) < curve.tough, np.inf, limits)
        self.measured: dict[float, np.ndarray] = {}

    def success(self, severity: float) -> np.ndarray:
        """Return the successes [N] at a severity."""
        if severity not in self.measured:
            success = self.clean & (severity < self.limits)
            changed = self.random.random(len(success)) < (self.curve.random if severity else 0)
            replaced = self.random.random(len(success)) < RANDOM_SUCCESS
            self.measured[severity] = np.where(changed, replaced, success).astype(float)
        return self.measured[severity]

    def search(self) -> np.ndarray:
        """Return the severities that a search measures."""
        severities = [0.0, FIRST, 1.0]
        while new := next_severities({at: self.success(at).mean() for at in severities}, LOSSES):
            severities += new
        return np.sort(severities)


def simulate(curve: Curve, agents: int, count: int, grid: bool) -> list[list[str]]:
    """Simulate searches; return one table line per loss in LOSSES."""
    counts = []
    values = np.zeros((agents, len(LOSSES)))
    covered = np.zeros((agents, len(LOSSES)), bool)
    for number in range(agents):
        random = generator(0, "critical severity", f"{curve} {number} {grid}")
        episodes = Episodes(curve, count, random)
        severities = GRID if grid else episodes.search()
        counts.append(len(severities) - 1)
        success = np.stack([episodes.success(float(at)) for at in severities])
        times = random.multinomial(count, np.full(count, 1 / count), RESAMPLES)
        samples = times @ success.T / count
        for place, loss in enumerate(LOSSES):
            values[number, place] = crossing(severities, success.mean(axis=1), loss)
            ordered = np.sort(crossing(severities, samples, loss))
            tail = int((1 - LEVEL) / 2 * RESAMPLES)
            covered[number, place] = ordered[tail] <= curve.critical(loss) <= ordered[-1 - tail]
    lines = []
    for place, loss in enumerate(LOSSES):
        true = curve.critical(loss)
        errors = np.minimum(values[:, place], CENSORED) - min(true, CENSORED)
        lines.append(
            [
                f"{true:.2f}" if np.isfinite(true) else "> 1",
                f"{100 * loss:.0f} %",
                "grid" if grid else "search",
                f"{np.mean(counts):.1f}",
                f"{errors.mean():+.3f}",
                f"{np.sqrt((errors**2).mean()):.3f}",
                f"{100 * covered[:, place].mean():.0f} %",
            ]
        )
    return lines


def main(argv: Sequence[str] | None = None) -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--agents", type=int, default=200, help="agents per curve (default 200)")
    parser.add_argument("--episodes", type=int, default=100, help="episodes (default 100)")
    options = parser.parse_args(argv)
    heads = ["true value", "loss", "severities", "number", "bias", "RMS error", "coverage"]
    lines = []
    for curve in CURVES:
        pairs = [simulate(curve, options.agents, options.episodes, grid) for grid in (False, True)]
        lines += [
            line for place in range(len(LOSSES)) for line in (pairs[0][place], pairs[1][place])
        ]
    print(markdown_table(heads, lines, words=3))


if __name__ == "__main__":
    main()
