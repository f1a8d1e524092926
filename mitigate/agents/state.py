"""Read all state that determines how an object behaves, and list state that cannot be read.

:func:`read_state` follows attributes, containers, functions and the names that functions use. A
value counts as read only if Python exposes all of it: plain data, arrays, attributes without hidden
C memory, or what pickle stores of types of Python, numpy or torch. Everything else is unreadable.
No code of the agent runs, except a hook's ``fingerprint()``.
"""

from __future__ import annotations

import copyreg
import functools
import hashlib
import logging
import pickle
import sys
import sysconfig
import threading
import types
from collections import deque
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache
from pathlib import PurePath
from typing import Any

import numpy as np
import torch
from torch import nn
from torch.nn.modules import module as torch_module

from mitigate.agents.adapter_layers import Adapter
from mitigate.core.checksums import DIGITS
from mitigate.core.contracts import read
from mitigate.core.observation import Observation

MOST_VALUES = 100_000  # maximum number of visited values (heuristic: takes under a second)
_SCALARS: tuple[Any, ...] = (str, bytes, int, float, complex)
_CONTENT: tuple[Any, ...] = (dict, list, tuple, set, frozenset, *_SCALARS)  # and their subclasses
# classes whose attributes are caches
_PATHS = (type(PurePath()), *type(PurePath()).__subclasses__())
_TEXTS = (*_SCALARS, bool, type(None), type(...), *_PATHS, torch.dtype, torch.device)
_IGNORED = (  # types that cannot change an action
    *(type(threading.Lock()), type(threading.RLock()), logging.Logger, Observation),
)
_ARRAYS = (np.ndarray, np.memmap, torch.Tensor, nn.Parameter)
_NAMED = (types.FunctionType, types.ModuleType, type, types.BuiltinFunctionType)
# members that determine the behaviour of the whole object
_MEMBERS: dict[type, tuple[str, ...]] = {
    **dict.fromkeys((staticmethod, classmethod), ("__func__",)),
    property: ("fget", "fset", "fdel"),
    types.MethodType: ("__self__", "__func__"),
    types.BuiltinFunctionType: ("__self__",),
}
_CODE = (*_NAMED, types.MethodType, functools.partial, functools.partialmethod)
_DESCRIPTORS = (types.MemberDescriptorType, types.GetSetDescriptorType)
_PYTHONS = sys.stdlib_module_names - {"__main__"}
_READABLE = _PYTHONS | {"numpy", "torch", "mitigate"}  # packages whose pickling is complete
_BY_VERSION = ("mitigate", "torch")  # packages whose code is identified by their version
_INSTALLED = frozenset(("site-packages", "dist-packages"))
_ANSWERING = {  # methods with which user code could replace an object's state
    *("__reduce_ex__", "__reduce__", "__getstate__", "__getnewargs_ex__", "__getnewargs__"),
    *("__getattr__", "__getattribute__", "__iter__", "items"),
}
# attributes that torch sets (the last two for recurrent layers), and those of adapters.py
_LEFT_OUT = {
    *(*vars(nn.Module()), "parametrizations", "_flat_weights", "_flat_weight_refs"),
    "_statistics_before_adapters",
}
_RUNNING = {"hook", "judged"}  # attributes of an adapter: its hook handle and its last output
_OWN_HOOKS = "mitigate.agents.adapters"  # adapters are modules, so state_dict() contains them

Parts = Iterable[tuple[str, Any]]


@dataclass
class State:
    """The result of :func:`read_state`, keyed by place, which is a dotted path ("" is the agent).

    Attributes:
        networks: every ``nn.Module`` by place, without the modules inside it.
        arrays: hashes of tensors and arrays by place, except those that are attributes.
        functions: code of the user's functions.
        lines: all other state, as lines ``place = text``. Places in classes begin with
            "class "; they do not depend on the object.
        unreadable: the reason for each unreadable place.
    """

    networks: list[tuple[str, nn.Module]] = field(default_factory=list)
    arrays: list[tuple[str, str]] = field(default_factory=list)
    functions: list[types.CodeType] = field(default_factory=list)
    lines: list[str] = field(default_factory=list)
    unreadable: dict[str, str] = field(default_factory=dict)


