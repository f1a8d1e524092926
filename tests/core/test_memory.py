"""The bounded memory of results."""

from __future__ import annotations

import numpy as np

from mitigate.core.memory import Memory


def made(memory, key, log, size=8):
    def make():
        log.append(key)
        return (np.zeros(size, np.uint8),)

    return memory.recall(key, make)


def test_what_is_kept_is_not_made_again():
    memory, log = Memory(100), []
    assert made(memory, "a", log)[0] is made(memory, "a", log)[0] and log == ["a"]


def test_what_was_not_used_longest_goes_first_when_the_bytes_are_used_up():
    memory, log = Memory(24), []
    for key in "abcad":
        made(memory, key, log)
    assert len(memory) == 3 and memory.held == 24
    for key in "acdb":
        made(memory, key, log)
    assert "".join(log) == "abcdb"


def test_a_result_larger_than_the_limit_is_kept_alone():
    memory, log = Memory(4), []
    made(memory, "a", log)
    made(memory, "b", log)
    assert len(memory) == 1 and memory.held == 8
