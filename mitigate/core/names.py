"""Format parts of messages: unknown names, counts, and shortened values."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Mapping
from pathlib import Path

LONGEST_NAME = 200  # maximum length of an untrusted name in a message, in characters (heuristic)
LONGEST_LIST = 4000  # maximum length of a list of names in a message, in characters (heuristic)
LONGEST_MESSAGE = 16000  # maximum length of a command's message, in characters (heuristic)


def unknown(what: str, name: object, allowed: Iterable[str]) -> str:
    """Return the error paragraph for an unknown ``name``.

    The paragraph suggests the nearest allowed name, and lists all allowed names.

    Args:
        what: kind of thing, such as "corruption".
        name: the unknown name.
        allowed: the names that exist; a set is sorted.
    """
    allowed = list(allowed) if isinstance(allowed, (list, tuple, Mapping)) else sorted(allowed)
    near = difflib.get_close_matches(str(name)[:LONGEST_NAME], allowed, n=1)
    hint = f" Did you mean {escaped(near[0])}?" if near else ""
    choices = escaped(", ".join(allowed), LONGEST_LIST)
    return f"There is no {what} {escaped(repr(name))}.{hint} Choose one of: {choices}."


def counted(count: int, what: str) -> str:
    """Return a count with its noun, such as ``1 episode`` or ``40 episodes``."""
    return f"{count} {what}" if count == 1 else f"{count} {what}s"


def short(value: object, most: int = 60) -> str:
    """Return an untrusted ``value`` as printable text on one line.

    The text has at most about ``most`` characters.
    """
    text = ascii(value[: most + 1] if isinstance(value, str) else value)
    return text if len(text) <= most + 2 else f"{text[:most]}..."


def escaped(text: str, most: int = LONGEST_NAME) -> str:
    """Escape the unprintable characters of an untrusted ``text``; cut it to ``most`` characters.

    The text ends in "..." if it was cut. In contrast to :func:`short`, no quotes are added.
    """
    printable = "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text[: most + 1])
    return printable if len(printable) <= most else f"{printable[: most - 3]}..."


def file_name(text: str) -> str:
    """Return ``text`` with a dash in place of characters that a file name should not contain."""
    return re.sub(r"[^A-Za-z0-9.@+-]+", "-", text)


def printable(message: str) -> str:
    """Return ``message`` without control characters except line breaks, for output on a terminal.

    A message may quote names from files, which can contain terminal escape sequences. A message
    longer than ``LONGEST_MESSAGE`` characters is cut.
    """
    lines = message[:LONGEST_MESSAGE].split("\n")
    return "\n".join(escaped(line, LONGEST_MESSAGE) for line in lines)


def name_of(weights: str) -> str:
    """Return a display name for the weights at a path.

    For the folder ``agent`` of a run, the display name is the name of the run. For shipped weights,
    it is the kind of agent: ``checkpoints/frontier/base`` is named "frontier", and ``.../teacher``
    is named "frontier_teacher".
    """
    path = Path(weights.removesuffix(".safetensors"))
    while path.name in ("model", "agent", "run"):
        path = path.parent
    if path.parent.parent.name == "checkpoints" and path.parent.name != "hardened":
        kind = path.parent.name
        return kind if path.name == "base" else f"{kind}_{path.name}"
    return path.name or "agent"
