"""What a world is made by, as texts by name that are the same in another process.

Of a value that is no data its class alone is told: it may look otherwise elsewhere.
"""

from __future__ import annotations

import hashlib
import inspect
import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import partial
from itertools import count
from pathlib import PurePath
from types import FunctionType, MethodType
from typing import Any

import numpy as np

from mitigate.agents.fingerprint import source_of
from mitigate.agents.state import array_sha
from mitigate.core.build import Maker
from mitigate.worlds.world import World

MADE = "what makes it"
CHANGES = "changes while worlds are made"
SHOWN = 100  # characters of a value that are kept as they are; of the rest a hash (ours)
DEEPEST, ENTRIES = 5, 50  # of nested values; of a mapping that are told one by one (ours)
MOST = 100_000  # lists, mappings and objects in one value that are told (ours)


def first(make: Callable[[], World]) -> tuple[World, dict[str, str]]:
    """Return a world and what it was made by: the entries of a config, or a function's arguments,
    defaults and the values that it uses, a callable object's class and attributes. Of a value that
    making one changes, such as a cache, ``CHANGES``."""
    before = dict(_made_by(make))
    world = make()
    after = dict(_made_by(make))
    changed = {key for key in {**before, **after} if before.get(key) != after.get(key)}
    return world, after | dict.fromkeys(changed, CHANGES)


def kind_of(thing: object) -> str:
    """The name of a thing's class, with its module."""
    return f"{type(thing).__module__}.{type(thing).__qualname__}"


def hash_of(value: Any) -> str:
    """Return 12 hex digits of what is JSON, or numbers of other libraries."""
    return hashlib.sha256(json.dumps(value, default=float).encode()).hexdigest()[:12]


def _made_by(make: Any) -> Iterator[tuple[str, str]]:
    if isinstance(make, Maker):
        yield from _flat("env.world", make.node)
    elif isinstance(make, partial):
        given = {str(number): value for number, value in enumerate(make.args)} | make.keywords
        yield from _flat(f"{MADE}, argument", given)
        yield from _made_by(make.func)
    elif isinstance(make, MethodType):
        yield from _made_by(make.__func__)
        yield from _object(make.__self__)
    elif isinstance(make, FunctionType):
        if not str(make.__module__).startswith("mitigate."):
            yield from _function(make)
    elif not isinstance(make, type):
        yield from _object(make)


def _function(make: FunctionType) -> Iterator[tuple[str, str]]:
    code = make.__code__  # not its source, which is that of all that its lines hold
    yield from _flat(MADE, [code.co_names, [c for c in code.co_consts if c is not None]])
    defaults = {str(number): value for number, value in enumerate(make.__defaults__ or ())}
    yield from _flat(f"{MADE}, default", defaults | (make.__kwdefaults__ or {}))
    with suppress(ValueError):  # what it uses is not there yet
        used = inspect.getclosurevars(make)
        yield from _each(f"{MADE}, value", {**used.globals, **used.nonlocals})


def _object(thing: Any) -> Iterator[tuple[str, str]]:
    """Of one whose method makes worlds, or that is called itself."""
    if isinstance(thing, type):
        yield f"{MADE}, class", thing.__qualname__
        return
    yield f"{MADE}, class", kind_of(thing)
    yield f"{MADE}, code", hash_of(source_of(type(thing)))
    yield from _each(f"{MADE}, attribute", getattr(thing, "__dict__", {}))


def _each(name: str, values: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Each as a whole: it may change as a whole."""
    return ((f"{name}.{key}", _text(value)) for key, value in values.items())


def _flat(name: str, value: Any, depth: int = 0) -> Iterator[tuple[str, str]]:
    """The entries of nested mappings, by their names joined by points, as JSON."""
    parts: list[tuple[Any, Any]] = []
    if isinstance(value, Mapping) and depth < DEEPEST:
        with suppress(Exception):  # a mapping of the user's
            parts = [*value.items()] if len(value) <= ENTRIES else []
    for key, part in parts:
        yield from _flat(f"{name}.{key}", part, depth + 1)
    if not parts and not (depth == 0 and type(value) is dict and not value):
        yield name, _text(value)


def _text(value: Any) -> str:
    try:
        text = json.dumps(_data(value, 0, count()), sort_keys=True)
    except Exception:  # whatever an object of the user's does when it is looked at
        return kind_of(value)
    return text if len(text) <= SHOWN else f"{text[:SHOWN]}... ({hash_of(text)})"


def _data(value: Any, depth: int, told: Iterator[int]) -> Any:
    """``value`` as JSON; what is no data, too deep, or beyond what is ``told``, by its class."""
    if isinstance(value, (Enum, PurePath)):
        return str(value)
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    if isinstance(value, np.generic) and not value.dtype.hasobject:
        return value.item()
    if isinstance(value, np.ndarray) and not value.dtype.hasobject:
        return f"array {value.dtype} {value.shape} {array_sha(value)}"
    if depth < DEEPEST and next(told) < MOST:
        inner = partial(_data, depth=depth + 1, told=told)
        if is_dataclass(value) and not isinstance(value, type):
            return [kind_of(value), [inner(getattr(value, one.name)) for one in fields(value)]]
        if isinstance(value, dict):
            return {json.dumps(inner(key)): inner(part) for key, part in value.items()}
        if isinstance(value, (list, tuple)):
            return [*map(inner, value)]
        if isinstance(value, (set, frozenset)):
            return sorted(map(inner, value), key=json.dumps)
    return str(getattr(value, "__qualname__", kind_of(value)))
