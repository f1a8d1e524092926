"""Signals that end a command: Ctrl-C, and SIGTERM as ``timeout``, SLURM and containers send it.

A command that is ended says how to go on, and exits as a shell expects: 130 or 143.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

ENDING = (signal.SIGINT, signal.SIGTERM)


class Ended(KeyboardInterrupt):
    """A signal ended the command; ``status`` is its exit status."""

    def __init__(self, number: int) -> None:
        super().__init__(signal.Signals(number).name)
        self.status = 128 + number


def raise_ended(number: int, frame: FrameType | None) -> None:
    """A signal handler: raises :class:`Ended` wherever the command is."""
    raise Ended(number)


class Held:
    """``number``: of the first signal that came, None while none did."""

    number: int | None = None


@contextmanager
def held(on: bool = True) -> Iterator[Held]:
    """Within it, if ``on``, the first signal only sets ``number``, so that what is at hand can be
    finished and saved; a second one ends it at once. In threads other than the main one nothing is
    held."""
    found = Held()

    def note(number: int, frame: FrameType | None) -> None:
        if found.number is not None:
            raise_ended(number, frame)
        found.number = number

    if not on or threading.current_thread() is not threading.main_thread():
        yield found
        return
    before = {number: signal.signal(number, note) for number in ENDING}
    try:
        yield found
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def unbroken() -> Iterator[None]:
    """Within it nothing is interrupted: what native code does not survive, what is to be whole. A
    signal that came raises :class:`Ended` at its end; a second one does so at once."""
    with held() as ending:
        yield
    if ending.number is not None:
        raise Ended(ending.number)
