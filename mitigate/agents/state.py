"""Read the state of an agent that may be any Python object, and list what cannot be read.

:func:`read_state` follows attributes, containers, functions and what functions name. It never runs
code of the agent, except ``settings()`` and ``fingerprint()`` where an object offers them.
"""

from __future__ import annotations

import hashlib
import logging
import operator
import random
import re
import sys
import sysconfig
import types
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import date, datetime, timedelta
from datetime import time as clock_time
from decimal import Decimal
from enum import Enum
from functools import cache, partial
from itertools import chain
from pathlib import PurePath
from typing import Any

import numpy as np
import torch
from torch import nn
from torch.nn.modules import module as torch_module

from mitigate.agents.adapter_layers import Adapter
from mitigate.core.checksums import DIGITS
from mitigate.core.observation import Observation

MOST_VALUES = 100_000  # values that are visited (heuristic: under a second)
_LISTS: tuple[Any, ...] = (list, tuple, deque, type({}.values()))
_CONTAINERS = (*_LISTS, set, frozenset, dict, types.MappingProxyType)
_GETTERS = (operator.itemgetter, operator.attrgetter, operator.methodcaller)
_SCALARS = (str, bytes, int, float, complex, type(None))
_DATA = (
    *(*_SCALARS, PurePath, np.generic, np.dtype, torch.device, torch.dtype, torch.Size),
    *(range, slice, re.Pattern, bytearray, Decimal, datetime, date, clock_time, timedelta),
)
_GENERATORS: dict[type, Callable[[Any], Any]] = {
    torch.Generator: lambda generator: generator.get_state().tolist(),
    np.random.Generator: lambda generator: generator.bit_generator.state,
    np.random.RandomState: lambda generator: generator.get_state(legacy=False),
    random.Random: lambda generator: generator.getstate(),
}
_IGNORED = (np.ufunc, logging.Logger, types.ModuleType, Observation)
_NAMED = (types.FunctionType, types.BuiltinFunctionType, np.ufunc, types.ModuleType, type)
_BY_VERSION = ("mitigate", "torch")  # packages whose code is identified by their version
_INSTALLED = frozenset(("site-packages", "dist-packages"))
_OF_TORCH = frozenset((*vars(nn.Module()), "parametrizations"))
_OF_ADAPTERS = "_statistics_before_adapters"  # set by agents/adapters.py
_OWN_HOOKS = "mitigate.agents.adapters"  # its adapters are modules: in state_dict()
_HOOKS = ("_forward_pre_hooks", "_forward_hooks")


@dataclass
class State:
    """What :func:`read_state` found, by dotted place in the agent; "" is the agent itself.

    Attributes:
        networks: every ``nn.Module``, without the modules inside it.
        arrays: hash of every tensor and array.
        functions: functions of the user's own code.
        constants: plain values that functions name or enclose.
        attributes: all other plain data, as text.
        behaviour: hooks and replaced methods that could be read, as text.
        unreadable: reasons by place.
    """

    networks: dict[str, nn.Module] = field(default_factory=dict)
    arrays: dict[str, str] = field(default_factory=dict)
    functions: dict[str, types.FunctionType] = field(default_factory=dict)
    constants: dict[str, str] = field(default_factory=dict)
    attributes: dict[str, str] = field(default_factory=dict)
    behaviour: dict[str, str] = field(default_factory=dict)
    unreadable: dict[str, str] = field(default_factory=dict)


@dataclass
class _Item:
    place: str
    value: Any
    fixed: bool = False  # belongs to code, not to the changing state of an object
    required: bool = False  # must be readable even if the agent has settings()


