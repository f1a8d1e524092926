"""One stage of a training: build its recipe, train by it, or say why it has nothing to do."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from omegaconf import DictConfig, OmegaConf
from torch import nn

from mitigate.core import checkpoint, seeding
from mitigate.core.build import build
from mitigate.core.files import atomic_text
from mitigate.training.batches import Workers
from mitigate.training.parts import POLICY, policy_parts
from mitigate.training.ranks import Ranks
from mitigate.training.trainer import Trainer

IDENTITY = "identity.json"  # in a stage's folder: what it started from, its settings, its teacher
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
    agent.requires_grad_(True)
    recipe = build(stage.recipe, agent=agent)
    identity = {
        "agent": plain(cfg.agent),
        "start": start,
        "recipe": dict(_identity(plain(stage.recipe))),
        **recipe.identity(),
    }
    ranks = ranks or Ranks()
    if ranks.first and not checkpoint.checkpoints(folder):  # else the trainer compares first
        with atomic_text(folder / IDENTITY) as file:
            json.dump(identity, file, indent=2)
    settings = {"name": name, "workers": workers, "ranks": ranks, **trainer_settings(cfg, stage)}
    trainer = Trainer(recipe, folder=folder, seed=cfg.seed, config=identity, **settings)
    trainer.fit()
    return trainer.precision


def nothing_to_do(stage: DictConfig, agent: nn.Module) -> str | None:
    """Why a stage has nothing to train in this kind of agent, or None: it sees no such sensor,
    stores no features, or is nothing but encoders. So one recipe serves agents of all kinds."""
    sensor, parts, variants = (
        OmegaConf.select(stage, f"recipe.{key}") for key in ("modality", "train_parts", "variants")
    )
    kind, encoders = type(agent).__name__, getattr(agent, "encoders", None)
    if sensor and encoders and sensor not in encoders:
        return f"{kind} has no {sensor} encoder"
    if variants and not hasattr(agent, "store"):
        return f"{kind} stores no features"
    if parts == POLICY and encoders and not policy_parts(agent):
        return f"nothing but encoders is learned in {kind}"
    return None


def trainer_settings(cfg: DictConfig, stage: DictConfig) -> dict[str, Any]:
    """The settings of a stage's trainer that are set; those of ``cfg.trainer`` go first."""
    return {
        str(name): value
        for node in (stage.trainer, cfg.trainer)
        for name, value in node.items()
        if value is not None
    }


def plain(node: DictConfig) -> dict[str, Any]:
    """A node of a config as plain data."""
    held = OmegaConf.to_container(node, resolve=True)
    assert isinstance(held, dict)
    return {str(name): value for name, value in held.items()}


def _identity(node: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    for name, value in node.items():
        if name not in NOT_IDENTITY:
            yield name, dict(_identity(value)) if isinstance(value, dict) else value