def read_state(agent: Any, *, attributes: bool = True, like: nn.Module | None = None) -> State:
    """Return the state of ``agent``; each object is read once, at its first place.

    Args:
        agent: any object.
        attributes: whether plain attributes are included. If not, only code and the objects it
            refers to are included.
        like: an agent of the same kind. Attributes of modules that this agent lacks are excluded.
    """
    return _Reader(agent, attributes, like).read()


class _Reader:
    """Breadth-first search through the objects of one agent."""

    def __init__(self, agent: Any, attributes: bool, like: nn.Module | None) -> None:
        self.agent = agent
        self.usual = dict(like.named_modules()) if like is not None else {}
        self.state = State()
        self.seen: dict[int, tuple[Any, str, bool]] = {}
        self.classes: set[type] = set()
        self.waiting: deque[tuple[str, Any, bool]] = deque([("", agent, attributes)])

    def read(self) -> State:
        """Visit every object that can be reached."""
        while self.waiting:
            self.visit(*self.waiting.popleft())
            if len(self.seen) > MOST_VALUES:
                self.state.unreadable[""] = f"it holds more than {MOST_VALUES:,} values"
                break
        return self.state

    def note(self, place: str, text: str, counts: bool = True) -> None:
        if counts:
            self.state.lines.append(f"{place} = {text}")

    def add(self, place: str, parts: Parts, counts: bool = True) -> None:
        """Add the ``parts`` of the object at ``place`` to the queue."""
        self.waiting.extend((_join(place, name), part, counts) for name, part in parts)

    def visit(self, place: str, value: Any, counts: bool) -> None:
        """Record ``value`` and add its parts to the queue."""
        counts = counts or isinstance(value, _CODE)
        text = plain_text(value)
        if isinstance(value, _IGNORED):
            return None
        if text is not None:
            return self.note(place, text, counts)
        if isinstance(value, _NAMED):
            self.note(f"{place}()", _name_of(value))
        _, first, counted = self.seen.get(id(value), (None, "", False))
        if id(value) in self.seen and (counted or not counts or value is self.agent):
            return self.note(place, f"same object as {first}", counts and counted)
        # keeps a reference, so that the id stays unique
        self.seen[id(value)] = value, place, counts
        if isinstance(value, nn.Module):
            return self.visit_network(place, value, counts)
        parts = self.parts(place, value, counts)
        if parts is None and counts:
            self.state.unreadable[place] = _why(value)
        self.add(place, parts or (), counts)

    def parts(self, place: str, value: Any, counts: bool) -> Parts | None:
        """Return the parts of ``value`` by name; None if not all of it can be read."""
        kind = type(value)
        if kind in _ARRAYS:
            sha = array_sha(value)
            self.note(place, sha, counts)
            self.state.arrays += [(place, sha)] if sha and not counts else []
            return [*_attributes(value)] if sha else None
        if isinstance(value, types.FunctionType):
            return self.function_parts(place, value)
        if isinstance(value, types.ModuleType):
            public = [(k, part) for k, part in vars(value).items() if not _is_dunder(k)]
            return public if _is_users_module(value) else []
        if isinstance(value, type):
            return self.add_class(value)
        if kind in _MEMBERS:
            return [(name, read(value, name)) for name in _MEMBERS[kind]]
        if isinstance(value, functools._lru_cache_wrapper):
            return [*vars(value).items(), ("cache", value.cache_parameters())]
        base = next(each for each in kind.__mro__ if each in _CONTENT or each is object)
        hidden = _hides_memory(kind, base)
        content = _pickled(value) if hidden else self.content(base, place, value, counts)
        if content is None:
            return None
        self.add_class(kind)
        if kind is not base:
            self.note(f"{place}()", class_name(kind), counts)
        return [*content, *_attributes(value)]

    def content(self, base: Any, place: str, value: Any, counts: bool) -> Parts | None:
        """Return the content of ``value`` without attributes, by its ``base`` in ``_CONTENT``."""
        if base is object:
            return []
        if base is dict:
            keys, parts = [*dict.keys(value)], [*dict.values(value)]
            names = [key if type(key) is str else f"[{n}]" for n, key in enumerate(keys)]
            return [("keys()", keys), *zip(names, parts, strict=True)]
        if base in (list, tuple):
            return _numbered(base.__iter__(value))
        if base in (set, frozenset):
            self.add(place, [("{}", part) for part in base.__iter__(value)], False)
            return None if counts else []  # the order of a set differs between processes
        return [("", base.__repr__(value))]

    def function_parts(self, place: str, value: types.FunctionType) -> Parts:
        """Record the code of a user's function; return its closure, defaults and named objects."""
        users = _is_users(value)
        if users:
            self.state.functions.append(value.__code__)
        # the same source line may contain several lambdas
        if users and value.__name__ == "<lambda>":
            self.note(place, bytecode(value.__code__))
        cells = zip(value.__code__.co_freevars, value.__closure__ or (), strict=True)
        enclosed = [(name, cell.cell_contents) for name, cell in cells if _is_filled(cell)]
        usual = [("defaults", value.__defaults__), ("keywords", value.__kwdefaults__)]
        usual = [(name, part) for name, part in usual if part]
        return [*enclosed, *usual, *vars(value).items(), *(_globals(value) if users else ())]

    def add_class(self, kind: type) -> Parts:
        """Visit the members of ``kind`` and of its bases."""
        for each in kind.__mro__:
            if each not in self.classes and each is not object:
                self.classes.add(each)
                self.add(f"class {class_name(each)}", _members(each))
        return []

    def visit_network(self, place: str, net: nn.Module, counts: bool) -> None:
        """Record a network; add its classes, its hooks and all state outside its state dict."""
        self.state.networks.append((place, net))
        if torch_module._global_forward_hooks or torch_module._global_forward_pre_hooks:
            hooks = _join(place, "global hooks")
            self.state.unreadable[hooks] = "a hook that is registered for all modules"
        for kind in dict.fromkeys(map(type, net.modules())):
            self.add_class(kind)
        saved = net.state_dict()
        for name, module in net.named_modules():
            inner = _join(place, name)
            self.seen.setdefault(id(module), (module, inner, counts))
            self.note(f"{inner}()", class_name(type(module)))
            if type(module).__module__.startswith("torch.jit"):
                self.state.unreadable[inner] = "a TorchScript module, whose program cannot be read"
                continue
            self.visit_hooks(inner, module)
            buffers = module._buffers.items()
            self.add(inner, [(k, one) for k, one in buffers if _join(name, k) not in saved])
            left_out = _LEFT_OUT | (_RUNNING if isinstance(module, Adapter) else set())
            usual = self.usual.get(name)
            if type(usual) is type(module):
                known = {*vars(usual), *dir(type(module))}
                left_out |= {*vars(module)} - known | {*read(module, "run_state", default=())}
            whole = counts or type(module).__module__.startswith("torch.")
            for k, part in vars(module).items():
                replaces = callable(part) and callable(read(type(module), k))
                adapter = k == "settings" and ".adapter" in f".{name}"
                if k not in left_out:
                    self.add(inner, [(k, part)], whole or replaces or adapter)
        packed = [(k, one) for k, one in saved.items() if not isinstance(one, torch.Tensor)]
        # for example packed weights of a quantised layer
        self.add(_join(place, "state_dict()"), packed)

    def visit_hooks(self, place: str, module: nn.Module) -> None:
        """Record the hooks of a module.

        A hook is readable if it belongs to an adapter of this project, has a method
        ``fingerprint()`` that returns plain data, or is an object of torch such as a weight norm.
        """
        hooks = [*module._forward_pre_hooks.values(), *module._forward_hooks.values()]
        origins = [str(read(hook, "__module__", default=type(hook).__module__)) for hook in hooks]
        for number, (hook, origin) in enumerate(zip(hooks, origins, strict=True)):
            name = _join(place, f"forward hook {number}")
            describe = read(hook, "fingerprint")
            kind = type(hook).__qualname__
            if callable(describe):
                self.note(name, f"{kind} {describe()!r}")
            elif origin.startswith("torch.") and [*_attributes(hook)]:
                self.add(name, [("", hook)])
            elif origin != _OWN_HOOKS:
                kind = read(hook, "__qualname__", default=kind)
                self.state.unreadable[name] = f"a forward hook, {kind}"
        adapter = isinstance(module._modules.get("adapter"), Adapter)
        if adapter and not (_OWN_HOOKS in origins or isinstance(module, nn.Sequential)):
            self.note(_join(place, "adapter"), "not called: its hook is removed")


