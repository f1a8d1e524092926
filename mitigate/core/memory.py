"""Keep the memory of a process bounded: a cache with a limit, and the release of freed memory."""

from __future__ import annotations

import ctypes
from collections import OrderedDict
from collections.abc import Callable, Hashable
from contextlib import suppress
from typing import Any


class Memory:
    """Cache of the most recently used results, at most ``limit`` bytes.

    A result is a tuple of arrays or tensors (anything with ``nbytes``). Results are returned
    without a copy: callers must not change them.
    """

    def __init__(self, limit: int) -> None:
        self.limit, self.held = limit, 0
        self._kept: OrderedDict[Hashable, tuple] = OrderedDict()

    def __len__(self) -> int:
        return len(self._kept)

    def recall(self, key: Hashable, make: Callable[[], tuple]) -> Any:
        """Return the cached result of ``key``, or call ``make`` and cache its result."""
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
    """Return freed memory to the system; takes a few milliseconds.

    glibc keeps freed memory, and keeps more and more of it when array sizes vary.
    """
    with suppress(AttributeError, OSError, TypeError):  # not glibc
        ctypes.CDLL(None).malloc_trim(0)


def _bytes(parts: tuple) -> int:
    return sum(part.nbytes for part in parts)
