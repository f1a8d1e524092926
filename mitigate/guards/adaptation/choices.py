"""Parse the values of ``adapt=``, such as "norm", "tent:never" or "norm+tent".

This module does not need torch.
"""

from __future__ import annotations

from mitigate.core.names import unknown

METHODS = ("norm", "tent", "recentre")
EPISODE, NEVER = "episode", "never"
RESETS = (EPISODE, NEVER)


def parsed(choice: str) -> list[tuple[str, str]]:
    """Return the pairs (method, reset) that ``choice`` lists.

    Raises:
        ValueError: If a method or a value of reset is unknown.
    """
    parts = []
    for part in str(choice).split("+"):
        method, _, reset = part.partition(":")
        if method not in METHODS:
            raise ValueError(f"adapt={choice}: {unknown('adaptation', method, METHODS)}")
        parts.append((method, check_reset(reset or EPISODE)))
    return parts


def check_reset(reset: str) -> str:
    """Return ``reset``; raise ValueError if it is unknown."""
    if reset not in RESETS:
        raise ValueError(f"reset must be one of {', '.join(RESETS)}, got {reset!r:.80}.")
    return reset


def label(choice: str) -> str:
    """Return the text that ``choice`` adds to a column's name."""
    return "+".join(
        method if reset == EPISODE else f"{method}-{reset}" for method, reset in parsed(choice)
    )
