"""Compute the fingerprint of an agent: a content hash of everything that determines its behaviour.

The fingerprint covers the kind of the agent, ``settings()``, weights, layers, sensors, and the
user's source files. Result rows hold the fingerprint in addition to a display name. Tables treat
agents with different fingerprints as different agents, and rows are reused only if the fingerprint
is equal. Hooks, TorchScript and other state that cannot be read (:attr:`Contents.unreadable`) need
``version=``.
"""

from __future__ import annotations

import hashlib
import inspect
import json
import types
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields, is_dataclass
from pathlib import PurePath
from typing import Any

import numpy as np
import torch
from torch import nn
from torch.nn.modules import module as torch_module

from mitigate.agents.networks import networks
from mitigate.agents.source import is_users, methods, named_values, source_files
from mitigate.core.checkpoint import weights_sha
from mitigate.core.checksums import DIGITS
from mitigate.core.contracts import read
from mitigate.core.observation import Observation, Sensor

# Shipped classes store a fixed name in this attribute, so moving a module changes no fingerprint.
KIND = "fingerprint_kind"
DEEPEST = 50  # maximum nesting depth of attributes (heuristic); deeper nesting is probably a cycle
# record hooks of this module by name only: state_dict() already contains the adapters they call
_OWN_HOOKS = "mitigate.agents.adapters"
# The fingerprint skips the attributes that torch itself adds to modules.
# It also skips the hook handle of an adapter and the last logits of a gate (``judged``).
_LEFT_OUT = {*vars(nn.Module()), "_flat_weights", "_flat_weight_refs", "hook", "judged"}
_LEFT_OUT |= {"_statistics_before_adapters", "settings"}
_PLAIN = (str, int, float, bool, type(None))
_SPACES = ("gymnasium.spaces.space.Space", "gym.spaces.space.Space")
# everything in a function's bytecode that affects its behaviour; the other attributes are names and
# line numbers
_BYTECODE = [
    *("co_code", "co_consts", "co_names", "co_varnames", "co_freevars", "co_cellvars"),
    *("co_argcount", "co_posonlyargcount", "co_kwonlyargcount", "co_flags"),
    "co_exceptiontable",  # from Python 3.11
]
_SOURCE = (type, types.FunctionType, property, types.MemberDescriptorType)  # in source files


@dataclass(frozen=True)
class Contents:
    """The data that a fingerprint is computed from, and the state that could not be read."""

    parts: Mapping[str, Any]  # plain data by name
    unreadable: Mapping[str, str]  # the reason for each unreadable attribute, by its dotted path

    def explain(self) -> str:
        """Return the first unreadable attributes and their reasons as text."""
        places = [f"{place or 'the agent'} ({why})" for place, why in self.unreadable.items()]
        more = f" and {len(places) - 3} more" if len(places) > 3 else ""
        return "; ".join(places[:3]) + more


def fingerprint(
    agent: Any, sensors: Mapping[str, Sensor], front: str = "none", version: str | None = None
) -> str:
    """Return the fingerprint of ``agent`` with the ``sensors`` of a world.

    Args:
        agent: any object.
        sensors: the sensors of the world.
        front: fingerprints of the guards between the world and the agent.
        version: a string, set by the user, that identifies state that cannot be read.
    """
    return hash_of(contents(agent, version).parts, sensors, front)


def contents(agent: Any, version: str | None = None) -> Contents:
    """Return everything that determines the behaviour of ``agent``.

    For a shipped agent, this includes the attributes whose values differ from those of a new agent
    with the same settings. For an agent whose ``settings()`` is missing or inherited, this
    includes all its attributes.
    """
    shipped = KIND in vars(type(agent))
    settings = agent.settings if _definer(agent) is not None else {}
    nets = networks(agent)
    attributes = not (shipped or says_all(agent))
    entries, unreadable = _entries(agent, nets, attributes)
    if shipped:
        entries = _changes(agent, nets)
    modules = [module for net in nets.values() for module in net.modules()]
    code = code_of(type(agent), *map(type, modules))
    unreadable |= code.unreadable
    shas = {place: weights_sha(net) for place, net in nets.items()}
    arrays = {name: array_sha(part) for name, part in attributes_of(agent)}
    weights = shas or {name: sha for name, sha in arrays.items() if sha}
    optional = {
        "state": entries,
        **code.parts,
        "version": version,
        "unreadable": sorted(unreadable.items()) if version is None else [],
    }
    parts = {
        "class": vars(type(agent)).get(KIND, class_name(type(agent))),
        "weights": shas[""] if [*shas] == [""] else sorted(weights.items()) or "",
        "settings": settings() if callable(settings) else settings,
        **{name: part for name, part in optional.items() if part},
    }
    return Contents(parts, unreadable if version is None else {})


