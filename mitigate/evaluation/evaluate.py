"""Evaluate an agent: ``mitigate evaluate checkpoint=checkpoints/base split=val_seen``.

Writes one JSON line an episode and condition to ``rows.jsonl`` in the output folder; the same
command again only fills what is missing.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import hydra
from hydra.core.config_store import ConfigStore
from hydra.core.hydra_config import HydraConfig
from omegaconf import MISSING, DictConfig, OmegaConf

from mitigate.cluster import launcher  # registers the kinds of conf/launcher
from mitigate.core import conf, seeding
from mitigate.core.contracts import lacking
from mitigate.core.locks import FolderLock
from mitigate.core.names import counted, name_of
from mitigate.evaluation.columns import changed, default_folder
from mitigate.evaluation.conditions import check_sensors, conditions
from mitigate.evaluation.episode_lists import episodes, warn_of_tasks
from mitigate.evaluation.rows import ROWS
from mitigate.guards.text.addresses import check_arguments, check_choice

# what a training of an agent ends with
REPORT = "mitigate.training.reports.before_after.report_before_after"
DECISIONS = "safeguard.jsonl"  # what a safeguard made of each instruction
OF_TRAININGS = ("finetune.", "cost.")  # options that a kind of agent has for its trainings
MOST_WORKERS = 100_000  # on all machines of a launcher (ours)


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
    """How recipes teach a policy that is trained already, for the chosen kind of agent."""

    lr: float = 4e-4
    follow_oracle: float = 0.25


@dataclass
class CostConfig:
    """How many times as long as with the topological agent something takes with the chosen kind of
    agent, for the estimate at the start of a training: a step on random views, a step on episodes
    that it walks, an evaluated episode. None: not known."""

    views: float | None = None
    episodes: float | None = None
    evaluation: float | None = None


def times(cost: float, kind: float | None) -> float | None:
    """What ``${times:2.7,${cost.episodes}}`` is in a config: a step's cost with the chosen kind of
    agent, None where that is not known."""
    return None if kind is None else cost * kind


OmegaConf.register_new_resolver("times", times, replace=True)


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
    launcher: Any = MISSING
    out: str | None = None
    agent: Any = MISSING
    weights: WeightsConfig = field(default_factory=WeightsConfig)
    finetune: FinetuneConfig = field(default_factory=FinetuneConfig)
    cost: CostConfig = field(default_factory=CostConfig)
    env: Any = MISSING
    suite: Any = field(default=MISSING)


ConfigStore.instance().store(name="evaluate_schema", node=EvaluateConfig)


def run(cfg: DictConfig, overrides: Sequence[str] = ()) -> Path:
    """Evaluate the weights ``cfg.checkpoint`` and return the folder with the rows and the table.

    ``overrides``: those of the command line; what they say of the agent (``agent.blind=[rgb]``)
    counts more than the weights' own settings, and the table's
    column names it.
    Raises ValueError for an unknown split or condition, weights that are not named, and what is no
    agent or is shown too little, FileNotFoundError for missing weights.
    """
    _check(cfg, overrides)
    where = launcher.chosen(cfg.launcher)
    names = list(cfg.suite.conditions) if cfg.conditions is None else list(cfg.conditions)
    chosen = episodes(cfg.env, cfg.split, cfg.episodes)
    met = conditions(names, cfg.severity, cfg.severity_depth)
    # nothing slow is imported before the options are checked
    from mitigate.core import build
    from mitigate.evaluation import making, walked
    from mitigate.evaluation.evaluator import evaluate
    from mitigate.guards.opening import open_guards
    from mitigate.guards.text import choices

    agent = load(cfg.agent, cfg.checkpoint, cfg.seed, overrides)
    check_walks(agent)
    world, name = build.maker(cfg.env.world), _column(cfg, overrides)
    first, made_by = making.first(world)
    check_sensors(met, first.sensors, cfg.env.name)
    choices.check(cfg.safeguard)
    out = Path(cfg.out or default_folder(cfg, name))
    guards = open_guards(cfg.safeguard, cfg.restore, first.sensors, log=out / DECISIONS)
    with FolderLock(out) as lock:
        walked.keep(out, first, made_by, cfg.split, chosen, cfg.env.episodes[cfg.split])
        lock.expect(out / ROWS, *walked.notes(out, cfg.split))
        print(  # when all is checked: a mistake is told alone
            f"evaluate: {cfg.checkpoint or name} on {cfg.split}, "
            f"{counted(len(chosen), 'episode')} x {counted(len(met), 'condition')} at severity "
            f"{cfg.severity:g}",
            flush=True,
        )
        warn_of_tasks(agent, chosen, name, cfg.env.split)
        rows = evaluate(
            agent,
            world,
            chosen,
            met,
            name=name,
            out=out / ROWS,
            split=cfg.split,
            seed=cfg.seed,
            workers=cfg.workers,
            launcher=where,
            guards=guards,
            version=cfg.version,
        )
        write_table([out / ROWS], out, rows)
    return out


def _column(cfg: DictConfig, overrides: Sequence[str]) -> str:
    """The table's column: the weights, what options change of the agent, and its guards."""
    from mitigate.guards.opening import labels

    usual = name_of(cfg.checkpoint or cfg.agent._target_.rpartition(".")[2])
    own = [cfg.name or usual, *changed(overrides)]
    return "+".join([*own, *labels(cfg.safeguard, cfg.restore)])


