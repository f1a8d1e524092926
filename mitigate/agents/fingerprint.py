"""Fingerprint of an agent: a content hash of whatever determines its behaviour.

Rows of results hold the fingerprint, not only a display name: an agent with another setting, other
weights or other sensors is another agent for every table, and rows are reused only under an equal
fingerprint. What cannot be read (:attr:`Contents.unreadable`) needs ``version=`` from the user.
"""

from __future__ import annotations

import hashlib
import inspect
import json
import re
import types
from collections import defaultdict
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import PurePath
from types import SimpleNamespace
from typing import Any

import numpy as np
import torch
from torch import nn

from mitigate.agents.adapter_layers import Adapter
from mitigate.agents.state import (
    State,
    array_sha,
    class_name,
    has_settings,
    is_users,
    plain_attributes,
    plain_text,
    read_state,
    says_all,
)
from mitigate.core.checkpoint import weights_sha
from mitigate.core.checksums import DIGITS
from mitigate.core.observation import Sensor

KIND = "fingerprint_kind"  # of a shipped agent's class: a name that stays when its module moves
_OF_SET = re.compile(r"\{\d+\}")  # numbers in a set, whose order differs between processes


@dataclass(frozen=True)
class Contents:
    """What a fingerprint hashes, and why it is incomplete.

    Attributes:
        parts: plain data by name.
        unreadable: reasons by dotted place; empty if everything could be read.
    """

    parts: Mapping[str, Any]
    unreadable: Mapping[str, str]

    def explain(self) -> str:
        """Return the first unreadable places in words."""
        found = [f"{place or 'the agent'} ({why})" for place, why in self.unreadable.items()]
        more = f" and {len(found) - 3} more" if len(found) > 3 else ""
        return "; ".join(found[:3]) + more


def fingerprint(
    agent: Any, sensors: Mapping[str, Sensor], front: str = "none", version: str | None = None
) -> str:
    """Return the hash of ``agent`` behind ``sensors``.

    Args:
        agent: any object.
        sensors: what the world shows.
        front: hashes of the guards between the world and the agent.
        version: the user's name for what cannot be read.
    """
    return hash_of(contents(agent, version).parts, sensors, front)


def contents(agent: Any, version: str | None = None) -> Contents:
    """Return what makes ``agent`` behave as it does.

    For every agent: its kind, ``settings()``, weights and buffers, the user's code, hooks that can
    be read, and replaced methods. For one of ours also whatever differs from a new agent with the
    same settings; for others the classes inside their networks. Without ``settings()``, or where
    a base class defines it, also the plain attributes and arrays.
    """
    shipped = KIND in vars(type(agent))
    complete = says_all(agent)
    state = read_state(agent, attributes=not complete)
    settings = agent.settings if has_settings(agent) else {}
    changes = _changes(agent, state) if shipped else []
    code = [*_codes(agent, state), *_lines(state.constants)]
    optional = {
        "code": code,
        "attributes": _lines(state.attributes),
        "behaviour": _lines(state.behaviour),
        "networks": [] if shipped else _architecture(state),
        "changes": changes,
        "arrays": [] if complete or not state.networks else _lines(state.arrays),
        "version": version,
        "unreadable": _lines(state.unreadable) if version is None else [],
    }
    parts = {
        "class": vars(type(agent)).get(KIND, class_name(type(agent))),
        "weights": _weights(state),
        "settings": settings() if callable(settings) else settings,
        **{name: part for name, part in optional.items() if part},
    }
    return Contents(parts, state.unreadable if version is None else {})


def hash_of(parts: Mapping[str, Any], sensors: Mapping[str, Sensor], front: str = "none") -> str:
    """Return the hash of an agent with these ``parts`` behind ``sensors`` and ``front``."""
    shown = {name: asdict(sensor) for name, sensor in sorted(sensors.items())}
    text = json.dumps({**parts, "sensors": shown, "front": front}, sort_keys=True, default=_plain)
    return hashlib.sha256(text.encode()).hexdigest()[:DIGITS]


def source_of(kind: type) -> list[str]:
    """Return the source of a class and of its bases that are the user's code, as it was when it
    was first read: a later edit of the file does not change a loaded class."""
    return list(_source_of(kind))


def code_sha(objective: nn.Module) -> str:
    """Return the hash of the user's code in an objective and its agent; "" if there is none."""
    code = "\n".join(_codes(objective, read_state(objective, attributes=False)))
    return code and hashlib.sha256(code.encode()).hexdigest()[:DIGITS]


def _lines(values: Mapping[str, str]) -> list[str]:
    """Texts by place, in an order that is equal in every process."""
    return sorted(f"{_OF_SET.sub('{}', place)} = {text}" for place, text in values.items())


def _codes(agent: Any, state: State) -> list[str]:
    """Sources of the classes of the agent and of its modules, and of functions outside them."""
    modules = [module for net in state.networks.values() for module in net.modules()]
    kinds = dict.fromkeys(map(type, (agent, *modules)))
    classes = [*dict.fromkeys(source for kind in kinds for source in source_of(kind))]
    codes = [function.__code__ for function in state.functions.values()]
    functions = dict.fromkeys(_written(code, code.co_filename) for code in codes)
    apart = [text for text in functions if not any(text in source for source in classes)]
    return [*classes, *apart]


