"""Evaluate an agent: ``python -m mitigate.evaluate checkpoint=checkpoints/base split=val_seen``.

Writes one JSON line an episode and condition to ``rows.jsonl`` in the output folder; the same
command again only fills what is missing.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import hydra
from hydra.core.config_store import ConfigStore
from hydra.core.hydra_config import HydraConfig
from omegaconf import MISSING, DictConfig
from torch import nn

from mitigate import cli
from mitigate.build import build_agent, settings_of
from mitigate.files import atomic_text, sha256
from mitigate.safeguard import adapter_folder

ROWS = "rows.jsonl"
DECISIONS = "safeguard.jsonl"  # what a safeguard made of each instruction
LIST = "episodes.sha256"  # of the file that the episodes came from
GOLDEN = (5**0.5 - 1) / 2


@dataclass
class EvaluationConfig:
    """The evaluation that follows a training."""

    enabled: bool = True
    split: str = "val_unseen"
    episodes: int | None = 40
    workers: int = 1


@dataclass
class EvaluateConfig:
    """Types of ``conf/evaluate.yaml``; the meaning of each entry is written there."""

    runs: str = "runs"
    checkpoint: str = "checkpoints/base"
    safeguard: str = "none"
    name: str | None = None
    split: str = "val_unseen"
    episodes: int | None = None
    conditions: list[str] | None = None
    severity: float = 0.6
    severity_depth: float | None = None
    seed: int = 0
    workers: int = 1
    out: str | None = None
    agent: Any = MISSING
    env: Any = MISSING
    suite: Any = field(default=MISSING)


ConfigStore.instance().store(name="evaluate_schema", node=EvaluateConfig)


def run(cfg: DictConfig, overrides: Sequence[str] = ()) -> Path:
    """Evaluate the weights ``cfg.checkpoint`` and return the folder with the rows and the table.

    ``overrides``: those of the command line. Its agent's settings (``agent.blind=[rgb]``) count
    more than the weights' own, and are named in the table's column, as is the size of a view.
    Raises ValueError for an unknown split or condition, FileNotFoundError for missing weights.
    """
    from mitigate.evaluation.evaluator import evaluate
    from mitigate.safeguard.guard import open_safeguard

    node = settings_of(cfg.agent, cfg.checkpoint)
    name = cfg.name or name_of(cfg.checkpoint)
    for setting in _settings_named(overrides):
        node[setting] = cfg.agent[setting]
        name += "+" + re.sub(r"[^A-Za-z0-9.]+", "-", f"{setting}={node[setting]}").strip("-")
    agent = build_agent(node, weights=cfg.checkpoint, seed=cfg.seed).eval()
    if cfg.safeguard != "none":
        name += f"+{_safeguard_label(cfg.safeguard)}"
    if any(override.startswith("env.size=") for override in overrides):
        name += f"+size-{cfg.env.size}"
    out = Path(cfg.out or f"{cfg.runs}/evaluate/{name}-{cfg.split}-s{cfg.severity:g}")
    names = list(cfg.suite.conditions) if cfg.conditions is None else list(cfg.conditions)
    chosen = episodes(cfg.env, cfg.split, cfg.episodes)
    _check_list(out / LIST, cfg.env.episodes[cfg.split])
    evaluate(
        agent,
        chosen,
        conditions(names, cfg.severity, cfg.severity_depth),
        name=name,
        out=out / ROWS,
        split=cfg.split,
        seed=cfg.seed,
        workers=cfg.workers,
        size=cfg.env.size,
        safeguard=open_safeguard(cfg.safeguard, log=out / DECISIONS),
    )
    write_table([out / ROWS], out)
    return out


def _safeguard_label(choice: str) -> str:
    """Return a safeguard's part of a column's name: an adapter's folder with a hash of its weights,
    an endpoint's host and model; the names of ours as they are."""
    if choice.startswith(("http://", "https://")):
        return re.sub(r"[^A-Za-z0-9.@-]+", "-", choice.partition("://")[2])
    weights = Path(choice) / adapter_folder.ADAPTER
    if not weights.is_file():
        return Path(choice).name
    return f"{name_of(choice)}-{sha256(weights)[:6]}"


def _check_list(note: Path, source: str) -> None:
    """Keep the hash of the episode file beside the rows; raise ValueError if it is another one's.

    A row names its episode by id alone, so another list's rows would count as done.
    """
    found = sha256(source)
    if note.is_file() and note.read_text(encoding="utf-8").split()[0] != found:
        raise ValueError(
            f"{note.parent} holds rows of another {source} than there is now. Name another folder "
            "(out=...), or delete this one."
        )
    with atomic_text(note) as file:
        file.write(f"{found}  {source}\n")


