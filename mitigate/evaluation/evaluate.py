"""Evaluate an agent: ``mitigate evaluate checkpoint=checkpoints/base split=val_seen``.

Writes one JSON line an episode and condition to ``rows.jsonl`` in the output folder; the same
command again only fills what is missing.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import hydra
from hydra.core.hydra_config import HydraConfig
from omegaconf import DictConfig

from mitigate.cluster import launcher
from mitigate.core import conf
from mitigate.core.contracts import lacking
from mitigate.core.locks import FolderLock
from mitigate.core.names import counted, name_of
from mitigate.evaluation import config as options
from mitigate.evaluation.conditions import check_sensors, conditions
from mitigate.evaluation.config import EvaluateConfig, changed, default_folder
from mitigate.evaluation.episode_lists import episodes, warn_of_tasks
from mitigate.evaluation.rows import ROWS
from mitigate.guards.text.addresses import check_arguments

DECISIONS = "safeguard.jsonl"  # what a safeguard made of each instruction


def run(cfg: DictConfig, overrides: Sequence[str] = ()) -> Path:
    """Evaluate the weights ``cfg.checkpoint`` and return the folder with the rows and the table.

    Args:
        cfg: the composed options.
        overrides: those of the command line; what they set of the agent (``agent.blind=[rgb]``)
            counts more than the weights' own settings, and the table's column names it.

    Raises:
        ValueError: for an unknown split or condition, weights that are not named, and an object
            that is no agent or lacks an observation.
        FileNotFoundError: for missing weights.
    """
    config = options.read(cfg)
    options.check(config, overrides)
    return evaluate_agent(config, overrides)


def evaluate_agent(config: EvaluateConfig, overrides: Sequence[str] = ()) -> Path:
    """As :func:`run`, of typed options that were checked."""
    env = config.env
    where = launcher.chosen(config.launcher)
    chosen = episodes(env, config.split, config.episodes)
    met = conditions(config.condition_names, config.severity, config.severity_depth)
    # nothing slow is imported before the options are checked
    from mitigate.core import build
    from mitigate.evaluation import provenance
    from mitigate.evaluation.evaluator import evaluate
    from mitigate.guards.opening import open_guards
    from mitigate.guards.text import choices

    agent = load(config.agent, config.checkpoint, config.seed, overrides)
    check_walks(agent)
    world = build.maker(env.world)
    name = _column(config, overrides)
    first, made_by = provenance.first_world(world, config.version)
    check_sensors(met, first.sensors, env.name)
    choices.check(config.safeguard)
    out = Path(config.out or default_folder(config, name))
    guards = open_guards(config.safeguard, config.restore, first.sensors, log=out / DECISIONS)
    with FolderLock(out) as lock:
        provenance.keep(out, first, made_by, config.split, chosen, env.episodes[config.split])
        lock.expect(out / ROWS, *provenance.notes(out, config.split))
        print(  # when all is checked: a mistake is told alone
            f"evaluate: {config.checkpoint or name} on {config.split}, "
            f"{counted(len(chosen), 'episode')} x {counted(len(met), 'condition')} at severity "
            f"{config.severity:g}",
            flush=True,
        )
        warn_of_tasks(agent, chosen, name, env.split)
        rows = evaluate(
            agent,
            world,
            chosen,
            met,
            name=name,
            out=out / ROWS,
            split=config.split,
            seed=config.seed,
            workers=config.workers,
            launcher=where,
            guards=guards,
            version=config.version,
        )
        write_table([out / ROWS], out, rows)
    return out


def _column(config: EvaluateConfig, overrides: Sequence[str]) -> str:
    """Return the table's column: the weights, options that change the agent, and its guards."""
    from mitigate.guards.opening import labels

    usual = name_of(config.checkpoint or config.agent["_target_"].rpartition(".")[2])
    own = [config.name or usual, *changed(overrides)]
    return "+".join([*own, *labels(config.safeguard, config.restore)])


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
    node: Mapping[str, Any], weights: str | None, seed: int = 0, overrides: Sequence[str] = ()
) -> Any:
    """Return the agent of ``weights`` in eval mode, by their own settings if they carry any, else
    by ``node``; what ``overrides`` say of the agent counts more. None: the agent of ``node``, which
    is no network. Raises FileNotFoundError if they are missing, ValueError if they do not fit."""

    from mitigate.agents import building

    settings = node if weights is None else building.settings_of(node, weights, overrides)
    agent = building.build_agent(settings, weights=weights, seed=seed)
    if lacking(agent, ("state_dict",)):
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
        from mitigate.agents.building import with_kind

        sys.argv[1:] = with_kind(sys.argv[1:])


def main() -> None:
    """Run from the command line."""
    conf.main(hydra_main, "evaluate", _add_kind_of_agent)
