"""What an agent that may be any object holds: networks, arrays and functions, wherever they are."""

from __future__ import annotations

import logging
import operator
import random
import re
import sys
import sysconfig
import types
from collections import deque
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from datetime import date, datetime, timedelta
from datetime import time as clock_time
from decimal import Decimal
from enum import Enum
from functools import cache, partial
from itertools import chain, islice
from pathlib import PurePath
from typing import Any

import numpy as np
import torch
from torch import nn

from mitigate.core.observation import Observation

DEPTH = 8  # how far below the agent is looked: agent.pol.nets["policy"] is 3 (ours)
PARTS, LEAST = 1_000, 20  # of a list or mapping; those inside it share them (ours)
MOST = 100_000  # things that are looked at in all (ours)
_LISTS: tuple[Any, ...] = (list, tuple, deque, type({}.values()))
_CONTAINERS = (*_LISTS, set, frozenset, dict, types.MappingProxyType)
_GETTERS = (operator.itemgetter, operator.attrgetter, operator.methodcaller)
_PLAIN = (str, bytes, int, float, complex, type(None), Enum)
_DATA = (
    *(*_PLAIN, PurePath, np.generic, np.dtype, torch.device, torch.dtype, torch.Size),
    *(range, slice, re.Pattern, bytearray, Decimal, datetime, date, clock_time, timedelta),
)
_GENERATORS = (torch.Generator, np.random.Generator, np.random.RandomState, random.Random)
_NO_WEIGHTS = (
    *(*_DATA, *_GENERATORS, type, np.ufunc, logging.Logger, types.ModuleType, Observation),
)
_BY_VERSION = ("mitigate", "torch")  # packages that are known by their version, wherever they are
_INSTALLED = frozenset(("site-packages", "dist-packages"))
_OWN_OF_TORCH = frozenset(vars(nn.Module()))  # hooks, parameters, and modules that it lists itself


@dataclass
class Held:
    """networks and arrays (also tensors) by where they are, such as "pol.nets.policy", the agent
    itself as ""; a number in braces is of a set, which has no order. functions: of the user's own
    code. constants: plain values that functions and partial calls hold. attributes: texts of those
    that it, its objects, lists and mappings and the modules of networks hold, which may change from
    step to step; of classes and generators among them; and where one thing has two places. unknown:
    places of what nobody could look into, such as a session of another library, or that are too
    deep or too many."""

    networks: dict[str, nn.Module] = field(default_factory=dict)
    arrays: dict[str, Any] = field(default_factory=dict)
    functions: dict[str, types.FunctionType] = field(default_factory=dict)
    constants: dict[str, Any] = field(default_factory=dict)
    attributes: dict[str, str] = field(default_factory=dict)
    unknown: list[str] = field(default_factory=list)