def _members(kind: type) -> Parts:
    """Yield the members of a user's class; for other classes, yield only replaced members."""
    users = _is_users_class(kind)
    ours = kind.__module__.startswith(("mitigate.", "torch.")) and kind is not nn.Module
    for name, one in vars(kind).items():
        function = read(one, "__func__", "fget", default=one)
        method = isinstance(function, types.FunctionType)
        data = name == "_abc_impl" or isinstance(one, _DESCRIPTORS)
        # such members are generated by a dataclass
        data |= name == "__repr__" and method and not _is_users(function)
        if data or (_is_dunder(name) and not callable(function)):
            continue
        moved = method and function.__qualname__ != f"{kind.__qualname__}.{name}"
        called = callable(function) or isinstance(one, functools.partialmethod)
        called = called and not isinstance(one, (type, nn.Module))
        if users or (method and _is_users(function)) or (ours and (moved or called and not method)):
            yield name, one


def _globals(function: types.FunctionType) -> Parts:
    """Yield the global variables that the user's ``function`` and its inner functions may use.

    Attributes of the user's modules are followed.
    """
    codes = [function.__code__]
    names = dict[str, None]()
    for code in codes:
        names |= dict.fromkeys(code.co_names)
        names |= dict.fromkeys(one for one in code.co_consts if isinstance(one, str))  # getattr
        codes += [part for part in code.co_consts if isinstance(part, types.CodeType)]
    scope = function.__globals__
    waiting = [(name, scope.get(name, sys.modules.get(name))) for name in names]
    waiting = [(n, part) for n, part in waiting if n in scope or _is_users_module(part)]
    entered: list[Any] = []
    for place, part in waiting:
        if not _is_users_module(part):
            yield place, part
        elif not any(part is one for one in entered):
            entered.append(part)
            here = [name for name in names if name in vars(part)]
            waiting += [(f"{place}.{name}", vars(part)[name]) for name in here]


