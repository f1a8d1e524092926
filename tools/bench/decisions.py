"""Measure the CPU time per decision of each mitigation: ``python -m tools.bench.decisions``.

All agents decide in turn in one process on one thread, so that the ratios to the base agent do not
depend on the load of the machine. The observation is a panorama of random pixels.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable

import numpy as np
import torch

import mitigate
from mitigate.core.observation import DEPTH, POSE, RGB
from mitigate.guards.opening import open_restorer

FOLDERS = {
    "base": "checkpoints/base",
    "conv_adapter": "checkpoints/hardened/conv_adapter",
    "harden": "checkpoints/hardened/harden",
    "stacked": "checkpoints/hardened/stacked",
    "ts_distill": "checkpoints/hardened/ts_distill",
}
ROUNDS = 40
INSTRUCTION = "walk past the red sofa and stop by the table"


def cpu_milliseconds(call: Callable[[], object]) -> float:
    """Return the CPU time of one call of this process."""
    start = time.process_time()
    call()
    return 1000 * (time.process_time() - start)


def main() -> None:
    """Print the median CPU time per decision, and its ratio to the base agent."""
    torch.set_num_threads(1)
    random = np.random.default_rng(0)
    observation = {
        RGB: random.integers(0, 256, (12, 64, 64, 3), np.uint8),
        DEPTH: np.full((12, 64, 64, 1), 2.0, np.float32),
        POSE: np.zeros(3, np.float32),
    }
    agents = {name: mitigate.load(folder) for name, folder in FOLDERS.items()}
    restorer = open_restorer("checkpoints/restorer")
    assert restorer is not None
    times: dict[str, list[float]] = {name: [] for name in (*agents, "restorer")}
    for _ in range(ROUNDS):
        for name, agent in agents.items():
            agent.reset(INSTRUCTION)
            times[name].append(cpu_milliseconds(lambda agent=agent: agent.act(observation)))
        times["restorer"].append(cpu_milliseconds(lambda: restorer.observe(observation)))
    base = statistics.median(times["base"])
    for name, values in times.items():
        median = statistics.median(values)
        print(f"{name:12s} {median:6.1f} ms, {median / base:.1f} times the base agent")


if __name__ == "__main__":
    main()
