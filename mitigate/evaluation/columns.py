"""How a column of a table is called: by its weights, its recipe and the options that changed it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from omegaconf import DictConfig


def name_of(weights: str) -> str:
    """Return the name of weights by their path: of the run, for a run's ``agent`` folder; of the
    kind of agent, for its shipped weights (``checkpoints/frontier/base``: frontier, and
    ``.../teacher``: frontier_teacher)."""
    path = Path(weights.removesuffix(".safetensors"))
    while path.name in ("model", "agent", "run"):
        path = path.parent
    if path.parent.parent.name == "checkpoints" and path.parent.name != "hardened":
        kind = path.parent.name
        return kind if path.name == "base" else f"{kind}_{path.name}"
    return path.name or "agent"


def changed(overrides: Sequence[str]) -> list[str]:
    """Return the options of a command line that change the agent or what it sees, as parts of a
    column's name."""
    own = [option.lstrip("+") for option in overrides]
    own = [option for option in own if option.startswith(("agent.", "env.size="))]
    return [_plain(option.removeprefix("agent.")).strip("-") for option in own]


def column_of(cfg: DictConfig, folder: Path) -> str:
    """Return the column of a training: the recipe, and the options that its folder's name holds, so
    that other settings are no other seeds of it."""
    options = folder.name.partition(f"-seed{cfg.seed}-")[2]
    return f"{cfg.name}+{options}" if options else cfg.name


def _plain(text: str) -> str:
    """Return ``text`` with a dash for all that a file's name should not hold."""
    return re.sub(r"[^A-Za-z0-9.@-]+", "-", text)
