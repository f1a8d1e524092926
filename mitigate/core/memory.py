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
        self.limit = limit
        self.held = 0
        self._results: OrderedDict[Hashable, tuple] = OrderedDict()

    def __len__(self) -> int:
        return len(self._results)

    def recall(self, key: Hashable, make: Callable[[], tuple]) -> Any:
        """Return the cached result of ``key``, or call ``make`` and cache its result."""
        if key in self._results:
            self._results.move_to_end(key)
            return self._results[key]
        result = make()
        self._results[key] = result
        self.held += _bytes(result)
        while self.held > self.limit and len(self._results) > 1:
            self.held -= _bytes(self._results.popitem(last=False)[1])
        return result


def give_back() -> None:
    """Return freed memory to the system; takes a few milliseconds.

    glibc keeps freed memory, and keeps more and more of it when array sizes vary.
    """
    with suppress(AttributeError, OSError, TypeError):  # not glibc
        ctypes.CDLL(None).malloc_trim(0)


def _bytes(parts: tuple) -> int:
    return sum(part.nbytes for part in parts)
