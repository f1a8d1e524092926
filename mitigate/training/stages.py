"""One stage of a training: build its recipe, and train by it."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from omegaconf import DictConfig
from torch import nn

from mitigate.agents.fingerprint import code_sha
from mitigate.core import checkpoint, seeding
from mitigate.core.build import build, plain
from mitigate.core.files import atomic_text
from mitigate.training import states
from mitigate.training.ranks import Ranks
from mitigate.training.recipe import Recipe
from mitigate.training.trainer import Trainer
from mitigate.training.workers import Workers

IDENTITY = "identity.json"  # in a stage's folder: its start, settings, code, teacher
NOT_IDENTITY = ("workers", "folder")  # settings of a recipe that do not change what it trains


def train_stage(
    cfg: DictConfig,
    name: str,
    stage: DictConfig,
    agent: nn.Module,
    folder: Path,
    workers: Workers | None = None,
    ranks: Ranks | None = None,
) -> str:
    """Train ``agent`` in place through one stage, and return the precision it was trained in; a
    finished stage is loaded from ``folder``."""
    seeding.seed_everything(cfg.seed, "stage", name)
    start = checkpoint.weights_sha(agent)
    recipe = recipe_of(stage, agent)
    recipe.workers = cfg.workers
    code = code_sha(recipe)
    known_by = {"code_sha256": code} if code else {}
    identity = {"start": start, **named(cfg, stage), **known_by, **recipe.identity()}
    ranks = ranks or Ranks()
    if ranks.first and not states.checkpoints(folder):  # else the trainer compares first
        with atomic_text(folder / IDENTITY) as file:
            json.dump(identity, file, indent=2)
    settings = {"name": name, "workers": workers, "ranks": ranks, **trainer_settings(cfg, stage)}
    trainer = Trainer(recipe, folder=folder, seed=cfg.seed, config=identity, **settings)
    trainer.fit()
    return trainer.precision


def recipe_of(stage: DictConfig, agent: nn.Module) -> Recipe:
    """The recipe of a stage for ``agent``, of which it chooses what trains.

    Raises ValueError for what is no recipe, beside what its constructor raises.
    """
    for parameter in agent.parameters():
        parameter.requires_grad_(parameter.is_floating_point())  # weights in 8 bits never learn
    made = build(stage.recipe, agent=agent)
    if not isinstance(made, Recipe):
        raise ValueError(not_a_recipe(stage.recipe._target_))
    return made


def not_a_recipe(target: str) -> str:
    """What is said of a ``target`` that is no recipe."""
    return (
        f"{target} is no recipe: make it a subclass of mitigate.training.recipe.Recipe "
        '(recipes/README.md, "A new one").'
    )


def named(cfg: DictConfig, stage: DictConfig) -> dict[str, Any]:
    """Of a stage's identity, what its settings alone say."""
    return {"agent": plain(cfg.agent), "recipe": dict(_identity(plain(stage.recipe)))}


def trainer_settings(cfg: DictConfig, stage: DictConfig) -> dict[str, Any]:
    """The settings of a stage's trainer that are set; those of ``cfg.trainer`` go first."""
    return {
        str(name): value
        for node in (stage.trainer, cfg.trainer)
        for name, value in node.items()
        if value is not None
    }


def _identity(node: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    for name, value in node.items():
        if name not in NOT_IDENTITY:
            yield name, dict(_identity(value)) if isinstance(value, dict) else value