def _settings_named(overrides: Sequence[str]) -> list[str]:
    """Return which settings of the agent the command line names, each once."""
    keys = [override.lstrip("+").partition("=")[0].split(".") for override in overrides]
    return list(dict.fromkeys(key[1] for key in keys if key[0] == "agent" and len(key) > 1))


def load(node: DictConfig, weights: str, seed: int = 0) -> nn.Module:
    """Return the agent of ``weights`` in eval mode, by their own settings if they carry any, else
    by ``node``. Raises FileNotFoundError if they are missing, ValueError if they do not fit."""
    return build_agent(settings_of(node, weights), weights=weights, seed=seed).eval()


def name_of(weights: str) -> str:
    """Return the name of weights by their path: of the run, for a run's ``agent`` folder."""
    path = Path(weights.removesuffix(".safetensors"))
    while path.name in ("model", "agent", "run"):
        path = path.parent
    return path.name or "agent"


def report_before_after(
    cfg: DictConfig, base_agent: nn.Module | None, trained_agent: nn.Module, folder: Path
) -> None:
    """Evaluate both agents on the same quick subset; print one table, write it and pictures.

    ``cfg`` is a training's config; ``base_agent`` is None for a training from nothing. The
    pictures in ``folder/pictures`` show episodes that the training won back.
    """
    from mitigate.evaluation.evaluator import evaluate
    from mitigate.evaluation.trajectories import write_pictures

    quick = cfg.evaluation
    chosen = episodes(cfg.env, quick.split, quick.episodes)
    suite = conditions(list(cfg.suite.conditions), cfg.severity, cfg.severity_depth)
    agents: dict[str, Any] = {"before": base_agent, cfg.name: trained_agent}
    agents = {name: agent for name, agent in agents.items() if agent is not None}
    rows = []
    for name, agent in agents.items():
        rows += evaluate(
            agent,
            chosen,
            suite,
            name=name,
            out=folder / ROWS,
            split=quick.split,
            seed=cfg.seed,
            workers=quick.workers,
            size=cfg.env.size,
        )
    write_table([folder / ROWS], folder)
    written = write_pictures(
        agents, chosen, rows, folder / "pictures", seed=cfg.seed, size=cfg.env.size
    )
    print("\n".join(f"wrote {path}" for path in written), flush=True)


def episodes(env: DictConfig, split: str, count: int | None) -> list:
    """Return ``count`` episodes of a split's shipped list (all, if None), spread evenly over it.

    A list goes layout by layout: the first 40 of ``val_unseen`` would be 4 of its 30 layouts. Those
    whose multiples of the golden section have the smallest fractional parts are spread for any
    count, and fewer are always among more: rows of 40 episodes count towards 100.
    Raises ValueError for an unknown split and a count below 1.
    """
    from mitigate.envs.episodes import read_episodes

    if count is not None and count < 1:
        raise ValueError(f"episodes={count} is none: give 1 or more, or null for all of the list.")
    if split not in env.episodes:
        raise ValueError(cli.unknown("split", split, env.episodes))
    listed = list(read_episodes(env.episodes[split]))
    chosen = sorted(range(len(listed)), key=lambda i: i * GOLDEN % 1)[:count]
    return [listed[i] for i in sorted(chosen)]


def conditions(names: list[str], severity: float, severity_depth: float | None) -> list:
    """Return one Corruption for each name; ``clean`` has severity 0."""
    from mitigate.corruptions import CLEAN, DEPTH, INSTRUCTION, RGB, Corruption
    from mitigate.corruptions.suite import check_severity

    allowed = ("clean", *RGB, *DEPTH, *INSTRUCTION)
    for name in names:
        if name not in allowed:
            raise ValueError(cli.unknown("condition", name, allowed))
    severity = check_severity(severity)  # also where all conditions are clean
    depth = severity if severity_depth is None else check_severity(severity_depth)
    return [
        CLEAN if name == "clean" else Corruption(name, depth if name in DEPTH else severity)
        for name in names
    ]


def write_table(rows: list[Path], out: Path) -> None:
    """Join row files into ``out/table.md`` and pictures, and print the table."""
    from mitigate import table

    written = table.run(rows, out)
    print(written[0].read_text(encoding="utf-8"))
    print("\n".join(f"wrote {path}" for path in written), flush=True)


@hydra.main(version_base="1.3", config_path=str(cli.CONF), config_name="evaluate")
def hydra_main(cfg: DictConfig) -> None:
    """Hydra's entry."""
    run(cfg, HydraConfig.get().overrides.task)


if __name__ == "__main__":
    from mitigate import evaluate  # by name, so that its classes exist once

    cli.main(evaluate.hydra_main, "evaluate")
