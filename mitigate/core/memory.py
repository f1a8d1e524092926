"""Limit the memory of a process: cache results up to a limit, and release freed memory."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Hashable
from contextlib import suppress
from typing import Any


class Memory:
    """Cache of the most recently used results, with at most ``limit`` bytes.

    A result is an array, a tensor, or a tuple of these. Results are returned without a copy, so
    callers must not change them. The cache has no lock, so that a process may fork at any time.
    Two threads may therefore compute the same result.
    """

    def __init__(self, limit: int) -> None:
        self.limit = limit
        self.bytes = 0
        self._results: dict[Hashable, Any] = {}  # the least recently used entry is the first

    def __len__(self) -> int:
        return len(self._results)

    def recall(self, key: Hashable, make: Callable[[], Any]) -> Any:
        """Return the cached result of ``key``, or call ``make`` and cache its result."""
        result = self._take(key)
        if result is None:
            result = make()
            self._take(key)  # another thread may have added this result
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


def release_memory() -> None:
    """Return freed memory to the system; this takes a few milliseconds.

    glibc keeps freed memory for later use. If array sizes vary, glibc keeps more and more memory.
    """
    with suppress(AttributeError, OSError, TypeError):  # the C library may not be glibc
        ctypes.CDLL(None).malloc_trim(0)


def _bytes(result: Any) -> int:
    return sum(part.nbytes for part in (result if isinstance(result, tuple) else (result,)))