def read_state(agent: Any, *, attributes: bool = True) -> State:
    """Return the state of ``agent``; each object is read once, at the place found first.

    Args:
        agent: any object.
        attributes: whether plain attributes count. Without them, which suits an agent that has
            ``settings()``, only hooks and replaced methods can be unreadable.
    """
    state = State()
    seen: dict[int, tuple[Any, str]] = {}
    waiting = deque([_Item("", agent)])
    while waiting:
        item = waiting.popleft()
        value = item.value
        note = _noting(state, item, attributes)
        text = plain_text(value)
        if text is not None:
            note(item.place, text)
            continue
        if isinstance(value, _NAMED):
            note(f"{item.place}()", _name_of(value))
        if id(value) in seen:
            if attributes and not callable(value):
                note(item.place, f"same object as {seen[id(value)][1]}")
            continue
        seen[id(value)] = value, item.place  # keeps the object alive, so that its id stays unique
        if len(seen) > MOST_VALUES:
            state.unreadable[""] = f"it holds more than {MOST_VALUES:,} values"
            break
        children = _visit(state, item, whole=value is agent, attributes=attributes)
        if children is None:
            if attributes or item.required:
                state.unreadable[item.place] = _why(value)
            continue
        waiting.extend(children)
    return state


def _noting(state: State, item: _Item, attributes: bool) -> Callable[[str, str], None]:
    """Return what notes a text of ``item``, where it counts."""
    lines = state.constants if item.fixed else state.attributes

    def note(place: str, text: str) -> None:
        if attributes or item.fixed:
            lines[place] = text

    return note


def _name_of(value: Any) -> str:
    """The name of a class, function or module."""
    if isinstance(value, type):
        return class_name(value)
    name = getattr(value, "__qualname__", getattr(value, "__name__", ""))
    users = isinstance(value, types.FunctionType) and _is_users(value)
    return name if users else f"{getattr(value, '__module__', None) or ''}.{name}"


def _visit(state: State, item: _Item, *, whole: bool, attributes: bool) -> list[_Item] | None:
    """Note what ``item`` is, and return its parts; None if it cannot be read."""
    value = item.value
    if isinstance(value, _IGNORED):
        return []
    if isinstance(value, types.FunctionType) and _is_users(value):
        state.functions[item.place] = value
    if isinstance(value, nn.Module):
        return _visit_network(state, item, whole=whole, attributes=attributes)
    if isinstance(value, torch.Tensor) or hasattr(type(value), "__array__"):
        sha = array_sha(value)
        if sha and item.fixed:
            state.constants[item.place] = sha
        elif sha:
            state.arrays[item.place] = sha
        return [] if sha else None
    parts = _parts(value)
    if parts is None:
        return None
    is_code = isinstance(value, (types.FunctionType, partial, types.MethodType))
    fixed = is_code or item.required or (item.fixed and isinstance(value, _CONTAINERS))
    if not is_code and not isinstance(value, (*_CONTAINERS, *_GETTERS, *_NAMED)):
        _noting(state, item, attributes)(f"{item.place}()", class_name(type(value)))
    return [
        _Item(_join(item.place, name), part, fixed and _is_constant(name, part), item.required)
        for name, part in parts
    ]


def _is_constant(name: str, part: Any) -> bool:
    """Return False for a container in a global variable, which code may fill as it runs."""
    return name.isdigit() or name in ("self", "func") or not isinstance(part, _CONTAINERS)


def _visit_network(
    state: State, item: _Item, *, whole: bool, attributes: bool
) -> list[_Item] | None:
    """Note a network, and return its methods, hooks and whatever state_dict() does not hold."""
    net = item.value
    state.networks[item.place] = net
    kinds = dict.fromkeys(map(type, net.modules()))
    found = [_Item(_join(item.place, k), part) for kind in kinds for k, part in _methods(kind)]
    if any(getattr(torch_module, f"_global{name}", None) for name in _HOOKS):
        place = _join(item.place, "global hooks")
        state.unreadable[place] = "a forward hook that is registered for all modules"
    for name, module in net.named_modules():
        place = _join(item.place, name)
        found += _hidden(state, place, module)
        if attributes or (whole and not name):
            found += [_Item(_join(place, k), v) for k, v in plain_attributes(module).items()]
    for name, value in net.state_dict().items():
        if not isinstance(value, torch.Tensor):  # such as packed weights of a quantised layer
            place = _join(item.place, f"state {name}")
            found.append(_Item(place, value, fixed=True, required=True))
    return found


