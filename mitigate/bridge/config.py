"""The options of ``mitigate run``: their types, and the checks before anything is run."""

from __future__ import annotations

import difflib
import math
import os
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

from omegaconf import MISSING

from mitigate.bridge.condition import SETTLED
from mitigate.cluster import launcher  # noqa: F401 - registers the kinds of conf/launcher
from mitigate.core import conf
from mitigate.core.files import make_folder
from mitigate.core.names import short, unknown
from mitigate.evaluation.conditions import suite_conditions
from mitigate.evaluation.rows import allowed
from mitigate.guards.text.addresses import check_choice
from mitigate.worlds.measures import RULES


@dataclass
class RunConfig:
    """Types of ``conf/run.yaml``; the meaning of each entry is written there."""

    name: str | None = None
    out: str | None = None
    runs: str = "runs"
    corruption: str | None = None
    conditions: list[str] | None = None
    severity: float = 0.6
    severity_depth: float | None = None
    seed: int = 0
    episodes: int | None = None
    repeats: int = 1
    jobs: int = 1
    launcher: Any = MISSING
    split: str = "unnamed"
    rule: str | None = None
    safeguard: str = "none"
    restore: str | None = None
    tokenizer: str | None = None
    token_length: int | None = None
    missing: float = 0.0
    turn: str = "left"
    patience: float = 25.0
    record: str | None = None
    adapters: str | None = None
    watch: list[str] | None = None
    count_closed: bool = False
    check: bool = False
    suite: Any = MISSING

    @property
    def names(self) -> list[str]:
        """The conditions that are asked for, by name: clean first, each once."""
        names = suite_conditions(self.suite) if self.conditions is None else self.conditions
        if self.corruption is not None:
            names = [self.corruption]
        return list(dict.fromkeys(["clean", *names]))


conf.register("run", RunConfig)


def check_options(config: RunConfig, command: Sequence[str]) -> None:
    """Raise ValueError for options that make no sense, and without a command; OSError for a
    recording that cannot be written."""
    check_choice(config.safeguard)
    if not command:
        raise ValueError(
            "No command is given. Write it behind --, as you would type it: mitigate run "
            "corruption=spatter -- bash run_r2r/main.bash eval 2333"
        )
    if config.rule is not None and config.rule not in RULES:
        raise ValueError(unknown("rule", config.rule, RULES))
    if config.turn not in ("left", "right"):
        raise ValueError(unknown("turn", config.turn, ("left", "right")))
    if config.corruption is not None and config.conditions is not None:
        raise ValueError(
            f"corruption={config.corruption} and conditions=... both say what is measured: put it "
            "into conditions=[...], or leave that out."
        )
    for option, value in (("jobs", config.jobs), ("repeats", config.repeats)):
        if value < 1:
            raise ValueError(f"{option}={value} is none: give 1 or more.")
    if not 0 <= config.missing < math.inf:
        raise ValueError(f"missing={config.missing:g} must be metres, 0 or more: missing=10.")
    if config.token_length is not None and config.token_length < 1:
        raise ValueError(f"token_length={config.token_length} is none: give 1 or more.")
    for option, text in (("split", config.split), ("name", config.name or name_of(command))):
        if wanted := allowed(option, text):  # before hours of what no row can say
            raise ValueError(f"{option}={short(text)} can stand in no row: {wanted}.")
    for watched in config.watch or ():
        _check_watched(str(watched))
    if not 1 <= config.patience <= 3600:
        raise ValueError(f"patience={config.patience:g} must be 1 to 3600 seconds.")
    if config.severity == 0 or config.severity_depth == 0:
        raise ValueError("severity=0 changes nothing: for clean runs alone, conditions=[clean].")
    if config.episodes is not None and config.patience < SETTLED + 1:
        raise ValueError(
            f"patience={config.patience:g} is too little with episodes={config.episodes}: which "
            f"are chosen is known {SETTLED:g} s after the last environment came. Give "
            f"{SETTLED + 1:g} or more (the default is 25)."
        )
    if config.episodes is not None and config.episodes < 1:
        raise ValueError(f"episodes={config.episodes} is none: give 1 or more, or null for all.")
    if config.record is not None:
        make_folder(config.record)


def _check_watched(name: str) -> None:
    """Raise ValueError for what is neither a file nor a variable that is set, and for a folder:
    nothing of it would be seen to change."""
    if os.path.isdir(name):
        raise ValueError(f"watch={name} is a folder: name the files in it that count.")
    if os.path.isfile(name) or name in os.environ:
        return
    folder = Path(name).parent
    there = [str(path) for path in folder.iterdir()] if folder.is_dir() else []
    near = difflib.get_close_matches(name, [*os.environ, *there], n=3)
    hint = f" Did you mean {' or '.join(near)}?" if near else ""
    raise ValueError(
        f"watch={name}: there is neither such a file nor a variable of the environment.{hint} One "
        f"that is meant to be unset can be empty: {Path(name).name}= mitigate run ..."
    )


def name_of(command: Sequence[str]) -> str:
    """Return a name for a command: of its first script or module (``-m``), or of the program."""
    scripts = [Path(word).stem for word in command if word.endswith((".py", ".sh", ".bash"))]
    modules = [name for word, name in pairwise(command) if word == "-m"]
    return [*scripts, *modules, Path(command[0]).stem][0]
