"""Success rates by corruption, which a success-distributed schedule draws by."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from mitigate.corruptions import Schedule
from mitigate.envs.apartments.renderer import Renderer
from mitigate.envs.apartments.simulator import Simulator
from mitigate.envs.apartments.tasks import draw_training_episode
from mitigate.evaluation.evaluator import run_episode
from mitigate.evaluation.rows import read
from mitigate.seeding import generator


def measure(
    agent: Any,
    schedule: Schedule,
    renderer: Renderer,
    *,
    episodes: int,
    apartments: int,
    seed: int,
    step: int,
) -> dict[str, float]:
    """Success of ``agent`` under every corruption of ``schedule``, in [0, 1] by name.

    ``episodes`` instruction-following episodes of the first ``apartments`` training layouts are
    drawn from (seed, step), the same ones under every corruption. ``agent`` is a module with reset
    and act; it is left in eval mode.
    """
    rng = generator(seed, "refresh", step)
    drawn = [draw_training_episode(rng, apartments, 0.0) for _ in range(episodes)]
    simulator = Simulator(renderer.size, renderer=renderer)
    agent.eval()
    return success_rates(
        [
            {"corruption": c.name, **run_episode(agent, simulator, episode, c, seed)}
            for c in map(schedule.corruption, schedule.names)
            for episode in drawn
        ]
    )


def prior_rates(path: Path | str) -> dict[str, float]:
    """Success by corruption in a file of result rows.

    Raises FileNotFoundError or ValueError for a file that is not there or broken, and ValueError
    if it mixes agents, splits or severities.
    """
    found = read(path)
    kinds = {
        "agents": {row["name"] for row in found},
        "splits": {row["split"] for row in found},
        "severities": {f"{row['severity']:g}" for row in found} - {"0"},
    }
    for what, held in kinds.items():
        if len(held) > 1:
            raise ValueError(
                f"{path} holds rows of several {what} ({', '.join(sorted(held))}), so its success "
                "rates say nothing about one agent. Name a file of one evaluation (prior=...)."
            )
    return success_rates(found)


def success_rates(results: list[dict[str, Any]]) -> dict[str, float]:
    """Mean success by corruption of rows or measures; clean ones are left out."""
    names = {row["corruption"] for row in results} - {"clean"}
    return {
        n: float(np.mean([r["success"] for r in results if r["corruption"] == n]))
        for n in sorted(names)
    }
