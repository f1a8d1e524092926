"""Define the options of ``conf/train.yaml`` as dataclasses, and the range of each value.

A value of a wrong type is rejected before anything is built.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, is_dataclass
from numbers import Real
from typing import Any

from omegaconf import MISSING, DictConfig, OmegaConf

from mitigate.core import conf, seeding
from mitigate.core.names import short, unknown
from mitigate.evaluation.config import (
    REPORT,
    CostConfig,
    EnvConfig,
    EvaluationConfig,
    FinetuneConfig,
    SuiteConfig,
    WeightsConfig,
    open_entries,
)

# maximum number of characters of options in a folder name; longer names are cut and end in a hash
LONGEST = 100
COUNT = 10**9  # maximum number of steps; at 1000 steps per second, training would take 11 days
EPISODES = 100_000  # maximum number of episodes per step (heuristic)
PROCESSES = 256  # maximum number of processes (heuristic)
# minimum and maximum of each trainer setting
LIMITS: dict[str, tuple[float, float]] = {
    "steps": (1, COUNT),
    "keep": (1, 10**6),
    "lr": (1e-12, 100.0),
    "weight_decay": (0.0, 100.0),
    "grad_clip": (0.0, 1e9),
    "lag": (0, 64),
    **dict.fromkeys(
        ("warmup", "log_every", "save_every", "eval_every", "figure_every"), (0, COUNT)
    ),
}
# maps each option of a run to its minimum, its maximum and its description
OPTIONS: dict[str, tuple[float, float, str]] = {
    "severity": (0, 1, "a severity from 0 (clean) to 1 (strongest), such as severity=0.6"),
    "severity_depth": (0, 1, "a severity from 0 (clean) to 1 (strongest); null uses severity"),
    "rollouts": (1, EPISODES, "a number of episodes per step, such as rollouts=24"),
    "refresh_episodes": (1, EPISODES, "a number of episodes per measured success rate, such as 8"),
    "workers": (
        0,
        PROCESSES,
        "a number of processes; 0 uses this one, null uses one per core",
    ),
    "evaluation.workers": (1, PROCESSES, "a number of processes; null uses one per core"),
}


@dataclass
class TrainerConfig:
    """Settings of a Trainer.

    If a setting is None, the stage's value is used; if that is None too, the Trainer's default.
    """

    steps: int | None = None
    lr: float | None = None
    weight_decay: float | None = None
    warmup: int | None = None
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
    """One stage of a recipe."""

    # ``_target_`` is the objective; other entries are arguments of the objective and its source
    recipe: Any = None
    trainer: TrainerConfig = field(default_factory=TrainerConfig)
    # seconds per step on the machine of ``precision.REFERENCE``, to estimate the run's duration
    cost: float | None = None

    def settings(self, common: TrainerConfig) -> dict[str, Any]:
        """Return the trainer settings that are not None; ``common`` overrides the stage."""
        pairs = [*vars(self.trainer).items(), *vars(common).items()]
        return {name: value for name, value in pairs if value is not None}


@dataclass
class TrainConfig:
    """Types of the options in ``conf/train.yaml``, which documents each of them."""

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
    agent: Any = MISSING  # becomes a dict when the options are read
    weights: WeightsConfig = field(default_factory=WeightsConfig)
    finetune: FinetuneConfig = field(default_factory=FinetuneConfig)
    cost: CostConfig = field(default_factory=CostConfig)
    env: Any = MISSING  # becomes an EnvConfig when the options are read
    schedule: Any = MISSING  # becomes a dict when the options are read
    suite: Any = MISSING  # becomes a SuiteConfig when the options are read
    stages: dict[str, StageConfig | None] = field(default_factory=dict)
    trainer: TrainerConfig = field(default_factory=TrainerConfig)
    evaluation: EvaluationConfig = field(default_factory=EvaluationConfig)

    @property
    def active_stages(self) -> dict[str, StageConfig]:
        """All stages that are not null, by name."""
        return {name: stage for name, stage in self.stages.items() if stage is not None}

    @property
    def has_base(self) -> bool:
        """Whether the initial weights cover all parts of the agent.

        In that case, the agent is also evaluated with its initial weights.
        """
        return bool(self.init and not self.init_parts)


conf.register("train", TrainConfig)


# ``${either:a,b}`` is the first value, or the second if the first is None
OmegaConf.register_new_resolver("either", lambda a, b: b if a is None else a, replace=True)


def read(cfg: DictConfig) -> TrainConfig:
    """Return the composed options of a training run as typed data, including its folder.

    Raises:
        ValueError: If an entry refers to a missing entry.
    """
    cfg = cfg.copy()
    # the folder is set first, because other entries refer to it
    cfg.folder = cfg.folder or default_folder(cfg)
    config: TrainConfig = conf.typed(cfg, "train")
    config.env = open_entries(EnvConfig, config.env)
    config.suite = open_entries(SuiteConfig, config.suite)
    return config


def plain_data(value: Any) -> Any:
    """Return a config as plain dicts, lists and numbers, as ``config.yaml`` stores it."""
    if is_dataclass(value) and not isinstance(value, type):
        value = vars(value)  # vars() also contains entries that the class does not declare
    if isinstance(value, Mapping):
        return {name: plain_data(entry) for name, entry in value.items()}
    return [*map(plain_data, value)] if isinstance(value, (list, tuple)) else value


def default_folder(config: TrainConfig | DictConfig, variant: str = "") -> str:
    """Return ``runs/<name>-s<severity>[-d<depth>]-seed<seed>[-<variant>]``."""
    depth = "" if config.severity_depth is None else f"-d{config.severity_depth:g}"
    # write booleans in lower case, as sweeps do
    variant = re.sub(r"=(True|False)\b", lambda match: match[0].lower(), variant)
    # replace "=", because Hydra splits options at this character
    end = re.sub(r"[^A-Za-z0-9._+-]+", "_", variant.replace("=", "-"))
    if len(end) > LONGEST:
        end = f"{end[:LONGEST]}-{seeding.digest(variant):032x}"[: LONGEST + 9]
    end = f"-{end}" if end else ""
    return f"{config.runs}/{config.name}-s{config.severity:g}{depth}-seed{config.seed}{end}"


def check_values(config: TrainConfig) -> None:
    """Raise ValueError for an option or a trainer setting that is out of its range."""
    numbers = {**vars(config), "evaluation.workers": config.evaluation.workers}
    for name, (low, high, meaning) in OPTIONS.items():
        value = numbers[name]
        if value is not None and not in_range(value, low, high):
            raise ValueError(
                f"{name} must be from {low:g} to {high:g}, got {number_text(value)}. It is "
                f"{meaning}."
            )
    seeding.check(config.seed)
    for stage in config.active_stages.values():
        check_trainer(stage.settings(config.trainer))


def check_trainer(settings: Mapping[str, Any]) -> None:
    """Raise ValueError for trainer settings that are unknown or out of range."""
    from mitigate.core import precision

    known = [entry.name for entry in fields(TrainerConfig)]
    for name in settings:
        if name not in known:
            raise ValueError(
                unknown("setting of a trainer", f"trainer.{name}", [f"trainer.{n}" for n in known])
            )
    check_limits(settings)
    precision.check(settings.get("precision", "auto"))
    precision.device_of(settings.get("device", "auto"))


def check_limits(settings: Mapping[str, Any]) -> None:
    """Raise ValueError for a trainer setting that is out of its range."""
    for name, (low, high) in LIMITS.items():
        value = settings.get(name)
        if value is not None and not in_range(value, low, high):
            raise ValueError(
                f"trainer.{name} must be a number from {low:g} to {high:g}, got "
                f"{number_text(value)}. Set it on the command line, e.g. trainer.lr=1e-3, or as an "
                "argument of a Python function, e.g. lr=1e-3."
            )


def in_range(value: float, low: float, high: float) -> bool:
    """Return whether ``value`` is a finite number from ``low`` to ``high``."""
    return isinstance(value, Real) and low <= value <= high and math.isfinite(value)


def number_text(value: float) -> str:
    """Return a number as text for a message."""
    if not isinstance(value, Real):
        return short(value)
    # format() fails for integers that are too large for a float
    huge = isinstance(value, int) and value.bit_length() > 60
    return "..." if huge else format(value, ".6g")
