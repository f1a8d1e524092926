"""Evaluate an agent: ``mitigate evaluate checkpoint=checkpoints/base split=val_seen``.

One JSON line per episode and condition is written to ``rows.jsonl`` in the output folder. If the
command is run again, it runs only missing episodes.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from hydra.core.hydra_config import HydraConfig
from omegaconf import DictConfig

from mitigate.cluster import launcher
from mitigate.core import conf
from mitigate.core.contracts import missing_members
from mitigate.core.locks import FolderLock
from mitigate.core.markdown import plain_text
from mitigate.core.names import counted, name_of
from mitigate.evaluation import config as options
from mitigate.evaluation.conditions import check_sensors, conditions
from mitigate.evaluation.config import EvaluateConfig, changed, default_folder
from mitigate.evaluation.episode_lists import episodes, training_episodes, warn_of_tasks
from mitigate.evaluation.rows import ROWS

DECISIONS = "safeguard.jsonl"  # name of the log with a safeguard's decision on each instruction


def run(cfg: DictConfig, overrides: Sequence[str] = ()) -> Path:
    """Evaluate the weights in ``cfg.checkpoint``; return the folder with the rows and the table.

    Args:
        cfg: the composed options.
        overrides: options of the command line. Options of the agent (``agent.blind=[rgb]``) take
            precedence over the settings of the weights and become part of the column name.

    Raises:
        ValueError: If the split or a condition is unknown, or if no weights are given. It is also
            raised if the agent lacks ``reset`` or ``act``, or if the world lacks a sensor.
        FileNotFoundError: If weights are missing.
    """
    config = options.read(cfg)
    options.check(config, overrides)
    env = config.env
    where = launcher.chosen(config.launcher)
    chosen = episodes(env, config.split, config.episodes)
    chosen_conditions = conditions(config.condition_names, config.severity, config.severity_depth)
    # these imports are slow, so they follow the checks of the options
    from mitigate.core import build
    from mitigate.evaluation import provenance
    from mitigate.evaluation.critical import first_conditions, search
    from mitigate.evaluation.evaluator import evaluate
    from mitigate.guards.opening import open_guards
    from mitigate.guards.text import choices

    agent = load(config.agent, config.checkpoint, config.seed, overrides)
    check_walks(agent)
    world = build.maker(env.world)
    name = _column(config, overrides)
    first, made_by = provenance.first_world(world, config.version)
    check_sensors(chosen_conditions, first.sensors, env.name)
    if config.critical is not None:
        chosen_conditions = first_conditions(chosen_conditions, first.rule)
    choices.check(config.safeguard)
    out = Path(config.out or default_folder(config, name))
    guards = open_guards(
        config.safeguard, config.restore, first.sensors, out / DECISIONS, config.adapt
    )
    guards.calibrate(agent, first, training_episodes(first, env.training))
    with FolderLock(out) as lock:
        source = env.episodes[config.split]
        note = provenance.keep(out, first, made_by, config.split, chosen, source)
        lock.expect(out / ROWS, note)
        print(  # printed after all checks, so that a failed check prints only its error
            f"evaluate: {config.checkpoint or name} on {config.split}, "
            f"{counted(len(chosen), 'episode')} x {counted(len(chosen_conditions), 'condition')} "
            f"at severity {config.severity:g}",
            flush=True,
        )
        warn_of_tasks(agent, chosen, name, env.split)
        measure = partial(
            evaluate,
            agent,
            world,
            chosen,
            name=name,
            out=out / ROWS,
            split=config.split,
            seed=config.seed,
            workers=config.workers,
            launcher=where,
            guards=guards,
            version=config.version,
        )
        if config.critical is None:
            write_table([out / ROWS], out, measure(conditions=chosen_conditions))
        else:
            write_critical(
                search(measure, chosen_conditions, config.critical), config.critical, out
            )
    return out


def _column(config: EvaluateConfig, overrides: Sequence[str]) -> str:
    """Return the column name, which names the weights, the options of the agent, and its guards."""
    from mitigate.guards.opening import labels

    default_name = name_of(config.checkpoint or config.agent["_target_"].rpartition(".")[2])
    parts = [config.name or default_name, *changed(overrides)]
    return "+".join([*parts, *labels(config.safeguard, config.restore, config.adapt)])


def check_walks(agent: Any) -> None:
    """Raise ValueError unless ``agent`` is an object with ``reset`` and ``act``."""
    if isinstance(agent, type):
        raise ValueError(f"agent must be an object, got the class {agent.__name__}.")
    absent = [f"{name}()" for name in missing_members(agent, ("reset", "act"))]
    if absent:
        raise ValueError(
            f"A {type(agent).__name__} cannot run episodes: it has no {' and no '.join(absent)}. "
            "Choose another agent (agent=..., docs/agents.md)."
        )


def load(
    node: Mapping[str, Any], weights: str | None, seed: int = 0, overrides: Sequence[str] = ()
) -> Any:
    """Return an agent in eval mode.

    Args:
        node: the config of the agent; settings that are stored with the weights replace its values.
        weights: file or folder of the weights, or None for an agent without weights.
        seed: seed of random initial weights.
        overrides: options of the command line, which take precedence.

    Raises:
        FileNotFoundError: If the weights are missing.
        ValueError: If the weights do not match the agent, or the agent needs weights.
    """
    from mitigate.agents import building
    from mitigate.agents.agent import as_agent

    settings = node if weights is None else building.settings_of(node, weights, overrides)
    agent = building.build_agent(settings, weights=weights, seed=seed)
    if missing_members(agent, ("state_dict",)):
        return agent
    if weights is None and not as_agent(agent).brings_weights:
        raise ValueError(
            "checkpoint is not set, and this agent has no shipped weights. Name a run's agent "
            "folder (checkpoint=runs/.../agent) or a .safetensors file of its weights, or choose "
            "an agent with shipped weights (docs/agents.md)."
        )
    return agent.eval()


def write_critical(rows: list[dict[str, Any]], losses: Sequence[float], out: Path) -> None:
    """Write and print the critical severities of ``rows`` (``critical.py``)."""
    from mitigate.evaluation import critical, critical_report

    paths = critical_report.write(critical.scores(rows, losses), out)
    print(paths[0].read_text(encoding="utf-8"))
    print("\n".join(f"wrote {path}" for path in paths), flush=True)


def write_table(files: list[Path], out: Path, selected: list[dict[str, Any]] | None = None) -> None:
    """Write the table and the pictures of the rows in ``files`` to ``out``, and print the table.

    If ``selected`` is not None, the printed table contains only these rows of the files.
    """
    from mitigate.evaluation import report, rows
    from mitigate.evaluation.sections import sections

    all_rows = rows.gather(files)
    paths = report.write(all_rows, out)
    if selected is None or len(selected) >= len(all_rows):
        print(plain_text(paths[0].read_text(encoding="utf-8")))
    else:
        others = counted(len(all_rows) - len(selected), "other row")
        print(plain_text(report.markdown(sections(selected))))
        print(f"{out} holds {others}, too; {paths[0]} includes them.")
    print("\n".join(f"wrote {path}" for path in paths), flush=True)


hydra_main = conf.hydra_program("evaluate", lambda cfg: run(cfg, HydraConfig.get().overrides.task))


def _add_kind_of_agent() -> None:
    """Add the ``agent=`` option that fits the weights in ``checkpoint=`` to the command line."""
    if any("checkpoint=" in option for option in sys.argv[1:]):
        from mitigate.agents.building import with_kind

        sys.argv[1:] = with_kind(sys.argv[1:])


def main() -> None:
    """Run from the command line."""
    conf.main(hydra_main, "evaluate", _add_kind_of_agent)
