"""Compose and check the options of a command, run its Hydra program, and explain its errors.

Each command registers the dataclass of its options when its module is imported (:func:`register`).
A user's mistake is explained in one paragraph with the cause, the allowed values and a fix. Set
``HYDRA_FULL_ERROR=1`` to see the whole traceback instead.
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
from collections.abc import Callable, Mapping, Sequence
from contextlib import redirect_stderr
from itertools import takewhile
from pathlib import Path
from typing import Any, TextIO

import hydra
from hydra import compose, initialize_config_dir
from hydra.core.config_store import ConfigStore
from hydra.core.global_hydra import GlobalHydra
from hydra.errors import HydraException, MissingConfigException, OverrideParseException
from hydra.utils import get_object
from omegaconf import DictConfig, OmegaConf
from omegaconf.errors import OmegaConfBaseException

from mitigate.core.addresses import check_arguments, check_choice
from mitigate.core.build import argument_names
from mitigate.core.errors import error_message, too_large_message
from mitigate.core.files import PACKAGE
from mitigate.core.names import unknown
from mitigate.core.options import check_dashes, config_folder, flags_first, without_config_folder
from mitigate.core.signals import Ended, raise_ended

CONF = PACKAGE / "conf"  # in a checkout, this is a link to its conf/
TYPES: dict[str, type] = {}  # the dataclass of each registered conf/<name>.yaml
# for each conf/<name>.yaml, maps a config group to the group's files that the command rejects
REJECTED: dict[str, Mapping[str, Sequence[str]]] = {}
FULL = "HYDRA_FULL_ERROR"  # environment variable that makes Hydra show whole tracebacks
# main sets this variable together with FULL.
# Child programs then know that the user did not set FULL.
OURS = "MITIGATE_FULL_ERROR"
# line that Hydra prints (hydra.core.utils, JobReturn.return_value)
HYDRA_LINE = "Error executing job with overrides"
WHOLE = "# @package _global_"  # first line of a file that also sets entries outside its group
KINDS = {
    "Integer": "a whole number, such as 4",
    "Float": "a number, such as 0.6",
    "bool": "true or false",
    "String": "text",
}


def register(
    primary: str,
    kind: type,
    schema: str | None = None,
    rejected: Mapping[str, Sequence[str]] | None = None,
) -> None:
    """Register the dataclass ``kind`` as the schema of ``conf/<primary>.yaml``.

    Args:
        primary: name of the config.
        kind: dataclass that declares the type of each option.
        schema: name of the schema without the suffix ``_schema``; the defaults list of the file
            contains ``<schema>_schema``. The default is ``primary``.
        rejected: maps config groups to the names of files that the command rejects. The help of the
            command does not list these files.
    """
    TYPES[primary] = kind
    REJECTED[primary] = rejected or {}
    ConfigStore.instance().store(name=f"{schema or primary}_schema", node=kind)


def typed(cfg: DictConfig, primary: str) -> Any:
    """Convert composed options to the dataclass of ``conf/<primary>.yaml``.

    Entries that the dataclass does not declare become attributes of the object. Nodes without a
    type become dicts.

    Raises:
        ValueError: If an entry refers to a missing entry, or a mandatory entry is not set.
    """
    try:
        return OmegaConf.to_object(cfg)
    except OmegaConfBaseException as error:
        raise ValueError(explain(error, primary)) from error


def hydra_program(primary: str, run: Callable[[DictConfig], Any]) -> Callable[[], None]:
    """Return a program that calls ``run`` with the options of ``conf/<primary>.yaml``."""
    return hydra.main(version_base="1.3", config_path=str(CONF), config_name=primary)(run)


def main(
    program: Callable[[], None],
    primary: str,
    check: Callable[[], None] | None = None,
    behind: Sequence[str] = (),
    again: str = "To resume",
) -> None:
    """Run the Hydra program of a command and explain its errors.

    With ``--help``, it only prints every option and the first lines of ``program``'s module
    docstring.

    After a ValueError, an OSError, an error in a config or a request for too much memory, it prints
    one paragraph and exits with status 1. After Ctrl-C (status 130) and SIGTERM (status 143), it
    prints the command that resumes the work.

    Args:
        program: a ``hydra.main`` function that uses the config ``conf/<primary>.yaml``
            (:func:`hydra_program`).
        primary: name of the config.
        check: function that is called before ``program`` and checks the command-line arguments.
            Addresses are checked earlier (``core/addresses.py``).
        behind: command-line arguments that were removed before Hydra parses the rest, such as those
            after ``--``. They are appended to the printed command.
        again: text before the printed command that states what the command does.
    """
    if {"--help", "-h"} & set(sys.argv[1:]):
        print(help_text(sys.modules[program.__module__].__doc__ or "", primary))
        return
    if os.environ.get(FULL) and OURS not in os.environ:
        _prepare(primary, check)
        return program()
    os.environ.update({FULL: "1", OURS: "1"})  # makes Hydra raise errors instead of exiting
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGTERM, raise_ended)
    try:
        _prepare(primary, check)
        with redirect_stderr(_WithoutHydraLine(sys.stderr)):
            program()
    except (HydraException, OmegaConfBaseException) as error:
        sys.exit(f"error: {explain(error, primary, sys.argv[1:])}")
    except BrokenPipeError:  # the program that reads the output has ended (mitigate/cli.py)
        raise
    except (ValueError, OSError) as error:
        sys.exit(f"error: {error_message(error)}")
    except (MemoryError, RuntimeError, OverflowError) as error:
        if message := too_large_message(error):
            sys.exit(f"error: {message}")
        raise
    except KeyboardInterrupt as error:
        command = shlex.join([*sys.argv[0].split(), *sys.argv[1:], *behind])
        print(f"\n{str(error) or 'SIGINT'}: stopped. {again}: {command}", file=sys.stderr)
        sys.exit(error.status if isinstance(error, Ended) else 130)
    finally:
        del os.environ[FULL], os.environ[OURS]


def _prepare(primary: str, check: Callable[[], None] | None) -> None:
    """Check the command line before Hydra parses or prints it, and move flags to the front."""
    check_arguments(sys.argv[1:])
    if check is not None:
        check()
    check_dashes(sys.argv[1:])
    sys.argv[1:] = flags_first(sys.argv[1:])
    _check_files(primary, sys.argv[1:])
    for notice in notices(primary, sys.argv[1:]):
        print(notice, file=sys.stderr)


def _check_files(primary: str, words: Sequence[str]) -> None:
    """Check the addresses in config files before Hydra prints them or saves the config of a sweep.

    The check takes a tenth of a second. It therefore runs only if the user names a config folder,
    starts a sweep or prints a config; ``words`` are the command-line arguments. Raises the same
    errors as :func:`mitigate.core.addresses.check_arguments`.
    """
    if not any(word.startswith("-") or "hydra." in word for word in words):
        return
    folder_words, overrides = without_config_folder(words)
    overrides = [word for word in overrides if re.match(r"[^-].*=|~", word)]
    try:
        cfg = load_config(primary, [*folder_words, *overrides], with_hydra=True)
        params = OmegaConf.select(cfg, "hydra.sweeper.params") or {}
        swept = [f"{key}={value}" for key, value in params.items()]
        choice = OmegaConf.select(cfg, "safeguard")
    except (HydraException, OmegaConfBaseException):  # the program itself explains this error
        return
    check_arguments(swept)
    if choice is not None:
        check_choice(choice)


class _WithoutHydraLine:
    """Output stream that drops the line that Hydra prints before an error.

    The line is not needed: :func:`main` explains a user's mistake, and other errors have a
    traceback.
    """

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        return len(text) if text.startswith(HYDRA_LINE) else self._stream.write(text)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)  # take all other attributes from the stream


def explain(error: Exception, primary: str, options: Sequence[str] = ()) -> str:
    """Return a paragraph that explains why ``options`` do not fit ``conf/<primary>.yaml``."""
    text = f"{error}\n{error.__cause__ or ''}"
    if isinstance(error, MissingConfigException) and error.options is not None:
        group, _, name = (error.missing_cfg_file or "").rpartition("/")
        problem = unknown(group, name, [o for o in error.options if not o.endswith("_schema")])
        if group != "suite":
            return problem
        return (
            f"{problem} To choose single corruptions, write conditions=[spatter,flare], or in "
            'Python suite=["spatter", "flare"].'
        )
    if isinstance(error, OverrideParseException):
        return (
            f"Cannot read the option {error.override!r}: write key=value, such as severity=0.6. A "
            "value that holds = , or spaces needs two pairs of quotes: 'checkpoint=\"my=agent\"'."
        )
    key = _first(r"Could not (?:override|delete from config\.) '([^']+)'", text)
    if key is not None:
        cfg = _chosen_by(options, primary)
        if isinstance(OmegaConf.select(cfg, key), DictConfig):  # Hydra treated the key as a group
            return _misfit(key, _first(rf"{re.escape(key)}=(.*)", "\n".join(options)) or "", cfg)
        return _unknown_key(key, cfg, primary)
    missing = _first(r"Interpolation key '([^']+)' not found", text)
    if missing is not None:
        key = _first(r"full_key: (\S+)", text) or "another entry"
        return f"{key} refers to {missing}, which does not exist. Keep {missing}, or set both."
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


def load_config(primary: str, words: Sequence[str] = (), with_hydra: bool = False) -> DictConfig:
    """Compose ``conf/<primary>.yaml`` with command-line arguments, outside a Hydra program.

    Args:
        primary: name of the config.
        words: Hydra overrides, and optionally the option ``--config-dir`` with a folder of more
            configs.
        with_hydra: whether to add Hydra's own settings as ``hydra``.

    Raises:
        ValueError: If no imported module has registered the schema of this file, or an address in
            the overrides contains a password.
    """
    check_arguments(words)
    if primary not in TYPES:
        raise ValueError(
            f"The schema of conf/{primary}.yaml is not registered: import the module of the "
            "command first (mitigate/cli.py names it)."
        )
    _, overrides = without_config_folder(words)
    if folder := config_folder(words):
        place = str(folder.resolve()).replace("\\", "\\\\").replace('"', '\\"')
        overrides.append(f'hydra.searchpath=["file://{place}"]')
    GlobalHydra.instance().clear()
    with initialize_config_dir(str(CONF), version_base="1.3"):
        return compose(primary, overrides, return_hydra_config=with_hydra)


def notices(primary: str, options: Sequence[str]) -> list[str]:
    """Return warnings about the entries that ``options`` add, such as ``+columns.mine=[...]``.

    Hydra itself does not warn when it replaces an existing list or mapping, or adds an entry that
    no program reads.
    """
    added = {
        option[1:].partition("=")[0]: option.partition("=")[2][:1] in "[{"
        for option in options
        if re.match(r"\+[^+]", option)
    }
    if not added:
        return []
    folder_words, overrides = without_config_folder(options)
    understood = [word for word in overrides if re.match(r"[^-+].*=|~", word)]
    try:
        cfg = load_config(primary, [*folder_words, *understood])
    except (HydraException, OmegaConfBaseException):  # the program itself explains this error
        return []
    folders = (CONF, config_folder(options) or CONF)
    notices = [
        _notice(key, whole, cfg)
        for key, whole in added.items()
        if not any((folder / key.partition("@")[0]).is_dir() for folder in folders)
    ]
    return [notice for notice in notices if notice]


def _notice(key: str, whole: bool, cfg: DictConfig) -> str:
    """Return the warning for ``+key=``; ``whole`` is true if the value is a list or a mapping."""
    # if the entry exists, Hydra itself rejects a value that is neither a list nor a mapping
    if OmegaConf.select(cfg, key) is not None:
        text = f"{key} already exists, and +{key}= replaces it. To add one, use another name."
        return text if whole else ""
    if "." in key:
        return ""
    near = difflib.get_close_matches(key, [*map(str, cfg)], n=1)
    hint = f" Did you mean {near[0]}=...?" if near else ""
    return f"+{key}= adds an option that only your own configs can use.{hint}"


def help_text(about: str, primary: str) -> str:
    """Return what ``--help`` prints: ``about`` and the options."""
    options = f"Options with their defaults:\n\n{options_text(primary)}"
    return f"{about}\n{options}" + (f"\n\n{_recipes()}" if primary == "train" else "")


def _recipes() -> str:
    """Return one line per recipe, with the first sentence of its file."""
    lines = ["Recipes (recipes/README.md):", ""]
    for file in sorted((CONF / "recipe").glob("*.yaml")):
        text = file.read_text(encoding="utf-8").removeprefix(WHOLE).strip()
        comment = takewhile(lambda line: line.startswith("#"), text.splitlines())
        sentence = re.split(r"\. |: make |\.$", " ".join(line[1:].strip() for line in comment))[0]
        lines += textwrap.wrap(f"  {file.stem:17s} {sentence}", 100, subsequent_indent=" " * 20)
    return "\n".join(lines)


def options_text(primary: str) -> str:
    """Describe every option of ``conf/<primary>.yaml`` by its comment.

    Options that choose a file in ``conf/`` come first, with their allowed values. Options that
    recipes set are also listed; the file contains them as comments.
    """
    text, _, _ = (CONF / f"{primary}.yaml").read_text(encoding="utf-8").partition("\nhydra:")
    lines = [re.sub(r"^# (\w+: .*#)", r"\1", line) for line in text.splitlines()]
    options = [line for line in lines if re.match(r" *\w+:.*#|\w+: \S", line)]
    groups = [
        f"{name}: {chosen or 'null'}  # {_choices(name, primary)}"
        for name, chosen in _chosen(primary).items()
    ]
    return "\n".join(groups + options)


def _choices(group: str, primary: str) -> str:
    """Return the names of the config files in a group.

    The group ``agent`` lists agents that can run episodes. For training, the other agents are
    listed separately, because they have their own recipes.
    """
    rejected = REJECTED[primary].get(group, ())
    files = [path for path in sorted((CONF / group).glob("*.yaml")) if path.stem not in rejected]
    if group != "agent":
        return ", ".join(path.stem for path in files)
    text = ", ".join(path.stem for path in files if walks(path))
    if primary != "train":
        return text
    others = ", ".join(path.stem for path in files if not walks(path))
    return f"{text}; cannot run episodes, have their own recipes: {others}"


def walks(file: Path) -> bool:
    """Return whether the agent that ``file`` (in ``conf/agent``) defines can run episodes.

    The file of such an agent begins with ``WHOLE``, because it also sets entries outside the group
    ``agent``, such as ``weights`` and ``env``.
    """
    return file.read_text(encoding="utf-8").startswith(WHOLE)


def _chosen(primary: str) -> dict[str, str | None]:
    """Map each config group of ``conf/<primary>.yaml`` to its default file."""
    entries = OmegaConf.load(CONF / f"{primary}.yaml").defaults
    pairs = [pair for entry in entries if isinstance(entry, DictConfig) for pair in entry.items()]
    return {str(name): chosen for name, chosen in pairs if "/" not in str(name)}


def composed(primary: str, words: Sequence[str] = ()) -> DictConfig:
    """Compose a config like :func:`load_config`, but explain every error as a ValueError."""
    try:
        return load_config(primary, words)
    except (HydraException, OmegaConfBaseException) as error:
        raise ValueError(explain(error, primary, words)) from error


def _chosen_by(options: Sequence[str], primary: str) -> DictConfig:
    """Compose the config with only the options that choose a file (``agent=recurrent``)."""
    folder_words, overrides = without_config_folder(options)
    groups = [o for o in overrides if o.partition("=")[0] in _chosen(primary)]
    return load_config(primary, [*folder_words, *groups])


def _unknown_key(key: str, cfg: DictConfig, primary: str) -> str:
    """Return the error paragraph for an option that is not in the config."""
    parent = key.rpartition(".")[0]
    while parent and not isinstance(OmegaConf.select(cfg, parent), DictConfig):
        parent = parent.rpartition(".")[0]
    if not parent:
        return unknown("option", key, {*map(str, cfg), *_chosen(primary)})
    node = OmegaConf.select(cfg, parent)
    additions = [f"+{parent}.{name}" for name in _arguments(node)]
    if f"+{key}" in additions:
        return f"{key} is not set yet. To add it, write +{key}=VALUE."
    if not node:
        return f"There is no option {key!r}: {parent} is empty. To add one, write +{key}=VALUE."
    return unknown("option", key, [*(f"{parent}.{name!s}" for name in node), *additions])


def _arguments(node: DictConfig) -> list[str]:
    """Return the arguments of the ``_target_`` of ``node`` that ``node`` does not set.

    Only targets of this project are imported; for other targets the result is empty.
    """
    target = str(node.get("_target_", ""))
    if not target.startswith(f"{PACKAGE.name}."):
        return []
    known = ("agent", *map(str, node))
    return [name for name in argument_names(get_object(target)) if name not in known]


def _misfit(key: str, value: str, cfg: DictConfig) -> str:
    """Return the error paragraph for a value that is invalid for the entry ``key``."""
    node = OmegaConf.select(cfg, key)
    if not isinstance(node, DictConfig):
        return f"{key} cannot be {value}."
    if not node:
        return f"{key} cannot be {value}. To add an entry, write +{key}.NAME=VALUE."
    names = [*map(str, node)]
    return f"{key} cannot be {value}: it holds {', '.join(names)}. Set {key}.{names[0]}=VALUE."


def _first(pattern: str, text: str) -> str | None:
    match = re.search(pattern, text)
    return match.group(1) if match else None