def plain_attributes(module: nn.Module) -> dict[str, Any]:
    """Return the attributes of ``module`` that neither torch nor the adapters have put there."""
    ours = ("hook",) if isinstance(module, Adapter) else ()
    left_out = _OF_TORCH | {_OF_ADAPTERS, *ours}
    return {name: value for name, value in vars(module).items() if name not in left_out}


def _hidden(state: State, place: str, module: nn.Module) -> Iterator[_Item]:
    """Note hooks, and yield readable ones and replaced methods such as ``forward``.

    A hook is readable if it is one of this project's adapters, an object with a ``fingerprint()``
    method that returns plain data, or an object of torch such as a weight norm.
    """
    hooks = [hook for kind in _HOOKS for hook in (getattr(module, kind, None) or {}).values()]
    for number, hook in enumerate(hooks):
        name = _join(place, f"forward hook {number}")
        origin = str(getattr(hook, "__module__", type(hook).__module__))
        describe = getattr(hook, "fingerprint", None)
        if origin == _OWN_HOOKS:
            continue
        if callable(describe):
            state.behaviour[name] = f"{type(hook).__qualname__} {describe()!r}"
        elif origin.startswith("torch.") and hasattr(hook, "__dict__") and vars(hook):
            yield _Item(name, hook, fixed=True, required=True)
        else:
            kind = getattr(hook, "__qualname__", type(hook).__qualname__)
            state.unreadable[name] = f"a forward hook, {kind}"
    for name, value in vars(module).items():
        if callable(value) and callable(getattr(type(module), name, None)):
            yield _Item(_join(place, name), value, fixed=True, required=True)
    if type(module).__module__.startswith("torch.jit"):
        state.unreadable[place] = "a TorchScript module, whose program cannot be read"


def _parts(value: Any) -> Iterable[tuple[str, Any]] | None:
    """The parts of ``value`` by name; None if nothing can be known of them."""
    if isinstance(value, dict):
        return ((str(key), part) for key, part in dict.items(value))
    if isinstance(value, types.MappingProxyType):
        return [("of", dict(value))]
    if isinstance(value, (set, frozenset)):
        return ((f"{{{number}}}", part) for number, part in enumerate(value))  # in any order
    if isinstance(value, _LISTS):
        return _numbered(value)
    if isinstance(value, type):
        return _methods(value)
    if isinstance(value, partial):
        return [("func", value.func), *_numbered((value.args, value.keywords))]
    if isinstance(value, _GETTERS):
        return _numbered(value.__reduce__())
    if isinstance(value, (types.MethodType, types.BuiltinFunctionType)):
        return [("self", value.__self__), ("func", getattr(value, "__func__", None))]
    if isinstance(value, types.FunctionType):
        enclosed = [cell.cell_contents for cell in value.__closure__ or () if _is_filled(cell)]
        usual = _numbered([*enclosed, *(value.__defaults__ or ()), value.__kwdefaults__])
        return chain(usual, _globals(value))
    return _attributes(value)


def _attributes(value: Any) -> Iterable[tuple[str, Any]] | None:
    """The attributes and slots of an object. Objects of the standard library's C code hold no
    weights, except iterators and foreign memory; of other C code nothing is known."""
    own = getattr(value, "__dict__", None)
    kinds = [kind for kind in type(value).__mro__ if vars(kind).get("__slots__")]
    slots = [one for kind in kinds for one in vars(kind).items()]
    members = [(k, one) for k, one in slots if isinstance(one, types.MemberDescriptorType)]
    if isinstance(own, dict) or members:
        return chain((own or {}).items(), _filled(value, members), _methods(type(value)))
    package = str(type(value).__module__).partition(".")[0]
    foreign = package == "ctypes" or type(value).__name__ == "PyCapsule"
    opaque = foreign or isinstance(value, Iterator)
    return [] if package in sys.stdlib_module_names and not opaque else None


