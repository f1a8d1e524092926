"""What was computed lately, by what it was computed from: a bounded memory."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
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


def _bytes(parts: tuple) -> int:
    return sum(part.nbytes for part in parts)
