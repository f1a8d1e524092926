"""The options of ``conf/evaluate.yaml`` as dataclasses, parts that trainings share, and names of
columns and folders that follow from options.
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
from mitigate.core.conf import CONF
from mitigate.evaluation import conditions  # noqa: F401 - registers ${suite:...} of conf/suite
from mitigate.guards.text.addresses import check_choice

# the report that a training of an agent ends with
REPORT = "mitigate.training.reports.before_after.report_before_after"
TRAINING_OPTIONS = ("finetune.", "cost.")  # options of an agent that act on its trainings alone
MOST_WORKERS = 100_000  # on all machines of a launcher, a generous bound

Entries = TypeVar("Entries")


@dataclass
class EvaluationConfig:
    """The evaluation that follows a training."""

    enabled: bool = True
    split: str = "val_unseen"
    episodes: int | None = 40
    workers: int | None = None


@dataclass
class WeightsConfig:
    """The weights that are shipped for the chosen kind of agent, if any."""

    base: str | None = None
    teacher: str | None = None


@dataclass
class FinetuneConfig:
    """How recipes fine-tune a trained policy of the chosen kind of agent."""

    lr: float = 4e-4
    follow_oracle: float = 0.25


@dataclass
class CostConfig:
    """Cost of the chosen kind of agent, relative to the topological agent; None: unknown.

    The estimate at the start of a training uses a step on random views, a step on rollouts and an
    evaluated episode.
    """

    views: float | None = None
    episodes: float | None = None
    evaluation: float | None = None


def times(cost: float, factor: float | None) -> float | None:
    """Resolve ``${times:2.7,${cost.episodes}}`` in a config; None where a factor is unknown."""
    return None if factor is None else cost * factor


OmegaConf.register_new_resolver("times", times, replace=True)


@dataclass
class EnvConfig:
    """A file of ``conf/env``; its further entries become attributes."""

    name: str = ""
    world: dict[str, Any] = field(default_factory=dict)
    training: dict[str, Any] | None = None
    split: str = ""
    episodes: dict[str, str] = field(default_factory=dict)


@dataclass
class SuiteConfig:
    """A file of ``conf/suite``; its further entries become attributes."""

    conditions: list[str] = field(default_factory=list)


def open_entries(kind: type[Entries], entries: Mapping[str, Any]) -> Entries:
    """Return a ``kind`` with ``entries``; those that it does not declare become attributes too."""
    declared = {entry.name for entry in fields(kind)}  # type: ignore[arg-type]
    made = kind(**{name: value for name, value in entries.items() if name in declared})
    vars(made).update(entries)
    return made


@dataclass
class EvaluateConfig:
    """Types of ``conf/evaluate.yaml``; the meaning of each entry is written there."""

    runs: str = "runs"
    checkpoint: str | None = None
    safeguard: str = "none"
    restore: str | None = None
    name: str | None = None
    version: str | None = None
    split: str = "val_unseen"
    episodes: int | None = None
    conditions: list[str] | None = None
    severity: float = 0.6
    severity_depth: float | None = None
    seed: int = 0
    workers: int | None = None
    launcher: Any = MISSING  # read: a LauncherConfig
    out: str | None = None
    agent: Any = MISSING  # read: a dict
    weights: WeightsConfig = field(default_factory=WeightsConfig)
    finetune: FinetuneConfig = field(default_factory=FinetuneConfig)
    cost: CostConfig = field(default_factory=CostConfig)
    env: Any = MISSING  # read: an EnvConfig
    suite: Any = MISSING  # read: a SuiteConfig

    @property
    def condition_names(self) -> list[str]:
        """The names of the conditions to evaluate."""
        return list(self.suite.conditions if self.conditions is None else self.conditions)


conf.register("evaluate", EvaluateConfig)


def read(cfg: DictConfig) -> EvaluateConfig:
    """Return the composed options of an evaluation as typed data.

    Raises:
        ValueError: for an entry that refers to a missing one.
    """
    config: EvaluateConfig = conf.typed(cfg, "evaluate")
    config.env = open_entries(EnvConfig, config.env)
    config.suite = open_entries(SuiteConfig, config.suite)
    return config


def check(config: EvaluateConfig, overrides: Sequence[str] = ()) -> None:
    """Raise ValueError for settings that are well typed but make no sense."""
    idle = [option for option in overrides if option.lstrip("+").startswith(TRAINING_OPTIONS)]
    if idle:
        raise ValueError(f"{idle[0]} is for trainings: an evaluation changes no weights.")
    check_choice(config.safeguard)
    seeding.check(config.seed)
    if config.workers is not None and not 1 <= config.workers <= MOST_WORKERS:
        raise ValueError(
            f"workers={config.workers} must be a number of processes from 1 to {MOST_WORKERS}, or "
            "null for one a core."
        )


def changed(overrides: Sequence[str]) -> list[str]:
    """Return the options of a command line that change the agent or what it sees, as parts of a
    column's name."""
    own = [option.lstrip("+") for option in overrides]
    own = [option for option in own if option.startswith(("agent.", "env.size="))]
    return [_plain(option.removeprefix("agent.")).strip("-") for option in own]


def column_of(name: str, seed: int, folder: Path) -> str:
    """Return the column of a training: the recipe, and the options that its folder's name holds, so
    that other settings are no other seeds of it."""
    options = folder.name.partition(f"-seed{seed}-")[2]
    return f"{name}+{options}" if options else name


def default_folder(config: EvaluateConfig, name: str) -> str:
    """Return ``runs/evaluate/<name>-[<world>-]<split>-s<severity>``; the world is named unless its
    config is of this project, whose worlds have splits of their own."""
    own = not (CONF / "env" / f"{config.env.name}.yaml").is_file()
    split = f"{config.env.name}-{config.split}" if own else config.split
    return f"{config.runs}/evaluate/{name}-{split}-s{_severities(config)}"


def _severities(config: EvaluateConfig) -> str:
    """The severities, as part of a folder's name."""
    depth = "" if config.severity_depth is None else f"-d{config.severity_depth:g}"
    return f"{config.severity:g}{depth}"


def _plain(text: str) -> str:
    """Return ``text`` with a dash for all that a file's name should not hold."""
    return re.sub(r"[^A-Za-z0-9.@-]+", "-", text)
