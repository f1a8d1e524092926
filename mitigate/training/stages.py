"""Run the stages of a plan, write the agent's folder, and evaluate."""

from __future__ import annotations

from pathlib import Path

from hydra.utils import get_method
from omegaconf import OmegaConf
from torch import nn

from mitigate.agents.fingerprint import code_sha
from mitigate.core import checkpoint, seeding
from mitigate.core.build import locate
from mitigate.core.files import write_json, write_text
from mitigate.core.progress import say
from mitigate.evaluation.evaluate import load
from mitigate.training import states
from mitigate.training.config import plain_data
from mitigate.training.estimate import describe
from mitigate.training.plan import IDENTITY, Plan, StagePlan, agent_config
from mitigate.training.ranks import Ranks
from mitigate.training.trainer import Trainer
from mitigate.training.workers import Workers


def run_plan(plan: Plan, ranks: Ranks) -> Path:
    """Run the stages of ``plan``, write the agent's folder, and evaluate."""
    config = plan.config
    if ranks.first:
        say(describe(config, plan.folder))
    with Workers(plan.workers) as workers:
        for stage in plan.stages:
            precision = train_stage(plan, stage, plan.agent, workers, ranks)
            config.active_stages[stage.name].trainer.precision = precision
    if not ranks.first:
        return plan.folder
    plan.agent.cpu().eval()
    settings = OmegaConf.to_yaml({"agent": agent_config(config.agent, plan.agent)})
    checkpoint.save_agent(plan.agent, plan.folder / "agent", settings)
    write_text(plan.folder / "config.yaml", OmegaConf.to_yaml(plain_data(config)))
    if config.evaluation.enabled:
        base = load(config.agent, config.init, config.seed) if config.has_base else None
        get_method(config.report)(config, base, plan.agent, plan.folder)
    print(f"done: {plan.folder}", flush=True)
    return plan.folder


def train_stage(
    plan: Plan, stage: StagePlan, agent: nn.Module, workers: Workers | None, ranks: Ranks
) -> str:
    """Train ``agent`` in place in one stage, and return the precision that was used ("fp32", ...).

    If a stage is already finished, its result is loaded from its folder.
    """
    seed = plan.config.seed
    seeding.seed_everything(seed, "stage", stage.name)
    start = checkpoint.weights_sha(agent)
    objective = stage.objective.build(agent)
    objective.workers = plan.config.workers
    world = locate((plan.config.env.world or {}).get("_target_", "builtins.object"))
    code = code_sha(objective, *([world] if isinstance(world, type) else []))
    known_code = {"code_sha256": code} if code else {}
    identity = {"start": start, **stage.identity, **known_code, **objective.identity()}
    # if there are checkpoints, the trainer compares their recorded identity with this one
    if ranks.first and not states.checkpoints(stage.folder):
        write_json(stage.folder / IDENTITY, identity, indent=2)
    trainer = Trainer(
        objective,
        folder=stage.folder,
        seed=seed,
        config=identity,
        name=stage.name,
        workers=workers,
        ranks=ranks,
        **stage.trainer,
    )
    trainer.fit()
    return trainer.precision
