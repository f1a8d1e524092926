"""Parse paths, ``key=value`` options and flags of a command line, before any config is read.

Commands without Hydra use :func:`paths_and_options`. The other commands check the arguments before
they pass them to Hydra (``core/conf.py``), because Hydra accepts some invalid arguments without a
warning and rejects others with an unclear message.
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
    """Return whether ``arguments`` is empty or contains a help flag, so that help is shown."""
    return not arguments or any(name in arguments for name in HELP)


def paths_and_options(
    arguments: Sequence[str], paths: Sequence[str], known: Collection[str]
) -> tuple[list[str], dict[str, str]]:
    """Return the paths and the ``key=value`` options of a command line.

    Args:
        arguments: all command-line arguments.
        paths: names of the required paths, for messages.
        known: names of the allowed options.

    Returns:
        The paths, and the options by name, as text.

    Raises:
        ValueError: If the number of paths is wrong, an option is unknown or set twice, or an
            argument begins with a dash.
    """
    words: list[str] = []
    options: dict[str, str] = {}
    for argument in arguments:
        name, equals, value = argument.partition("=")
        if equals and name.isidentifier():
            if name not in known:
                raise ValueError(unknown("option", name, known))
            if name in options:
                raise ValueError(
                    f"{name} is set twice: {options[name]!r} and {value!r}. Set it once."
                )
            options[name] = value
        elif argument.startswith("-"):
            raise ValueError(f"There is no option {argument}. Write key=value, or --help.")
        else:
            words.append(argument)
    if len(words) != len(paths):
        got = f"{len(words)}: {', '.join(words)}" if words else "none"
        raise ValueError(
            f"The command takes {len(paths)} {'path' if len(paths) == 1 else 'paths'}, "
            f"{' and '.join(paths)}, got {got}. See --help. (Write a path that contains '=' as "
            "./a=b.)"
        )
    return words, options


def check_paths(paths: Sequence[object], options: str) -> None:
    """Raise ValueError for a path like ``out=x``, which is meant as an option.

    Commands whose options begin with dashes call this; ``options`` shows their form in the message.
    """
    for path in map(str, paths):
        if path.partition("=")[0].isidentifier() and "=" in path and not Path(path).exists():
            raise ValueError(f"There is no file {path}. Write options here as {options}.")


def paths_and_overrides(arguments: Iterable[str]) -> tuple[list[str], list[str]]:
    """Split command-line arguments into paths and Hydra overrides."""
    words = list(arguments)
    options = [word for word in words if "=" in word or word.startswith("-")]
    return [word for word in words if word not in options], options


def values(options: Sequence[str], key: str) -> list[str]:
    """Return the values that ``options`` assign to ``key``, without quotes and escapes.

    If ``key`` is set several times, the last value counts. A sweep (``key=a,b``) has several
    values. The list is empty if ``key`` is not set or Hydra cannot parse the options.
    """
    from hydra.core.override_parser.overrides_parser import OverridesParser  # an optional package
    from hydra.core.override_parser.types import QuotedString
    from hydra.errors import HydraException

    overrides = [option for option in options if re.match(rf"\+{{0,2}}{re.escape(key)}=", option)]
    try:
        parsed = OverridesParser.create().parse_overrides(overrides)
    except HydraException:
        return []
    if not parsed:
        return []
    if parsed[-1].is_sweep_override():
        return [*map(str, parsed[-1].sweep_string_iterator())]
    value = parsed[-1].value()
    return [value.text if isinstance(value, QuotedString) else str(value)]


def config_folder(options: Sequence[str]) -> Path | None:
    """Return the user's folder of configs if ``options`` name such a folder, else None."""
    match = re.search(r"(?:^|\n)(?:--config-dir|-cd)[=\n]([^\n]+)", "\n".join(options))
    return Path(match[1]) if match else None


def without_config_folder(options: Sequence[str]) -> tuple[list[str], list[str]]:
    """Separate the option ``--config-dir``, which names a folder of configs, from other options.

    Returns:
        The command-line arguments that set the folder, and the remaining arguments.
    """
    folder_words: list[str] = []
    rest: list[str] = []
    for word in options:
        is_value = bool(folder_words) and folder_words[-1] in CONFIG_DIR
        names_folder = is_value or word.partition("=")[0] in CONFIG_DIR
        (folder_words if names_folder else rest).append(word)
    return folder_words, rest


def check_dashes(options: Sequence[str]) -> None:
    """Raise ValueError for options with dashes, such as ``--severity 0.6``."""
    from hydra._internal.utils import get_args_parser  # an optional package

    known = {flag for action in get_args_parser()._actions for flag in action.option_strings}
    for at, word in enumerate(options):
        flag, equals, value = word.partition("=")
        if not re.match(r"--\w", flag) or flag in known:
            continue
        value = options[at + 1] if at + 1 < len(options) and not equals else value
        example = value if value and not value.startswith("-") and "=" not in value else "VALUE"
        key = flag[2:].replace("-", "_")
        raise ValueError(f"There is no option {flag}. Write {key}={example}, without dashes.")


def flags_first(words: Sequence[str]) -> list[str]:
    """Move ``--multirun`` and ``--config-dir`` to the front of the command-line arguments.

    The parser of Hydra rejects a flag that stands between two overrides.
    """
    flags = [word for word in words if word in MULTIRUN]
    folder, others = without_config_folder([word for word in words if word not in MULTIRUN])
    return [*flags[:1], *folder, *others]


def positive(text: str) -> int:
    """Parse a whole number >= 1 (a ``type`` of argparse)."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"must be a whole number >= 1, got {text!r}")
    return int(text)
