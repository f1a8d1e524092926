"""Compute the fingerprint of an agent: a content hash of everything that determines its behaviour.

Result rows hold the fingerprint in addition to a display name. Agents with different settings,
weights or sensors appear as different agents in tables, and rows are reused only if the fingerprint
is equal. If some state cannot be read (:attr:`Contents.unreadable`), the user must identify it with
``version=``.
"""

from __future__ import annotations

import hashlib
import inspect
import json
import re
import types
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from functools import cache
from pathlib import PurePath
from typing import Any

import torch
from torch import nn

from mitigate.agents.state import State, bytecode, class_name, is_users, read_state
from mitigate.core.checkpoint import weights_sha
from mitigate.core.checksums import DIGITS
from mitigate.core.contracts import read
from mitigate.core.observation import Sensor

# attribute of shipped classes: a name that stays the same if a module is moved
KIND = "fingerprint_kind"


@dataclass(frozen=True)
class Contents:
    """The data that a fingerprint is computed from, and the state that could not be read.

    Attributes:
        parts: plain data by name.
        unreadable: the reason for each unreadable attribute, by its dotted path.
    """

    parts: Mapping[str, Any]
    unreadable: Mapping[str, str]

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
        version: string with which the user identifies state that cannot be read.
    """
    return hash_of(contents(agent, version).parts, sensors, front)


_SETTINGS_LINE = re.compile(r"settings[.( ]")


def contents(agent: Any, version: str | None = None) -> Contents:
    """Return everything that determines the behaviour of ``agent``.

    For every agent, the contents are its kind, ``settings()``, weights, buffers, layers, hooks, the
    user's code and the objects that this code refers to. For a shipped agent, everything that
    differs from a new agent with the same settings is added. If ``settings()`` is missing or
    inherited, all attributes of the agent are added.
    """
    shipped = KIND in vars(type(agent))
    settings = agent.settings if _definer(agent) is not None else {}
    state = _changes(agent) if shipped else read_state(agent, attributes=not says_all(agent))
    optional = {
        "code": _codes(agent, state),
        # the result of ``settings`` is included, not the attribute, which loading may have set
        "state": sorted(line for line in state.lines if not _SETTINGS_LINE.match(line)),
        "version": version,
        "unreadable": sorted(state.unreadable.items()) if version is None else [],
    }
    parts = {
        "class": vars(type(agent)).get(KIND, class_name(type(agent))),
        "weights": _weights(state),
        "settings": settings() if callable(settings) else settings,
        **{name: part for name, part in optional.items() if part},
    }
    return Contents(parts, state.unreadable if version is None else {})


def says_all(agent: Any) -> bool:
    """Return whether ``settings`` describes all attributes.

    An inherited ``settings`` does not, because a subclass may add attributes.
    """
    return _definer(agent) in (agent, type(agent))


def _definer(agent: Any) -> Any:
    """Return the object or class that defines ``settings``, or None.

    A ``settings`` from ``__getattr__`` does not count, because it describes a different object.
    """
    candidates = (agent, *type(agent).__mro__)
    definers = (one for one in candidates if "settings" in read(one, "__dict__", default=()))
    return next(definers, None)


def _changes(agent: Any) -> State:
    """Return the differences between a shipped agent's state and a new agent with the same
    settings.

    Weights and the memory of an episode are excluded.
    """
    with torch.random.fork_rng(devices=[]):
        new = type(agent)(**agent.settings())
    state = read_state(agent, like=new)
    baseline = read_state(new, like=new)
    state_lines = {line for line in baseline.lines if not line.startswith("class ")}
    missing = [f"not {line}" for line in state_lines - {*state.lines}]
    lines = [line for line in state.lines if line not in state_lines] + missing
    unreadable = {k: v for k, v in state.unreadable.items() if k not in baseline.unreadable}
    return replace(state, lines=lines, unreadable=unreadable)


def hash_of(parts: Mapping[str, Any], sensors: Mapping[str, Sensor], front: str = "none") -> str:
    """Return the fingerprint for these ``parts``, ``sensors`` and guards (``front``)."""
    plain = {name: asdict(sensor) for name, sensor in sorted(sensors.items())}
    text = json.dumps({**parts, "sensors": plain, "front": front}, sort_keys=True, default=_plain)
    return hashlib.sha256(text.encode()).hexdigest()[:DIGITS]


def code_sha(objective: nn.Module) -> str:
    """Return the hash of the user's code in an objective and its agent; "" if there is no such
    code."""
    code = "\n".join(_codes(objective, read_state(objective, attributes=False)))
    return code and hashlib.sha256(code.encode()).hexdigest()[:DIGITS]


def _codes(agent: Any, state: State) -> list[str]:
    """Return the sources of the classes of the agent and its modules, and of other functions."""
    modules = [module for _, net in state.networks for module in net.modules()]
    kinds = dict.fromkeys(map(type, (agent, *modules)))
    classes = [*dict.fromkeys(source for kind in kinds for source in source_of(kind))]
    functions = dict.fromkeys(_code_source(code, code.co_filename) for code in state.functions)
    outside = [text for text in functions if not any(text in source for source in classes)]
    return [*classes, *outside]


@cache
def _code_source(code: types.CodeType, file: str) -> str:
    """Return the source of ``code`` as it was when first read, or its bytecode if there is no
    file."""
    try:
        return inspect.getsource(code)
    except (OSError, TypeError):
        return bytecode(code)


def source_of(kind: type) -> list[str]:
    """Return the sources of a class and of its base classes, as far as they are the user's code.

    They are read once, because a later edit of the file does not change a loaded class.
    """
    return list(_source_of(kind))


@cache
def _source_of(kind: type) -> tuple[str, ...]:
    sources = []
    for each in kind.__mro__:
        with suppress(OSError, TypeError):  # defined interactively or at run time
            if is_users(each.__module__, inspect.getsourcefile(each) or ""):
                sources.append(inspect.getsource(each))
    return tuple(sources)


def _weights(state: State) -> str | list[tuple[str, str]]:
    """Return the hash of the weights, or one hash for each of several networks or arrays."""
    shas = [(place, weights_sha(net)) for place, net in state.networks]
    if len(shas) == 1 and not shas[0][0]:
        return shas[0][1]
    return sorted(shas or state.arrays) or ""


def _plain(value: Any) -> Any:
    """Return a setting as JSON data. Raises ValueError for a value that is not plain data."""
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
