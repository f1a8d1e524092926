"""What a run consists of: its conditions, and what their results depend on.

By the settings of a condition a finished one is known again. By the labels of a run its rows are
told from those of another agent.
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
from mitigate.bridge.condition import Condition, Observer, Subset, Words, tokenizer_of
from mitigate.bridge.config import RunConfig, check_options, name_of
from mitigate.bridge.hook import mitigate_hook
from mitigate.bridge.recording import Recorder, plain
from mitigate.core.files import sha256
from mitigate.corruptions import SUITE_VERSION, Corruption
from mitigate.corruptions.registry import version
from mitigate.evaluation.conditions import conditions
from mitigate.guards.guard import Guards
from mitigate.guards.opening import labels, open_guards

SETTINGS = ("seed", "episodes", "turn", "tokenizer", "missing", "token_length")  # as they are


@dataclass(frozen=True)
class Plan:
    """A run whose options were checked.

    Attributes:
        config: The options.
        command: The words of the user's command.
        name: Column of the table, before the names of guards.
        out: Output folder.
    """

    config: RunConfig
    command: tuple[str, ...]
    name: str
    out: Path


def make_plan(config: RunConfig, command: Sequence[str]) -> Plan:
    """Return the plan of a run. Raises as :func:`check_options`."""
    check_options(config, command)
    name = config.name or name_of(command)
    out = Path(config.out or default_folder(config, name))
    return Plan(config, tuple(command), name, out)


def cells(plan: Plan) -> list[Cell]:
    """All conditions of a run, clean first, then repeated clean runs."""
    config, out = plan.config, plan.out
    clean, *others = conditions(config.names, config.severity, config.severity_depth)
    words = _words(config)
    environment = _environment(config)
    guards = open_guards(config.safeguard, config.restore, log=out / "safeguard.jsonl")
    _check_guards(guards)
    chosen = None if config.episodes is None else Subset(config.episodes, out)
    keep = None if chosen is None else chosen.keep
    fixed, added = _settings(plan, guards)
    label = _label(plan, added)
    made: list[Cell] = []
    for corruption, repeat in [
        *((clean, number) for number in range(config.repeats)),
        *((corruption, 0) for corruption in others),
    ]:
        name = folder_name(corruption.name, corruption.severity, repeat)
        recording = None if config.record is None else Path(config.record) / name
        observers: list[Observer] = []
        if recording is not None:
            observers.append(Recorder(recording, recording.parent))
        condition = Condition(
            *(corruption, config.seed, words, repeat, config.missing, config.turn, keep),
            guards=guards,
            observers=observers,
        )
        made.append(
            Cell(
                name,
                corruption,
                repeat,
                plan.command,
                out / "conditions" / name,
                condition,
                label,
                config.rule,
                fixed | met(corruption) | added,
                config.patience,
                environment,
                clean=made[0].folder if made else None,
                recording=recording,
                chosen=chosen,
                count_closed=config.count_closed,
            )
        )
    return made


def _check_guards(guards: Guards) -> None:
    """Raise ValueError for a guard that changes the agent, which runs in another process."""
    if guards.adapts:
        raise ValueError(
            f"The guard {guards.label} adapts the agent itself, and the agent of another program "
            "cannot be reached through the bridge: leave restore= out, or name a guard that "
            "changes frames or instructions only."
        )


def _words(config: RunConfig) -> Words:
    tokenizer = None if config.tokenizer is None else tokenizer_of(config.tokenizer)
    return Words(tokenizer, config.token_length)


def _environment(config: RunConfig) -> dict[str, str]:
    """What the hook must know of adapters. Raises ValueError for what names none."""
    if config.adapters is None:
        return {}
    from mitigate.encoders import plain_adapters

    folder, module, place = place_of(config.adapters)
    kind, _, path = place.partition(".")
    plain_adapters.read(folder)
    told = {"folder": str(Path(folder).resolve()), "file": str(plain_adapters.__file__)}
    told |= {"module": module, "class": kind, "path": path}
    return {mitigate_hook.ADAPTERS: json.dumps(told)}


def _settings(plan: Plan, guards: Guards) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return what every result of a run depends on, beside the corruption: the command and options,
    and what changes the agent. By these a finished condition is known again."""
    config = plan.config
    fixed = {"command": shlex.join(plan.command)}
    fixed |= {name: vars(config)[name] for name in SETTINGS}
    guard = "none"  # without a wait for torch
    if config.safeguard != "none":
        from mitigate.guards.text.choices import identity

        guard = identity(config.safeguard)
    added = {"restore": guards.frames_hash(), "adapters": adapters_of(config)}
    return fixed, {**added, "safeguard": guard, "watch": watched(config)}


