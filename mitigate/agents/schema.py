"""Allowed values of settings that come with weights.

The class of each agent in ``KINDS`` has its own ``settings_schema`` beside its constructor.

The limits are far above what any agent here has; they keep a file from asking for all memory, and
patterns from taking for ever to match.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

from mitigate.core import settings
from mitigate.core.observation import DEPTH, RGB, VIEWS

SENSES = (RGB, DEPTH, "instruction")
MOST_TARGETS = 64  # patterns of a list
MOST_WORDS = 50_000  # of a vocabulary
_WORD = re.compile(r"[a-z]{1,40}")
_PATTERN = re.compile(r"[\w.\\\[\]|*+?-]{1,200}", re.ASCII)  # no groups, no counts
_REPEATS = 2  # of a pattern; more could be tried in too many ways


class Kind(NamedTuple):
    """``words`` say which values ``fits`` allows."""

    words: str
    fits: Callable[[Any], bool]


def whole(least: int, most: int) -> Kind:
    """Whole numbers from ``least`` to ``most``, both included; no truth values."""
    return Kind(
        f"a whole number from {least} to {most}",
        lambda value: type(value) is int and least <= value <= most,
    )


def number(least: float, most: float) -> Kind:
    """Numbers from ``least`` to ``most``, both included; no truth values."""
    return Kind(
        f"a number from {least:g} to {most:g}",
        lambda value: type(value) in (int, float) and least <= value <= most,
    )


def one_of(names: tuple[str, ...]) -> Kind:
    """One of ``names``."""
    return Kind(f"one of {', '.join(names)}", lambda value: value in names)


def some_of(names: tuple[str, ...]) -> Kind:
    """Lists of ``names``."""
    return Kind(
        f"a list of {', '.join(names)}",
        lambda value: isinstance(value, list) and all(item in names for item in value),
    )


def _are_targets(value: Any) -> bool:
    return (
        isinstance(value, list)
        and len(value) <= MOST_TARGETS
        and all(isinstance(item, str) and _PATTERN.fullmatch(item) for item in value)
        and all(sum(map(item.count, "*+?")) <= _REPEATS for item in value)
    )


TARGETS = Kind(
    f"a list of at most {MOST_TARGETS} names of modules, or of patterns without groups and with at "
    f"most {_REPEATS} of * + ?",
    _are_targets,
)


def _are_words(value: Any) -> bool:
    return value is None or (
        isinstance(value, list)
        and len(value) <= MOST_WORDS
        and all(isinstance(item, str) and _WORD.fullmatch(item) for item in value)
    )


VOCABULARY = Kind(f"null or a list of at most {MOST_WORDS} words of the letters a to z", _are_words)
TRUTH = Kind("true or false", lambda value: type(value) is bool)
ADAPTERS = {  # keyword arguments of ``insert_adapters``
    "target_modules": TARGETS,
    "ring": TARGETS,
    "gates": TARGETS,
    "reduction": whole(1, 1024),
    "ring_reduction": whole(1, 1024),
    "kernel": whole(1, 15),
    "gate": TRUTH,
    "middle": whole(1, 1024),
    "views": Kind(f"{VIEWS}, as the agents' panoramas have", lambda value: value == VIEWS),
    "hfov": number(1, 179),
}
ENCODERS = {  # of all our agents
    "size": whole(16, 1024),
    "blind": some_of(SENSES),
    "adapters": ADAPTERS,
}


class Schema(NamedTuple):
    """Settings of a kind of agent: the attribute ``settings_schema`` of its class.

    Attributes:
        settings: the allowed values by name; nested mappings for arguments of a part.
        part: the setting that holds the arguments of the part with attention heads; "" for none.
        usual: width and heads of that part by default.
    """

    settings: dict[str, Any]
    part: str = ""
    usual: tuple[int, int] = (1, 1)


KINDS = (  # classes that a folder may name, and no others
    "mitigate.agents.topological.TopologicalAgent",
    "mitigate.agents.recurrent.RecurrentAgent",
    "mitigate.agents.frontier.FrontierAgent",
)


def class_of(target: str) -> Any:
    """The class of one of ``KINDS``; each is imported only where it is needed."""
    assert target in KINDS, target
    module, _, name = target.rpartition(".")
    return getattr(import_module(module), name)  # named by KINDS


def schema_of(target: str) -> Schema:
    """The settings of one of ``KINDS``."""
    return class_of(target).settings_schema


_AGAIN = "Fetch the folder again, or train again."


def check(
    found: dict[str, Any], file: Path | str, target: str, again: str = _AGAIN
) -> dict[str, Any]:
    """Return ``found``, the settings of an agent of the kind ``target`` in ``file``. Raises
    ValueError, naming the file and the setting, for an unknown one and a value of another kind;
    ``again``: what to do about it."""
    kind = schema_of(target)
    _check(found, kind.settings, file, "agent", again)
    own = found.get(kind.part) or {}
    width, heads = (own.get(n, d) for n, d in zip(("width", "heads"), kind.usual, strict=True))
    if width % heads:
        raise ValueError(
            f"{file}: agent.{kind.part}.width ({width}) must be a multiple of agent."
            f"{kind.part}.heads ({heads}). {again}"
        )
    adapters = found.get("adapters") or {}
    if adapters and "target_modules" not in adapters:
        raise ValueError(
            f"{file}: agent.adapters lacks target_modules ([] for none beside ring). {again}"
        )
    return found


def _check(
    found: dict[str, Any], schema: dict[str, Any], file: Path | str, where: str, again: str
) -> None:
    for name, value in found.items():
        key = f"{where}.{name}"
        if name not in schema:
            raise ValueError(settings.unknown(file, key, schema))
        kind = schema[name]
        if isinstance(kind, Kind):
            if not kind.fits(value):
                raise ValueError(
                    f"{file}: {key} is {value!r:.80}, but must be {kind.words}. {again}"
                )
        elif isinstance(value, dict):
            _check(value, kind, file, key, again)
        elif value is not None:
            raise ValueError(
                f"{file}: {key} is {value!r:.80}, but must be null or a mapping of "
                f"{', '.join(kind)}. {again}"
            )
