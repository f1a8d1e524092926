"""What a run consists of: its conditions, made of the options, and which reach an agent."""

from __future__ import annotations

import hashlib
import json
import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from omegaconf import DictConfig

from mitigate.bridge.cell import Cell
from mitigate.bridge.connection import Condition
from mitigate.bridge.hook import mitigate_hook
from mitigate.bridge.recording import Recorder
from mitigate.bridge.results import Told
from mitigate.bridge.subset import Subset
from mitigate.bridge.words import Words, is_english
from mitigate.corruptions import Corruption

if TYPE_CHECKING:
    from mitigate.restoration.restorer import Restorer

SETTINGS = (  # options that a condition's result depends on
    "seed",
    "episodes",
    "turn",
    "safeguard",
    "tokenizer",
    "missing",
    "adapters",
    "token_length",
    "record",
)


def cells(cfg: DictConfig, command: Sequence[str], out: Path, name: str) -> list[Cell]:
    """All conditions of a run, clean first, then repeated clean runs."""
    from mitigate.evaluation.conditions import conditions

    names = list(cfg.suite.conditions) if cfg.conditions is None else list(cfg.conditions)
    if cfg.corruption is not None:
        names = [cfg.corruption]
    found = conditions(
        ["clean", *(n for n in dict.fromkeys(names) if n != "clean")],
        cfg.severity,
        cfg.severity_depth,
    )
    words, environment, restorer = _words(cfg, out), _environment(cfg), _restorer(cfg)
    keep = None if cfg.episodes is None else Subset(cfg.episodes, out).keep
    wanted = [(found[0], n) for n in range(cfg.repeats)] + [(c, 0) for c in found[1:]]
    text = shlex.join(command)
    sha = hashlib.sha256(text.encode()).hexdigest()[:12]
    made = []
    for corruption, repeat in wanted:
        own = f"{corruption.name}-s{corruption.severity:g}" if corruption.severity else "clean"
        own += f"-again{repeat}" if repeat else ""
        settings = _settings(cfg, text, restorer)
        condition = Condition(
            corruption, cfg.seed, words, repeat, cfg.missing, cfg.turn, keep, restorer=restorer
        )
        if cfg.record is not None:
            condition.observers.append(Recorder(Path(cfg.record) / own))
        label = _label(cfg, sha, name, restorer)
        folder = out / "conditions" / own
        made.append(
            Cell(
                own,
                corruption,
                repeat,
                tuple(command),
                folder,
                condition,
                label,
                cfg.rule,
                settings,
                cfg.patience,
                environment,
            )
        )
    return made


def _restorer(cfg: DictConfig) -> Restorer | None:
    if cfg.restore is None:
        return None  # without a wait for torch
    from mitigate.restoration.restorer import load_restorer

    return load_restorer(cfg.restore)


def _settings(cfg: DictConfig, command: str, restorer: Restorer | None) -> dict[str, Any]:
    """What a condition's result depends on, by which a finished one is known again."""
    told = {name: cfg[name] for name in SETTINGS}
    return {"command": command, **told, "restore": None if restorer is None else restorer.hash}


def _label(cfg: DictConfig, sha: str, name: str, restorer: Restorer | None) -> dict[str, Any]:
    """What the rows say of the agent: with a restorer in front of it, it is another one."""
    from mitigate.evaluation.columns import name_of

    if cfg.safeguard != "none":
        from mitigate.safeguard.guard import label as front

        name += f"+{front(cfg.safeguard)}"
    if restorer is not None:
        name += f"+{name_of(cfg.restore)}"
        sha = hashlib.sha256(f"{sha} {restorer.hash}".encode()).hexdigest()[:12]
    if cfg.adapters is not None:
        name += "+adapters"
    return {"agent": sha, "name": name, "split": cfg.split, "seed": cfg.seed}


def _words(cfg: DictConfig, out: Path) -> Words:
    from mitigate.bridge.words import tokenizer_of
    from mitigate.safeguard.guard import open_safeguard

    guard = open_safeguard(cfg.safeguard, log=out / "safeguard.jsonl")
    return Words(
        None if cfg.tokenizer is None else tokenizer_of(cfg.tokenizer),
        None if guard is None else lambda text: guard.canonicalise(text).text,
        cfg.token_length,
    )


def _environment(cfg: DictConfig) -> dict[str, str]:
    """What the hook must know of adapters. Raises ValueError for what names none."""
    if cfg.adapters is None:
        return {}
    from mitigate.encoders import plain_adapters

    folder, module, place = (*str(cfg.adapters).rsplit(":", 2), "", "")[:3]
    kind, _, path = place.partition(".")
    if not kind or not module:
        raise ValueError(
            f"adapters={cfg.adapters} must be FOLDER:package.module:Class.attribute, where the "
            "attribute of the class's instances is the encoder that the adapters were trained for: "
            "runs/clip/agent:vlnce_baselines.models.encoders.resnet_encoders:CLIPEncoder.model"
        )
    plain_adapters.read(folder)
    told = {"folder": str(Path(folder).resolve()), "file": str(plain_adapters.__file__)}
    told |= {"module": module, "class": kind, "path": path}
    return {mitigate_hook.ADAPTERS: json.dumps(told)}


def applicable(corruption: Corruption, clean: Told) -> str:
    """Return why a corruption cannot reach the agent of a clean run; empty if it can."""
    kinds = {camera["type"] for camera in clean.cameras}
    for part in corruption.parts:
        if part.modality in ("rgb", "depth") and part.modality not in kinds:
            return f"the agent has no {part.modality} camera"
        if part.name == "white_box":
            return "an agent's system prompt does not pass the bridge"
        if part.modality == "instruction" and not clean.first.get("text"):
            return "its goals are categories, not instructions"
    return ""


def untold(corruption: Corruption, clean: Told, words: Words) -> bool:
    """Whether the agent reads tokens, and no tokenizer was named to tell it corrupted words by."""
    spoken = any(part.modality == "instruction" for part in corruption.parts)
    reads = bool(clean.first.get("tokens")) and is_english(clean.first.get("language"))
    return spoken and reads and words.tokenizer is None
