"""An agent of a class of the user's own that a hardened folder fills, and the folder's settings."""

from __future__ import annotations

import json
import warnings
from functools import partial
from pathlib import Path
from typing import Any

from mitigate.core import settings

_PLAIN = (bool, int, float, str)  # of other attributes nobody knows what they were made of


def check_fillable(agent: Any) -> None:
    """Raise TypeError for a class in place of its object, and for what has no weights."""
    if isinstance(agent, type):
        raise TypeError(f"agent is the class {agent.__name__}: give an object of it, made by it.")
    if not hasattr(agent, "eval"):
        raise TypeError(
            f"agent is a {type(agent).__name__}, which has no weights to fill: give a "
            "torch.nn.Module of the class that was trained."
        )


def check_same(agent: Any, config: Path, again: str) -> None:
    """Compare what ``agent`` says of itself with the settings in ``config``.

    Raises ValueError if its ``settings()`` are others, or, ending in ``again``, if the file holds
    none. Of an agent without ``settings()`` the attributes of their names are compared, and others
    warned of: an attribute may mean something else.
    """
    held = _held(config, again)
    told = hasattr(agent, "settings")
    said = agent.settings if told else _attributes(agent, held)
    own: dict[str, Any] = said() if callable(said) else dict(said)
    wrong = [k for k, value in own.items() if k in held and _json(held[k]) != _json(value)]
    if not wrong:
        return
    text = (
        f"{config} is of an agent with {wrong[0]}={held[wrong[0]]!r:.60}, but the one given "
        f"has {own[wrong[0]]!r:.60}. Build it with the settings in that file."
    )
    if told:
        raise ValueError(text)
    warnings.warn(text, stacklevel=4)


def give_settings(agent: Any, config: Path, again: str) -> None:
    """Let an agent without ``settings`` say those in ``config``, as one that an evaluation builds
    does: the same agent then has the same hash in both. Errors as of :func:`check_same`."""
    if not hasattr(agent, "settings"):
        known = {k: v for k, v in _held(config, again).items() if k != "_target_"}
        agent.settings = partial(dict, known)


def _held(config: Path, again: str) -> dict[str, Any]:
    held = settings.read(config).get("agent")
    if not isinstance(held, dict):
        raise ValueError(f"{config} has no settings of an agent. {again}")
    return held


def _json(value: Any) -> Any:
    """``value`` as it is once it was written: a tuple is a list."""
    return json.loads(json.dumps(value, default=lambda one: getattr(one, "tolist", one.__str__)()))


def _attributes(agent: Any, held: dict[str, Any]) -> dict[str, Any]:
    """The plain attributes of ``agent`` that are called as plain settings of ``held`` are."""
    found = {k: getattr(agent, k, None) for k, v in held.items() if isinstance(v, _PLAIN)}
    return {name: value for name, value in found.items() if isinstance(value, _PLAIN)}
