"""Report the progress of a long job: a tqdm bar in a terminal, plain lines elsewhere."""

from __future__ import annotations

import math
import sys
import time
from typing import Any

from tqdm import tqdm

from mitigate.core.names import counted

EVERY = 10.0  # minimum seconds between two plain lines of progress

_open_bars: list[tqdm] = []
_last_line = 0.0  # value of time.monotonic() when the last plain line was printed


class Progress:
    """Context manager that reports the progress of a job.

    Args:
        title: name of the job.
        total: number of units.
        unit: name of a unit, in the singular.
        start: number of units that were done before.

    Raises:
        ValueError: If ``start`` is not between 0 and ``total``.
    """

    def __init__(self, title: str, total: int, *, unit: str = "step", start: int = 0) -> None:
        if not 0 <= start <= total:
            raise ValueError(
                f"Progress of {title!r}: start={start} must be between 0 and {total=}."
            )
        self.title = title
        self.total = total
        self.unit = unit
        self.start = start
        self.done = start
        self.note = ""
        self._began = time.monotonic()
        # number of units done and time.monotonic(), both taken at the first advance
        self._first: tuple[int, float] | None = None
        self._bar: tqdm | None = None

    def __enter__(self) -> Progress:
        self._began = time.monotonic()
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
            _open_bars.append(self._bar)
        else:
            before = f", {self.start} already done" if self.start else ""
            say(f"{self.title}: {counted(self.total, self.unit)}{before}")
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: Any) -> None:
        if self._bar is not None:
            _open_bars.remove(self._bar)
            self._bar.close()
        else:
            end = "done in" if kind is None else "stopped after"
            say(self._line(f"{end} {duration(time.monotonic() - self._began)}"))

    def advance(self, count: int = 1, note: str = "") -> None:
        """Record that ``count`` more units are done; an empty ``note`` keeps the previous note.

        A job that waits calls this method with ``count`` 0, which prints a new line if the last one
        is ``EVERY`` seconds old.
        """
        self.done += count
        self.note = note or self.note
        if count and self._first is None:
            self._first = self.done, time.monotonic()
        if self._bar is not None:
            if note:
                self._bar.set_postfix_str(note, refresh=False)
            self._bar.update(count)
        elif time.monotonic() - _last_line >= EVERY:
            say(self.line())

    def say(self, text: str) -> None:
        """Print one line above the progress bar."""
        say(text)

    def line(self) -> str:
        """Return a line such as ``train: step 12/70, 3.1 steps/s, 18 s left, loss 0.31``."""
        pace = self._pace()
        if pace is None:
            return self._line(f"{duration(time.monotonic() - self._began)} so far")
        return self._line(f"{_rate(1 / pace, self.unit)}, {duration(self.left())} left")

    def left(self) -> float:
        """Return the seconds left at the mean speed so far, or infinity if the speed is unknown."""
        pace = self._pace()
        if self.done >= self.total:
            return 0.0
        return math.inf if pace is None else (self.total - self.done) * pace

    def _pace(self) -> float | None:
        """Return the mean seconds per unit, or None while the mean is unknown.

        The mean excludes the first units, because their time includes compiling code and opening
        files. The mean is unknown until another 1 % of all units is done, because each worker
        compiles code during its first units.
        """
        least = max(1, (self.total - self.start) // 100)
        if self._first is None or self.done - self._first[0] < least:
            return None
        count, since = self._first
        return max(time.monotonic() - since, 1e-9) / (self.done - count)

    def _line(self, pace: str) -> str:
        note = f", {self.note}" if self.note else ""
        return f"{self.title}: {self.unit} {self.done}/{self.total}, {pace}{note}"


def say(text: str) -> None:
    """Print one line immediately, above any bars."""
    global _last_line
    if _open_bars:
        tqdm.write(text, file=sys.stdout)
        sys.stdout.flush()
    else:
        print(text, flush=True)
    _last_line = time.monotonic()


def duration(seconds: float) -> str:
    """Format a duration: ``8 s``, ``3 min 10 s``, ``1 h 05 min``; infinity is ``unknown time``."""
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