def _methods(kind: type) -> Iterator[tuple[str, Any]]:
    """The user's functions in ``kind`` and its bases, also those that were set later."""
    for each in kind.__mro__:
        for name, one in vars(each).items() if each is not object else ():
            bound = getattr(one, "__func__", one)  # of a static or class method
            function = getattr(bound, "fget", bound)  # of a property
            if isinstance(function, types.FunctionType) and _is_users(function):
                yield name, function


def _globals(function: types.FunctionType) -> Iterator[tuple[str, Any]]:
    """What the user's ``function``, and functions written inside it, may name of its module."""
    if not _is_users(function):
        return
    codes = [function.__code__]
    names = dict[str, None]()
    for code in codes:
        names |= dict.fromkeys(code.co_names)
        codes += [part for part in code.co_consts if isinstance(part, types.CodeType)]
    for name in names:
        if name in function.__globals__:
            yield name, function.__globals__[name]


def _is_users(function: types.FunctionType) -> bool:
    return is_users(function.__module__ or "", function.__code__.co_filename)


@cache
def is_users(module: str, file: str) -> bool:
    """Return whether code belongs to the user: not to this project, torch, Python or an installed
    package, which are identified by their versions."""
    path = PurePath(file)
    installed = _INSTALLED & {*path.parts} or path.is_relative_to(sysconfig.get_path("stdlib"))
    return module.partition(".")[0] not in _BY_VERSION and not installed


def class_name(kind: type) -> str:
    """Return the name of a class; with its module only where the source does not count anyway."""
    module = sys.modules.get(kind.__module__)
    users = is_users(kind.__module__, getattr(module, "__file__", None) or "")
    return kind.__qualname__ if users else f"{kind.__module__}.{kind.__qualname__}"


def array_sha(array: Any) -> str:
    """Return the hash of an array's or tensor's type, shape and bytes; "" if it has no readable
    bytes (sparse, on the meta device, of objects)."""
    kind = array.dtype if isinstance(array, torch.Tensor) else ""
    if isinstance(array, torch.Tensor):
        if array.layout != torch.strided or array.is_meta:
            return ""
        array = array.dequantize() if array.is_quantized else array
        array = array.detach().cpu().contiguous()
        text = f"{kind} {tuple(array.shape)}"
        array = array.reshape(-1).view(torch.uint8).numpy()
    else:
        try:
            array = np.asarray(array)
        except Exception:  # of another library, such as one on a GPU
            return ""
        text = f"{array.dtype} {tuple(array.shape)}"
    if array.dtype.hasobject:
        return ""
    return hashlib.sha256(text.encode() + array.tobytes()).hexdigest()[:DIGITS]


def plain_text(value: Any) -> str | None:
    """Plain data, or a flat container of it, as text that is equal in every process; else None."""
    if isinstance(value, Enum):
        return f"{type(value).__qualname__}.{value.name}"
    for kind, generator_state in _GENERATORS.items():
        if isinstance(value, kind):
            return str(generator_state(value))
    if isinstance(value, _DATA):
        return repr(value)
    if type(value) in (list, tuple, deque, set, frozenset, dict):
        pairs = value.items() if isinstance(value, dict) else [(0, part) for part in value]
        if all(type(part) in _SCALARS for pair in pairs for part in pair):
            unordered = isinstance(value, (set, frozenset))
            return repr(sorted(map(repr, value)) if unordered else value)
    return None


def _why(value: Any) -> str:
    if isinstance(value, (torch.Tensor, np.ndarray)):
        return "an array without readable bytes"
    return f"a {class_name(type(value))}, whose state cannot be read"


def _join(*names: str) -> str:
    return ".".join(name for name in names if name)


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
