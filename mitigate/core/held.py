"""What an agent that may be any object holds: networks and arrays, wherever they are in it."""

from __future__ import annotations

import logging
import random
import types
from collections import deque
from collections.abc import Iterator, Mapping, Set
from contextlib import contextmanager
from dataclasses import dataclass, field
from enum import Enum
from functools import partial
from pathlib import PurePath
from typing import Any

import numpy as np
import torch
from torch import nn

from mitigate.core.observation import Observation

DEPTH = 6  # how far below the agent is looked: agent.pol.nets["policy"] is 3 (ours)
MOST = 10_000  # things that are looked at (ours)
_NO_WEIGHTS = (
    *(str, bytes, int, float, complex, type(None), type, Enum, PurePath, np.generic),
    *(torch.device, torch.dtype, torch.Size, torch.Generator, np.random.Generator, random.Random),
    *(np.random.RandomState, logging.Logger, types.ModuleType, types.BuiltinFunctionType),
    Observation,
)
_OWN_OF_TORCH = frozenset(vars(nn.Module()))  # hooks, parameters, and modules that it lists itself


@dataclass
class Held:
    """networks and arrays (also tensors) by where they are, such as "pol.nets.policy", the agent
    itself as "". unknown: places of what nobody could look into, such as a session of another
    library, or that are too deep or too many."""

    networks: dict[str, nn.Module] = field(default_factory=dict)
    arrays: dict[str, Any] = field(default_factory=dict)
    unknown: list[str] = field(default_factory=list)


def held(agent: Any) -> Held:
    """Return what is in ``agent``, in its attributes, and in the lists, mappings, objects and
    functions that these hold; each thing once, where it is found first."""
    found = Held()
    seen: set[int] = set()
    waiting: deque[tuple[tuple[str, ...], Any]] = deque([((), agent)])
    while waiting:
        place, value = waiting.popleft()
        if id(value) in seen or isinstance(value, _NO_WEIGHTS):
            continue
        seen.add(id(value))
        name = ".".join(place)
        if isinstance(value, nn.Module):
            found.networks[name] = value
            seen.update(map(id, value.modules() if value is agent else ()))
        elif _is_array(value):
            found.arrays[name] = value
            continue
        inside = _inside(value, whole=value is agent)
        if inside is None or (inside and (len(place) >= DEPTH or len(seen) > MOST)):
            found.unknown.append(name)
            continue
        waiting.extend(((*place, own), part) for own, part in inside)
    return found


def networks(agent: Any) -> list[nn.Module]:
    """The networks that ``agent`` is or holds."""
    return [*held(agent).networks.values()]


@contextmanager
def in_eval_mode(agent: Any) -> Iterator[None]:
    """Have every network of ``agent`` in eval mode; afterwards each module is as it was."""
    modes = {module: module.training for net in networks(agent) for module in net.modules()}
    for module in modes:
        module.training = False
    try:
        yield
    finally:
        for module, training in modes.items():
            module.training = training


def _is_array(value: Any) -> bool:
    if isinstance(value, np.ndarray):
        return value.dtype != object
    return isinstance(value, torch.Tensor) or hasattr(value, "__array__")


def _inside(value: Any, whole: bool) -> list[tuple[str, Any]] | None:
    """The parts of ``value`` by name; None if it has none that can be looked at. ``whole``: it is
    the agent, of which a network has attributes beside its modules; of others they do not count."""
    if isinstance(value, nn.Module):
        own = {k: v for k, v in vars(value).items() if k not in _OWN_OF_TORCH}
        return [*own.items()] if whole else []
    if isinstance(value, Mapping):
        return [(str(key), part) for key, part in value.items()]
    if isinstance(value, (list, tuple, deque, Set)):
        return [(str(number), part) for number, part in enumerate(value)]
    if isinstance(value, partial):
        return [("func", value.func), *_numbered((value.args, value.keywords))]
    if isinstance(value, types.MethodType):
        return [("self", value.__self__)]
    if isinstance(value, types.FunctionType):
        filled = [cell for cell in value.__closure__ or () if _is_filled(cell)]
        return _numbered([cell.cell_contents for cell in filled])
    slots = [name for kind in type(value).__mro__ for name in _slots(kind)]
    if hasattr(value, "__dict__") or slots:
        own = {name: getattr(value, name) for name in slots if hasattr(value, name)}
        return [*(getattr(value, "__dict__", {}) | own).items()]
    return None if type(value) is not object else []


def _numbered(parts: Any) -> list[tuple[str, Any]]:
    return [(str(number), part) for number, part in enumerate(parts)]


def _slots(kind: type) -> tuple[str, ...]:
    own = vars(kind).get("__slots__", ())
    return (own,) if isinstance(own, str) else tuple(own)


def _is_filled(cell: types.CellType) -> bool:
    try:
        return cell.cell_contents is not cell
    except ValueError:
        return False
