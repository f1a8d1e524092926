"""Define the allowed values of settings that are stored with weights.

Each class in ``KINDS`` defines ``settings_schema`` next to its constructor. The settings of shipped
agents are far below the limits. The limits ensure that a file can neither cause a huge memory
allocation nor contain patterns that take too long to match.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

from mitigate.core import names, settings
from mitigate.core.observation import DEPTH, RGB

SENSES = (RGB, DEPTH, "instruction")
MOST_TARGETS = 64  # maximum number of patterns in a list
MOST_WORDS = 50_000  # largest size of a vocabulary
_WORD = re.compile(r"[a-z]{1,40}")
# patterns of module names; groups and repetition counts are not allowed
_PATTERN = re.compile(r"[\w.\\\[\]|*+?-]{1,200}", re.ASCII)
_REPEATS = 2  # maximum number of quantifiers in a pattern; with more, matching can take too long


def check_blind(blind: Sequence[str], senses: Sequence[str] = SENSES) -> None:
    """Raise ValueError if ``blind`` contains a name that is not in ``senses``."""
    for name in blind:
        if name not in senses:
            raise ValueError(names.unknown("sense to blank (agent.blind)", name, senses))


class Kind(NamedTuple):
    """A set of allowed values: ``fits`` accepts them, and the text ``words`` describes them."""

    words: str
    fits: Callable[[Any], bool]


def whole(least: int, most: int) -> Kind:
    """Return a :class:`Kind` that accepts integers from ``least`` to ``most`` inclusive."""
    return Kind(
        f"a whole number from {least} to {most}",
        lambda value: type(value) is int and least <= value <= most,
    )


def number(least: float, most: float) -> Kind:
    """Return a :class:`Kind` that accepts numbers from ``least`` to ``most`` inclusive."""
    return Kind(
        f"a number from {least:g} to {most:g}",
        lambda value: type(value) in (int, float) and least <= value <= most,
    )


def one_of(allowed: tuple[str, ...]) -> Kind:
    """Return a :class:`Kind` that accepts each member of ``allowed``."""
    return Kind(f"one of {', '.join(allowed)}", lambda value: value in allowed)


def some_of(allowed: tuple[str, ...]) -> Kind:
    """Return a :class:`Kind` that accepts lists of members of ``allowed``."""
    return Kind(
        f"a list of {', '.join(allowed)}",
        lambda value: isinstance(value, list) and all(item in allowed for item in value),
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
ADAPTERS = {  # keyword arguments of ``insert_adapters`` that settings may contain
    "target_modules": TARGETS,
    "ring": TARGETS,
    "gates": TARGETS,
    "reduction": whole(1, 1024),
    "ring_reduction": whole(1, 1024),
    "kernel": whole(1, 15),
    "gate": TRUTH,
    "middle": whole(1, 1024),
}
ENCODERS = {  # settings that all shipped agents have
    "size": whole(16, 1024),
    "blind": some_of(SENSES),
    "adapters": ADAPTERS,
}


KINDS = (  # the only classes that the config in a folder may name
    "mitigate.agents.topological.TopologicalAgent",
    "mitigate.agents.recurrent.RecurrentAgent",
    "mitigate.agents.frontier.FrontierAgent",
)


def class_of(target: str) -> Any:
    """Import and return the class of one of ``KINDS``."""
    assert target in KINDS, target
    module, _, name = target.rpartition(".")
    return getattr(import_module(module), name)  # the name comes from KINDS


def schema_of(target: str) -> dict[str, Any]:
    """Return the allowed values of each setting of the class ``target``, as a nested dict."""
    return class_of(target).settings_schema


_AGAIN = "Fetch the folder again, or train again."


def check(
    values: dict[str, Any],
    schema: dict[str, Any],
    file: Path | str,
    again: str = _AGAIN,
    where: str = "agent",
) -> None:
    """Check settings that come with weights.

    Args:
        values: the settings.
        schema: the allowed values (:func:`schema_of`).
        file: source of the settings, for messages.
        again: advice that ends the error message.
        where: dotted name of the settings, for messages.

    Raises:
        ValueError: If a setting is unknown or has an invalid value; the message names the file and
            the setting.
    """
    for name, value in values.items():
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
            check(value, kind, file, again, key)
        elif value is not None:
            raise ValueError(
                f"{file}: {key} is {value!r:.80}, but must be null or a mapping of "
                f"{', '.join(kind)}. {again}"
            )
