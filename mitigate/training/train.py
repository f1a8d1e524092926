"""Train an agent by a recipe: ``mitigate train recipe=da_per_episode severity=0.6``.

A recipe names one or more stages; one agent goes through them in order, each in a subfolder of the
run. The same command again goes on where the last one stopped. Afterwards the agent is evaluated
before and after.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Mapping
from contextlib import nullcontext
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import hydra
from hydra.core.config_store import ConfigStore
from hydra.core.hydra_config import HydraConfig
from hydra.types import RunMode
from hydra.utils import get_method
from omegaconf import MISSING, DictConfig, OmegaConf

from mitigate.core import conf, seeding
from mitigate.core.build import maker
from mitigate.core.files import atomic_text
from mitigate.core.locks import FolderLock
from mitigate.core.names import unknown
from mitigate.core.progress import say
from mitigate.core.workers import cores
from mitigate.evaluation.conditions import check_sensors, conditions
from mitigate.evaluation.episode_lists import episodes
from mitigate.evaluation.evaluate import (
    REPORT,
    CostConfig,
    EvaluationConfig,
    FinetuneConfig,
    WeightsConfig,
    load,
)

if TYPE_CHECKING:  # nothing slow is imported before the options are composed
    from torch import nn

    from mitigate.training.ranks import Ranks

LONGEST = 100  # characters of a run folder's options; what is longer ends in a digest (ours)


@dataclass
class TrainerConfig:
    """Settings of a Trainer; None means "as the stage says", or else the Trainer's default."""

    steps: int | None = None
    lr: float | None = None
    weight_decay: float | None = None
    warmup: int | None = None
    schedule: str | None = None
    grad_clip: float | None = None
    log_every: int | None = None
    save_every: int | None = None
    eval_every: int | None = None
    figure_every: int | None = None
    keep: int | None = None
    lag: int | None = None
    precision: str | None = None
    device: str | None = None


@dataclass
class StageConfig:
    """One stage: what to train (a ``_target_`` node), how, and what a step costs: seconds on the
    machine of ``precision.REFERENCE``, for the estimate at the start alone. None: not known."""

    recipe: Any = MISSING
    trainer: TrainerConfig = field(default_factory=TrainerConfig)
    cost: float | None = None


@dataclass
class TrainConfig:
    """Types of ``conf/train.yaml``; the meaning of each entry is written there."""

    name: str = MISSING
    seed: int = 0
    severity: float = 0.6
    severity_depth: float | None = None
    init: str | None = None
    init_parts: list[str] | None = None
    teacher: str | None = None
    rollouts: int = 24
    refresh_episodes: int = 8
    runs: str = "runs"
    folder: str | None = None
    workers: int | None = None
    report: str = REPORT
    agent: Any = MISSING
    weights: WeightsConfig = field(default_factory=WeightsConfig)
    finetune: FinetuneConfig = field(default_factory=FinetuneConfig)
    cost: CostConfig = field(default_factory=CostConfig)
    env: Any = MISSING
    schedule: Any = MISSING
    suite: Any = MISSING
    stages: dict[str, StageConfig | None] = field(default_factory=dict)
    trainer: TrainerConfig = field(default_factory=TrainerConfig)
    evaluation: EvaluationConfig = field(default_factory=EvaluationConfig)


ConfigStore.instance().store(name="train_schema", node=TrainConfig)


def either(first: Any, second: Any) -> Any:
    """What ``${either:${trainer.steps},${stages.policy.trainer.steps}}`` is in a config: the first
    value, or the second where that is null."""
    return second if first is None else first


OmegaConf.register_new_resolver("either", either, replace=True)


def run(cfg: DictConfig) -> Path:
    """Train as ``cfg`` says, evaluate, and return the run's folder.

    The folder holds ``config.yaml``, one subfolder for each stage, ``agent/model.safetensors``, and
    what the evaluation writes. Raises ValueError or FileNotFoundError for a user's mistake.
    """
    check(cfg)
    from mitigate.training.ranks import Ranks

    with Ranks.of_environment() as ranks:
        cfg.folder = cfg.folder or default_folder(cfg)  # what refers to it finds it
        within = ("agent", "walks", *cfg.stages)
        with FolderLock(cfg.folder, within) if ranks.first else nullcontext():
            return _run(cfg, Path(cfg.folder), ranks)


def _run(cfg: DictConfig, folder: Path, ranks: Ranks) -> Path:
    from mitigate.agents.loading import begun_from, build_agent
    from mitigate.core import checkpoint
    from mitigate.training import fitting
    from mitigate.training.estimate import has_base, plan
    from mitigate.training.stages import train_stage
    from mitigate.training.workers import MOST, Workers

    begun = begun_from(cfg.agent, cfg.init)  # refuses the weights of another kind of agent
    node = cfg.agent if cfg.init_parts else begun
    agent = build_agent(node, weights=cfg.init, seed=cfg.seed, parts=cfg.init_parts)
    OmegaConf.resolve(cfg.stages)  # a stage that is left out may be named by another
    fitting.check_teacher(cfg)
    fitting.tell_of_schedule(cfg)
    fitting.leave_out(cfg, agent)
    fitting.tell_of_warmup(cfg)
    fitting.draw_what_is_read(cfg, agent)
    fitting.check(cfg, agent, folder, ranks)
    if ranks.first:
        say(plan(cfg, folder))
    with Workers(min(MOST, cores()) if cfg.workers is None else cfg.workers) as workers:
        for name, stage in cfg.stages.items():
            if stage is not None:
                stage.trainer.precision = train_stage(
                    cfg, name, stage, agent, folder / name, workers, ranks
                )
    if not ranks.first:
        return folder
    agent.cpu().eval()
    config = OmegaConf.to_yaml({"agent": written(cfg.agent, agent)})
    checkpoint.save_agent(agent, folder / "agent", config)
    with atomic_text(folder / "config.yaml") as file:
        file.write(OmegaConf.to_yaml(cfg, resolve=True))
    if cfg.evaluation.enabled:
        base = load(cfg.agent, cfg.init, cfg.seed) if has_base(cfg) else None
        get_method(cfg.report)(cfg, base, agent, folder)
    print(f"done: {folder}", flush=True)
    return folder


