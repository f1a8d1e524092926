"""Limit the memory of a process with a bounded cache and by releasing freed memory."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Hashable
from contextlib import suppress
from typing import Any


class Memory:
    """Cache of the most recently used results, with at most ``limit`` bytes.

    A result is an array, a tensor, or a tuple of these (anything with ``nbytes``). Results are
    returned without a copy: callers must not change them. The cache has no lock, so that a process
    may fork at any time. Therefore two threads may compute the same result twice.
    """

    def __init__(self, limit: int) -> None:
        self.limit = limit
        self.bytes = 0
        self._results: dict[Hashable, Any] = {}  # ordered with the least recently used entry first

    def __len__(self) -> int:
        return len(self._results)

    def recall(self, key: Hashable, make: Callable[[], Any]) -> Any:
        """Return the cached result of ``key``, or call ``make`` and cache its result."""
        result = self._take(key)
        if result is None:
            result = make()
            self._take(key)  # a different thread may have added the entry
        self._results[key] = result
        self.bytes += _bytes(result)
        while self.bytes > self.limit and len(self._results) > 1:
            self._take(next(iter(self._results), None))
        return result

    def _take(self, key: Hashable) -> Any:
        """Remove and return a result, or return None if no result is left."""
        result = self._results.pop(key, None)
        if result is not None:
            self.bytes -= _bytes(result)
        return result


def give_back() -> None:
    """Return freed memory to the system, which takes a few milliseconds.

    glibc keeps freed memory, and keeps more and more of it when array sizes vary.
    """
    with suppress(AttributeError, OSError, TypeError):  # raised if the C library is not glibc
        ctypes.CDLL(None).malloc_trim(0)


def _bytes(result: Any) -> int:
    return sum(part.nbytes for part in (result if isinstance(result, tuple) else (result,)))
