"""Read optional members from objects of users' classes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any


def read(thing: Any, *names: str, default: Any = None) -> Any:
    """Return the first attribute of ``names`` that ``thing`` has, else ``default``."""
    for name in names:
        if hasattr(thing, name):  # the class is unknown
            return getattr(thing, name)
    return default


def take_over(view: Any, thing: Any, names: Iterable[str]) -> None:
    """Copy those members ``names`` that ``thing`` has to ``view``, replacing its defaults."""
    for name in names:
        if hasattr(thing, name):  # only this function reads these members from a user's object
            setattr(view, name, getattr(thing, name))


def missing_members(thing: Any, names: Sequence[str]) -> list[str]:
    """Return the ``names`` that ``thing`` lacks or that are empty (the default)."""
    return [name for name in names if not getattr(thing, name, None)]
