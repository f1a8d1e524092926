"""Plan a run: its conditions, and the settings that their results depend on.

A finished condition is reused only if its settings have not changed. The labels of a run
distinguish its rows from the rows of other agents.
"""

from __future__ import annotations

import hashlib
import json
import os
import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mitigate.bridge.cell import Cell, folder_name
from mitigate.bridge.condition import Condition, Observer, Subset, Words, load_tokenizer
from mitigate.bridge.config import RunConfig, check_options, command_name
from mitigate.bridge.hook import mitigate_hook
from mitigate.bridge.recording import Recorder, path_part
from mitigate.core.files import sha256
from mitigate.corruptions import SUITE_VERSION, Corruption
from mitigate.corruptions.registry import version
from mitigate.evaluation.conditions import conditions
from mitigate.guards.guard import Guards
from mitigate.guards.opening import labels, open_guards

SETTINGS = ("seed", "episodes", "turn", "tokenizer", "missing", "token_length")  # options


@dataclass(frozen=True)
class Plan:
    """A planned run with checked options."""

    config: RunConfig
    command: tuple[str, ...]
    name: str  # name of the table's column, without the names of guards
    out: Path


def make_plan(config: RunConfig, command: Sequence[str]) -> Plan:
    """Return the plan of a run. Raises the same errors as :func:`check_options`."""
    check_options(config, command)
    name = config.name or command_name(command)
    out = Path(config.out or default_folder(config, name))
    return Plan(config, tuple(command), name, out)


def make_cells(plan: Plan) -> list[Cell]:
    """Return all conditions: first clean, then repeated clean runs, then corrupted ones."""
    config, out = plan.config, plan.out
    clean, *others = conditions(config.names, config.severity, config.severity_depth)
    tokenizer = None if config.tokenizer is None else load_tokenizer(config.tokenizer)
    words = Words(tokenizer, config.token_length)
    environment = _adapter_environment(config)
    guards = open_guards(config.safeguard, config.restore, log=out / "safeguard.jsonl")
    if guards.adapts:  # the agent runs in another process
        raise ValueError(
            f"The guard {guards.label} adapts the agent, but the bridge cannot adapt an agent that "
            "runs in another program. Leave restore= out, or choose a guard that changes only "
            "frames or instructions."
        )
    chosen = None if config.episodes is None else Subset(config.episodes, out)
    options, agent = _settings(plan, guards)
    label = _make_label(plan, agent)
    cells: list[Cell] = []
    runs = [(clean, number) for number in range(config.repeats)]
    for corruption, repeat in [*runs, *((corruption, 0) for corruption in others)]:
        name = folder_name(corruption.name, corruption.severity, repeat)
        recording = None if config.record is None else Path(config.record) / name
        condition = Condition(
            *(corruption, config.seed, words, repeat, config.missing, config.turn, chosen, guards),
            observer=Observer() if recording is None else Recorder(recording),
        )
        cells.append(
            Cell(
                name,
                config,
                plan.command,
                out / "conditions" / name,
                condition,
                label,
                options | corruption_settings(corruption) | agent,
                environment,
                clean=cells[0].folder if cells else None,
                recording=recording,
            )
        )
    return cells


def _adapter_environment(config: RunConfig) -> dict[str, str]:
    """Return the environment variable that tells the hook which adapters to attach."""
    if config.adapters is None:
        return {}
    from mitigate.encoders import plain_adapters

    folder, module, target = split_adapters(config.adapters)
    kind, _, path = target.partition(".")
    plain_adapters.read(folder)
    adapters = {"folder": str(Path(folder).resolve()), "file": str(plain_adapters.__file__)}
    adapters |= {"module": module, "class": kind, "path": path}
    return {mitigate_hook.ADAPTERS: json.dumps(adapters)}


