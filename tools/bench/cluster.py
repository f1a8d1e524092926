"""How long an evaluation takes on a cluster whose nodes fail: ``python -m tools.bench.cluster``.

A simulation by discrete events, not a measurement: episodes take times drawn from a lognormal
distribution with the mean and spread that ``--mean`` and ``--spread`` state (of one episode under
all conditions); workers take shares of some episodes at a time; nodes fail at random and come back.
A finished episode's rows are kept, as both launchers do; the one at hand is lost, and the rest of
the share goes back to the front of the queue.
"""

from __future__ import annotations

import argparse
import heapq
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mitigate.core.markdown import markdown_table

HOUR = 3600.0


@dataclass(frozen=True)
class Cluster:
    """``days``: mean time between failures of a node. ``back``: minutes until it is back."""

    nodes: int = 100
    workers: int = 16
    days: float = 7.0
    back: float = 10.0


@dataclass(frozen=True)
class Outcome:
    """hours: until the last episode is done. lost: worker hours of episodes that were begun in
    vain. idle: worker hours between a worker's last episode and the end. failures: of nodes."""

    hours: float
    lost: float
    idle: float
    failures: int


def simulate(seconds: np.ndarray, share: int, cluster: Cluster, seed: int = 0) -> Outcome:
    """Run episodes of ``seconds`` [N] on ``cluster``, ``share`` at a time."""
    return _Simulation(seconds, share, cluster, seed).run()


class _Simulation:
    """Events are (time, order, kind, node or worker)."""

    def __init__(self, seconds: np.ndarray, share: int, cluster: Cluster, seed: int) -> None:
        self.seconds, self.cluster = seconds, cluster
        self.rng = np.random.default_rng(seed)
        numbers = list(range(len(seconds)))
        self.waiting = deque(numbers[at : at + share] for at in range(0, len(numbers), share))
        self.events: list[tuple[float, int, str, int]] = []
        self.held: dict[int, tuple[list[int], float, float]] = {}  # worker: share, begun, due
        self.idle: set[int] = set()
        self.now = self.lost = self.busy = 0.0
        self.order = self.done = self.failures = 0

    def run(self) -> Outcome:
        for node in range(self.cluster.nodes):
            self.comes_back(node)
        while self.done < len(self.seconds):
            self.now, _, kind, who = heapq.heappop(self.events)
            getattr(self, kind)(who)
        whole = self.now * self.cluster.nodes * self.cluster.workers
        idle = whole - self.busy - self.lost
        return Outcome(self.now / HOUR, self.lost / HOUR, idle / HOUR, self.failures)

    def comes_back(self, node: int) -> None:
        """A node begins, or begins again."""
        mean = self.cluster.days * 24 * HOUR
        self._at(self.now + self.rng.exponential(mean), "fails", node)
        for worker in self._workers(node):
            self._take(worker)

    def fails(self, node: int) -> None:
        """A node is lost, with the episodes at hand; what its workers had left goes to others."""
        self.failures += 1
        for worker in self._workers(node):
            self.idle.discard(worker)
            if worker in self.held:
                episodes, begun, _ = self.held.pop(worker)
                self.lost += self.now - begun
                self.waiting.appendleft(episodes)
        self._at(self.now + 60 * self.cluster.back, "comes_back", node)
        for worker in sorted(self.idle)[: len(self.waiting)]:
            self.idle.discard(worker)
            self._take(worker)

    def finishes(self, worker: int) -> None:
        """A worker is done with an episode, unless that was lost before."""
        if worker not in self.held or self.held[worker][2] != self.now:
            return
        episodes, begun, _ = self.held.pop(worker)
        self.done, self.busy = self.done + 1, self.busy + self.now - begun
        if len(episodes) > 1:
            self._begin(worker, episodes[1:])
        else:
            self._take(worker)

    def _workers(self, node: int) -> range:
        return range(node * self.cluster.workers, (node + 1) * self.cluster.workers)

    def _take(self, worker: int) -> None:
        if self.waiting:
            self._begin(worker, self.waiting.popleft())
        else:
            self.idle.add(worker)

    def _begin(self, worker: int, episodes: list[int]) -> None:
        due = self.now + float(self.seconds[episodes[0]])
        self.held[worker] = (episodes, self.now, due)
        self._at(due, "finishes", worker)

    def _at(self, time: float, kind: str, who: int) -> None:
        self.order += 1
        heapq.heappush(self.events, (time, self.order, kind, who))


def draw(count: int, mean: float, spread: float, seed: int) -> np.ndarray:
    """Seconds [count] of a lognormal distribution; ``spread``: standard deviation over mean."""
    sigma = np.sqrt(np.log1p(spread**2))
    return np.random.default_rng(seed).lognormal(np.log(mean) - sigma**2 / 2, sigma, count)


def table(options: argparse.Namespace) -> str:
    """The outcomes by share and failures as Markdown, each the median of the seeds."""
    about = (
        f"{options.episodes:,} episodes of {options.mean:g} s (all conditions), {options.nodes} "
        f"nodes of {options.workers} workers, a failed node is back after {options.back:g} "
        f"minutes; medians of {options.seeds} simulations"
    )
    rows = []
    workers = options.nodes * options.workers
    for days in options.days:
        for share in (*options.shares, -(-options.episodes // workers)):
            cluster = Cluster(options.nodes, options.workers, days, options.back)
            found = []
            for seed in range(options.seeds):
                seconds = draw(options.episodes, options.mean, options.spread, seed)
                found.append(simulate(seconds, share, cluster, seed))
            names = ("hours", "failures", "lost", "idle")
            h, f, lost, idle = (float(np.median([getattr(o, n) for o in found])) for n in names)
            cells = [f"{days:g} days", f"{share:,}", f"{h:.2f}", f"{f:.0f}"]
            rows.append([*cells, f"{lost:.1f}", f"{idle:.0f}"])
    head = ("a node fails each", "episodes at a time", "hours", "failures", "worker hours lost")
    return f"{about}\n\n{markdown_table((*head, 'idle'), rows, words=0)}"


def main(arguments: Sequence[str] | None = None) -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(prog="python -m tools.bench.cluster", description=__doc__)
    add = parser.add_argument
    add("--episodes", type=int, default=7 * 5 * 1839, help="7 agents x 5 severities x R2R-CE's")
    add("--mean", type=float, default=17.0, help="seconds of an episode under all conditions")
    add("--spread", type=float, default=0.5, help="standard deviation over mean")
    add("--nodes", type=int, default=100)
    add("--workers", type=int, default=16, help="of a node")
    add("--days", type=float, nargs="+", default=[1.0, 30.0], help="between failures of a node")
    add("--back", type=float, default=10.0, help="minutes until a node is back")
    add("--shares", type=int, nargs="+", default=[1, 8], help="episodes a worker takes at a time")
    add("--seeds", type=int, default=5)
    print(table(parser.parse_args(arguments)))


if __name__ == "__main__":
    main()