def says_all(agent: Any) -> bool:
    """Return whether ``settings`` describes all attributes.

    An inherited ``settings`` does not describe all attributes, because a subclass may add
    attributes.
    """
    return _definer(agent) in (agent, type(agent))


def _definer(agent: Any) -> Any:
    """Return the object or class that defines ``settings``, or None.

    Settings that come from ``__getattr__`` are ignored, because they belong to a wrapped object.
    """
    candidates = (agent, *type(agent).__mro__)
    definers = (one for one in candidates if "settings" in read(one, "__dict__", default=()))
    return next(definers, None)


def _changes(agent: Any, nets: Mapping[str, nn.Module]) -> dict[str, Any]:
    """Return the differences in attributes and layers between a shipped agent and a new agent.

    Weights, and the attributes that ``run_state`` names, are excluded.
    """
    with torch.random.fork_rng(devices=[]):
        new = type(agent)(**agent.settings())
    usual, _ = _entries(new, {"": new}, True)
    entries, _ = _entries(agent, nets, True)
    layers = {place.removesuffix("()") for place in usual if place.endswith("()")}
    before = {place: "missing" for place in entries if place.rpartition(".")[0] not in layers}
    before |= {place: "missing" for place in entries if place.endswith("()")}
    before |= dict.fromkeys(dir(type(agent)), "default") | usual
    after = {place: "missing" for place in usual if place.endswith("()")} | entries
    changed = {k: text for k, text in after.items() if text != before.get(k, text)}
    running = tuple(agent.run_state)
    return {k: text for k, text in changed.items() if not k.startswith(running)}


def _entries(
    agent: Any, nets: Mapping[str, nn.Module], attributes: bool
) -> tuple[dict[str, Any], dict[str, str]]:
    """Return two dicts: descriptions of the agent's contents, and reasons for unreadable contents.

    The contents are attributes, layers and hooks. The keys of both dicts are dotted paths in the
    agent.

    Args:
        agent: the agent.
        nets: its networks.
        attributes: whether the attributes of the agent and of the user's modules are included.
            Attributes of other modules are always included, because ``settings()`` might not list
            them.
    """
    entries: dict[str, Any] = {}
    unreadable: dict[str, str] = {}
    if torch_module._global_forward_hooks or torch_module._global_forward_pre_hooks:
        unreadable["global hooks"] = "they are registered for all modules"
    objects = {} if "" in nets else {"": agent}
    for place, net in nets.items():
        layers = net.named_modules(remove_duplicate=False)
        objects |= {_join(place, name): module for name, module in layers}
    for place, thing in objects.items():
        if isinstance(thing, nn.Module):
            entries[f"{place}()"] = class_name(type(thing))
            _add_hooks(thing, place, entries, unreadable)
        library = place != "" and not is_users(type(thing))
        for name, part in attributes_of(thing):
            inner = _join(place, name)
            if callable(part) and callable(read(type(thing), name)):
                unreadable[inner] = "a replaced method"
            elif attributes or library:
                entries[inner] = _described(part, inner, unreadable if attributes else {})
    for place, net in nets.items():  # the state also holds packed weights of quantised layers
        for name, part in net.state_dict().items():
            if not isinstance(part, torch.Tensor):
                entries[_join(place, name)] = _described(part, place, unreadable)
    return entries, unreadable


def _add_hooks(
    module: nn.Module, place: str, entries: dict[str, Any], unreadable: dict[str, str]
) -> None:
    """Add a description of each forward hook of ``module`` to ``entries``.

    A hook is described by its method ``fingerprint()``, or by its name if ``adapters.py`` defines
    it. Any other hook is added to ``unreadable``.
    """
    if type(module).__module__.startswith("torch.jit"):
        unreadable[place] = "a TorchScript module"
        return
    hooks = [*module._forward_pre_hooks.values(), *module._forward_hooks.values()]
    for number, hook in enumerate(hooks):
        name = _join(place, f"forward hook {number}")
        describe = read(hook, "fingerprint")
        if callable(describe):
            entries[f"{name}()"] = f"{type(hook).__qualname__} {describe()!r}"
        elif read(hook, "__module__") == _OWN_HOOKS:
            entries[f"{name}()"] = hook.__qualname__
        else:
            kind = read(hook, "__qualname__", default=type(hook).__qualname__)
            unreadable[name] = f"a forward hook, {kind}"


