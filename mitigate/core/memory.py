"""Memory that stays bounded: results that are kept for a while, and what was freed."""

from __future__ import annotations

import ctypes
from collections import OrderedDict
from collections.abc import Callable, Hashable
from contextlib import suppress
from typing import Any


class Memory:
    """Keeps the results used last, ``limit`` bytes of them at most.

    A result is a tuple of arrays or tensors (anything with ``nbytes``). They are given out as they
    are kept: a caller that lets others change them gives copies away.
    """

    def __init__(self, limit: int) -> None:
        self.limit, self.held = limit, 0
        self._kept: OrderedDict[Hashable, tuple] = OrderedDict()

    def __len__(self) -> int:
        return len(self._kept)

    def recall(self, key: Hashable, make: Callable[[], tuple]) -> Any:
        """Return the result of ``key``, made now if it is not kept."""
        if key in self._kept:
            self._kept.move_to_end(key)
            return self._kept[key]
        made = make()
        self._kept[key] = made
        self.held += _bytes(made)
        while self.held > self.limit and len(self._kept) > 1:
            self.held -= _bytes(self._kept.popitem(last=False)[1])
        return made


def give_back() -> None:
    """Return freed memory to the system where the C library keeps it (glibc): among arrays of ever
    other sizes it keeps more and more. Takes a few milliseconds."""
    with suppress(AttributeError, OSError, TypeError):  # another C library
        ctypes.CDLL(None).malloc_trim(0)


def _bytes(parts: tuple) -> int:
    return sum(part.nbytes for part in parts)
