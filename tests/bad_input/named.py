"""What every refusal has in common."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

LONGEST = 1500  # characters of a message (ours)


def refused(call: Callable[[], Any], words: str = "") -> str:
    """Call it; it must raise ValueError or FileNotFoundError with one paragraph that holds
    ``words``. Any other error is a failure of the test, as it would be a traceback for a user."""
    try:
        found = call()
    except (ValueError, FileNotFoundError) as error:
        said = str(error)
    else:
        raise AssertionError(f"was not refused: {found!r:.200}")
    assert said and "\n" not in said and len(said) < LONGEST, said[:2000]
    assert words in said, said
    return said
