"""What the settings of our agents may be, where they come with weights.

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
RGB_ENCODERS = ("own", "efficientnet_lite0")
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
FUSION = {"learned": TRUTH, "rate": number(0, 1e6), "cap": number(0, 1e6)}
PLANNER = {
    "width": whole(4, 1024),
    "heads": whole(1, 64),
    "text_layers": whole(0, 32),
    "layers": whole(0, 32),
    "dropout": number(0, 1),
    "fusion": FUSION,
}
ADAPTERS = {
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
POLICY = {
    "width": whole(4, 1024),
    "heads": whole(1, 64),
    "text_layers": whole(0, 32),
    "dropout": number(0, 1),
}
ENCODERS = {  # what all have
    "size": whole(16, 1024),
    "blind": some_of(SENSES),
    "adapters": ADAPTERS,
}
AGENT = {
    **ENCODERS,
    "width": whole(4, 1024),
    "planner": PLANNER,
    "vocabulary": VOCABULARY,
    "encoder": one_of(RGB_ENCODERS),
}
RECURRENT = {
    **ENCODERS,
    "sensors": some_of((RGB, DEPTH)),
    "rgb_width": whole(4, 1024),
    "depth_width": whole(4, 1024),
    "policy": POLICY,
    "vocabulary": VOCABULARY,
}
FRONTIER = {**ENCODERS, "width": whole(4, 1024), "eye": number(0.05, 5)}


class Shipped(NamedTuple):
    """A kind of agent that a folder may hold: what its settings may be, and of the part that has
    attention heads, its name and the usual width and heads."""

    settings: dict[str, Any]
    part: str = ""
    usual: tuple[int, int] = (1, 1)


KINDS = {  # a folder may name these classes, and no others
    "mitigate.agents.topological.TopologicalAgent": Shipped(AGENT, "planner", (128, 4)),
    "mitigate.agents.recurrent.RecurrentAgent": Shipped(RECURRENT, "policy", (160, 4)),
    "mitigate.agents.frontier.FrontierAgent": Shipped(FRONTIER),
}


def class_of(target: str) -> Callable[..., Any]:
    """The class of one of ``KINDS``; each is imported only where it is needed."""
    assert target in KINDS, target
    module, _, name = target.rpartition(".")
    return getattr(import_module(module), name)


_AGAIN = "Fetch the folder again, or train again."


def check(
    found: dict[str, Any], file: Path | str, target: str, again: str = _AGAIN
) -> dict[str, Any]:
    """Return ``found``, the settings of an agent of the kind ``target`` in ``file``. Raises
    ValueError, naming the file and the setting, for an unknown one and a value of another kind;
    ``again``: what to do about it."""
    kind = KINDS[target]
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
