"""Masks are kept by bytes: many large ones do not add up, and what is made anew is the same."""

from __future__ import annotations

import numpy as np
import pytest

from mitigate.corruptions import Key, corrupt, keying

MASKED = ("low_light", "spatter", "flare", "haze", "scratches", "refraction")


def held() -> int:
    return sum(size for _, size in keying._cache.values())


@pytest.fixture
def kept(monkeypatch):
    """A cache of its own, for 1 MB and 8 entries."""
    monkeypatch.setattr(keying, "_cache", {})
    monkeypatch.setattr(keying, "MAX_CACHE_BYTES", 1 << 20)
    monkeypatch.setattr(keying, "MAX_CACHE_ENTRIES", 8)
    return keying._cache


def test_what_is_kept_in_all_is_bounded_by_bytes(kept):
    rgb, depth = np.full((96, 128, 3), 90, np.uint8), np.full((96, 128), 3.0, np.float32)
    for episode in range(40):
        for name in MASKED:
            corrupt(rgb, name, 0.6, key=episode)
        corrupt(depth, "missing_data", 0.6, key=episode)
        assert 0 < held() <= 1 << 20 and len(kept) <= 8


@pytest.mark.parametrize("name", MASKED)
def test_a_mask_that_was_dropped_is_made_again_to_the_bit(kept, name):
    rgb = np.random.default_rng(0).integers(0, 256, (64, 96, 3), np.uint8)
    first = corrupt(rgb, name, 0.6, key=Key(0, "a"))
    kept.clear()
    assert np.array_equal(corrupt(rgb, name, 0.6, key=Key(0, "a")), first)


def test_what_was_used_last_stays_and_a_large_one_is_kept_alone(kept):
    made = []

    @keying.cached
    def zeros(count):
        made.append(count)
        return np.zeros(count, np.uint8)

    zeros(400_000), zeros(500_000), zeros(400_000)  # the second is longest unused
    zeros(300_000), zeros(400_000)
    assert made == [400_000, 500_000, 300_000]
    assert zeros(2_000_000) is zeros(2_000_000) and len(kept) == 1
