"""Simulate how long an evaluation takes on a cluster with failing nodes.

    python -m tools.bench.cluster

This is a discrete-event simulation and not a measurement. The times of episodes (under all
conditions) are sampled from a lognormal distribution with the mean and spread of ``--mean`` and
``--spread``. Each worker takes several episodes (a share) at a time. Nodes fail at random times and
return later. As in both launchers, the rows of a finished episode are kept. The running episode is
lost, and the rest of the share is returned to the front of the queue.
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
    """A simulated cluster.

    Attributes:
        nodes: Number of nodes.
        workers: Workers per node.
        days: Mean time between failures of a node.
        back: Minutes until a failed node is back.
    """

    nodes: int = 100
    workers: int = 16
    days: float = 7.0
    back: float = 10.0


@dataclass(frozen=True)
class Outcome:
    """The result of a simulation.

    Attributes:
        hours: Hours until the last episode is finished.
        lost: Worker hours of episodes that failures interrupted.
        idle: Worker hours without an episode.
        failures: Number of node failures.
    """

    hours: float
    lost: float
    idle: float
    failures: int


def simulate(seconds: np.ndarray, share: int, cluster: Cluster, seed: int = 0) -> Outcome:
    """Run episodes that take ``seconds`` [N] on ``cluster``; a worker takes ``share`` episodes at a
    time."""
    return _Simulation(seconds, share, cluster, seed).run()


class _Simulation:
    """Events are (time, order, kind, node or worker); the kind names a method."""

    def __init__(self, seconds: np.ndarray, share: int, cluster: Cluster, seed: int) -> None:
        self.seconds = seconds
        self.cluster = cluster
        self.rng = np.random.default_rng(seed)
        episodes = list(range(len(seconds)))
        self.waiting = deque(episodes[i : i + share] for i in range(0, len(episodes), share))
        self.events: list[tuple[float, int, str, int]] = []
        # maps a worker to its share, start and end
        self.running: dict[int, tuple[list[int], float, float]] = {}
        self.idle: set[int] = set()
        self.now = self.lost = self.busy = 0.0
        self.order = self.done = self.failures = 0

    def run(self) -> Outcome:
        for node in range(self.cluster.nodes):
            self.comes_back(node)
        while self.done < len(self.seconds):
            self.now, _, kind, number = heapq.heappop(self.events)
            getattr(self, kind)(number)
        total = self.now * self.cluster.nodes * self.cluster.workers
        idle = total - self.busy - self.lost
        return Outcome(self.now / HOUR, self.lost / HOUR, idle / HOUR, self.failures)

    def comes_back(self, node: int) -> None:
        """Start a node, at the beginning or after a failure of the node."""
        mean = self.cluster.days * 24 * HOUR
        self._schedule(self.now + self.rng.exponential(mean), "fails", node)
        for worker in self._workers(node):
            self._take_share(worker)

    def fails(self, node: int) -> None:
        """Lose a node and its running episodes; remaining episodes go to other workers."""
        self.failures += 1
        for worker in self._workers(node):
            self.idle.discard(worker)
            if worker in self.running:
                episodes, start, _ = self.running.pop(worker)
                self.lost += self.now - start
                self.waiting.appendleft(episodes)
        self._schedule(self.now + 60 * self.cluster.back, "comes_back", node)
        for worker in sorted(self.idle)[: len(self.waiting)]:
            self.idle.discard(worker)
            self._take_share(worker)

    def finishes(self, worker: int) -> None:
        """Finish a worker's episode, unless a failure interrupted it."""
        if worker not in self.running or self.running[worker][2] != self.now:
            return
        episodes, start, _ = self.running.pop(worker)
        self.done += 1
        self.busy = self.busy + self.now - start
        if len(episodes) > 1:
            self._start(worker, episodes[1:])
        else:
            self._take_share(worker)

    def _workers(self, node: int) -> range:
        return range(node * self.cluster.workers, (node + 1) * self.cluster.workers)

    def _take_share(self, worker: int) -> None:
        if self.waiting:
            self._start(worker, self.waiting.popleft())
        else:
            self.idle.add(worker)

    def _start(self, worker: int, episodes: list[int]) -> None:
        end = self.now + float(self.seconds[episodes[0]])
        self.running[worker] = (episodes, self.now, end)
        self._schedule(end, "finishes", worker)

    def _schedule(self, time: float, kind: str, number: int) -> None:
        self.order += 1
        heapq.heappush(self.events, (time, self.order, kind, number))


def draw(count: int, mean: float, spread: float, seed: int) -> np.ndarray:
    """Sample durations in seconds [count] from a lognormal distribution.

    Args:
        count: How many.
        mean: Seconds.
        spread: Standard deviation divided by the mean.
        seed: Seed of the generator.
    """
    sigma = np.sqrt(np.log1p(spread**2))
    return np.random.default_rng(seed).lognormal(np.log(mean) - sigma**2 / 2, sigma, count)


def table(options: argparse.Namespace) -> str:
    """Return a Markdown table of outcomes by share and failures, as medians over the seeds."""
    caption = (
        f"{options.episodes:,} episodes of {options.mean:g} s (all conditions), {options.nodes} "
        f"nodes of {options.workers} workers, a failed node is back after {options.back:g} "
        f"minutes; medians of {options.seeds} simulations"
    )
    rows = []
    workers = options.nodes * options.workers
    for days in options.days:
        for share in (*options.shares, -(-options.episodes // workers)):
            cluster = Cluster(options.nodes, options.workers, days, options.back)
            outcomes = []
            for seed in range(options.seeds):
                seconds = draw(options.episodes, options.mean, options.spread, seed)
                outcomes.append(simulate(seconds, share, cluster, seed))
            names = ("hours", "failures", "lost", "idle")
            medians = [float(np.median([getattr(o, n) for o in outcomes])) for n in names]
            hours, failures, lost, idle = medians
            cells = [f"{days:g} days", f"{share:,}", f"{hours:.2f}", f"{failures:.0f}"]
            rows.append([*cells, f"{lost:.1f}", f"{idle:.0f}"])
    head = ("a node fails every", "episodes per share", "hours", "failures", "worker hours lost")
    return f"{caption}\n\n{markdown_table((*head, 'idle'), rows, words=0)}"


def main(arguments: Sequence[str] | None = None) -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(prog="python -m tools.bench.cluster", description=__doc__)
    add = parser.add_argument
    add("--episodes", type=int, default=7 * 5 * 1839, help="7 agents x 5 severities x R2R-CE")
    add("--mean", type=float, default=17.0, help="seconds of an episode under all conditions")
    add("--spread", type=float, default=0.5, help="standard deviation over mean")
    add("--nodes", type=int, default=100)
    add("--workers", type=int, default=16, help="per node")
    add("--days", type=float, nargs="+", default=[1.0, 30.0], help="between failures of a node")
    add("--back", type=float, default=10.0, help="minutes until a failed node is back")
    add("--shares", type=int, nargs="+", default=[1, 8], help="episodes per share")
    add("--seeds", type=int, default=5)
    print(table(parser.parse_args(arguments)))


if __name__ == "__main__":
    main()
