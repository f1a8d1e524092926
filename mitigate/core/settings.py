"""Read the settings file in a folder of weights; the file is plain data with a fixed schema.

A folder of weights may be untrusted. Its ``config.yaml`` is YAML without anchors, tags or
interpolations; nothing in it is resolved, instantiated or run. No other module reads such files.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Any

import yaml

from mitigate.core import names
from mitigate.core.files import PACKAGE, read_bounded
from mitigate.core.output import UnsafePathError

LARGEST = 1 << 16  # maximum size of a file in bytes (heuristic); the config of a run has about 4000
DEEPEST = 16  # maximum nesting of lists and mappings (heuristic; the config of a run has 8)
GREATEST = 1 << 53  # largest allowed integer; not every larger one is exact as a float (IEEE 754)
UNRESOLVED = ("${", "???")  # OmegaConf resolves values with ${ and treats ??? as missing
_SHOWN = 60  # maximum length of a key or value in a message, in characters
_WARNING = "Settings that come with weights are plain data: do not use this folder."


def read(file: Path) -> dict[str, Any]:
    """Return the YAML mapping in ``file``.

    Allowed values are None, bools, finite numbers and strings, and lists and dicts (with str keys)
    that contain such values.

    Raises:
        ValueError: If the file contains a value of another type, a repeated key or an OmegaConf
            interpolation, is larger than ``LARGEST`` bytes, or is nested deeper than ``DEEPEST``
            levels.
    """
    try:
        settings = yaml.load(read_bounded(file, LARGEST).decode("utf-8"), _PlainLoader)
    except UnsafePathError:
        raise
    except (yaml.YAMLError, ValueError, OverflowError, RecursionError) as error:
        cause = names.escaped(" ".join(str(error).split()))
        raise ValueError(f"{file} is not plain YAML ({cause}). {_WARNING}") from error
    if not isinstance(settings, dict):
        raise ValueError(
            f"{file} must hold a mapping with the settings of an agent. Fetch or write it again."
        )
    for key, value in _entries(settings):
        if problem := _problem(value):
            raise ValueError(f"{file}: {_short(key)} {problem}. {_WARNING}")
    return settings


def read_agent(file: Path, target: str, known: Collection[str]) -> dict[str, Any]:
    """Return the settings in the mapping ``agent`` of ``file``, without ``_target_``.

    Args:
        file: the YAML file.
        target: required value of ``_target_``, if the file contains this key.
        known: names of the settings of the agent.

    Raises:
        ValueError: :func:`read` rejects the file, the settings are missing or belong to a different
            agent, a setting is not in ``known``, or a key begins with "_", like Hydra's own keys.
    """
    settings = read(file).get("agent")
    if not isinstance(settings, dict):
        raise ValueError(
            f"{file} must hold the settings of an agent (a mapping called agent), as `make train` "
            "writes it. Fetch the folder again, or train again."
        )
    actual = settings.pop("_target_", target)
    if actual != target:
        raise ValueError(
            f"{file} belongs to the agent {_short(actual)}, but the agent here is {target}. "
            f"Choose the agent that the weights belong to (agent={named(actual) or '...'}; in "
            "Python, mitigate.load(folder, agent=...) loads them into an agent that you built)."
        )
    for key, _ in _entries(settings):
        if any(part.startswith("_") for part in key.split(".")):
            raise ValueError(
                f"{file}: agent.{_short(key)} must not begin with '_': Hydra uses "
                f"such keys to choose the class that it builds. {_WARNING}"
            )
    for name in settings:
        if name not in known:
            raise ValueError(unknown(file, f"agent.{name}", known))
    return settings


def named(target: object) -> str:
    """Return the value of the option ``agent=`` that selects the class ``target``, or ""."""
    for file in sorted((PACKAGE / "conf" / "agent").glob("*.yaml")):
        if f"_target_: {target}" in map(str.strip, file.read_text(encoding="utf-8").splitlines()):
            return file.stem
    return ""


def unknown(file: Path | str, key: str, allowed: Collection[str]) -> str:
    """Return the error message for a dotted ``key`` of ``file`` that is not in ``allowed``."""
    parent, _, name = key.rpartition(".")
    problem = names.unknown(f"setting of {parent}", _short(name), sorted(allowed))
    return f"{file}: {problem} Use the version of the agent that the weights belong to."


class _PlainLoader(yaml.SafeLoader):
    """YAML loader that rejects anchors, tags, deep nesting and repeated keys.

    They are rejected before they are expanded, because a short file may describe a huge value.
    """

    _depth = 0

    def compose_node(self, parent: Any, index: Any) -> Any:
        event: Any = self.peek_event()
        if event.anchor is not None:
            raise ValueError(f"it has the anchor {_short(event.anchor)}")
        if event.tag is not None:
            raise ValueError(f"it has the tag {_short(event.tag)}")
        self._depth += 1
        if self._depth > DEEPEST:
            raise ValueError(f"it has more than {DEEPEST} levels of nesting")
        node = super().compose_node(parent, index)
        self._depth -= 1
        return node

    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Any, Any]:
        counts = Counter(key.value for key, _ in node.value if isinstance(key, yaml.ScalarNode))
        twice = [key for key, count in counts.items() if count > 1]
        if twice:
            raise ValueError(f"the key {_short(twice[0])} occurs twice")
        return super().construct_mapping(node, deep)


def _entries(value: Any, key: str = "") -> Iterator[tuple[str, Any]]:
    """Yield every nested value with its dotted key.

    An invalid key is also yielded as a value, in a tuple, which :func:`_problem` reports.
    """
    if isinstance(value, dict):
        for name, item in value.items():
            inner = f"{key}.{name}" if key else str(name)
            if not isinstance(name, str) or _problem(name):
                yield inner, (name,)
            yield inner, item
            yield from _entries(item, inner)
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield f"{key}[{index}]", item
            yield from _entries(item, f"{key}[{index}]")


def _problem(value: Any) -> str:
    """Return the reason why ``value`` is not plain data, or "" if it is plain data.

    The items of a container are not checked.
    """
    if isinstance(value, tuple):
        return "is not a plain key"
    if isinstance(value, str):
        marks = [mark for mark in UNRESOLVED if mark in value]
        return f"holds {marks[0]}, which OmegaConf would resolve" if marks else ""
    if isinstance(value, float) and not math.isfinite(value):
        return f"must be a finite number, got {value}"
    if type(value) is int and abs(value) > GREATEST:
        return "is too large a number"
    if value is None or isinstance(value, (bool, int, float, list, dict)):
        return ""
    return f"must be null, true, false, a number, text, list or mapping, got {type(value).__name__}"


def _short(value: Any) -> str:
    return names.escaped(str(value), _SHOWN)
