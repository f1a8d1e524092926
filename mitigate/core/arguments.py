"""Arguments of the commands that take paths and key=value options, and need no Hydra."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from pathlib import Path

from mitigate.core.names import unknown

HELP = ("--help", "-h")


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
