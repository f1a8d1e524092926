"""Report the progress of a long job: a tqdm bar in a terminal, plain lines elsewhere.

While a :class:`Progress` is open, a daemon thread (the clock) prints the progress of the innermost
one whenever nothing was printed for ``EVERY`` seconds, even if the job does not advance; tqdm
prints only when it does. The clock stops while a single call holds the interpreter lock; torch,
numpy, sleeps and subprocesses release it.
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

_lock = threading.RLock()  # of what follows and of standard output
_changed = threading.Condition(_lock)  # wakes the clock
_open: list[Progress] = []  # outermost first
_spoke = 0.0  # time.monotonic() of the last plain line
_thread: threading.Thread | None = None  # the clock while it runs


class Progress:
    """Progress of a job of ``total`` units, of which ``start`` are done; a context manager.

    Raises ValueError when ``start`` does not lie between 0 and ``total``.
    """

    def __init__(self, title: str, total: int, *, unit: str = "step", start: int = 0) -> None:
        if not 0 <= start <= total:
            raise ValueError(
                f"Progress of {title!r}: start={start} must be at least 0 and at most "
                f"total={total}. Pass the number of {unit}s in all and of those done before."
            )
        self.title, self.total, self.unit = title, total, unit
        self.start = self.done = start
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
                    leave=None,  # nested ones vanish
                )
            else:
                before = f", {self.start} of them done before" if self.start else ""
                say(f"{self.title}: {counted(self.total, self.unit)}{before}")
            _open.append(self)
            _start_clock()
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: Any) -> None:
        with _lock:
            if self in _open:  # it is not in a forked child
                _open.remove(self)
            _changed.notify_all()
            if self._bar is not None:
                self._bar.close()
            else:
                end = "done in" if kind is None else "stopped after"
                say(self._line(f"{end} {duration(time.monotonic() - self._began)}"))

    def advance(self, count: int = 1, note: str = "") -> None:
        """Count ``count`` units as done (0 is allowed); an empty ``note`` keeps the latest one."""
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
        elapsed, now = time.monotonic() - self._began, self.done - self.start
        if now <= 0:
            return self._line(f"{duration(elapsed)} so far")
        rate = _rate(now / max(elapsed, 1e-9), self.unit)
        return self._line(f"{rate}, {duration(self.left())} left")

    def left(self) -> float:
        """Return the seconds that the rest takes at the mean pace so far; infinite before that."""
        now = self.done - self.start
        pace = (time.monotonic() - self._began) / now if now > 0 else math.inf
        return (self.total - self.done) * pace if self.done < self.total else 0.0

    def _line(self, pace: str) -> str:
        note = f", {self.note}" if self.note else ""
        return f"{self.title}: {self.unit} {self.done}/{self.total}, {pace}{note}"


def say(text: str) -> None:
    """Print one line at once, above the bars if there are any."""
    global _spoke
    with _lock:
        if any(progress._bar is not None for progress in _open):
            tqdm.write(text, file=sys.stdout)
            sys.stdout.flush()
        else:
            print(text, flush=True)
        _spoke = time.monotonic()


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
        return f"{took} {'an' if unit[0] in 'aeiou' else 'a'} {unit}"
    return f"{per_second:.3g} {unit}s/s"


def _start_clock() -> None:
    global _thread
    if _thread is None:
        _thread = threading.Thread(target=_clock, name="progress", daemon=True)
        _thread.start()


def _clock() -> None:
    """Keep lines or bars coming while anything is open."""
    global _thread
    with _changed:
        try:
            while _open:
                _changed.wait(_tell())
        except (OSError, ValueError):  # standard output is closed; the job itself may go on
            pass
        finally:
            _thread = None


def _tell() -> float:
    """Redraw the bars, or print a line if it is time; return the seconds until the next look."""
    bars = [progress._bar for progress in _open if progress._bar is not None]
    if bars:
        for bar in bars:
            bar.refresh()
        return REDRAW
    left = _spoke + EVERY - time.monotonic()
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
