"""Handle SIGINT (Ctrl-C) and SIGTERM (sent by ``timeout``, SLURM and containers).

When a signal ends a command, the command prints how to resume. Its exit status is 130 or 143, as
shells expect.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import resource_tracker
from multiprocessing.process import BaseProcess
from multiprocessing.util import Finalize
from types import FrameType

ENDING = (signal.SIGINT, signal.SIGTERM)


class Ended(KeyboardInterrupt):
    """Raised when a signal ended the command; ``status`` is the exit status."""

    def __init__(self, number: int) -> None:
        super().__init__(signal.Signals(number).name)
        self.status = 128 + number


def raise_ended(number: int, frame: FrameType | None) -> None:
    """Raise :class:`Ended`; this function is a signal handler."""
    raise Ended(number)


class SignalDelay:
    """Signal handler that is installed while a block delays signals."""

    def __init__(self) -> None:
        # number of the first signal, or None if no signal was received
        self.number: int | None = None
        self.again = False  # whether a second signal was received
        # The previous signal handlers. If they also delay signals, each signal is passed to them.
        self.outer = {number: signal.getsignal(number) for number in ENDING}

    def __call__(self, number: int, frame: FrameType | None) -> None:
        outer = self.outer[signal.Signals(number)]
        if isinstance(outer, SignalDelay):
            outer(number, frame)
        if self.number is not None:
            self.again = True
            raise_ended(number, frame)
        self.number = number

    def check(self) -> None:
        """Raise :class:`Ended` if a signal was received."""
        if self.number is not None:
            raise Ended(self.number)

    @property
    def nested(self) -> bool:
        """Whether an outer block also delays signals."""
        return any(isinstance(handler, SignalDelay) for handler in self.outer.values())


@contextmanager
def delay_signals(on: bool = True) -> Iterator[SignalDelay]:
    """Delay the first signal during the block, so that current work can be finished and saved.

    The signal sets the attribute ``number`` of the yielded object, and of the objects that
    enclosing blocks yielded. A second signal ends the command immediately. Only the main thread can
    delay signals; in other threads this has no effect.

    Args:
        on: False delays nothing.
    """
    handler = SignalDelay()
    if not on or threading.current_thread() is not threading.main_thread():
        yield handler
        return
    try:
        for number in ENDING:
            signal.signal(number, handler)
        yield handler
    finally:
        for number, previous in handler.outer.items():
            signal.signal(number, previous)


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Protect the block from interrupts, for native code and for writes that must be completed.

    A signal raises :class:`Ended` at the end of the block, unless an outer block delays signals. A
    second signal raises :class:`Ended` immediately.
    """
    with delay_signals() as ending:
        yield
    if not ending.nested:
        ending.check()


def start_worker(process: BaseProcess) -> None:
    """Start the ``process`` of a worker with SIGINT and SIGTERM blocked.

    The signals stay blocked until the worker calls :func:`leave_to_parent`, so they cannot
    interrupt its imports. A worker that still runs when this interpreter ends is killed. Otherwise,
    multiprocessing would send SIGTERM, which the worker ignores, and wait forever.
    """
    resource_tracker.ensure_running()  # starting the tracker later would unblock the signals
    before = signal.pthread_sigmask(signal.SIG_BLOCK, ENDING)
    try:
        process.start()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
    Finalize(None, process.kill, exitpriority=0)


def leave_to_parent() -> None:
    """Ignore SIGINT and SIGTERM in a worker.

    The terminal sends these signals to all processes of a command. The parent finishes the current
    work and ends the workers.
    """
    for number in ENDING:
        signal.signal(number, signal.SIG_IGN)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, ENDING)
