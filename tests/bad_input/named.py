"""The check shared by all tests of rejected files."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

LONGEST = 1500  # maximum length of a message (heuristic)


def refused(call: Callable[[], Any], words: str = "") -> str:
    """Call ``call``; it must raise ValueError or FileNotFoundError with one paragraph that contains
    ``words``. Any other type of error fails the test, because a user would see a traceback."""
    try:
        matches = call()
    except (ValueError, FileNotFoundError) as error:
        message = str(error)
    else:
        raise AssertionError(f"was not refused: {matches!r:.200}")
    assert message and "\n" not in message and len(message) < LONGEST, message[:2000]
    assert words in message, message
    return message