def _settings(plan: Plan, guards: Guards) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the settings, except the corruption, that all results of a run depend on.

    Returns:
        The command and options, and the hashes of everything that changes the agent.
    """
    config = plan.config
    options = {"command": shlex.join(plan.command)}
    options |= {name: vars(config)[name] for name in SETTINGS}
    safeguard = "none"  # this import does not load torch
    if config.safeguard != "none":
        from mitigate.guards.text.choices import identity

        safeguard = identity(config.safeguard)
    agent = {"restore": guards.frames_hash(), "adapters": adapters_label(config)}
    return options, {**agent, "safeguard": safeguard, "watch": watched_values(config)}


def watched_values(config: RunConfig) -> dict[str, str | None] | None:
    """Return hashes of files and values of variables in ``watch=``, or None without this option."""
    names = [str(name) for name in config.watch or ()]
    if not names:
        return None
    return {n: sha256(n)[:12] if os.path.isfile(n) else os.environ.get(n) for n in names}


def corruption_settings(corruption: Corruption) -> dict[str, Any]:
    """Return the settings of a condition that come from its corruption."""
    versions = version(corruption.name)
    return {"suite": SUITE_VERSION, "severity": corruption.severity, **versions}


def _as_text(values: dict[str, str | None] | None) -> str | None:
    return None if values is None else json.dumps(values, sort_keys=True)


def _make_label(plan: Plan, agent: dict[str, Any]) -> dict[str, Any]:
    """Return the entries that are the same in all rows of a run.

    The hash of the agent includes the restorer, safeguard, adapters and watched values.
    """
    config = plan.config
    sha = _digest(shlex.join(plan.command))
    safeguard = None if agent["safeguard"] == "none" else agent["safeguard"]
    for part in (agent["restore"], safeguard, agent["adapters"], _as_text(agent["watch"])):
        sha = sha if part is None else _digest(f"{sha} {part}")
    name = _column(config, plan.name)
    return {"agent": sha, "name": name, "split": config.split, "seed": config.seed}


def default_folder(config: RunConfig, name: str) -> Path:
    """Return the default folder of a run, which depends on the agent, severity and episodes."""
    parts = [part for part in (adapters_label(config), _as_text(watched_values(config))) if part]
    folder = "-".join([_column(config, name), *(_digest(part)[:6] for part in parts)])
    folder += f"-s{config.severity:g}" + (f"-e{config.episodes}" if config.episodes else "")
    return Path(config.runs) / "run" / path_part(folder)


def adapters_label(config: RunConfig) -> str | None:
    """Return the hash of the adapters and of the target module's name, or None without adapters."""
    if config.adapters is None:
        return None
    from mitigate.encoders.plain_adapters import WEIGHTS

    folder, module, target = split_adapters(config.adapters)
    file = Path(folder) / WEIGHTS
    if not file.is_file():
        raise FileNotFoundError(
            f"adapters={config.adapters}: there is no file {file}. Name the agent/ folder of a "
            "training run with the recipe encoder."
        )
    return f"{sha256(file)[:12]}:{module}:{target}"


def split_adapters(adapters: str) -> tuple[str, str, str]:
    """Split ``adapters=`` into its folder, module and target (Class.attribute).

    Raises ValueError if the module or the class is missing.
    """
    folder, module, target = (*str(adapters).rsplit(":", 2), "", "")[:3]
    if not target.partition(".")[0] or not module:
        raise ValueError(
            f"adapters={adapters} must be FOLDER:package.module:Class.attribute, where the "
            "attribute is the encoder that the adapters were trained for: "
            "runs/clip/agent:vlnce_baselines.models.encoders.resnet_encoders:CLIPEncoder.model"
        )
    return folder, module, target


def _column(config: RunConfig, name: str) -> str:
    """Return the column name for the table: the command's name and the labels of guards."""
    parts = [name, *labels(config.safeguard, config.restore)]
    parts += ["adapters"] if config.adapters is not None else []
    return "+".join(parts)


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:12]
