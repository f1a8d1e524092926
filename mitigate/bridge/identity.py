"""What a condition's result depends on: by it a finished one is known again, and rows are told
apart."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from omegaconf import DictConfig

from mitigate.bridge.recording import plain
from mitigate.core.files import sha256
from mitigate.corruptions import SUITE_VERSION, Corruption
from mitigate.corruptions.registry import version
from mitigate.guards.opening import labels

SETTINGS = ("seed", "episodes", "turn", "tokenizer", "missing", "token_length")  # as they are
LARGEST = 1 << 30  # bytes of a file of the command that is hashed; of a larger one its size counts


def settings_of(
    cfg: DictConfig,
    command: str,
    corruption: Corruption,
    restored: str | None,
    adapters: str | None,
) -> dict[str, Any]:
    """What a condition's result depends on, by which a finished one is known again."""
    told = {name: cfg[name] for name in SETTINGS}
    told |= met(corruption)
    told |= {"restore": restored, "adapters": adapters}
    return {"command": command, **told, "safeguard": _guard(cfg), "watch": watched(cfg)}


def watched(cfg: DictConfig) -> dict[str, str | None] | None:
    """What ``watch=`` names: of a file its hash, else an environment variable; None without."""
    if not cfg.watch:
        return None
    return {
        str(name): _sha(str(name), os.stat(name)) if os.path.isfile(name) else os.environ.get(name)
        for name in cfg.watch
    }


def _sha(path: str, now: os.stat_result) -> str:
    """The hash of a file, read once while it stays as it is."""
    return _read(path, now.st_size, now.st_mtime_ns)


@cache
def _read(path: str, size: int, changed: int) -> str:
    return sha256(path)[:12]


def met(corruption: Corruption) -> dict[str, Any]:
    """What of a condition's result is by its corruption."""
    own = version(corruption.name)
    return {"suite": SUITE_VERSION, "severity": corruption.severity, **own}


def _watch(cfg: DictConfig) -> str | None:
    seen = watched(cfg)
    return None if seen is None else json.dumps(seen, sort_keys=True)


def label_of(
    cfg: DictConfig, command: str, name: str, restored: str | None, adapters: str | None
) -> dict[str, Any]:
    """What the rows say of the agent: with a restorer, a safeguard, adapters or what is watched it
    is another one, by their hashes."""
    sha = _digest(command)
    guard = None if cfg.safeguard == "none" else _guard(cfg)
    for part in (restored, guard, adapters, _watch(cfg)):
        sha = sha if part is None else _digest(f"{sha} {part}")
    return {"agent": sha, "name": _column(cfg, name), "split": cfg.split, "seed": cfg.seed}


def default_folder(cfg: DictConfig, name: str) -> Path:
    """The folder of a run that names none: other for another agent, severity, episodes."""
    parts = [part for part in (adapters_of(cfg), _watch(cfg)) if part]
    own = "-".join([_column(cfg, name), *(_digest(part)[:6] for part in parts)])
    own += f"-s{cfg.severity:g}" + (f"-e{cfg.episodes}" if cfg.episodes else "")
    return Path(cfg.runs) / "run" / plain(own)


def adapters_of(cfg: DictConfig) -> str | None:
    """The hash of the adapters and where they go; None without."""
    if cfg.adapters is None:
        return None
    from mitigate.encoders.plain_adapters import WEIGHTS

    folder, module, place = place_of(cfg.adapters)
    file = Path(folder) / WEIGHTS
    if not file.is_file():
        raise FileNotFoundError(
            f"adapters={cfg.adapters}: there is no {file}. Name the agent/ folder of a training "
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


def files_of(command: Sequence[str]) -> dict[str, dict[str, Any]]:
    """Size and sha256 of the files that the words of a command name, alone or behind a ``=``."""
    found = {}
    for path in dict.fromkeys(_named(command)):
        size = path.stat().st_size
        found[str(path)] = {"size": size, "sha256": sha256(path) if size <= LARGEST else None}
    return found


def _named(command: Sequence[str]) -> Iterator[Path]:
    for word in command:
        for text in (word, word.partition("=")[2]):
            if os.path.isfile(text) and os.access(text, os.R_OK):  # of any text, code too
                yield Path(text)


def _column(cfg: DictConfig, name: str) -> str:
    """The column of the table: the command's name, and the labels of guards."""
    parts = [name, *labels(cfg.safeguard, cfg.restore)]
    parts += ["adapters"] if cfg.adapters is not None else []
    return "+".join(parts)


def _guard(cfg: DictConfig) -> str:
    if cfg.safeguard == "none":
        return "none"  # without a wait for torch
    from mitigate.guards.text.choices import identity

    return identity(cfg.safeguard)


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:12]