@cache
def _written(code: types.CodeType, file: str) -> str:
    """Return the source of ``code`` in ``file`` when first read; without a file, its bytecode."""
    try:
        return inspect.getsource(code)
    except (OSError, TypeError):
        return f"{code.co_name} {code.co_code.hex()} {code.co_names} {_constants(code)}"


def _constants(code: types.CodeType) -> list[str]:
    inner = [part for part in code.co_consts if isinstance(part, types.CodeType)]
    plain = [repr(part) for part in code.co_consts if not isinstance(part, types.CodeType)]
    return plain + [text for part in inner for text in (part.co_code.hex(), *_constants(part))]


@cache
def _source_of(kind: type) -> tuple[str, ...]:
    found = []
    for each in kind.__mro__:
        with suppress(OSError, TypeError):  # defined interactively or at run time
            if is_users(each.__module__, inspect.getsourcefile(each) or ""):
                found.append(inspect.getsource(each))
    return tuple(found)


def _weights(state: State) -> str | dict[str, str]:
    """Return the hash of the agent's own weights, else of each network, else of each array."""
    if [*state.networks] == [""]:
        return weights_sha(state.networks[""])
    shas = {place: weights_sha(net) for place, net in state.networks.items()} or state.arrays
    found: dict[str, list[str]] = defaultdict(list)
    for place, sha in shas.items():
        found[_OF_SET.sub("{}", place)].append(sha)
    return {place: " ".join(sorted(each)) for place, each in found.items()} or ""


def _architecture(state: State) -> list[str]:
    """Return the class of every module, the settings of adapters, and buffers that are not in the
    state dict."""
    lines: dict[str, str] = {}
    for place, net in state.networks.items():
        saved = {*net.state_dict()} if hasattr(net, "state_dict") else set()
        for name, module in net.named_modules():
            settings = getattr(module, "settings", None) if ".adapter" in f".{name}" else None
            shown = f" {settings}" if isinstance(settings, dict) else ""
            lines[f"{place}:{name}"] = f"{class_name(type(module))}{shown}"
        for name, buffer in net.named_buffers():
            if name not in saved:
                lines[f"{place}:{name}"] = array_sha(buffer)
    return _lines(lines)


def _changes(agent: Any, state: State) -> list[str]:
    """Return what differs between one of our agents and a new one with its settings, beside weights
    and what it remembers of an episode: layers, buffers and plain attributes. Note in ``state``
    what cannot be read of added layers."""
    with torch.random.fork_rng(devices=[]):
        new = type(agent)(**agent.settings())
    before = dict(new.named_modules())
    changes = []
    for place, module in agent.named_modules():
        other = before.pop(place, None)
        if type(module) is not type(other):
            changes.append(f"{place}: {class_name(type(module))}")
            changes += _added(place, module, state)
        if other is not None:
            found, usual = _attributes(module, other), _attributes(other, other)
            changes += [f"{place}.{n} = {v}" for n, v in found.items() if usual.get(n) != v]
            changes += [f"{place}.{n} is missing" for n in usual if n not in found]
    return sorted([*changes, *(f"{place} is missing" for place in before)])


def _added(place: str, module: nn.Module, state: State) -> list[str]:
    """Return the attributes of a layer that a new agent does not have, and of its class."""
    if isinstance(module, Adapter):  # also holds what it said of the last frames
        return [f"{place}.settings = {_text(module.settings)}"]
    alone = SimpleNamespace(**plain_attributes(module), kind=type(module))
    found = read_state(alone)
    state.unreadable.update({f"{place}.{name}": why for name, why in found.unreadable.items()})
    shas = {name: weights_sha(net) for name, net in found.networks.items()}
    buffers = {k: module._buffers[k] for k in module._non_persistent_buffers_set}
    hashed = {k: array_sha(v) for k, v in buffers.items() if v is not None}
    lines = _lines({**found.attributes, **found.constants, **found.arrays, **shas, **hashed})
    return [f"{place}.{line}" for line in lines]


def _attributes(module: nn.Module, new: nn.Module) -> dict[str, str]:
    """Return buffers that are not in the state dict, and attributes that ``new`` or the class has,
    as text."""
    known = {*vars(new), *dir(type(module))} - {*getattr(module, "run_state", ())}
    found = {k: _text(v) for k, v in plain_attributes(module).items() if k in known}
    buffers = {k: module._buffers[k] for k in module._non_persistent_buffers_set}
    return found | {k: array_sha(v) for k, v in buffers.items() if v is not None}


def _text(value: Any) -> str:
    """An attribute as text: plain data and arrays by value, other objects by their class."""
    if isinstance(value, dict):
        return f"{{{', '.join(f'{key}: {_text(part)}' for key, part in value.items())}}}"
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(map(_text, value))}]"
    if isinstance(value, (torch.Tensor, np.ndarray)):
        return array_sha(value)
    text = plain_text(value)
    return class_name(type(value)) if text is None else text


def _plain(value: Any) -> Any:
    """A setting as JSON. Raises ValueError for a value that is not plain data."""
    if isinstance(value, (set, frozenset)):
        return sorted(value)
    if isinstance(value, np.generic) or hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, (PurePath, tuple)):
        return str(value) if isinstance(value, PurePath) else list(value)
    raise ValueError(
        f"settings() of the agent must return plain data, got a {type(value).__name__}. Return "
        "numbers, texts, lists and mappings."
    )
