"""Find the networks of an agent, which may be any Python object, and set their mode."""

from __future__ import annotations

import functools
import types
from collections import deque
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from typing import Any

from torch import nn

from mitigate.agents.source import is_users, methods, named_values

MOST_VALUES = 100_000  # maximum number of visited values (heuristic; takes less than a second)
_SCALARS = (str, bytes, int, float, complex, type(None), types.ModuleType)


def networks(agent: Any) -> dict[str, nn.Module]:
    """Return a dict that maps dotted paths in ``agent`` to networks.

    If ``agent`` is a network itself, its path is "". Submodules of a network are not listed.
    Attributes, containers, closures and the global variables that methods refer to are searched,
    without running the agent's code.
    """
    by_place: dict[str, nn.Module] = {}
    seen: dict[int, Any] = {}
    waiting: deque[tuple[str, Any]] = deque([("", agent)])
    while waiting and len(seen) < MOST_VALUES:
        place, value = waiting.popleft()
        if id(value) in seen or isinstance(value, _SCALARS):
            continue
        seen[id(value)] = value  # holding a reference keeps the id unique
        if isinstance(value, nn.Module):
            by_place[place] = value
            seen |= {id(module): module for module in value.modules()}
            parts = [part for module in value.modules() for part in _parts(module)]
        else:
            parts = [*_parts(value)]
        waiting.extend((f"{place}.{name}".strip("."), part) for name, part in parts)
    return by_place


def _parts(value: Any) -> Iterable[tuple[Any, Any]]:
    """Return the attributes or items of ``value`` by name."""
    if isinstance(value, dict):
        return dict.items(value)
    if type(value) in (list, tuple, set, frozenset):
        return enumerate(value)
    if isinstance(value, functools.partial):
        return [("func", value.func), ("args", value.args), ("keywords", value.keywords)]
    if isinstance(value, types.MethodType):
        return [("self", value.__self__), ("function", value.__func__)]
    if isinstance(value, types.FunctionType):
        values = named_values(value) if is_users(value) else {}
        return [*values.items(), ("defaults", value.__defaults__)]
    if isinstance(value, type):
        users = [each for each in value.__mro__ if is_users(each)]
        return [part for each in users for part in [*vars(each).items(), *methods(each).items()]]
    with suppress(AttributeError):  # without the user's __getattr__
        return [*object.__getattribute__(value, "__dict__").items(), ("class", type(value))]
    return ()


@contextmanager
def in_eval_mode(agent: Any) -> Iterator[None]:
    """Put every network of ``agent`` into eval mode, and restore all modes at the end."""
    roots = [net for net in networks(agent).values() if _has_mode(net)]
    modes = {m: m.training for net in roots for m in net.modules() if _has_mode(m)}
    for net in roots:
        net.eval()  # a class may override it
    try:
        yield
    finally:
        for net in roots:
            net.train(modes[net])
        for module, training in modes.items():
            module.training = training


def _has_mode(module: nn.Module) -> bool:
    return hasattr(module, "training")  # an exported program has no such method