def held(agent: Any, *, attributes: bool = False) -> Held:
    """Return what is in ``agent``, in its attributes, its methods, and in the lists, dicts, objects
    and functions that these hold or name; each thing once, where it is found first. Of a large list
    or dict its first parts that may hold weights are looked into, and the list is unknown.
    ``attributes``: whether these are asked for."""
    found = Held()
    seen: dict[int, tuple[Any, str]] = {}
    waiting: deque[tuple[tuple[str, ...], Any, int, bool]] = deque([((), agent, PARTS, False)])
    while waiting:
        place, value, most, fixed = waiting.popleft()
        name = ".".join(place)
        if id(value) in seen:
            if attributes and not isinstance(value, types.FunctionType):
                found.attributes[name] = f"as {seen[id(value)][1]}"
            continue
        seen[id(value)] = value, name
        if isinstance(value, types.FunctionType) and _is_users(value):
            found.functions[name] = value
        if isinstance(value, nn.Module):
            found.networks[name] = value
            seen.update((id(m), (m, name)) for m in (value.modules() if value is agent else ()))
            found.attributes |= _of_modules(name, value) if attributes else {}
        elif (array := _array(value)) is not None:
            found.arrays[name] = array
            continue
        inside, many = _inside(value, whole=value is agent), isinstance(value, _CONTAINERS)
        fixed = isinstance(value, (types.FunctionType, partial)) or (fixed and many)
        if inside is not None and (fixed or attributes):
            inside = [*inside]
            within = [(".".join((*place, own)), part) for own, part in inside]
            if fixed:
                found.constants |= {own: part for own, part in within if isinstance(part, _PLAIN)}
            else:
                found.attributes |= {own: t for own, part in within if (t := _text(part))}
        able = (part for part in inside or () if not isinstance(part[1], _NO_WEIGHTS))
        parts = [*islice(able, most + 1 if many else None)]
        if inside is None or (parts and (len(place) >= DEPTH or len(seen) > MOST)):
            found.unknown.append(name)
            continue
        if many and len(parts) > most:
            found.unknown.append(name)
        each = max(LEAST, most // max(1, len(parts))) if many else most
        for own, part in parts[: most if many else None]:  # numbered ones are no globals
            waiting.append(((*place, own), part, each, fixed and own.isdigit()))
    return found


def _text(value: Any) -> str:
    """Plain data, a class, or the state of a generator as text that is the same in every process;
    empty for anything else."""
    if isinstance(value, Enum):
        return f"{type(value).__qualname__}.{value.name}"
    if isinstance(value, type):
        return f"{value.__module__}.{value.__qualname__}"
    if isinstance(value, torch.Generator):
        return str(value.get_state().tolist())
    if isinstance(value, np.random.Generator):
        return str(value.bit_generator.state)
    if isinstance(value, np.random.RandomState):
        return str(value.get_state(legacy=False))
    if isinstance(value, random.Random):
        return str(value.getstate())
    return repr(value) if isinstance(value, _DATA) else ""


def _of_modules(name: str, net: nn.Module) -> dict[str, str]:
    """The plain attributes of the modules of a network."""
    return {
        f"{name}.{inner}.{own}": text
        for inner, module in net.named_modules()
        for own, value in getattr(module, "__dict__", {}).items()
        if own not in _OWN_OF_TORCH and (text := _text(value))
    }


def networks(agent: Any) -> list[nn.Module]:
    """The networks that ``agent`` is or holds."""
    return [*held(agent).networks.values()]


@contextmanager
def in_eval_mode(agent: Any) -> Iterator[None]:
    """Have every network of ``agent`` in eval mode, by its own ``eval()``, which may do more;
    afterwards each module is as it was."""
    tops = [net for net in networks(agent) if hasattr(net, "training")]  # frozen programs have none
    modules = [module for net in tops for module in net.modules() if hasattr(module, "training")]
    modes = {module: module.training for module in modules}
    for net in tops:
        net.eval()
    try:
        yield
    finally:
        for net in tops:
            net.train(modes[net])
        for module, training in modes.items():
            module.training = training


def _array(value: Any) -> Any:
    """``value`` as an array whose bytes are its values, or None if it is none."""
    if isinstance(value, torch.Tensor):
        plain = value.layout == torch.strided and not (value.is_quantized or value.is_meta)
        return value if plain else None
    if not hasattr(type(value), "__array__"):
        return None
    with suppress(Exception):  # of another library, such as one on a GPU
        array = np.asarray(value)
        return None if array.dtype.hasobject else array
    return None


def _inside(value: Any, whole: bool) -> Iterable[tuple[str, Any]] | None:
    """The parts of ``value`` by name; None if it has none that can be looked at. ``whole``: it is
    the agent, of which a network has attributes beside its modules; of others they do not count,
    but the methods of all do."""
    if isinstance(value, nn.Module):
        own = {k: v for k, v in vars(value).items() if k not in _OWN_OF_TORCH}
        kinds = dict.fromkeys(map(type, value.modules()))
        return chain(own.items() if whole else (), *map(_methods, kinds))
    if isinstance(value, torch.Tensor) or hasattr(type(value), "__array__"):
        return None
    if isinstance(value, dict):
        return ((str(key), part) for key, part in dict.items(value))
    if isinstance(value, types.MappingProxyType):
        return [("of", dict(value))]
    if isinstance(value, (set, frozenset)):
        return ((f"{{{number}}}", part) for number, part in enumerate(value))
    if isinstance(value, _LISTS):
        return _numbered(value)
    if isinstance(value, partial):
        return [("func", value.func), *_numbered((value.args, value.keywords))]
    if isinstance(value, _GETTERS):
        return _numbered(value.__reduce__())
    if isinstance(value, (types.MethodType, types.BuiltinFunctionType)):
        return [("self", value.__self__), ("func", getattr(value, "__func__", None))]
    if isinstance(value, types.FunctionType):
        filled = [cell.cell_contents for cell in value.__closure__ or () if _is_filled(cell)]
        usual = _numbered([*filled, *(value.__defaults__ or ()), value.__kwdefaults__])
        return chain(usual, _globals(value) if _is_users(value) else ())
    return _attributes(value)


def _attributes(value: Any) -> Iterable[tuple[str, Any]] | None:
    """The attributes and slots of an object. One of Python's own classes in C holds no weights but
    for an iterator and a handle of foreign memory; of other classes in C nobody knows."""
    own = getattr(value, "__dict__", None)
    kinds = [kind for kind in type(value).__mro__ if vars(kind).get("__slots__")]
    slots = [one for kind in kinds for one in vars(kind).items()]
    members = [(k, one) for k, one in slots if isinstance(one, types.MemberDescriptorType)]
    if isinstance(own, dict) or members:
        return chain((own or {}).items(), _filled(value, members), _methods(type(value)))
    package, name = str(type(value).__module__).partition(".")[0], type(value).__name__
    foreign = package == "ctypes" or name == "PyCapsule" or isinstance(value, Iterator)
    return [] if package in sys.stdlib_module_names and not foreign else None


def _methods(kind: type) -> Iterator[tuple[str, Any]]:
    """The functions of ``kind`` and of the classes that it builds on, of those that are the
    user's."""
    for each in kind.__mro__:
        file = getattr(sys.modules.get(each.__module__), "__file__", None)
        if each is object or not is_users(each.__module__, file or ""):
            continue
        for name, one in vars(each).items():
            bound = getattr(one, "__func__", one)  # of a static or class method
            function = getattr(bound, "fget", bound)  # of a property
            if isinstance(function, types.FunctionType):
                yield name, function


def _globals(function: types.FunctionType) -> Iterator[tuple[str, Any]]:
    """What ``function``, and those that are written in it, may name of its module."""
    codes, names = [function.__code__], dict[str, None]()
    for code in codes:
        names |= dict.fromkeys(code.co_names)
        codes += [part for part in code.co_consts if isinstance(part, types.CodeType)]
    return ((name, function.__globals__[name]) for name in names if name in function.__globals__)


def _is_users(function: types.FunctionType) -> bool:
    return is_users(function.__module__ or "", function.__code__.co_filename)


@cache
def is_users(module: str, file: str) -> bool:
    """Whether code is of neither this project, torch, Python itself nor an installed package, which
    nobody edits."""
    path = PurePath(file)
    installed = _INSTALLED & {*path.parts} or path.is_relative_to(sysconfig.get_path("stdlib"))
    return module.partition(".")[0] not in _BY_VERSION and not installed


def _numbered(parts: Iterable[Any]) -> Iterator[tuple[str, Any]]:
    return ((str(number), part) for number, part in enumerate(parts))


def _filled(value: Any, members: Iterable[tuple[str, Any]]) -> Iterator[tuple[str, Any]]:
    for name, member in members:
        with suppress(AttributeError):  # not set
            yield name, member.__get__(value)


def _is_filled(cell: types.CellType) -> bool:
    try:
        return cell.cell_contents is not cell
    except ValueError:
        return False
