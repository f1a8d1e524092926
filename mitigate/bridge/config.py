"""Define the options of ``mitigate run`` and check them before anything runs."""

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

from mitigate.bridge.condition import SETTLE_TIME
from mitigate.cluster import launcher  # noqa: F401 - registers the options of conf/launcher
from mitigate.core import conf
from mitigate.core.addresses import check_choice
from mitigate.core.files import make_folder
from mitigate.core.names import short, unknown
from mitigate.corruptions.record import MOTION
from mitigate.corruptions.registry import family
from mitigate.evaluation.conditions import suite_conditions
from mitigate.evaluation.rows import allowed
from mitigate.worlds.measures import RULES


@dataclass
class RunConfig:
    """Typed options of ``mitigate run``; ``conf/run.yaml`` documents each option."""

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
    # The type is Any, because Hydra's type error would print the value, including a password.
    # The function check_choice checks the value instead.
    safeguard: Any = "none"
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
        """The names of the requested conditions without duplicates, with clean first."""
        names = suite_conditions(self.suite) if self.conditions is None else self.conditions
        if self.corruption is not None:
            names = [self.corruption]
        return list(dict.fromkeys(["clean", *names]))


conf.register("run", RunConfig)


def check_options(config: RunConfig, command: Sequence[str]) -> None:
    """Raise ValueError if an option is invalid or the command is missing.

    Raises OSError if the folder of ``record=`` cannot be written.
    """
    check_choice(config.safeguard)
    if not command:
        raise ValueError(
            "A command is missing. Write it after --, as you would type it: mitigate run "
            "conditions=[spatter] -- bash run_r2r/main.bash eval 2333"
        )
    if config.rule is not None and config.rule not in RULES:
        raise ValueError(unknown("rule", config.rule, RULES))
    if config.turn not in ("left", "right"):
        raise ValueError(unknown("turn", config.turn, ("left", "right")))
    if config.corruption is not None and config.conditions is not None:
        raise ValueError(
            f"corruption={config.corruption} and conditions=... both name conditions. Put "
            f"{config.corruption} into conditions=[...], or leave conditions out."
        )
    if moving := [name for name in config.names if family(name) == MOTION]:
        raise ValueError(
            f"{moving[0]} changes actions, which mitigate run does not intercept. Leave it out "
            "(suite=temporal and suite=camera work)."
        )
    for option in ("jobs", "repeats", "episodes", "token_length"):
        value = vars(config)[option]
        if value is not None and value < 1:
            raise ValueError(f"{option} must be >= 1, got {value}.")
    if not 0 <= config.missing < math.inf:
        raise ValueError(f"missing must be metres >= 0, got {config.missing:g}. Try missing=10.")
    for option, text in (("split", config.split), ("name", config.name or command_name(command))):
        if constraint := allowed(option, text):  # check it now, not after hours of measuring
            raise ValueError(f"{option}={short(text)} cannot be written to rows: {constraint}.")
    for watched in config.watch or ():
        _check_watched(str(watched))
    if not 1 <= config.patience <= 3600:
        raise ValueError(f"patience must be 1 to 3600 seconds, got {config.patience:g}.")
    if config.severity == 0 or config.severity_depth == 0:
        raise ValueError("severity=0 changes nothing. For clean runs only: conditions=[clean].")
    if config.episodes is not None and config.patience < SETTLE_TIME + 1:
        raise ValueError(
            f"patience must be >= {SETTLE_TIME + 1:g} seconds with episodes={config.episodes}, got "
            f"{config.patience:g}. The default is 25."
        )
    if config.record is not None:
        make_folder(config.record)


def _check_watched(name: str) -> None:
    """Raise ValueError if ``name`` is neither a file nor a set environment variable.

    Folders are rejected, because changes in them would not be noticed.
    """
    if os.path.isdir(name):
        raise ValueError(
            f"watch must name files or environment variables, got the folder {name}. Name the "
            "files in it that the results depend on."
        )
    if os.path.isfile(name) or name in os.environ:
        return
    folder = Path(name).parent
    files = [str(path) for path in folder.iterdir()] if folder.is_dir() else []
    similar = difflib.get_close_matches(name, [*os.environ, *files], n=3)
    hint = f" Did you mean {' or '.join(similar)}?" if similar else ""
    raise ValueError(
        f"watch={name} must be a file or an environment variable, and neither exists.{hint} A "
        f"variable may be empty: {Path(name).name}= mitigate run ..."
    )


def command_name(command: Sequence[str]) -> str:
    """Return a short name for a command.

    This is the name of its first script. If there is no script, it is the first module (``-m``).
    If there is no module either, it is the name of the executable.
    """
    scripts = [Path(word).stem for word in command if word.endswith((".py", ".sh", ".bash"))]
    modules = [name for word, name in pairwise(command) if word == "-m"]
    return [*scripts, *modules, Path(command[0]).stem][0]
