"""Settings that come with weights: plain data of a fixed schema, read here and nowhere else.

A folder of weights may come from anybody. Its ``config.yaml`` is YAML without anchors, tags and
interpolations; nothing in it is resolved, instantiated or run.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Any

import yaml

from mitigate.core import names
from mitigate.core.files import PACKAGE
from mitigate.core.output import is_regular

LARGEST = 1 << 16  # bytes of a file; the config of a run has about 4000 (ours)
DEEPEST = 16  # levels of lists and mappings; the config of a run has 8 (ours)
GREATEST = 1 << 53  # of a whole number: above it, floats skip some (IEEE 754)
UNRESOLVED = ("${", "???")  # what OmegaConf would resolve, or take for a missing value
_SHOWN = 60  # characters of a key or value that a message repeats
_WARNING = "Settings that come with weights are plain data: do not use this folder."


def read(file: Path) -> dict[str, Any]:
    """Return the YAML mapping in ``file``: None, bools, finite numbers, strings, lists and
    str-keyed dicts of these.

    Raises ValueError for anything else, a file of more than ``LARGEST`` bytes, more than
    ``DEEPEST`` levels, a key that comes twice, and an OmegaConf interpolation.
    """
    is_regular(file)  # a FIFO would wait forever
    with open(file, "rb") as opened:
        raw = opened.read(LARGEST + 1)
    if len(raw) > LARGEST:
        raise ValueError(f"{file} has more than {LARGEST} bytes. {_WARNING}")
    try:
        found = yaml.load(raw.decode("utf-8"), _PlainLoader)
    except (yaml.YAMLError, ValueError, OverflowError, RecursionError) as error:
        cause = " ".join(str(error).split())
        raise ValueError(f"{file} is no plain YAML ({cause}). {_WARNING}") from error
    if not isinstance(found, dict):
        raise ValueError(
            f"{file} holds no mapping, and so no settings of an agent: fetch or write it again."
        )
    for key, value in _entries(found):
        problem = _problem(value)
        if problem:
            raise ValueError(f"{file}: {_short(key)} {problem}. {_WARNING}")
    return found


def read_agent(file: Path, target: str, known: Collection[str]) -> dict[str, Any]:
    """Return the settings under ``agent`` in ``file`` but ``_target_``, which must be ``target``.

    Args: known: the settings that the agent has. Raises ValueError as :func:`read`; also if there
    are none, for those of another agent, for a setting not in ``known`` and for any other key that
    begins with "_" (Hydra's own begin so).
    """
    settings = read(file).get("agent")
    if not isinstance(settings, dict):
        raise ValueError(
            f"{file} has no settings of an agent: it must hold a mapping called agent, as `make "
            "train` writes it. Fetch the folder again, or train again."
        )
    found = settings.pop("_target_", target)
    if found != target:
        raise ValueError(
            f"{file} is of the agent {_short(found)}, but the agent here is {target}: choose the "
            f"agent that the weights belong to (agent={named(found) or '...'}; in Python, "
            "mitigate.load(folder, agent=...) fills one that you built)."
        )
    for key, _ in _entries(settings):
        if any(part.startswith("_") for part in key.split(".")):
            raise ValueError(
                f"{file}: agent.{_short(key)} begins with '_', as what names a class to build "
                f"does. {_WARNING}"
            )
    for name in settings:
        if name not in known:
            raise ValueError(unknown(file, f"agent.{name}", known))
    return settings


def named(target: object) -> str:
    """What ``agent=`` calls an agent of the class ``target``; empty if it is none of ours."""
    files = sorted((PACKAGE / "conf" / "agent").glob("*.yaml"))
    for file in files:
        lines = file.read_text(encoding="utf-8").splitlines()
        if f"_target_: {target}" in map(str.strip, lines):
            return file.stem
    return ""


def unknown(file: Path | str, key: str, allowed: Collection[str]) -> str:
    """Return what is wrong with ``key`` (dotted) in ``file``, of which ``allowed`` are known."""
    parent, _, name = key.rpartition(".")
    problem = names.unknown(f"setting of {parent}", _short(name), sorted(allowed))
    return f"{file}: {problem} Use the version of the agent that the weights belong to."


class _PlainLoader(yaml.SafeLoader):
    """SafeLoader that refuses what plain data does not need, before it is expanded."""

    _depth = 0

    def compose_node(self, parent: Any, index: Any) -> Any:
        event: Any = self.peek_event()
        if event.anchor is not None:
            raise ValueError(f"it has the anchor {_short(event.anchor)}")
        if event.tag is not None:
            raise ValueError(f"it has the tag {_short(event.tag)}")
        self._depth += 1
        if self._depth > DEEPEST:
            raise ValueError(f"it has more than {DEEPEST} levels")
        node = super().compose_node(parent, index)
        self._depth -= 1
        return node

    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Any, Any]:
        counts = Counter(key.value for key, _ in node.value if isinstance(key, yaml.ScalarNode))
        twice = [key for key, count in counts.items() if count > 1]
        if twice:
            raise ValueError(f"the key {_short(twice[0])} comes twice")
        return super().construct_mapping(node, deep)


def _entries(value: Any, key: str = "") -> Iterator[tuple[str, Any]]:
    """Yield every value below ``value`` with its dotted key; a key itself as a value, too."""
    if isinstance(value, dict):
        for name, item in value.items():
            inner = f"{key}.{name}" if key else str(name)
            if not isinstance(name, str) or _problem(name):
                yield inner, (name,)  # no plain data, whatever it is
            yield inner, item
            yield from _entries(item, inner)
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield f"{key}[{index}]", item
            yield from _entries(item, f"{key}[{index}]")


def _problem(value: Any) -> str:
    """Return why ``value`` (what it holds aside) is no plain data, empty if it is."""
    if isinstance(value, tuple):
        return "is no plain key"
    if isinstance(value, str):
        found = [mark for mark in UNRESOLVED if mark in value]
        return f"holds {found[0]}, which OmegaConf would resolve" if found else ""
    if isinstance(value, float) and not math.isfinite(value):
        return f"is {value}, no finite number"
    if type(value) is int and abs(value) > GREATEST:
        return "is too great a number"
    if value is None or isinstance(value, (bool, int, float, list, dict)):
        return ""
    return f"is a {type(value).__name__}, not null, a truth value, a number, text, list or mapping"


def _short(value: Any) -> str:
    text = value if isinstance(value, str) and value.isprintable() else ascii(value)
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]}..."
