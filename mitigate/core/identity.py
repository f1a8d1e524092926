"""What makes an agent the one that it is, as one hash: equal hash, equal behaviour.

A display name carries no identity. Rows of results hold the hash, so that an agent with one setting
changed, other words, or views of another size is another agent to every table and every resume.
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
from dataclasses import asdict
from functools import cache
from pathlib import PurePath
from typing import Any

import numpy as np
import torch
from torch import nn

from mitigate.core.checkpoint import weights_sha
from mitigate.core.held import Held, held, is_users
from mitigate.core.observation import Sensor

DIGITS = 12  # hex digits: 48 bits
_OF_SET = re.compile(r"\{\d+\}")  # of which each process has another order


def identity(agent: Any, sensors: Mapping[str, Sensor], front: str = "none") -> str:
    """Return the hash of ``agent`` behind ``sensors``.

    It covers all that :func:`made_of` names; what each sensor gives; and what stands in front of
    the agent (``front``: the safeguard that repairs its instructions).
    """
    return hash_of(made_of(agent), sensors, front)


def made_of(agent: Any, *, attributes: bool = False) -> dict[str, Any]:
    """Return what makes ``agent`` the one that it is.

    The weights (names, types, shapes, values) of the network that it is and of those that it holds,
    wherever they are in it (``core/held.py``), or its arrays if it has no networks; its class and
    ``settings`` (a mapping, or a method that returns one: vocabulary and all else that is no
    weight); the code of its classes and of its networks' (:func:`source_of`), and of the functions
    that it holds or that its code names, with their constants. ``attributes``: of an agent without
    ``settings``, also the plain data that its attributes hold now, which may be others after a
    walk.
    """
    settings = getattr(agent, "settings", dict)
    inside = held(agent, attributes=attributes and not hasattr(agent, "settings"))
    code = [*_codes(agent, inside), *_lines(inside.constants)]
    return {
        "class": f"{type(agent).__module__}.{type(agent).__qualname__}",
        "weights": _weights(inside),
        "settings": settings() if callable(settings) else settings,
        **({"code": code} if code else {}),
        **({"attributes": _lines(inside.attributes)} if inside.attributes else {}),
    }


def hash_of(made: Mapping[str, Any], sensors: Mapping[str, Sensor], front: str = "none") -> str:
    """Return the hash of an agent that is made of ``made`` behind ``sensors`` and ``front``."""
    shown = {name: asdict(sensor) for name, sensor in sorted(sensors.items())}
    text = json.dumps({**made, "sensors": shown, "front": front}, sort_keys=True, default=_plain)
    return hashlib.sha256(text.encode()).hexdigest()[:DIGITS]


def _lines(values: Mapping[str, Any]) -> list[str]:
    """Plain values by where they are, in an order that is the same in every process."""
    return sorted(f"{_OF_SET.sub('{}', place)} = {value!r}" for place, value in values.items())


def source_of(kind: type) -> list[str]:
    """The source of a class and of those that it builds on, but for this project's, torch's,
    Python's own and those of installed packages, which nobody edits; as it was when it was first
    asked for, whatever becomes of the file."""
    return list(_source_of(kind))


def code_sha(recipe: nn.Module) -> str:
    """The hash of the code by which a recipe, its agent in it, trains, of what is the user's own;
    empty if nothing is."""
    code = "\n".join(_codes(recipe, held(recipe)))
    return code and hashlib.sha256(code.encode()).hexdigest()[:DIGITS]


def _codes(agent: Any, inside: Held) -> list[str]:
    """What :func:`source_of` has of the agent's class and of those of its networks' modules, each
    class once, and functions that are in none of these."""
    modules = [module for net in inside.networks.values() for module in net.modules()]
    kinds = dict.fromkeys(map(type, (agent, *modules)))
    classes = [*dict.fromkeys(source for kind in kinds for source in source_of(kind))]
    codes = [function.__code__ for function in inside.functions.values()]
    functions = dict.fromkeys(_written(code, code.co_filename) for code in codes)
    apart = [text for text in functions if not any(text in source for source in classes)]
    return [*classes, *apart]


@cache
def _written(code: types.CodeType, file: str) -> str:
    """The source of a function's ``code`` in ``file``, as it was when it was first asked for; of
    one that is in no file, its instructions."""
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
        with suppress(OSError, TypeError):  # typed in, or made while it ran
            if is_users(each.__module__, inspect.getsourcefile(each) or ""):
                found.append(inspect.getsource(each))
    return tuple(found)


def _weights(inside: Held) -> str | dict[str, str]:
    """The hash of the weights of the network that the agent is, or of each of those that it holds,
    else of its arrays; empty if there are none."""
    if [*inside.networks] == [""]:
        return weights_sha(inside.networks[""])
    found: dict[str, list[str]] = defaultdict(list)
    for place, thing in (inside.networks or inside.arrays).items():
        sha = weights_sha(thing) if isinstance(thing, nn.Module) else array_sha(thing)
        found[_OF_SET.sub("{}", place)].append(sha)
    return {place: " ".join(sorted(shas)) for place, shas in found.items()} or ""


def array_sha(array: torch.Tensor | np.ndarray) -> str:
    """Return the hash of an array's type, shape and bytes."""
    if isinstance(array, torch.Tensor):
        bytes_of = array.detach().cpu().contiguous().reshape(-1).view(torch.uint8).numpy().tobytes()
    else:
        bytes_of = array.tobytes()
    kind = f"{array.dtype} {tuple(array.shape)}"
    return hashlib.sha256(kind.encode() + bytes_of).hexdigest()[:DIGITS]


def _plain(value: Any) -> Any:
    """A setting as JSON; ValueError for one that is no data."""
    if isinstance(value, (set, frozenset)):
        return sorted(value)
    if hasattr(value, "tolist"):  # numpy
        return value.tolist()
    if isinstance(value, (PurePath, tuple)):
        return str(value) if isinstance(value, PurePath) else list(value)
    raise ValueError(
        f"A setting of the agent is a {type(value).__name__}, which is no data: settings() returns "
        "numbers, texts, lists and mappings."
    )
