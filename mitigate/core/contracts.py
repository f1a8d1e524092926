"""How objects of users' own classes meet a contract that has optional members."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any


def read(thing: Any, *names: str, default: Any = None) -> Any:
    """Return the first of the attributes ``names`` that an object of an unknown class has."""
    for name in names:
        if hasattr(thing, name):  # any class may be asked
            return getattr(thing, name)
    return default


def take_over(view: Any, thing: Any, names: Iterable[str]) -> None:
    """Give ``view``, which has defaults, those of the members ``names`` that ``thing`` has."""
    for name in names:
        if hasattr(thing, name):  # the one place where a user's object is asked for these
            setattr(view, name, getattr(thing, name))


def lacking(thing: Any, names: Sequence[str]) -> list[str]:
    """Return the members ``names`` that ``thing`` does not have, or has empty, as defaults are."""
    return [name for name in names if not getattr(thing, name, None)]
