"""Tests that the cache of masks has a maximum size in bytes, and that a recomputed mask is
equal."""

from __future__ import annotations

import numpy as np
import pytest

from mitigate.core.memory import Memory
from mitigate.corruptions import Key, corrupt, keying

MASKED = ("low_light", "spatter", "flare", "haze", "scratches", "refraction")


@pytest.fixture
def memory(monkeypatch):
    """A separate cache of 1 MB."""
    memory = Memory(1 << 20)
    monkeypatch.setattr(keying, "_memory", memory)
    return memory


def test_cached_bounds_the_bytes_of_all_results(memory):
    rgb, depth = np.full((96, 128, 3), 90, np.uint8), np.full((96, 128), 3.0, np.float32)
    for episode in range(40):
        for name in MASKED:
            corrupt(rgb, name, 0.6, key=episode)
        corrupt(depth, "missing_data", 0.6, key=episode)
        assert 0 < memory.bytes <= 1 << 20


@pytest.mark.parametrize("name", MASKED)
def test_dropped_mask_is_made_again_to_the_bit(memory, name):
    rgb = np.random.default_rng(0).integers(0, 256, (64, 96, 3), np.uint8)
    first = corrupt(rgb, name, 0.6, key=Key(0, "a"))
    keying._memory = Memory(1 << 20)
    assert np.array_equal(corrupt(rgb, name, 0.6, key=Key(0, "a")), first)


def test_cached_keeps_the_last_used_and_one_large_result(memory):
    output = []

    @keying.cached
    def zeros(count):
        output.append(count)
        return np.zeros(count, np.uint8)

    zeros(400_000), zeros(500_000), zeros(400_000)  # the second entry is the least recently used
    zeros(300_000), zeros(400_000)
    assert output == [400_000, 500_000, 300_000]
    assert zeros(2_000_000) is zeros(2_000_000) and len(memory) == 1
