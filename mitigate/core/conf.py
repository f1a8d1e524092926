"""Configs: compose, type and explain the options of a command; run its Hydra program.

Each command registers the dataclass of its options when its module is imported (:func:`register`).
A user's mistake ends in one paragraph: cause, choices, fix. Set ``HYDRA_FULL_ERROR=1`` to see the
whole traceback instead.
"""

from __future__ import annotations

import difflib
import os
import re
import shlex
import signal
import sys
import textwrap
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, redirect_stderr
from itertools import takewhile
from pathlib import Path
from typing import Any, TextIO

from hydra import compose, initialize_config_dir
from hydra.core.config_store import ConfigStore
from hydra.core.global_hydra import GlobalHydra
from hydra.errors import HydraException, MissingConfigException, OverrideParseException
from hydra.utils import get_object
from omegaconf import DictConfig, OmegaConf
from omegaconf.errors import OmegaConfBaseException

from mitigate.core.build import argument_names
from mitigate.core.errors import said, too_much
from mitigate.core.files import PACKAGE
from mitigate.core.names import unknown
from mitigate.core.options import check_dashes, config_folder, flags_first, without_config_folder
from mitigate.core.signals import Ended, raise_ended

CONF = PACKAGE / "conf"  # of a checkout: a link to its conf/
TYPES: dict[str, type] = {}  # the dataclass of each conf/<name>.yaml that is registered
FULL = "HYDRA_FULL_ERROR"  # what Hydra asks whether errors are shown whole
# set beside it by main: programs that it starts do not show them whole
OURS = "MITIGATE_FULL_ERROR"
HYDRAS = "Error executing job with overrides"  # hydra.core.utils, JobReturn.return_value
WHOLE = "# @package _global_"  # Hydra's mark of a file that sets entries beside its own group
KINDS = {
    "Integer": "a whole number, such as 4",
    "Float": "a number, such as 0.6",
    "bool": "true or false",
    "String": "text",
}


def register(primary: str, kind: type, schema: str | None = None) -> None:
    """Register the dataclass ``kind`` as the types of ``conf/<primary>.yaml``.

    The file names ``<schema>_schema`` in its defaults; by default ``schema`` is ``primary``.
    """
    TYPES[primary] = kind
    ConfigStore.instance().store(name=f"{schema or primary}_schema", node=kind)


def typed(cfg: DictConfig, primary: str) -> Any:
    """Return composed options as an object of the dataclass of ``conf/<primary>.yaml``.

    Entries that the dataclass does not declare become attributes; nodes without types are dicts.

    Raises:
        ValueError: for an entry that refers to a missing one, or that is mandatory and not set.
    """
    try:
        return OmegaConf.to_object(cfg)
    except OmegaConfBaseException as error:
        raise ValueError(explain(error, primary)) from error


def main(
    program: Callable[[], None],
    primary: str,
    check: Callable[[], None] | None = None,
    behind: Sequence[str] = (),
    again: str = "To go on",
) -> None:
    """Call ``check`` and then ``program`` (a ``hydra.main`` function over ``conf/<primary>.yaml``);
    for ``--help`` print the first lines of its module and every option instead. behind: words of
    the command line that are not Hydra's, to be said behind the options in the command to go on.
    again: what that command is for, where it does not go on.

    Exits with status 1 and one paragraph for ValueError, OSError, config errors and what asks for
    too much memory, with 130 for Ctrl-C and 143 for SIGTERM, saying how to go on.
    """
    if {"--help", "-h"} & set(sys.argv[1:]):
        print(help_text(sys.modules[program.__module__].__doc__ or "", primary))
        return
    if os.environ.get(FULL) and OURS not in os.environ:
        return program()
    os.environ.update({FULL: "1", OURS: "1"})  # lets errors through to here
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGTERM, raise_ended)
    try:
        if check is not None:
            check()
        check_dashes(sys.argv[1:])
        sys.argv[1:] = flags_first(sys.argv[1:])
        for told in notices(primary, sys.argv[1:]):
            print(told, file=sys.stderr)
        with _without_hydras_line():
            program()
    except (HydraException, OmegaConfBaseException) as error:
        sys.exit(f"error: {explain(error, primary, sys.argv[1:])}")
    except (ValueError, OSError) as error:
        sys.exit(f"error: {said(error)}")
    except (MemoryError, RuntimeError, OverflowError) as error:
        told = too_much(error)
        if not told:
            raise
        sys.exit(f"error: {told}")
    except KeyboardInterrupt as error:
        command = shlex.join([*sys.argv[0].split(), *sys.argv[1:], *behind])
        print(f"\n{str(error) or 'SIGINT'}: stopped. {again}: {command}", file=sys.stderr)
        sys.exit(error.status if isinstance(error, Ended) else 130)
    finally:
        del os.environ[FULL], os.environ[OURS]


