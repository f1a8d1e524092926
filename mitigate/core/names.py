"""How messages name things; the one answer to a name that does not exist: what was meant, and what
there is."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from pathlib import Path


def unknown(what: str, name: object, allowed: Iterable[str]) -> str:
    """Return the paragraph for an unknown ``name`` of the kind ``what``, with the nearest; what is
    allowed keeps its order, and is sorted where it has none."""
    allowed = list(allowed) if isinstance(allowed, (list, tuple, Mapping)) else sorted(allowed)
    near = difflib.get_close_matches(str(name), allowed, n=1)
    hint = f" Did you mean {near[0]}?" if near else ""
    return f"There is no {what} {name!r}.{hint} Choose one of: {', '.join(allowed)}."


def counted(count: int, what: str) -> str:
    """Return e.g. ``1 episode``, ``0 episodes`` or ``40 episodes``."""
    return f"{count} {what}" if count == 1 else f"{count} {what}s"


def short(value: object, most: int = 60) -> str:
    """Return how a message shows a ``value`` that may be of anybody: on one line, printable, at
    most about ``most`` characters."""
    text = ascii(value[: most + 1] if isinstance(value, str) else value)
    return text if len(text) <= most + 2 else f"{text[:most]}..."


def name_of(weights: str) -> str:
    """Return the name of weights by their path: of the run, for a run's ``agent`` folder; of the
    kind of agent, for its shipped weights (``checkpoints/frontier/base``: frontier, and
    ``.../teacher``: frontier_teacher)."""
    path = Path(weights.removesuffix(".safetensors"))
    while path.name in ("model", "agent", "run"):
        path = path.parent
    if path.parent.parent.name == "checkpoints" and path.parent.name != "hardened":
        kind = path.parent.name
        return kind if path.name == "base" else f"{kind}_{path.name}"
    return path.name or "agent"
