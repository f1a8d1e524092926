"""How a column of a table and the folder of its rows are called: by weights, recipe and options."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from mitigate.core.conf import CONF

if TYPE_CHECKING:
    from mitigate.evaluation.config import EvaluateConfig


def changed(overrides: Sequence[str]) -> list[str]:
    """Return the options of a command line that change the agent or what it sees, as parts of a
    column's name."""
    own = [option.lstrip("+") for option in overrides]
    own = [option for option in own if option.startswith(("agent.", "env.size="))]
    return [_plain(option.removeprefix("agent.")).strip("-") for option in own]


def column_of(name: str, seed: int, folder: Path) -> str:
    """Return the column of a training: the recipe, and the options that its folder's name holds, so
    that other settings are no other seeds of it."""
    options = folder.name.partition(f"-seed{seed}-")[2]
    return f"{name}+{options}" if options else name


def default_folder(config: EvaluateConfig, name: str) -> str:
    """Return ``runs/evaluate/<name>-[<world>-]<split>-s<severity>``; the world is named unless its
    config is of this project, whose worlds have splits of their own."""
    own = not (CONF / "env" / f"{config.env.name}.yaml").is_file()
    split = f"{config.env.name}-{config.split}" if own else config.split
    return f"{config.runs}/evaluate/{name}-{split}-s{_severities(config)}"


def _severities(config: EvaluateConfig) -> str:
    """The severities, as part of a folder's name."""
    depth = "" if config.severity_depth is None else f"-d{config.severity_depth:g}"
    return f"{config.severity:g}{depth}"


def _plain(text: str) -> str:
    """Return ``text`` with a dash for all that a file's name should not hold."""
    return re.sub(r"[^A-Za-z0-9.@-]+", "-", text)
