"""The words of a command line, before any config is read: paths, ``key=value`` options and flags.

Commands that need no Hydra read theirs with :func:`paths_and_options`. The others leave options to
Hydra (``core/conf.py``), except those that it would refuse in words of its own, or take without a
word.
"""

from __future__ import annotations

import argparse
import re
from collections.abc import Collection, Iterable, Sequence
from pathlib import Path

from mitigate.core.names import unknown

HELP = ("--help", "-h")
MULTIRUN = ("-m", "--multirun")
CONFIG_DIR = ("--config-dir", "-cd")


def asks_help(arguments: Sequence[str]) -> bool:
    """Whether the help is to be shown: it is asked for, or there is nothing to do."""
    return not arguments or any(name in arguments for name in HELP)


def paths_and_options(
    arguments: Sequence[str], paths: Sequence[str], known: Collection[str]
) -> tuple[list[str], dict[str, str]]:
    """As many paths as there are names in ``paths``, and the options by name, as text.

    Raises ValueError in one paragraph for another number of paths, an option that is not in
    ``known`` or that is given twice, and for -x or --x.
    """
    found: list[str] = []
    options: dict[str, str] = {}
    for argument in arguments:
        name, equals, value = argument.partition("=")
        if equals and name.isidentifier():
            if name not in known:
                raise ValueError(unknown("option", name, known))
            if name in options:
                raise ValueError(f"{name} is given twice: {options[name]!r} and {value!r}.")
            options[name] = value
        elif argument.startswith("-"):
            raise ValueError(f"There is no option {argument}: write key=value, or --help.")
        else:
            found.append(argument)
    if len(found) != len(paths):
        given = f"there are {len(found)}: {', '.join(found)}" if found else "there are none"
        raise ValueError(
            f"The command takes {len(paths)} {'path' if len(paths) == 1 else 'paths'}, "
            f"{' and '.join(paths)}, but {given}. See --help. (A path whose name holds '=' is "
            "written ./a=b.)"
        )
    return found, options


def check_paths(paths: Sequence[object], options: str) -> None:
    """Raise ValueError for ``out=x`` among the paths of a command whose ``options`` have dashes."""
    for path in map(str, paths):
        if path.partition("=")[0].isidentifier() and "=" in path and not Path(path).exists():
            raise ValueError(f"There is no file {path}. Options are written {options} here.")


def paths_and_overrides(arguments: Iterable[str]) -> tuple[list[str], list[str]]:
    """A command line's words without "=" (paths), and Hydra's overrides."""
    words = list(arguments)
    options = [word for word in words if "=" in word or word.startswith("-")]
    return [word for word in words if word not in options], options


def values(options: Sequence[str], key: str) -> list[str]:
    """What ``options`` set ``key`` to, without quotes and escapes: the last of them, and of one
    with several values, for many runs, all. None for what Hydra cannot read."""
    from hydra.core.override_parser.overrides_parser import OverridesParser  # an optional package
    from hydra.core.override_parser.types import QuotedString
    from hydra.errors import HydraException

    given = [option for option in options if re.match(rf"\+{{0,2}}{re.escape(key)}=", option)]
    try:
        parsed = OverridesParser.create().parse_overrides(given)
    except HydraException:
        return []
    if not parsed:
        return []
    if parsed[-1].is_sweep_override():
        return [*map(str, parsed[-1].sweep_string_iterator())]
    value = parsed[-1].value()
    return [value.text if isinstance(value, QuotedString) else str(value)]


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
    from hydra._internal.utils import get_args_parser  # an optional package

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
