"""Masks and fields that are used again through an episode, kept up to a number of bytes."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from operator import itemgetter
from typing import Any, ParamSpec, TypeVar

import numpy as np

MOST = 256 << 20  # bytes of all that is kept in a process (ours): 20 masks of 1080p
MOST_KEPT = 256  # of small ones (ours)

P = ParamSpec("P")
T = TypeVar("T")
_kept: dict[tuple, tuple[Any, int]] = {}  # by function and arguments, the longest unused first


def cached(make: Callable[P, T]) -> Callable[P, T]:
    """``make``, a pure function of hashable arguments that gives an array or a tuple of them, made
    once while there is room: beyond ``MOST`` and ``MOST_KEPT`` what was longest unused goes.

    There is no lock: threads at once make a thing twice, and a process may fork at any time.
    """

    @wraps(make)
    def found(*given: P.args, **named: P.kwargs) -> T:
        key = (make, given, *named.items())
        entry = _kept.pop(key, None)
        if entry is not None:
            _kept[key] = entry
            return entry[0]
        made = make(*given, **named)
        _kept[key] = made, _bytes(made)
        _make_room()
        return made

    return found


def _make_room() -> None:
    """Drop what was longest unused, but never the newest."""
    sizes = [*map(itemgetter(1), _kept.values())]  # at every miss: no loop of Python's
    size, count = sum(sizes), len(sizes)
    while count > 1 and (size > MOST or count > MOST_KEPT):
        _, each = _kept.pop(next(iter(_kept), ()), (None, 0))
        size, count = size - each, count - 1


def _bytes(made: Any) -> int:
    parts = made if isinstance(made, tuple) else (made,)
    return sum(part.nbytes for part in parts if isinstance(part, np.ndarray))
