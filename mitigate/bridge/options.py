"""Options of ``mitigate run`` that make no sense are refused before anything is run."""

from __future__ import annotations

import difflib
import math
import os
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

from omegaconf import DictConfig

from mitigate.bridge.subset import SETTLED
from mitigate.core.files import make_folder
from mitigate.core.names import short, unknown
from mitigate.evaluation.rows import allowed
from mitigate.guards.text.addresses import check_choice
from mitigate.worlds.measures import RULES


def check_options(cfg: DictConfig, command: Sequence[str]) -> None:
    """Raise ValueError for options that make no sense, and without a command; OSError for a
    recording that cannot be written."""
    check_choice(cfg.safeguard)
    if not command:
        raise ValueError(
            "No command is given. Write it behind --, as you would type it: mitigate run "
            "corruption=spatter -- bash run_r2r/main.bash eval 2333"
        )
    if cfg.rule is not None and cfg.rule not in RULES:
        raise ValueError(unknown("rule", cfg.rule, RULES))
    if cfg.turn not in ("left", "right"):
        raise ValueError(unknown("turn", cfg.turn, ("left", "right")))
    if cfg.corruption is not None and cfg.conditions is not None:
        raise ValueError(
            f"corruption={cfg.corruption} and conditions=... both say what is measured: put it "
            "into conditions=[...], or leave that out."
        )
    for option in ("jobs", "repeats"):
        if cfg[option] < 1:
            raise ValueError(f"{option}={cfg[option]} is none: give 1 or more.")
    if not 0 <= cfg.missing < math.inf:
        raise ValueError(f"missing={cfg.missing:g} must be metres, 0 or more: missing=10.")
    if cfg.token_length is not None and cfg.token_length < 1:
        raise ValueError(f"token_length={cfg.token_length} is none: give 1 or more.")
    for option, text in (("split", cfg.split), ("name", cfg.name or name_of(command))):
        if wanted := allowed(option, text):  # before hours of what no row can say
            raise ValueError(f"{option}={short(text)} can stand in no row: {wanted}.")
    for watched in cfg.watch or ():
        _check_watched(str(watched))
    if not 1 <= cfg.patience <= 3600:
        raise ValueError(f"patience={cfg.patience:g} must be 1 to 3600 seconds.")
    if cfg.severity == 0 or cfg.severity_depth == 0:
        raise ValueError("severity=0 changes nothing: for clean runs alone, conditions=[clean].")
    if cfg.episodes is not None and cfg.patience < SETTLED + 1:
        raise ValueError(
            f"patience={cfg.patience:g} is too little with episodes={cfg.episodes}: which are "
            f"chosen is known {SETTLED:g} s after the last environment came. Give {SETTLED + 1:g} "
            "or more (the default is 25)."
        )
    if cfg.episodes is not None and cfg.episodes < 1:
        raise ValueError(f"episodes={cfg.episodes} is none: give 1 or more, or null for all.")
    if cfg.record is not None:
        make_folder(cfg.record)


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
