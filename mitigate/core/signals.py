"""Signals that end a command: Ctrl-C, and SIGTERM as ``timeout``, SLURM and containers send it.

A command that is ended says how to go on, and exits as a shell expects: 130 or 143.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import resource_tracker
from multiprocessing.process import BaseProcess
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
    """The handler of a block that holds signals. ``number``: of the first that came, None while
    none did; ``again``: whether another came. ``outer``: the handlers of before, which are told of
    a signal if they hold signals themselves."""

    def __init__(self) -> None:
        self.number: int | None = None
        self.again = False
        self.outer = {number: signal.getsignal(number) for number in ENDING}

    def __call__(self, number: int, frame: FrameType | None) -> None:
        outer = self.outer[signal.Signals(number)]
        if isinstance(outer, Held):
            outer(number, frame)
        if self.number is not None:
            self.again = True
            raise_ended(number, frame)
        self.number = number

    def check(self) -> None:
        """Raise :class:`Ended` if a signal came."""
        if self.number is not None:
            raise Ended(self.number)

    @property
    def nested(self) -> bool:
        """Whether a block around it holds signals, too."""
        return any(isinstance(handler, Held) for handler in self.outer.values())


@contextmanager
def held(on: bool = True) -> Iterator[Held]:
    """Within it, if ``on``, the first signal only sets ``number``, here and in each such block
    around it, so that what is at hand can be finished and saved; a second one ends it at once. In
    threads other than the main one nothing is held."""
    found = Held()
    if not on or threading.current_thread() is not threading.main_thread():
        yield found
        return
    try:
        for number in ENDING:
            signal.signal(number, found)
        yield found
    finally:
        for number, handler in found.outer.items():
            signal.signal(number, handler)


@contextmanager
def unbroken() -> Iterator[None]:
    """Within it nothing is interrupted: what native code does not survive, what is to be whole. A
    signal that came raises :class:`Ended` at its end, unless a block around it holds signals, which
    is told; a second one does so at once."""
    with held() as ending:
        yield
    if not ending.nested:
        ending.check()


def start_worker(process: BaseProcess) -> None:
    """Start a worker's ``process``, in which these signals wait until it calls
    :func:`leave_to_parent`: what it imports before knows nothing of them."""
    resource_tracker.ensure_running()  # which lets signals through when it starts
    before = signal.pthread_sigmask(signal.SIG_BLOCK, ENDING)
    try:
        process.start()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def leave_to_parent() -> None:
    """Ignore these signals in a worker: they reach a command's whole process group, and the parent
    finishes what is at hand and ends the workers."""
    for number in ENDING:
        signal.signal(number, signal.SIG_IGN)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, ENDING)
