"""Evaluate an agent: ``python -m mitigate.evaluate checkpoint=checkpoints/base split=val_seen``.

Writes one JSON line an episode and condition to ``rows.jsonl`` in the output folder; the same
command again only fills what is missing.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import hydra
from hydra.core.config_store import ConfigStore
from hydra.core.hydra_config import HydraConfig
from omegaconf import MISSING, DictConfig

from mitigate.core import conf, seeding
from mitigate.core.files import atomic_text, find, sha256
from mitigate.core.locks import FolderLock
from mitigate.core.names import counted
from mitigate.evaluation.columns import changed, column_of, name_of
from mitigate.evaluation.conditions import check_sensors, conditions
from mitigate.evaluation.episode_lists import episodes, warn_of_tasks
from mitigate.safeguard.addresses import check_arguments, check_choice
from mitigate.scale import launcher  # registers the kinds of conf/launcher

if TYPE_CHECKING:  # nothing slow is imported before run() has checked the options
    from torch import nn

ROWS = "rows.jsonl"
DECISIONS = "safeguard.jsonl"  # what a safeguard made of each instruction
LIST = "episodes-{split}.sha256"  # of the file that the episodes of a split came from
OLD_LIST = "episodes.sha256"  # the same by an older version: a line a file, of whichever splits
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


@dataclass
class EvaluateConfig:
    """Types of ``conf/evaluate.yaml``; the meaning of each entry is written there."""

    runs: str = "runs"
    checkpoint: str | None = None
    safeguard: str = "none"
    restore: str | None = None
    name: str | None = None
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
    _check(cfg)
    names = list(cfg.suite.conditions) if cfg.conditions is None else list(cfg.conditions)
    chosen = episodes(cfg.env, cfg.split, cfg.episodes)
    met = conditions(names, cfg.severity, cfg.severity_depth)
    from mitigate.core import build
    from mitigate.evaluation.evaluator import evaluate
    from mitigate.restoration.choices import label as restoring
    from mitigate.restoration.restorer import restorer_of
    from mitigate.safeguard.choices import label
    from mitigate.safeguard.guard import open_safeguard

    node = build.settings_of(cfg.agent, cfg.checkpoint, overrides)
    agent = build.build_agent(node, weights=cfg.checkpoint, seed=cfg.seed).eval()
    check_walks(agent)
    front, world = label(cfg.safeguard), build.maker(cfg.env.world)
    sensors = world().sensors
    restorer = restorer_of(cfg.restore, sensors)
    before = [part for part in (front, cfg.restore and restoring(cfg.restore)) if part]
    before = [part for part in before if part != "none"]
    name = "+".join([cfg.name or name_of(cfg.checkpoint), *changed(overrides), *before])
    check_sensors(met, sensors, cfg.env.name)
    out = Path(cfg.out or f"{cfg.runs}/evaluate/{name}-{cfg.split}-s{cfg.severity:g}")
    with FolderLock(out):
        _check_list(out, cfg.split, cfg.env.episodes[cfg.split])
        safeguard = open_safeguard(cfg.safeguard, log=out / DECISIONS)
        print(  # when all is checked: a mistake is told alone
            f"evaluate: {cfg.checkpoint} on {cfg.split}, {counted(len(chosen), 'episode')} x "
            f"{counted(len(met), 'condition')} at severity {cfg.severity:g}",
            flush=True,
        )
        warn_of_tasks(agent, chosen, name, cfg.env.split)
        evaluate(
            agent,
            world,
            chosen,
            met,
            name=name,
            out=out / ROWS,
            split=cfg.split,
            seed=cfg.seed,
            workers=cfg.workers,
            launcher=launcher.chosen(cfg.launcher),
            safeguard=safeguard,
            restorer=restorer,
        )
        write_table([out / ROWS], out)
    return out


def _check(cfg: DictConfig) -> None:
    """Raise ValueError for settings that are well typed but make no sense."""
    check_choice(cfg.safeguard)
    seeding.check(cfg.seed)
    if cfg.checkpoint is None:
        raise ValueError(
            "checkpoint is not set, and no weights are shipped for this agent: name a run's agent "
            "folder (checkpoint=runs/.../agent), or choose an agent that walks episodes "
            "(agent=recurrent; docs/agents.md lists them)."
        )
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
    if not all(callable(getattr(agent, name, None)) for name in ("reset", "act")):
        raise ValueError(
            f"A {type(agent).__name__} walks no episodes: it has no reset() and act(). Choose an "
            "agent that does (agent=..., docs/agents.md)."
        )


def _check_list(folder: Path, split: str, source: str) -> None:
    """Keep the hash of a split's episode file beside the rows, as ``sha256sum`` writes it; raise
    ValueError if it was another: a row names its episode by id alone, so another list's rows would
    count as done."""
    note, found = folder / LIST.format(split=split), sha256(find(source))
    held = _held(folder, split, source)
    if held and found not in held:
        raise ValueError(
            f"{folder} holds rows of another list of {split} than {source} is now. Name another "
            "folder (out=..., of a training folder=...), or delete this one."
        )
    with atomic_text(note) as file:
        file.write(f"{found}  {source}\n")


def _held(folder: Path, split: str, source: str) -> list[str]:
    """The hashes of the lists that the rows of ``split`` in ``folder`` may be of, none if it is not
    known; an older version kept those of all splits in one file, by their paths."""
    note, old = folder / LIST.format(split=split), folder / OLD_LIST
    if note.is_file():
        return note.read_text(encoding="utf-8").split()[:1]
    from mitigate.evaluation.rows import read

    written = (folder / ROWS).is_file() and any(r["split"] == split for r in read(folder / ROWS))
    if not written or not old.is_file():
        return []
    lines = [line.partition("  ") for line in old.read_text(encoding="utf-8").splitlines()]
    return [d for d, _, name in lines if name == source] or [d for d, _, _ in lines]


def load(node: DictConfig, weights: str, seed: int = 0, overrides: Sequence[str] = ()) -> nn.Module:
    """Return the agent of ``weights`` in eval mode, by their own settings if they carry any, else
    by ``node``; what ``overrides`` say of the agent counts more. Raises
    FileNotFoundError if they are missing, ValueError if they do not fit."""
    from mitigate.core import build

    settings = build.settings_of(node, weights, overrides)
    return build.build_agent(settings, weights=weights, seed=seed).eval()


def report_before_after(
    cfg: DictConfig, base_agent: nn.Module | None, trained_agent: nn.Module, folder: Path
) -> None:
    """Evaluate both agents on the same quick subset; print one table, write it and pictures.

    ``cfg`` is a training's config; ``base_agent`` is None for a training from nothing. The
    pictures in ``folder/pictures`` show episodes that the training won back.
    """
    from mitigate.core import build
    from mitigate.evaluation.evaluator import evaluate
    from mitigate.evaluation.trajectories import write_pictures

    quick = cfg.evaluation
    chosen = episodes(cfg.env, quick.split, quick.episodes)
    suite = conditions(list(cfg.suite.conditions), cfg.severity, cfg.severity_depth)
    agents: dict[str, Any] = {"before": base_agent, column_of(cfg, folder): trained_agent}
    agents = {name: agent for name, agent in agents.items() if agent is not None}
    _check_list(folder, quick.split, cfg.env.episodes[quick.split])
    world, rows = build.maker(cfg.env.world), []
    for name, agent in agents.items():
        rows += evaluate(
            agent,
            world,
            chosen,
            suite,
            name=name,
            out=folder / ROWS,
            split=quick.split,
            seed=cfg.seed,
            workers=quick.workers,
        )
    write_table([folder / ROWS], folder)
    written = write_pictures(agents, world(), chosen, rows, folder / "pictures", seed=cfg.seed)
    print("\n".join(f"wrote {path}" for path in written), flush=True)


def write_table(rows: list[Path], out: Path) -> None:
    """Join row files into ``out/table.md`` and pictures, and print the table."""
    from mitigate.evaluation import table

    written = table.run(rows, out)
    print(written[0].read_text(encoding="utf-8"))
    print("\n".join(f"wrote {path}" for path in written), flush=True)


@hydra.main(version_base="1.3", config_path=str(conf.CONF), config_name="evaluate")
def hydra_main(cfg: DictConfig) -> None:
    """Hydra's entry."""
    run(cfg, HydraConfig.get().overrides.task)


def main() -> None:
    """Run from the command line."""
    conf.main(hydra_main, "evaluate", lambda: check_arguments(sys.argv))