def _hides_memory(kind: type, base: type) -> bool:
    """Return whether objects of ``kind`` hold C memory beyond ``base`` and Python attributes.

    This repeats the check of ``object.__reduce_ex__`` without calling the user's code.
    """
    slots: Any = copyreg._slotnames(kind)  # type: ignore[attr-defined]
    words = len(slots) + (kind.__weakrefoffset__ > 0)
    words += kind.__dictoffset__ > 0 or (kind.__dictoffset__ < 0 < kind.__itemsize__)
    return kind.__basicsize__ > base.__basicsize__ + words * tuple.__itemsize__


def _pickled(value: Any) -> Parts | None:
    """Return what pickle would store of an object with C memory.

    The result is None if it cannot be pickled, or if this would run code of the user or of an
    unknown package.
    """
    if isinstance(value, Iterator):  # this state changes with every use
        return None
    for each in type(value).__mro__:
        users = _is_users_class(each)
        readable = each.__module__.partition(".")[0] in _READABLE
        if not (users or readable) or (users and _ANSWERING & {*vars(each)}):
            return None
    try:
        reduce = copyreg.dispatch_table.get(type(value))
        reduced = reduce(value) if reduce else value.__reduce_ex__(2)
        if not isinstance(reduced, str):
            return _numbered(list(part) if isinstance(part, Iterator) else part for part in reduced)
        where = pickle.whichmodule(value, reduced)  # type: ignore[attr-defined]
        return [("", f"{where}.{reduced}")] if read(sys.modules[where], reduced) is value else None
    except Exception:  # types that cannot be pickled may raise any error
        return None


def _attributes(value: Any) -> Parts:
    """Yield the attributes and slots of an object."""
    with suppress(AttributeError):
        yield from object.__getattribute__(value, "__dict__").items()
    for kind in type(value).__mro__:
        for name, one in vars(kind).items() if "__slots__" in vars(kind) else ():
            if isinstance(one, types.MemberDescriptorType):
                with suppress(AttributeError):  # the slot has no value yet
                    yield name, one.__get__(value)


