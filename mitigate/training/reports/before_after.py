"""Evaluate an agent before and after training, and write one table."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from torch import nn

from mitigate.core import build
from mitigate.evaluation import provenance
from mitigate.evaluation.conditions import conditions
from mitigate.evaluation.config import column_of
from mitigate.evaluation.episode_lists import episodes
from mitigate.evaluation.evaluate import write_table
from mitigate.evaluation.evaluator import evaluate
from mitigate.evaluation.rows import ROWS
from mitigate.evaluation.trajectories import write_pictures
from mitigate.training.config import TrainConfig


def report_before_after(
    config: TrainConfig, base_agent: nn.Module | None, trained_agent: nn.Module, folder: Path
) -> None:
    """Evaluate both agents on the same episodes, print and write one table, and write pictures.

    Args:
        config: options of the training run.
        base_agent: the agent before training, or None if it started from scratch.
        trained_agent: the agent after training.
        folder: folder of the run; its subfolder ``pictures`` shows episodes that only the trained
            agent solves.
    """
    quick = config.evaluation
    chosen = episodes(config.env, quick.split, quick.episodes)
    suite = conditions(config.suite.conditions, config.severity, config.severity_depth)
    agents: dict[str, Any] = {} if base_agent is None else {"before": base_agent}
    agents[column_of(config.name, config.seed, folder)] = trained_agent
    world = build.maker(config.env.world)
    rows: list[Any] = []
    first, made_by = provenance.first_world(world)
    provenance.keep(folder, first, made_by, quick.split, chosen, config.env.episodes[quick.split])
    for name, agent in agents.items():
        rows += evaluate(
            agent,
            world,
            chosen,
            suite,
            name=name,
            out=folder / ROWS,
            split=quick.split,
            seed=config.seed,
            workers=quick.workers,
        )
    write_table([folder / ROWS], folder)
    pictures = write_pictures(agents, first, chosen, rows, folder / "pictures", seed=config.seed)
    print("\n".join(f"wrote {path}" for path in pictures), flush=True)
