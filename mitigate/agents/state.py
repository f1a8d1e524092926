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
from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import date, datetime, timedelta
from datetime import time as clock_time
from decimal import Decimal
from enum import Enum
from functools import cache, partial, partialmethod
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
_PYTHONS = sys.stdlib_module_names - {"__main__"}
_DESCRIPTORS = (types.MemberDescriptorType, types.GetSetDescriptorType)
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


@dataclass(frozen=True)
class _Replacement:
    """What stands in a class in place of a method: part of the code."""

    value: Any


def has_settings(agent: Any) -> bool:
    """Return whether ``agent`` or its class defines ``settings``: what ``__getattr__`` finds in
    another object does not describe this one."""
    return "settings" in getattr(agent, "__dict__", ()) or _definer(type(agent)) is not None


def says_all(agent: Any) -> bool:
    """Return whether ``settings`` stands for all attributes: not of a subclass, which may add
    some, of the class that defines it."""
    own = "settings" in getattr(agent, "__dict__", ())
    return own or _definer(type(agent)) is type(agent)


def _definer(kind: type) -> type | None:
    return next((each for each in kind.__mro__ if "settings" in vars(each)), None)


def read_state(agent: Any, *, attributes: bool = True) -> State:
    """Return the state of ``agent``; each object is read once, at the place found first.

    Args:
        agent: any object.
        attributes: whether plain attributes count. Without them, which suits an agent that has
            ``settings()``, only hooks and replaced methods can be unreadable.
    """
    state = State()
    seen: dict[int, tuple[Any, str]] = {}
    taken = Counter[str]()
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
        for child in children:
            taken[child.place] += 1
            if taken[child.place] > 1:  # a method that the object or a subclass replaces
                child.place += f" ({taken[child.place]})"
            waiting.append(child)
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
    is_code = isinstance(value, (types.FunctionType, partial, partialmethod, types.MethodType))
    kept = isinstance(value, (*_CONTAINERS, type))
    fixed = is_code or item.required or (item.fixed and kept)
    if not is_code and not isinstance(value, (*_CONTAINERS, *_GETTERS, *_NAMED)):
        _noting(state, item, attributes)(f"{item.place}()", class_name(type(value)))
    return [
        _item(_join(item.place, name), part, fixed and _is_constant(name, part), item.required)
        for name, part in parts
    ]


def _item(place: str, part: Any, fixed: bool = False, required: bool = False) -> _Item:
    if isinstance(part, _Replacement):
        return _Item(place, part.value, fixed=True, required=True)
    return _Item(place, part, fixed, required)


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
    found = [_item(_join(item.place, k), part) for kind in kinds for k, part in _methods(kind)]
    if attributes:
        data = [pair for kind in kinds for pair in _class_data(kind)]
        found += [_Item(_join(item.place, name), part) for name, part in data]
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
    adapter = dict(module.named_children()).get("adapter")
    hooked = any(getattr(hook, "__module__", "") == _OWN_HOOKS for hook in hooks)
    if isinstance(adapter, Adapter) and not (hooked or isinstance(module, nn.Sequential)):
        state.behaviour[_join(place, "adapter")] = "not called: its hook is removed"
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
        return chain(_methods(value), _class_data(value))
    if isinstance(value, (partial, partialmethod)):
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
        kind = type(value)
        return chain(
            (own or {}).items(), _filled(value, members), _methods(kind), _class_data(kind)
        )
    package = str(type(value).__module__).partition(".")[0]
    foreign = package == "ctypes" or type(value).__name__ == "PyCapsule"
    opaque = foreign or isinstance(value, Iterator)
    return [] if package in sys.stdlib_module_names and not opaque else None


def _methods(kind: type) -> Iterator[tuple[str, Any]]:
    """The user's functions in ``kind`` and its bases, also those that were set later, and what
    else stands in place of a method."""
    for each in kind.__mro__:
        users = _is_users_class(each)
        for name, one in vars(each).items() if each is not object else ():
            bound = getattr(one, "__func__", one)  # of a static or class method
            function = getattr(bound, "fget", bound)  # of a property
            if isinstance(function, types.FunctionType):
                if _is_users(function):
                    yield name, function
                elif _of_another(each, function):
                    yield name, _Replacement(_name_of(function))
            elif (users or each.__module__.startswith("mitigate.")) and _acts(name, function):
                yield name, _Replacement(function)


def _of_another(kind: type, function: types.FunctionType) -> bool:
    """Return whether one of our classes has got a function that was written elsewhere."""
    return kind.__module__.startswith("mitigate.") and (
        function.__module__.startswith("mitigate.")
        and not function.__qualname__.startswith(f"{kind.__qualname__}.")
    )


def _acts(name: str, value: Any) -> bool:
    """Return whether ``value`` in a class is called as a method without being a function."""
    if isinstance(value, (type, nn.Module)) or (name.startswith("__") and name.endswith("__")):
        return False
    return isinstance(value, partialmethod) or callable(value)


def _class_data(kind: type) -> Iterator[tuple[str, Any]]:
    """The attributes of the user's classes among ``kind`` and its bases that are no methods."""
    for each in kind.__mro__:
        for name, one in vars(each).items() if _is_users_class(each) else ():
            hidden = (name.startswith("__") and name.endswith("__")) or name == "_abc_impl"
            function = getattr(one, "__func__", getattr(one, "fget", one))
            described = isinstance(one, (property, staticmethod, classmethod, *_DESCRIPTORS))
            if not (hidden or described or isinstance(one, Enum) or _acts(name, function)):
                yield name, one


def _is_users_class(kind: type) -> bool:
    module = sys.modules.get(kind.__module__)
    file = getattr(module, "__file__", None) or ""
    stdlib = kind.__module__.partition(".")[0] in _PYTHONS
    return not stdlib and is_users(kind.__module__, file)


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
            part = function.__globals__[name]
            yield name, part
            yield from _named(name, part, names)
        elif name in sys.modules:  # imported where it is used
            yield from _named(name, sys.modules[name], names)


def _named(place: str, module: Any, names: Iterable[str]) -> Iterator[tuple[str, Any]]:
    """What code with these ``names`` may read of one of the user's modules, or of one inside it."""
    waiting = [(place, module)]
    seen: list[Any] = []
    while waiting:
        place, module = waiting.pop()
        if any(module is one for one in seen) or not _is_users_module(module):
            continue
        seen.append(module)
        for name in names:
            if name in vars(module):
                yield f"{place}.{name}", vars(module)[name]
                waiting.append((f"{place}.{name}", vars(module)[name]))


def _is_users_module(module: Any) -> bool:
    if not isinstance(module, types.ModuleType):
        return False
    top = module.__name__.partition(".")[0]
    file = getattr(module, "__file__", None) or next(iter(getattr(module, "__path__", ())), "")
    return top not in _PYTHONS and is_users(module.__name__, file)


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
