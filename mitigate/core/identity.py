"""What makes an agent the one that it is, as one hash: equal hash, equal behaviour.

A display name carries no identity. Rows of results hold the hash, so that an agent with one setting
changed, other words, or views of another size is another agent to every table and every resume.
"""

from __future__ import annotations

import hashlib
import inspect
import json
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import asdict
from functools import cache
from pathlib import PurePath
from typing import Any

from torch import nn

from mitigate.core.checkpoint import weights_sha
from mitigate.core.observation import Sensor

DIGITS = 12  # hex digits: 48 bits


def identity(agent: Any, sensors: Mapping[str, Sensor], front: str = "none") -> str:
    """Return the hash of ``agent`` behind ``sensors``.

    It covers the weights (names, types, shapes, values), also those of networks that an agent which
    is none itself holds as attributes, the agent's class and ``settings`` (a mapping, or a method
    that returns one: vocabulary and all else that is no weight), what each sensor gives, and what
    stands in front of the agent (``front``: the safeguard that repairs its instructions). Of an
    agent without ``settings`` it covers the code of its class as well, where that is in a file.
    """
    settings = getattr(agent, "settings", dict)
    code = {} if hasattr(agent, "settings") else {"code": _code(type(agent))}  # type: ignore[arg-type]
    held = {
        "class": f"{type(agent).__module__}.{type(agent).__qualname__}",
        "weights": _weights(agent),
        "settings": settings() if callable(settings) else settings,
        "sensors": {name: asdict(sensor) for name, sensor in sorted(sensors.items())},
        "front": front,
        **code,
    }
    text = json.dumps(held, sort_keys=True, default=_plain)
    return hashlib.sha256(text.encode()).hexdigest()[:DIGITS]


@cache
def _code(kind: type) -> list[str]:
    """The source of a class and of those that it builds on, but torch's and Python's own; as it was
    when it was first asked for, whatever becomes of the file."""
    found = []
    for each in kind.__mro__:
        if each.__module__.partition(".")[0] in ("builtins", "abc", "typing", "torch"):
            continue
        with suppress(OSError, TypeError):  # typed in, or made while it ran
            found.append(inspect.getsource(each))
    return found


def _weights(agent: Any) -> str | dict[str, str]:
    """The hash of the weights of a network, or of each of those in the attributes of another
    object; empty if there are none."""
    if isinstance(agent, nn.Module):
        return weights_sha(agent)
    own = getattr(agent, "__dict__", {})
    return {k: weights_sha(v) for k, v in own.items() if isinstance(v, nn.Module)} or ""


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
