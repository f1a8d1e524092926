"""How messages name things; the one answer to a name that does not exist: what was meant, and what
there is."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping


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