def check(cfg: DictConfig) -> None:
    """Raise ValueError for settings that are well typed but make no sense."""
    from mitigate.training import limits
    from mitigate.training.stages import trainer_settings

    limits.check_options(cfg)
    seeding.check(cfg.seed)
    for stage in cfg.stages.values():
        if stage is not None:
            check_trainer(trainer_settings(cfg, stage))
    if not any(cfg.stages.values()):
        raise ValueError(f"The recipe {cfg.name} has no stages: its YAML must list at least one.")
    if OmegaConf.select(cfg, "env.training") is None and cfg.report == REPORT:
        raise ValueError(
            f"The world {cfg.env.name} has no training episodes: give its config an entry "
            "training, such as {_target_: mitigate.worlds.episodes.ListedEpisodes, path: x.json}."
        )
    for name, stage in cfg.stages.items():
        if stage is not None and not OmegaConf.select(stage, "recipe._target_", default=None):
            own = [n for n, s in cfg.stages.items() if s and OmegaConf.select(s, "recipe._target_")]
            raise ValueError(
                f"The recipe {cfg.name} has no stage {name!r}: its stages are {', '.join(own)}. "
                "Leave out what sets another one (experiment=frozen fits imitation and da_* only)."
            )
    listed = cfg.report == REPORT or OmegaConf.select(cfg, "env.episodes")
    if cfg.evaluation.enabled and listed:  # a mistake must not show only after hours of training
        count = cfg.evaluation.episodes
        episodes(cfg.env, cfg.evaluation.split, count if count is None else min(count, 1))
        met = conditions(list(cfg.suite.conditions), cfg.severity, cfg.severity_depth)
        if cfg.report == REPORT:
            check_sensors(met, maker(cfg.env.world)().sensors, cfg.env.name)


def check_trainer(settings: Mapping[str, Any]) -> None:
    """Raise ValueError for settings of a trainer that are unknown, or that it would not take."""
    from mitigate.core import precision
    from mitigate.training import limits, optimization

    known = [entry.name for entry in fields(TrainerConfig)]
    for name in settings:
        if name not in known:
            raise ValueError(
                unknown("setting of a trainer", f"trainer.{name}", [f"trainer.{n}" for n in known])
            )
    limits.check(settings)
    if "schedule" in settings:
        optimization.check(settings["schedule"])
    precision.check(settings.get("precision", "auto"))
    precision.device_of(settings.get("device", "auto"))


def default_folder(cfg: DictConfig, variant: str = "") -> str:
    """Return ``runs/<name>-s<severity>[-d<depth>]-seed<seed>[-<variant>]``."""
    depth = "" if cfg.severity_depth is None else f"-d{cfg.severity_depth:g}"
    variant = re.sub(r"=(True|False)\b", lambda found: found[0].lower(), variant)  # sweeps' case
    end = re.sub(r"[^A-Za-z0-9._+-]+", "_", variant.replace("=", "-"))  # Hydra splits at "="
    if len(end) > LONGEST:
        end = f"{end[:LONGEST]}-{seeding.digest(variant):032x}"[: LONGEST + 9]
    end = f"-{end}" if end else ""
    return f"{cfg.runs}/{cfg.name}-s{cfg.severity:g}{depth}-seed{cfg.seed}{end}"


def written(node: DictConfig, agent: nn.Module) -> dict[str, Any]:
    """What lies beside the weights of ``agent``: its config, with what it says itself
    (``settings()``, such as its vocabulary). Which classes are inside it is for the reader's own
    config to say."""

    def data(value: Any) -> Any:
        if isinstance(value, dict):
            return {k: data(v) for k, v in value.items() if not str(k).startswith("_")}
        return value

    from mitigate.core.build import plain

    own: dict[str, Any] = getattr(agent, "settings", dict)()
    from mitigate.agents.agent import as_agent

    barred = as_agent(agent).own_config_only
    held = {name: value for name, value in data(plain(node)).items() if name not in barred}
    return {"_target_": node._target_, **held, **data(own)}


@hydra.main(version_base="1.3", config_path=str(conf.CONF), config_name="train")
def hydra_main(cfg: DictConfig) -> None:
    """Name the folder after the options that differ from the defaults, then run."""
    if cfg.folder is None:
        cfg.folder = default_folder(cfg, HydraConfig.get().job.override_dirname)
    try:
        run(cfg)
    except Exception as error:
        if HydraConfig.get().mode == RunMode.MULTIRUN:  # Hydra goes on and shows the first only
            print(f"failed: {cfg.folder}: {error}", file=sys.stderr, flush=True)
        raise


def main() -> None:
    """Run from the command line."""
    conf.main(hydra_main, "train")