def watched(config: RunConfig) -> dict[str, str | None] | None:
    """What ``watch=`` names: of a file its hash, else an environment variable; None without."""
    names = [str(name) for name in config.watch or ()]
    if not names:
        return None
    return {n: sha256(n)[:12] if os.path.isfile(n) else os.environ.get(n) for n in names}


def met(corruption: Corruption) -> dict[str, Any]:
    """What of a condition's result is by its corruption."""
    own = version(corruption.name)
    return {"suite": SUITE_VERSION, "severity": corruption.severity, **own}


def _text(watch: dict[str, str | None] | None) -> str | None:
    return None if watch is None else json.dumps(watch, sort_keys=True)


def _label(plan: Plan, added: dict[str, Any]) -> dict[str, Any]:
    """What the rows say of the agent: with a restorer, a safeguard, adapters or what is watched it
    is another one, by their hashes."""
    config = plan.config
    sha = _digest(shlex.join(plan.command))
    guard = None if added["safeguard"] == "none" else added["safeguard"]
    for part in (added["restore"], guard, added["adapters"], _text(added["watch"])):
        sha = sha if part is None else _digest(f"{sha} {part}")
    column = _column(config, plan.name)
    return {"agent": sha, "name": column, "split": config.split, "seed": config.seed}


def default_folder(config: RunConfig, name: str) -> Path:
    """The folder of a run that names none: other for another agent, severity, episodes."""
    parts = [part for part in (adapters_of(config), _text(watched(config))) if part]
    own = "-".join([_column(config, name), *(_digest(part)[:6] for part in parts)])
    own += f"-s{config.severity:g}" + (f"-e{config.episodes}" if config.episodes else "")
    return Path(config.runs) / "run" / plain(own)


def adapters_of(config: RunConfig) -> str | None:
    """The hash of the adapters and where they go; None without."""
    if config.adapters is None:
        return None
    from mitigate.encoders.plain_adapters import WEIGHTS

    folder, module, place = place_of(config.adapters)
    file = Path(folder) / WEIGHTS
    if not file.is_file():
        raise FileNotFoundError(
            f"adapters={config.adapters}: there is no {file}. Name the agent/ folder of a training "
            "by the recipe encoder."
        )
    return f"{sha256(file)[:12]}:{module}:{place}"


def place_of(adapters: str) -> tuple[str, str, str]:
    """Folder, module and place (Class.attribute) of ``adapters=``. Raises ValueError for what names
    none."""
    folder, module, place = (*str(adapters).rsplit(":", 2), "", "")[:3]
    if not place.partition(".")[0] or not module:
        raise ValueError(
            f"adapters={adapters} must be FOLDER:package.module:Class.attribute, where the "
            "attribute of the class's instances is the encoder that the adapters were trained for: "
            "runs/clip/agent:vlnce_baselines.models.encoders.resnet_encoders:CLIPEncoder.model"
        )
    return folder, module, place


def _column(config: RunConfig, name: str) -> str:
    """The column of the table: the command's name, and the labels of guards."""
    parts = [name, *labels(config.safeguard, config.restore)]
    parts += ["adapters"] if config.adapters is not None else []
    return "+".join(parts)


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:12]
