"""Read optional attributes and methods of objects whose classes users wrote."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any


def read(thing: Any, *names: str, default: Any = None) -> Any:
    """Return the first of the attributes ``names`` that ``thing`` has, or else ``default``."""
    for name in names:
        if hasattr(thing, name):  # the user wrote the class
            return getattr(thing, name)
    return default


def take_over(view: Any, thing: Any, names: Iterable[str]) -> None:
    """Copy attributes from ``thing`` to ``view``; skip ``names`` that ``thing`` does not have."""
    for name in names:
        if hasattr(thing, name):  # no other function reads these attributes of a user's object
            setattr(view, name, getattr(thing, name))


def missing_members(thing: Any, names: Sequence[str]) -> list[str]:
    """Return the names of attributes that ``thing`` does not have or leaves empty (the default)."""
    return [name for name in names if not getattr(thing, name, None)]