def attributes_of(thing: Any) -> list[tuple[str, Any]]:
    """Return (name, value) pairs: an object's attributes and a module's non-persistent buffers."""
    attributes = read(thing, "__dict__", default={})
    if not isinstance(thing, nn.Module):
        return [(name, part) for name, part in attributes.items() if name != "settings"]
    buffers = {name: thing._buffers[name] for name in thing._non_persistent_buffers_set}
    return [(k, part) for k, part in {**attributes, **buffers}.items() if k not in _LEFT_OUT]


def code_of(*kinds: type) -> Contents:
    """Return the source files of the user's classes among ``kinds``, and values that they use.

    These values are class attributes and the global variables to which methods refer.
    """
    classes = dict.fromkeys(each for kind in kinds for each in kind.__mro__ if each is not object)
    users = [each for each in classes if is_users(each)]
    sources = source_files([each.__module__ for each in users])
    unreadable = {
        k: "a module without a source file" for k, text in sources.items() if text is None
    }
    values: dict[str, Any] = {}
    for each in classes:
        functions = methods(each)
        for name, function in functions.items():
            same_name = function.__qualname__ == f"{each.__qualname__}.{name}"
            if is_users(function) and not (same_name or name.startswith("__")):
                unreadable[f"{each.__qualname__}.{name}"] = "a replaced method"
        if each not in users:
            continue
        named = [(k, part) for k, part in vars(each).items() if k not in functions and k[0] != "_"]
        waiting = [*functions.values()]
        for function in waiting:
            globals_named = named_values(function)
            named += [(f"() {name}", part) for name, part in globals_named.items()]
            called = [one for one in globals_named.values() if isinstance(one, types.FunctionType)]
            waiting += [one for one in called if is_users(one) and one not in waiting]
        for name, part in named:
            place = f"{each.__qualname__}.{name}"
            if not isinstance(part, (*_SOURCE, types.ModuleType)):
                values[place] = _described(part, place, unreadable)
    code = sorted(text for text in sources.values() if text)
    parts = {"code": code, "names": values}
    return Contents({name: part for name, part in parts.items() if part}, unreadable)


def _described(value: Any, place: str, unreadable: dict[str, str]) -> Any:
    """Return ``value`` as JSON data; parts that cannot be read are added to ``unreadable``."""
    kind = type(value)
    if kind in _PLAIN:
        return value
    if isinstance(value, Observation):
        return None  # the last observation does not affect later actions
    if place.count(".") > DEEPEST:
        unreadable[place] = "nested too deeply"
        return None
    if kind in (list, tuple):
        parts = [_described(part, f"{place}.{n}", unreadable) for n, part in enumerate(value)]
        return [kind.__name__, *parts]
    if kind is dict and all(type(key) in (str, int) for key in value):
        items = value.items()
        return [[repr(k), _described(part, f"{place}.{k}", unreadable)] for k, part in items]
    if isinstance(value, nn.Module):
        return f"{class_name(kind)} {weights_sha(value)}"
    if isinstance(value, (bytes, torch.dtype, torch.device, PurePath, np.generic, np.dtype)):
        return repr(value)
    if kind in (complex, types.EllipsisType):  # constants of bytecode
        return repr(value)
    if kind is types.CodeType:
        bytecode = {name: read(value, name) for name in _BYTECODE}
        return _described(bytecode, place, unreadable)
    if _is_users_function(value):
        return _function(value, place, unreadable)
    if isinstance(value, (type, types.FunctionType)) and not is_users(value):
        return class_name(value)
    if isinstance(value, types.BuiltinFunctionType) and value.__module__:  # not a bound method
        return class_name(value)
    if kind in (set, frozenset) and all(type(part) in _PLAIN for part in value):
        return sorted(map(repr, value))
    if sha := array_sha(value):
        return sha
    attributes = _attributes_of_data(value)
    if attributes is not None:
        return [kind.__qualname__, _described(attributes, place, unreadable)]
    unreadable[place] = f"a {class_name(kind)}"
    return None


