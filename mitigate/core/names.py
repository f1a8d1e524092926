"""Phrases of messages: unknown names, counts, and values in short form."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from pathlib import Path


def unknown(what: str, name: object, allowed: Iterable[str]) -> str:
    """Return the paragraph for an unknown ``name``, with the nearest and all allowed names.

    Args:
        what: kind of thing, such as "corruption".
        name: the unknown name.
        allowed: the names that exist; sorted if they have no order.
    """
    allowed = list(allowed) if isinstance(allowed, (list, tuple, Mapping)) else sorted(allowed)
    near = difflib.get_close_matches(str(name), allowed, n=1)
    hint = f" Did you mean {near[0]}?" if near else ""
    return f"There is no {what} {name!r}.{hint} Choose one of: {', '.join(allowed)}."


def counted(count: int, what: str) -> str:
    """Return e.g. ``1 episode``, ``0 episodes`` or ``40 episodes``."""
    return f"{count} {what}" if count == 1 else f"{count} {what}s"


def short(value: object, most: int = 60) -> str:
    """Return an untrusted ``value`` as printable text on one line.

    The text has at most about ``most`` characters.
    """
    text = ascii(value[: most + 1] if isinstance(value, str) else value)
    return text if len(text) <= most + 2 else f"{text[:most]}..."


def escaped(text: str, most: int = 200) -> str:
    """Return an untrusted ``text`` without quotes, printable and with at most ``most`` characters.

    It ends in "..." if it was cut.
    """
    printable = "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text[: most + 1])
    return printable if len(printable) <= most else f"{printable[: most - 3]}..."


def name_of(weights: str) -> str:
    """Return a name for the weights at a path.

    It is the name of the run for the ``agent`` folder of a run. For shipped weights it is the kind
    of agent: ``checkpoints/frontier/base`` is "frontier", ``.../teacher`` "frontier_teacher".
    """
    path = Path(weights.removesuffix(".safetensors"))
    while path.name in ("model", "agent", "run"):
        path = path.parent
    if path.parent.parent.name == "checkpoints" and path.parent.name != "hardened":
        kind = path.parent.name
        return kind if path.name == "base" else f"{kind}_{path.name}"
    return path.name or "agent"