def _check(cfg: DictConfig, overrides: Sequence[str]) -> None:
    """Raise ValueError for settings that are well typed but make no sense."""
    idle = [option for option in overrides if option.lstrip("+").startswith(OF_TRAININGS)]
    if idle:
        raise ValueError(f"{idle[0]} is for trainings: an evaluation changes no weights.")
    check_choice(cfg.safeguard)
    seeding.check(cfg.seed)
    if cfg.workers is not None and not 1 <= cfg.workers <= MOST_WORKERS:
        raise ValueError(
            f"workers={cfg.workers} must be a number of processes from 1 to {MOST_WORKERS}, or "
            "null for one a core."
        )


def check_walks(agent: Any) -> None:
    """Raise ValueError for what cannot be evaluated: it lacks ``reset`` or ``act``, or is the class
    of an agent and not one."""
    if isinstance(agent, type):
        raise ValueError(
            f"{agent.__name__} is a class and walks no episodes: give an object of it."
        )
    absent = [f"{name}()" for name in lacking(agent, ("reset", "act"))]
    if absent:
        raise ValueError(
            f"A {type(agent).__name__} walks no episodes: it has no {' and no '.join(absent)}. "
            "Choose an agent that does (agent=..., docs/agents.md)."
        )


def load(
    node: DictConfig, weights: str | None, seed: int = 0, overrides: Sequence[str] = ()
) -> Any:
    """Return the agent of ``weights`` in eval mode, by their own settings if they carry any, else
    by ``node``; what ``overrides`` say of the agent counts more. None: the agent of ``node``, which
    is no network. Raises FileNotFoundError if they are missing, ValueError if they do not fit."""

    from mitigate.agents import loading

    settings = node if weights is None else loading.settings_of(node, weights, overrides)
    agent = loading.build_agent(settings, weights=weights, seed=seed)
    if not hasattr(agent, "state_dict"):
        return agent
    if weights is None:
        raise ValueError(
            "checkpoint is not set, and no weights are shipped for this agent: name a run's agent "
            "folder (checkpoint=runs/.../agent) or a .safetensors file of its weights, or choose "
            "an agent that walks episodes (agent=recurrent; docs/agents.md lists them)."
        )
    return agent.eval()


def write_table(files: list[Path], out: Path, asked: list[dict[str, Any]] | None = None) -> None:
    """Join row files into ``out/table.md`` and pictures, and print the table: of the rows that were
    ``asked`` for alone, if there are others beside them."""
    from mitigate.evaluation import report, rows
    from mitigate.evaluation.sections import sections

    found = rows.gather(files)
    written = report.write(found, out)
    others = 0 if asked is None else len(found) - len(asked)
    if asked is None or others <= 0:
        print(written[0].read_text(encoding="utf-8"))
    else:
        print(report.markdown(sections(asked)))
        print(f"{out} holds {counted(others, 'other row')} besides: {written[0]} is of all.")
    print("\n".join(f"wrote {path}" for path in written), flush=True)


@hydra.main(version_base="1.3", config_path=str(conf.CONF), config_name="evaluate")
def hydra_main(cfg: DictConfig) -> None:
    """Hydra's entry."""
    run(cfg, HydraConfig.get().overrides.task)


def _add_kind_of_agent() -> None:
    """Check the command line, and add the kind of agent that its weights are of."""
    check_arguments(sys.argv)
    if any("checkpoint=" in option for option in sys.argv[1:]):
        from mitigate.agents.loading import with_kind

        sys.argv[1:] = with_kind(sys.argv[1:])


def main() -> None:
    """Run from the command line."""
    conf.main(hydra_main, "evaluate", _add_kind_of_agent)
