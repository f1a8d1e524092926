"""How long an evaluation takes on a cluster whose nodes fail: ``python -m mitigate.bench.cluster``.

A simulation by discrete events, not a measurement: episodes take times drawn from a lognormal
distribution with the mean and spread that ``--mean`` and ``--spread`` state (of one episode under
all conditions, as ``docs/scale.md`` measured them); workers take shares of some episodes at a time;
nodes fail at random and come back. A finished episode's rows are kept, as both launchers do; the one
at hand is lost, and the rest of the share goes back to the front of the queue.
"""

from __future__ import annotations

import argparse
import heapq
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

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
    rng = np.random.default_rng(seed)
    waiting: deque[list[int]] = deque(
        list(range(at, min(at + share, len(seconds)))) for at in range(0, len(seconds), share)
    )
    mean = cluster.days * 24 * HOUR
    events: list[tuple[float, int, str, int]] = []  # time, order, kind, node or worker
    order = 0

    def at(time: float, kind: str, who: int) -> None:
        nonlocal order
        order += 1
        heapq.heappush(events, (time, order, kind, who))

    held: dict[int, tuple[list[int], float, int]] = {}  # worker: its share, begun, its ticket
    tickets = np.zeros(cluster.nodes * cluster.workers, np.int64)
    due: dict[int, tuple[float, int]] = {}
    idle: set[int] = set()
    done, lost, failures, busy, now = 0, 0.0, 0, 0.0, 0.0

    def take(worker: int) -> None:
        if not waiting:
            idle.add(worker)
            return
        begin(worker, waiting.popleft())

    def begin(worker: int, episodes: list[int]) -> None:
        tickets[worker] += 1
        held[worker] = (episodes, now, int(tickets[worker]))
        due[worker] = (now + seconds[episodes[0]], int(tickets[worker]))
        at(due[worker][0], "done", worker)

    for node in range(cluster.nodes):
        at(rng.exponential(mean), "fails", node)
        for worker in range(node * cluster.workers, (node + 1) * cluster.workers):
            take(worker)
    while done < len(seconds):
        now, _, kind, who = heapq.heappop(events)
        if kind == "done":
            if who not in held or due[who] != (now, held[who][2]):
                continue  # of a share that was lost
            episodes, begun, _ = held.pop(who)
            done, busy = done + 1, busy + now - begun
            if len(episodes) > 1:
                begin(who, episodes[1:])
            else:
                take(who)
        elif kind == "fails":
            failures += 1
            for worker in range(who * cluster.workers, (who + 1) * cluster.workers):
                idle.discard(worker)
                if worker in held:
                    episodes, begun, _ = held.pop(worker)
                    lost += now - begun
                    waiting.appendleft(episodes)
            at(now + 60 * cluster.back, "back", who)
            for worker in list(idle)[: len(waiting)]:
                idle.discard(worker)
                take(worker)
        else:
            at(now + rng.exponential(mean), "fails", who)
            for worker in range(who * cluster.workers, (who + 1) * cluster.workers):
                take(worker)
    whole = now * cluster.nodes * cluster.workers
    return Outcome(now / HOUR, lost / HOUR, (whole - busy - lost) / HOUR, failures)


def draw(count: int, mean: float, spread: float, seed: int) -> np.ndarray:
    """Seconds [count] of a lognormal distribution; ``spread``: standard deviation over mean."""
    sigma = np.sqrt(np.log1p(spread**2))
    return np.random.default_rng(seed).lognormal(np.log(mean) - sigma**2 / 2, sigma, count)


def table(options: argparse.Namespace) -> str:
    """The outcomes by share and failures as Markdown, each the median of the seeds."""
    lines = [
        f"{options.episodes:,} episodes of {options.mean:g} s (all conditions), {options.nodes} nodes "
        f"of {options.workers} workers, a failed node is back after {options.back:g} minutes; "
        f"medians of {options.seeds} simulations",
        "",
        "| a node fails each | episodes at a time | hours | failures | worker hours lost | idle |",
        "|---:|---:|---:|---:|---:|---:|",
    ]
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
            lines.append(
                f"| {days:g} days | {share:,} | {h:.2f} | {f:.0f} | {lost:.1f} | {idle:.0f} |"
            )
    return "\n".join(lines)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(prog="python -m mitigate.bench.cluster", description=__doc__)
    parser.add_argument(
        "--episodes", type=int, default=7 * 5 * 1839, help="agents x severities x list"
    )
    parser.add_argument(
        "--mean", type=float, default=17.0, help="seconds of an episode, all conditions"
    )
    parser.add_argument("--spread", type=float, default=0.5, help="standard deviation over mean")
    parser.add_argument("--nodes", type=int, default=100)
    parser.add_argument("--workers", type=int, default=16, help="of a node")
    parser.add_argument(
        "--days", type=float, nargs="+", default=[1.0, 30.0], help="between failures"
    )
    parser.add_argument("--back", type=float, default=10.0, help="minutes until a node is back")
    parser.add_argument("--shares", type=int, nargs="+", default=[1, 8])
    parser.add_argument("--seeds", type=int, default=5)
    print(table(parser.parse_args(arguments)))


if __name__ == "__main__":
    main()
