"""Options of a command line that Hydra would refuse in words of its own, or take without a word."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterable, Sequence
from pathlib import Path

from hydra._internal.utils import get_args_parser
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.core.override_parser.types import Override
from hydra.errors import HydraException

MULTIRUN = ("-m", "--multirun")
CONFIG_DIR = ("--config-dir", "-cd")


def paths_and_overrides(arguments: Iterable[str]) -> tuple[list[str], list[str]]:
    """A command line's words without "=" (paths), and Hydra's overrides."""
    words = list(arguments)
    options = [word for word in words if "=" in word or word.startswith("-")]
    return [word for word in words if word not in options], options


def values(options: Sequence[str], key: str) -> list[str]:
    """What ``options`` set ``key`` to, without quotes and escapes: the last of them, and of one
    with several values, for many runs, all. None for what Hydra cannot read."""
    found: list[str] = []
    for option in options:
        if re.match(rf"\+{{0,2}}{re.escape(key)}=", option):
            try:
                (parsed,) = OverridesParser.create().parse_overrides([option])
            except HydraException:
                return []
            several = parsed.is_sweep_override()
            found = [*map(str, parsed.sweep_string_iterator())] if several else [_text(parsed)]
    return found


def _text(parsed: Override) -> str:
    value = parsed.value()
    return str(getattr(value, "text", value))


def config_folder(options: Sequence[str]) -> Path | None:
    """The user's own folder of configs, if ``options`` name one."""
    found = re.search(r"(?:^|\n)(?:--config-dir|-cd)[=\n]([^\n]+)", "\n".join(options))
    return Path(found[1]) if found else None


def without_config_folder(options: Sequence[str]) -> tuple[list[str], list[str]]:
    """The words of ``options`` that name the user's own folder of configs (``--config-dir mine``),
    and the others."""
    own: list[str] = []
    rest: list[str] = []
    for word in options:
        behind = bool(own) and own[-1] in CONFIG_DIR
        own_word = behind or word.partition("=")[0] in CONFIG_DIR
        (own if own_word else rest).append(word)
    return own, rest


def check_dashes(options: Sequence[str]) -> None:
    """Raise ValueError for ``--severity 0.6``, as other programs have it."""
    known = {flag for action in get_args_parser()._actions for flag in action.option_strings}
    for at, word in enumerate(options):
        flag, equals, value = word.partition("=")
        if not re.match(r"--\w", flag) or flag in known:
            continue
        behind = options[at + 1] if at + 1 < len(options) and not equals else value
        shown = behind if behind and not behind.startswith("-") and "=" not in behind else "VALUE"
        key = flag[2:].replace("-", "_")
        raise ValueError(f"{flag} is no option: options are written {key}={shown}, without dashes.")


def flags_first(words: Sequence[str]) -> list[str]:
    """``words`` of a command line with Hydra's flag of many runs and its folder of configs in
    front, which it does not read between options."""
    flags = [word for word in words if word in MULTIRUN]
    folder, others = without_config_folder([word for word in words if word not in MULTIRUN])
    return [*flags[:1], *folder, *others]


def positive(text: str) -> int:
    """The whole number from 1 on that a word of a command line says (a ``type`` of argparse)."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r} must be a whole number from 1 on")
    return int(text)
