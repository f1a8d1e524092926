"""Define the types of the options in ``conf/evaluate.yaml``, and the names of table columns and
output folders that depend on them.

Training also uses some of these options.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, TypeVar

from omegaconf import MISSING, DictConfig, OmegaConf

from mitigate.cluster import launcher  # noqa: F401 - registers the kinds of conf/launcher
from mitigate.core import conf, seeding
from mitigate.core.addresses import check_choice
from mitigate.core.conf import CONF
from mitigate.evaluation import conditions  # noqa: F401 - registers ${suite:...} of conf/suite

# import path of the report at the end of an agent's training
REPORT = "mitigate.training.reports.before_after.report_before_after"
TRAINING_OPTIONS = ("finetune.", "cost.")  # prefixes of agent options that affect only training
# maximum total number of workers on all machines of a launcher (heuristic)
MOST_WORKERS = 100_000

Entries = TypeVar("Entries")


@dataclass
class EvaluationConfig:
    """Options of the evaluation at the end of a training run."""

    enabled: bool = True
    split: str = "val_unseen"
    episodes: int | None = 40
    workers: int | None = None


@dataclass
class WeightsConfig:
    """Paths of the shipped weights for the chosen kind of agent; None means no weights."""

    base: str | None = None
    teacher: str | None = None


@dataclass
class FinetuneConfig:
    """Options that recipes use to fine-tune a trained policy of the chosen kind of agent."""

    lr: float = 4e-4
    follow_oracle: float = 0.25


@dataclass
class CostConfig:
    """Computing time of the chosen kind of agent, relative to the topological agent; None means
    unknown.

    The time estimate at the start of a training run uses these costs.

    Attributes:
        views: relative time of a training step on random views.
        episodes: relative time of a training step on rollouts.
        evaluation: relative time of an evaluated episode.
    """

    views: float | None = None
    episodes: float | None = None
    evaluation: float | None = None


def times(cost: float, factor: float | None) -> float | None:
    """Resolve ``${times:2.7,${cost.episodes}}`` in a config to the product of the numbers, or to
    None if ``factor`` is unknown.
    """
    return None if factor is None else cost * factor


OmegaConf.register_new_resolver("times", times, replace=True)


USUAL = "s0.6"  # the severity of conf/train.yaml, as in the name of a run's folder


@dataclass
class EnvConfig:
    """Options in a file of ``conf/env``. Undeclared options become attributes too."""

    name: str = ""
    world: dict[str, Any] = field(default_factory=dict)
    training: dict[str, Any] | None = None
    split: str = ""
    episodes: dict[str, str] = field(default_factory=dict)


@dataclass
class SuiteConfig:
    """Options in a file of ``conf/suite``. Undeclared options become attributes too."""

    conditions: list[str] = field(default_factory=list)


def open_entries(kind: type[Entries], entries: Mapping[str, Any]) -> Entries:
    """Construct a dataclass ``kind`` from ``entries``. Undeclared entries become attributes too."""
    declared = {entry.name for entry in fields(kind)}  # type: ignore[arg-type]
    config = kind(**{name: value for name, value in entries.items() if name in declared})
    vars(config).update(entries)
    return config


@dataclass
class EvaluateConfig:
    """The options in ``conf/evaluate.yaml`` with their types; the file documents each option."""

    runs: str = "runs"
    checkpoint: str | None = None
    # not an enum, because Hydra's type error would print the value, which may be a password
    safeguard: Any = "none"
    restore: str | None = None
    adapt: str | None = None
    name: str | None = None
    version: str | None = None
    split: str = "val_unseen"
    episodes: int | None = None
    conditions: list[str] | None = None
    severity: float = 0.6
    severity_depth: float | None = None
    critical: list[float] | None = None
    seed: int = 0
    workers: int | None = None
    launcher: Any = MISSING  # becomes a LauncherConfig when the options are read
    out: str | None = None
    agent: Any = MISSING  # becomes a dict when the options are read
    weights: WeightsConfig = field(default_factory=WeightsConfig)
    finetune: FinetuneConfig = field(default_factory=FinetuneConfig)
    cost: CostConfig = field(default_factory=CostConfig)
    env: Any = MISSING  # becomes an EnvConfig when the options are read
    suite: Any = MISSING  # becomes a SuiteConfig when the options are read

    @property
    def condition_names(self) -> list[str]:
        """The names of the conditions to evaluate: "clean" and those that the options name."""
        named = self.suite.conditions if self.conditions is None else self.conditions
        return ["clean", *named] if named else []


conf.register("evaluate", EvaluateConfig)


def read(cfg: DictConfig) -> EvaluateConfig:
    """Convert the composed config of an evaluation to typed options.

    Raises:
        ValueError: If an entry refers to a missing entry.
    """
    config: EvaluateConfig = conf.typed(cfg, "evaluate")
    config.env = open_entries(EnvConfig, config.env)
    config.suite = open_entries(SuiteConfig, config.suite)
    return config


def check(config: EvaluateConfig, overrides: Sequence[str] = ()) -> None:
    """Raise ValueError for options that have the right type but an invalid value."""
    unused = [option for option in overrides if option.lstrip("+").startswith(TRAINING_OPTIONS)]
    if unused:
        raise ValueError(
            f"{unused[0]} must be left out: it is a training option, and an evaluation does not "
            "train."
        )
    check_choice(config.safeguard)
    seeding.check(config.seed)
    if config.critical is not None:
        from mitigate.evaluation.critical import check_losses

        check_losses(config.critical)
    if config.workers is not None and not 1 <= config.workers <= MOST_WORKERS:
        raise ValueError(
            f"workers must be from 1 to {MOST_WORKERS}, or null (one process per core), got "
            f"{config.workers}."
        )


def changed(overrides: Sequence[str]) -> list[str]:
    """Return the options that change the agent or its input, as text for a column name."""
    stripped = [option.lstrip("+") for option in overrides]
    relevant = [option for option in stripped if option.startswith(("agent.", "env.size="))]
    # dashes replace characters that a file name should not contain
    return [re.sub(r"[^A-Za-z0-9.@-]+", "-", x.removeprefix("agent.")).strip("-") for x in relevant]


def column_of(name: str, seed: int, folder: Path) -> str:
    """Return the column name of a training run.

    It has ``name``, the severity if it is not ``USUAL``, and the options that appear in the name of
    the run's folder.

    Without them, runs with different settings would be treated as different seeds of one column.
    """
    before, _, options = folder.name.partition(f"-seed{seed}")
    severity = before.removeprefix(f"{name}-") if before.startswith(f"{name}-s") else ""
    parts = ["" if severity == USUAL else severity, options.removeprefix("-")]
    return "+".join([name, *filter(None, parts)])


def default_folder(config: EvaluateConfig, name: str) -> str:
    """Return ``runs/evaluate/<name>-[<world>-]<split>-s<severity>``.

    The name of the world is left out for worlds of this project, because the names of their splits
    are unique.
    """
    custom = not (CONF / "env" / f"{config.env.name}.yaml").is_file()
    split = f"{config.env.name}-{config.split}" if custom else config.split
    depth = "" if config.severity_depth is None else f"-d{config.severity_depth:g}"
    return f"{config.runs}/evaluate/{name}-{split}-s{config.severity:g}{depth}"
