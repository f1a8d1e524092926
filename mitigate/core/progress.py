"""Report the progress of a long job: a tqdm bar in a terminal, plain lines elsewhere.

While a :class:`Progress` is open, a daemon thread (the clock) prints the progress of the innermost
one when nothing was printed for ``EVERY`` seconds, even if the job does not advance. tqdm alone
prints only when the job advances. The clock cannot print while a single call holds the interpreter
lock; torch, numpy, sleeps and subprocesses release it.
"""

from __future__ import annotations

import math
import os
import sys
import threading
import time
from typing import Any

from tqdm import tqdm

from mitigate.core.names import counted

EVERY = 10.0  # seconds without a line after which the clock prints one
REDRAW = 1.0  # seconds between redraws of a bar

_lock = threading.RLock()  # guards the variables below and standard output
_changed = threading.Condition(_lock)  # wakes the clock
_open: list[Progress] = []  # outermost first
_last_line = 0.0  # time.monotonic() of the last plain line
_thread: threading.Thread | None = None  # the clock while it runs


class Progress:
    """Progress of a job of ``total`` units, of which ``start`` are done; a context manager.

    Raises ValueError unless ``start`` is between 0 and ``total``.
    """

    def __init__(self, title: str, total: int, *, unit: str = "step", start: int = 0) -> None:
        if not 0 <= start <= total:
            raise ValueError(
                f"Progress of {title!r}: start={start} must be at least 0 and at most "
                f"total={total}. Pass the number of all {unit}s and of those already done."
            )
        self.title = title
        self.total = total
        self.unit = unit
        self.start = start
        self.done = start
        self.note = ""
        self._began = time.monotonic()
        self._bar: tqdm | None = None

    def __enter__(self) -> Progress:
        self._began = time.monotonic()
        with _lock:
            if sys.stdout.isatty():
                self._bar = tqdm(
                    total=self.total,
                    initial=self.start,
                    desc=self.title,
                    unit=self.unit,
                    file=sys.stdout,
                    dynamic_ncols=True,
                    leave=None,  # nested bars disappear
                )
            else:
                before = f", {self.start} already done" if self.start else ""
                say(f"{self.title}: {counted(self.total, self.unit)}{before}")
            _open.append(self)
            _start_clock()
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: Any) -> None:
        with _lock:
            if self in _open:  # a forked child has emptied the list
                _open.remove(self)
            _changed.notify_all()
            if self._bar is not None:
                self._bar.close()
            else:
                end = "done in" if kind is None else "stopped after"
                say(self._line(f"{end} {duration(time.monotonic() - self._began)}"))

    def advance(self, count: int = 1, note: str = "") -> None:
        """Count ``count`` units as done (may be 0); an empty ``note`` keeps the previous one."""
        with _lock:
            self.done += count
            self.note = note or self.note
            if self._bar is not None:
                if note:
                    self._bar.set_postfix_str(note, refresh=False)
                self._bar.update(count)

    def say(self, text: str) -> None:
        """Print one line without breaking the bar."""
        say(text)

    def line(self) -> str:
        """Return e.g. ``train: step 120/700, 3.1 steps/s, 3 min 10 s left, loss 0.31``."""
        elapsed = time.monotonic() - self._began
        now = self.done - self.start
        if now <= 0:
            return self._line(f"{duration(elapsed)} so far")
        rate = _rate(now / max(elapsed, 1e-9), self.unit)
        return self._line(f"{rate}, {duration(self.left())} left")

    def left(self) -> float:
        """Return the seconds left at the mean pace so far; infinite before the first unit."""
        now = self.done - self.start
        pace = (time.monotonic() - self._began) / now if now > 0 else math.inf
        return (self.total - self.done) * pace if self.done < self.total else 0.0

    def _line(self, pace: str) -> str:
        note = f", {self.note}" if self.note else ""
        return f"{self.title}: {self.unit} {self.done}/{self.total}, {pace}{note}"


def say(text: str) -> None:
    """Print one line immediately, above any bars."""
    global _last_line
    with _lock:
        if any(progress._bar is not None for progress in _open):
            tqdm.write(text, file=sys.stdout)
            sys.stdout.flush()
        else:
            print(text, flush=True)
        _last_line = time.monotonic()


def duration(seconds: float) -> str:
    """Return e.g. ``8 s``, ``3 min 10 s``, ``1 h 05 min`` or, if infinite, ``unknown time``."""
    if math.isinf(seconds):
        return "unknown time"
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60:02d} s"
    return f"{whole // 3600} h {whole % 3600 // 60:02d} min"


def _rate(per_second: float, unit: str) -> str:
    if per_second < 1:
        each = 1 / per_second
        took = f"{each:.3g} s" if each < 60 else duration(each)
        return f"{took} per {unit}"
    return f"{per_second:.3g} {unit}s/s"


def _start_clock() -> None:
    global _thread
    if _thread is None:
        _thread = threading.Thread(target=_clock, name="progress", daemon=True)
        _thread.start()


def _clock() -> None:
    """Print lines or refresh bars while any progress is open."""
    global _thread
    with _changed:
        try:
            while _open:
                _changed.wait(_report())
        except (OSError, ValueError):  # standard output is closed; the job itself continues
            pass
        finally:
            _thread = None


def _report() -> float:
    """Redraw the bars, or print a line if it is due; return the seconds until the next call."""
    bars = [progress._bar for progress in _open if progress._bar is not None]
    if bars:
        for bar in bars:
            bar.refresh()
        return REDRAW
    left = _last_line + EVERY - time.monotonic()
    if left > 0:
        return left
    say(_open[-1].line())
    return EVERY


def _after_fork_in_child() -> None:
    """Drop the jobs of the parent process: a forked child has no clock."""
    global _thread
    _open.clear()
    _thread = None
    _lock.release()


# No fork while another thread holds the lock: the child could never take it.
os.register_at_fork(
    before=_lock.acquire, after_in_parent=_lock.release, after_in_child=_after_fork_in_child
)