def _is_dunder(name: str) -> bool:
    return name.startswith("__") and name.endswith("__")


def _name_of(value: Any) -> str:
    """Return the name of a class, function or module."""
    if isinstance(value, type):
        return class_name(value)
    name = read(value, "__qualname__", "__name__")
    users = isinstance(value, types.FunctionType) and _is_users(value)
    return name if users else f"{read(value, '__module__') or ''}.{name}"


def _is_users_class(kind: type) -> bool:
    return kind.__module__.partition(".")[0] not in _PYTHONS and _is_users_code(kind)


def _is_users_code(kind: type) -> bool:
    module = sys.modules.get(kind.__module__)
    return is_users(kind.__module__, read(module, "__file__") or "")


def _is_users_module(module: Any) -> bool:
    if not isinstance(module, types.ModuleType) or module.__name__.partition(".")[0] in _PYTHONS:
        return False
    file = read(module, "__file__") or next(iter(read(module, "__path__", default=())), "")
    return is_users(module.__name__, file)


def _is_users(function: types.FunctionType) -> bool:
    return is_users(function.__module__ or "", function.__code__.co_filename)


@cache
def is_users(module: str, file: str) -> bool:
    """Return whether a module is the user's code.

    This project, torch, Python and installed packages are identified by their versions instead.
    """
    path = PurePath(file)
    installed = _INSTALLED & {*path.parts} or path.is_relative_to(sysconfig.get_path("stdlib"))
    return module.partition(".")[0] not in _BY_VERSION and not installed


def class_name(kind: type) -> str:
    """Return the name of a class, with its module unless the class is the user's."""
    return kind.__qualname__ if _is_users_code(kind) else f"{kind.__module__}.{kind.__qualname__}"


def array_sha(array: np.ndarray | torch.Tensor) -> str:
    """Return the hash of an array's or tensor's type, shape and bytes.

    The result is "" if there are no readable bytes: sparse, on the meta device, or an array of
    objects.
    """
    kind: Any = array.dtype
    if isinstance(array, torch.Tensor):
        if array.layout != torch.strided or array.is_meta:
            return ""
        shape = tuple(array.shape)
        array = array.dequantize() if array.is_quantized else array
        array = array.detach().cpu().contiguous().reshape(-1).view(torch.uint8).numpy()
    elif array.dtype.hasobject:
        return ""
    else:
        shape = array.shape
    return hashlib.sha256(f"{kind} {shape}".encode() + array.tobytes()).hexdigest()[:DIGITS]


def plain_text(value: Any) -> str | None:
    """Return plain data, or a flat container of plain data, as text that is equal in every
    process."""
    kind = type(value)
    if kind in _TEXTS:
        return repr(value)
    if kind in (set, frozenset) and all(type(part) in _TEXTS for part in value):
        return f"{kind.__name__} {sorted(map(repr, value))}"
    flat = [*value.keys(), *value.values()] if kind is dict else value
    if kind in (dict, list, tuple) and all(type(part) in _TEXTS for part in flat):
        return repr(value)
    return None


def bytecode(code: types.CodeType) -> str:
    """Return the bytecode, names and constants of ``code`` as text."""
    return f"{code.co_name} {code.co_code.hex()} {code.co_names} {_constants(code)}"


def _constants(code: types.CodeType) -> list[str]:
    inner = [part for part in code.co_consts if isinstance(part, types.CodeType)]
    plain = [plain_text(p) or repr(p) for p in code.co_consts if not isinstance(p, types.CodeType)]
    return plain + [text for part in inner for text in (part.co_code.hex(), *_constants(part))]


def _why(value: Any) -> str:
    if isinstance(value, (torch.Tensor, np.ndarray)):
        return "an array without readable bytes"
    return f"a {class_name(type(value))}, whose state cannot be read"


def _join(*names: str) -> str:
    return ".".join(name for name in names if name)


def _numbered(parts: Iterable[Any]) -> Parts:
    return [(str(number), part) for number, part in enumerate(parts)]


def _is_filled(cell: types.CellType) -> bool:
    try:
        return cell.cell_contents is not cell
    except ValueError:
        return False
