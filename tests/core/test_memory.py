"""Tests that results are cached up to a limit, and that freed memory is returned to the system."""

from __future__ import annotations

import os
import platform
from pathlib import Path

import numpy as np
import pytest

from mitigate.core.memory import Memory, release_memory


def compute(memory, key, log, size=8):
    def make():
        log.append(key)
        return (np.zeros(size, np.uint8),)

    return memory.recall(key, make)


def test_cache_returns_the_stored_result():
    memory, log = Memory(100), []
    assert compute(memory, "a", log)[0] is compute(memory, "a", log)[0] and log == ["a"]


def test_cache_drops_least_recently_used_first():
    memory, log = Memory(24), []
    for key in "abcad":
        compute(memory, key, log)
    assert len(memory) == 3 and memory.bytes == 24
    for key in "acdb":
        compute(memory, key, log)
    assert "".join(log) == "abcdb"


def test_cache_keeps_a_single_large_result():
    memory, log = Memory(4), []
    compute(memory, "a", log)
    compute(memory, "b", log)
    assert len(memory) == 1 and memory.bytes == 8


@pytest.mark.skipif("glibc" not in platform.libc_ver(), reason="of glibc alone")
def test_freed_memory_returns_to_the_system():
    # each piece is too small for malloc to map it separately
    pieces = [bytearray(60_000) for _ in range(3000)]
    remaining = pieces[::100]
    del pieces
    before = resident()
    release_memory()
    assert resident() < before - 100_000_000 and len(remaining) == 30


def resident() -> int:
    """Return the memory that this process uses, in bytes."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