def _attributes_of_data(value: Any) -> dict[str, Any] | None:
    """Return the attributes of a gymnasium space or of a frozen dataclass of this project.

    The random generator of a space is left out. Return None for any other value.
    """
    kind = type(value)
    if any(f"{each.__module__}.{each.__qualname__}" in _SPACES for each in kind.__mro__):
        return {name: part for name, part in vars(value).items() if name != "_np_random"}
    shipped = kind.__module__.partition(".")[0] == "mitigate"
    if shipped and is_dataclass(kind) and read(kind, "__dataclass_params__").frozen:
        return {one.name: getattr(value, one.name) for one in fields(kind)}
    return None


def _is_users_function(value: Any) -> bool:
    """Return whether ``value`` is a user's function, perhaps in a decorator of a library."""
    return isinstance(value, types.FunctionType) and is_users(inspect.unwrap(value))


def _function(function: types.FunctionType, place: str, unreadable: dict[str, str]) -> Any:
    """Return the bytecode of a user's function and of the user's functions that it calls.

    The result also contains their default values and attributes, and other values that they use.
    """
    if place.count("().") > 1:  # functions that name each other in dicts would never end
        unreadable[place] = "nested too deeply"
        return None
    parts = []
    waiting = [function]
    for each in waiting:
        named = named_values(each).items()
        called = {name: part for name, part in named if _is_users_function(part)}
        waiting += [one for one in dict.fromkeys(called.values()) if one not in waiting]
        skipped = {*called, *(name for name, part in named if isinstance(part, types.ModuleType))}
        values = {name: part for name, part in named if name not in skipped}
        content = [each.__code__, each.__defaults__, each.__kwdefaults__, vars(each)]
        described = [_described(part, f"{place}()", unreadable) for part in (content, values)]
        parts.append([*described, {name: waiting.index(one) for name, one in called.items()}])
    return parts


def array_sha(array: Any) -> str:
    """Return the hash of an array's or tensor's type, shape and bytes.

    Return "" if the value is not an array or has no readable bytes, because it is sparse, on the
    meta device, or holds objects.
    """
    if type(array) not in (np.ndarray, torch.Tensor, nn.Parameter):
        return ""
    text = f"{array.dtype} {tuple(array.shape)}"
    if isinstance(array, torch.Tensor):
        if array.layout != torch.strided or array.is_meta or vars(array):
            return ""
        array = array.dequantize() if array.is_quantized else array
        array = array.detach().cpu().contiguous().reshape(-1).view(torch.uint8).numpy()
    elif array.dtype.hasobject:
        return ""
    return hashlib.sha256(text.encode() + array.tobytes()).hexdigest()[:DIGITS]


def class_name(kind: Any) -> str:
    """Return the name of a class or function, with its module unless it is user code."""
    if isinstance(kind, types.BuiltinFunctionType):
        return f"{kind.__module__}.{kind.__qualname__}"
    return kind.__qualname__ if is_users(kind) else f"{kind.__module__}.{kind.__qualname__}"


def _join(*names: str) -> str:
    return ".".join(name for name in names if name)


def hash_of(parts: Mapping[str, Any], sensors: Mapping[str, Sensor], front: str = "none") -> str:
    """Return the fingerprint for these ``parts``, ``sensors`` and guards (``front``)."""
    plain = {name: asdict(sensor) for name, sensor in sorted(sensors.items())}
    text = json.dumps({**parts, "sensors": plain, "front": front}, sort_keys=True, default=_plain)
    return hashlib.sha256(text.encode()).hexdigest()[:DIGITS]


def code_sha(objective: nn.Module, *others: type) -> str:
    """Return the hash of the user's code in an objective, its agent and ``others``.

    The result is "" if there is no user code.
    """
    kinds = [type(module) for net in networks(objective).values() for module in net.modules()]
    code = "\n".join(code_of(type(objective), *kinds, *others).parts.get("code", ()))
    return code and hashlib.sha256(code.encode()).hexdigest()[:DIGITS]


def _plain(value: Any) -> Any:
    """Return a setting as JSON data; raise ValueError if it is not plain data."""
    if isinstance(value, (set, frozenset)):
        return sorted(value)
    if to_list := read(value, "tolist"):  # arrays and tensors
        return to_list()
    if isinstance(value, (PurePath, tuple)):
        return str(value) if isinstance(value, PurePath) else list(value)
    raise ValueError(
        f"settings() of the agent must return plain data, got a {type(value).__name__}. Return "
        "numbers, strings, lists and mappings."
    )
