"""What every refusal has in common."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

LONGEST = 1500  # characters of a message (ours)


def refused(call: Callable[[], Any], words: str = "") -> str:
    """Call it; it must raise ValueError or FileNotFoundError with one paragraph that holds
    ``words``. Any other error is a failure of the test, as it would be a traceback for a user."""
    try:
        matches = call()
    except (ValueError, FileNotFoundError) as error:
        message = str(error)
    else:
        raise AssertionError(f"was not refused: {matches!r:.200}")
    assert message and "\n" not in message and len(message) < LONGEST, message[:2000]
    assert words in message, message
    return message