@contextmanager
def _without_hydras_line() -> Iterator[None]:
    """Leave out the line with which Hydra announces an error: users' are explained in a paragraph,
    and others come with a traceback."""
    with redirect_stderr(_Quieter(sys.stderr)):
        yield


class _Quieter:
    """A stream that leaves out what begins with ``HYDRAS``."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        return len(text) if text.startswith(HYDRAS) else self._stream.write(text)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)  # all else is the stream's own


def explain(error: Exception, primary: str, options: Sequence[str] = ()) -> str:
    """Return one paragraph for an error of composing ``conf/<primary>.yaml`` with ``options``."""
    text = f"{error}\n{error.__cause__ or ''}"
    if isinstance(error, MissingConfigException) and error.options is not None:
        group, _, name = (error.missing_cfg_file or "").rpartition("/")
        return unknown(group, name, [o for o in error.options if not o.endswith("_schema")])
    if isinstance(error, OverrideParseException):
        return (
            f"Cannot read the option {error.override!r}: write key=value, like severity=0.6, and "
            "put a value that holds = , or spaces in quotes twice: 'checkpoint=\"my=agent\"'."
        )
    key = _first(r"Could not (?:override|delete from config\.) '([^']+)'", text)
    if key is not None:
        return _unknown_key(key, _chosen_by(options, primary), primary)
    missing = _first(r"Interpolation key '([^']+)' not found", text)
    if missing is not None:
        key = _first(r"full_key: (\S+)", text) or "another entry"
        return (
            f"There is no {missing}, and {key} is what that is: leave it in its place, or set both."
        )
    override = _first(r"Error merging override ([^=\s]+=.*)", text)
    value = _first(r"Value '(.*)' (?:of type '\w+' could not be|is not a valid)", text)
    if value is not None:
        key = _first(r"full_key: (\S+)", text) or _first(r"override (\S+?)=", text)
        kind = _first(r"(?:converted to|is not a valid) (\w+)", text) or ""
        return f"{key}={value} has the wrong type: {key} must be {KINDS.get(kind, kind)}."
    if override is not None:
        key, _, value = override.partition("=")
        if "not a ListConfig" in text:
            return f"{key}={value} has the wrong type: {key} must be a list, such as [{value}]."
        return _misfit(key, value, _chosen_by(options, primary))
    return " ".join(str(error).split())


def load_config(primary: str, words: Sequence[str] = ()) -> DictConfig:
    """Compose ``conf/<primary>.yaml`` with ``words`` of a command line, outside a Hydra program.

    They are overrides, and maybe a folder with more configs (``--config-dir=mine``).

    Raises:
        ValueError: if no imported module has registered the types of this file.
    """
    if primary not in TYPES:
        raise ValueError(
            f"The types of conf/{primary}.yaml are not registered: import the module of the "
            "command first (mitigate/cli.py names it)."
        )
    _, overrides = without_config_folder(words)
    folder = config_folder(words)
    if folder is not None:
        place = str(folder.resolve()).replace("\\", "\\\\").replace('"', '\\"')
        overrides.append(f'hydra.searchpath=["file://{place}"]')
    GlobalHydra.instance().clear()
    with initialize_config_dir(str(CONF), version_base="1.3"):
        return compose(primary, overrides)


def notices(primary: str, options: Sequence[str]) -> list[str]:
    """What is to be said of the entries that ``options`` add to ``conf/<primary>.yaml``
    (``+columns.mine=[...]``): Hydra puts a new list or mapping in the place of one that is there,
    and adds an entry that no program reads, without a word."""
    added = {
        option[1:].partition("=")[0]: option.partition("=")[2][:1] in "[{"
        for option in options
        if re.match(r"\+[^+]", option)
    }
    if not added:
        return []
    own, others = without_config_folder(options)
    try:
        cfg = load_config(primary, [*own, *(o for o in others if re.match(r"[^-+].*=|~", o))])
    except (HydraException, OmegaConfBaseException):  # which the program itself explains
        return []
    folders = (CONF, config_folder(options) or CONF)
    return [
        told
        for key, whole in added.items()
        if not any((folder / key.partition("@")[0]).is_dir() for folder in folders)
        and (told := _notice(key, whole, OmegaConf.select(cfg, key) is not None, [*map(str, cfg)]))
    ]


def _notice(key: str, whole: bool, there: bool, names: list[str]) -> str:
    if there and not whole:
        return ""  # which Hydra refuses
    if there:
        return f"{key} is there already, and +{key}= replaces it. To add one, give it another name."
    if "." in key:
        return ""
    near = difflib.get_close_matches(key, names, n=1)
    hint = f" Did you mean {near[0]}=...?" if near else ""
    return f"+{key}= adds an option that only configs of your own can use.{hint}"


def help_text(about: str, primary: str) -> str:
    """What ``--help`` prints: ``about``, and :func:`options_text`."""
    options = f"Options, with what they are if nothing is said:\n\n{options_text(primary)}"
    return f"{about}\n{options}" + (f"\n\n{_recipes()}" if primary == "train" else "")


def _recipes() -> str:
    """A line for each recipe: the first sentence of its file."""
    lines = ["Recipes (recipes/README.md):", ""]
    for file in sorted((CONF / "recipe").glob("*.yaml")):
        text = file.read_text(encoding="utf-8").removeprefix(WHOLE).strip()
        comment = takewhile(lambda line: line.startswith("#"), text.splitlines())
        told = re.split(r"\. |: make |\.$", " ".join(line[1:].strip() for line in comment))[0]
        lines += textwrap.wrap(f"  {file.stem:17s} {told}", 100, subsequent_indent=" " * 20)
    return "\n".join(lines)


def options_text(primary: str) -> str:
    """Every option of ``conf/<primary>.yaml`` with its comment, also those that stand in a comment
    since the recipes set them; those that choose a file of ``conf/`` come first, with what there
    is."""
    own, _, _ = (CONF / f"{primary}.yaml").read_text(encoding="utf-8").partition("\nhydra:")
    lines = [re.sub(r"^# (\w+: .*#)", r"\1", line) for line in own.splitlines()]
    kept = [line for line in lines if re.match(r" *\w+:.*#|\w+: \S", line)]
    groups = [
        f"{name}: {chosen or 'null'}  # {_choices(name, primary)}"
        for name, chosen in _chosen(primary).items()
    ]
    return "\n".join(groups + kept)


def _choices(group: str, primary: str) -> str:
    """The files of a group; of ``agent`` those that walk episodes, and for a training, which has
    recipes for them, the others apart."""
    files = sorted((CONF / group).glob("*.yaml"))
    if group != "agent":
        return ", ".join(path.stem for path in files)
    others = [path.stem for path in files if not walks(path)]
    text = ", ".join(path.stem for path in files if walks(path))
    own = f"; walk no episodes, for recipes of their own: {', '.join(others)}"
    return text + (own if primary == "train" else "")


def walks(file: Path) -> bool:
    """Whether the agent of a ``file`` of ``conf/agent`` walks episodes: such a file also says which
    weights are shipped and what is asked of the world, so it is one of the whole config."""
    return file.read_text(encoding="utf-8").startswith(WHOLE)


def _chosen(primary: str) -> dict[str, str | None]:
    """The groups of ``conf/<primary>.yaml`` and what of each it chooses."""
    entries = OmegaConf.load(CONF / f"{primary}.yaml").defaults
    pairs = [pair for entry in entries if isinstance(entry, DictConfig) for pair in entry.items()]
    found = {str(name): chosen for name, chosen in pairs}
    return {name: chosen for name, chosen in found.items() if "/" not in name}


def composed(primary: str, words: Sequence[str] = ()) -> DictConfig:
    """:func:`load_config`, which raises ValueError, in one paragraph, for what is wrong."""
    try:
        return load_config(primary, words)
    except (HydraException, OmegaConfBaseException) as error:
        raise ValueError(explain(error, primary, words)) from error


def _chosen_by(options: Sequence[str], primary: str) -> DictConfig:
    """The config with what ``options`` choose of its groups (``agent=recurrent``), and no more."""
    own, others = without_config_folder(options)
    groups = [o for o in others if o.partition("=")[0] in _chosen(primary)]
    return load_config(primary, [*own, *groups])


def _unknown_key(key: str, cfg: DictConfig, primary: str) -> str:
    parent = key.rpartition(".")[0]
    while parent and not isinstance(OmegaConf.select(cfg, parent), DictConfig):
        parent = parent.rpartition(".")[0]
    if not parent:
        return unknown("option", key, {*map(str, cfg), *_chosen(primary)})
    held = OmegaConf.select(cfg, parent)
    taken = [f"+{parent}.{name}" for name in _arguments(held)]
    if f"+{key}" in taken:
        return f"{key} is not set so far: to add it, write +{key}=VALUE."
    if not held:
        return f"There is no option {key!r}: {parent} is empty. To add one, write +{key}=VALUE."
    return unknown("option", key, [*(f"{parent}.{name!s}" for name in held), *taken])


def _arguments(node: DictConfig) -> list[str]:
    """What a ``_target_`` of this project takes beside what ``node`` sets; those of others are not
    imported."""
    target = str(node.get("_target_", ""))
    if not target.startswith(f"{PACKAGE.name}."):
        return []
    given = ("agent", *map(str, node))
    return [name for name in argument_names(get_object(target)) if name not in given]


def _misfit(key: str, value: str, cfg: DictConfig) -> str:
    held = OmegaConf.select(cfg, key)
    if not isinstance(held, DictConfig) or not held:
        return f"{key} cannot be {value}."
    names = [str(name) for name in held]
    return (
        f"{key} cannot be {value}: it holds {', '.join(names)}. Set one of these, as "
        f"{key}.{names[0]}=VALUE."
    )


def _first(pattern: str, text: str) -> str | None:
    found = re.search(pattern, text)
    return found.group(1) if found else None
