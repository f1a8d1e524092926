"""What a run consists of: its conditions, made of the options, and which reach an agent."""

from __future__ import annotations

import json
import shlex
from collections.abc import Sequence
from pathlib import Path

from omegaconf import DictConfig

from mitigate.bridge.cell import Cell
from mitigate.bridge.condition import Condition
from mitigate.bridge.hook import mitigate_hook
from mitigate.bridge.identity import adapters_of, label_of, place_of, settings_of
from mitigate.bridge.recording import Recorder
from mitigate.bridge.results import Told
from mitigate.bridge.subset import Subset
from mitigate.bridge.words import Words
from mitigate.corruptions import Corruption
from mitigate.corruptions.language.text import is_english
from mitigate.guards.guard import Guards
from mitigate.guards.opening import open_guards


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
    words = _words(cfg)
    environment = _environment(cfg)
    guards = open_guards(cfg.safeguard, cfg.restore, log=out / "safeguard.jsonl")
    _check_guards(guards)
    restored = guards.frames_hash()
    chosen = None if cfg.episodes is None else Subset(cfg.episodes, out)
    keep = None if chosen is None else chosen.keep
    wanted = [(found[0], n) for n in range(cfg.repeats)] + [(c, 0) for c in found[1:]]
    text, adapters = shlex.join(command), adapters_of(cfg)
    made: list[Cell] = []
    for corruption, repeat in wanted:
        own = f"{corruption.name}-s{corruption.severity:g}" if corruption.severity else "clean"
        own += f"-again{repeat}" if repeat else ""
        condition = Condition(
            corruption, cfg.seed, words, repeat, cfg.missing, cfg.turn, keep, guards=guards
        )
        recording = None if cfg.record is None else Path(cfg.record) / own
        if recording is not None:
            condition.observers.append(Recorder(recording))
        made.append(
            Cell(
                own,
                corruption,
                repeat,
                tuple(command),
                out / "conditions" / own,
                condition,
                label_of(cfg, text, name, restored, adapters),
                cfg.rule,
                settings_of(cfg, text, corruption, restored, adapters),
                cfg.patience,
                environment,
                clean=made[0].folder if made else None,
                recording=recording,
                chosen=chosen,
                count_closed=cfg.count_closed,
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


def _words(cfg: DictConfig) -> Words:
    from mitigate.bridge.words import tokenizer_of

    tokenizer = None if cfg.tokenizer is None else tokenizer_of(cfg.tokenizer)
    return Words(tokenizer, cfg.token_length)


def _environment(cfg: DictConfig) -> dict[str, str]:
    """What the hook must know of adapters. Raises ValueError for what names none."""
    if cfg.adapters is None:
        return {}
    from mitigate.encoders import plain_adapters

    folder, module, place = place_of(cfg.adapters)
    kind, _, path = place.partition(".")
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
            if clean.first.get("category"):
                return "its goals are categories, not instructions"
            return "no instruction was told: connect(..., instruction=...)"
    return ""


def untold(corruption: Corruption, clean: Told, words: Words) -> bool:
    """Whether the agent reads tokens, and no tokenizer was named to tell it corrupted words by."""
    spoken = any(part.modality == "instruction" for part in corruption.parts)
    reads = bool(clean.first.get("tokens")) and is_english(clean.first.get("language"))
    return spoken and reads and words.tokenizer is None
