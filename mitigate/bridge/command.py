"""The user's command of one condition, with every process that comes from it."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import IO, Any

from mitigate.bridge import supervisor

GRACE = 3.0  # seconds in which the processes of a command may end by themselves (heuristic)
SHOWN = 3  # processes that a message names
LONGEST = 200  # characters of a process's command line in a message


class Command:
    """Starts a command under a supervisor (``supervisor.py``), and ends all of its processes.

    A process belongs to the command if it descends from it, or if its environment holds
    ``marker``: in a container of its own, or after its supervisor was killed.

    Args:
        words: The command and its arguments.
        log: Gets its output.
        environment: All of its environment variables.
        marker: A text that only this command's environment holds.

    Raises:
        OSError: The command cannot be started.
    """

    def __init__(
        self, words: Sequence[str], log: IO[str], environment: Mapping[str, str], marker: str
    ) -> None:
        self.marker = marker.encode()
        self._ended: int | None = None
        self._text = b""
        self._news, writer = os.pipe()
        own = [sys.executable, "-I", "-S", supervisor.__file__, str(os.getpid()), str(writer)]
        try:
            self.process = subprocess.Popen(
                [*own, *words],
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                env=dict(environment),
                start_new_session=True,
                pass_fds=[writer],
            )
        finally:
            os.close(writer)
        started = self._next()
        if "pid" not in started:
            self.end(lambda: False)
            raise OSError(0, started.get("error") or "its supervisor was killed")
        os.set_blocking(self._news, False)

    def status(self) -> int | None:
        """Return the exit status of the command, None while it runs; that of a signal is below 0.

        Processes that it started may still run.
        """
        if self._ended is None:
            gone = self.process.poll()  # before: what it told is then in the pipe
            news = self._next()
            if "status" in news:
                self._ended = int(news["status"])
            elif gone is not None:  # somebody killed the supervisor
                self._ended = gone or 1
        return self._ended

    def running(self) -> list[int]:
        """Return the pids of all processes of the command that run."""
        below = supervisor.descendants(self.process.pid)
        return sorted({*below, *_marked(self.marker)} - {self.process.pid, os.getpid()})

    def left(self) -> list[str]:
        """Wait up to ``GRACE`` for the processes of a command that ended; describe those left."""
        until = time.monotonic() + GRACE
        while (pids := self.running()) and time.monotonic() < until:
            time.sleep(supervisor.PAUSE)
        return [_described(pid) for pid in pids]

    def end(self, connected: Callable[[], bool]) -> None:
        """End all processes: by SIGTERM, and by SIGKILL what is left after ``GRACE``.

        Args:
            connected: Whether any of them is connected to the bridge. If none is and the command
                ended, SIGKILL follows at once.
        """
        until = time.monotonic() + GRACE
        supervisor.signal_all(self.running(), signal.SIGTERM)
        while self.running() and time.monotonic() < until:
            if self.status() is not None and not connected():
                break
            time.sleep(supervisor.PAUSE)
        until = time.monotonic() + supervisor.LONGEST
        while (pids := self.running()) and time.monotonic() < until:
            supervisor.signal_all(pids, signal.SIGKILL)
            time.sleep(supervisor.PAUSE)
        try:
            self.process.wait(supervisor.LONGEST)
        except subprocess.TimeoutExpired:  # a process of another user holds it
            self.process.kill()
            self.process.wait()
        self.status()
        if self._news >= 0:
            os.close(self._news)
            self._news = -1

    def _next(self) -> dict[str, Any]:
        """Return the next line of the supervisor, empty if there is none (yet)."""
        while self._news >= 0 and b"\n" not in self._text:
            try:
                read = os.read(self._news, 4096)
            except BlockingIOError:
                break
            if not read:
                break
            self._text += read
        line, ended, rest = self._text.partition(b"\n")
        if not ended:
            return {}
        self._text = rest
        news: dict[str, Any] = json.loads(line)
        return news


def _marked(marker: bytes) -> list[int]:
    """Return the pids of this user's processes whose environment holds ``marker``."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            if marker in (folder / "environ").read_bytes():
                found.append(int(folder.name))
    return [pid for pid in found if _runs(pid)]


def _runs(pid: int) -> bool:
    """Whether a process is no zombie."""
    with suppress(OSError, IndexError):
        stat = Path(f"/proc/{pid}/stat").read_bytes()
        return stat[stat.rindex(b")") + 2 :].split()[0] not in (b"Z", b"X")
    return False


def _described(pid: int) -> str:
    """Return a process's command line, printable and short, with its pid."""
    words = b""
    with suppress(OSError):
        words = Path(f"/proc/{pid}/cmdline").read_bytes().strip(b"\0").replace(b"\0", b" ")
    text = "".join(c if c.isprintable() else " " for c in words.decode(errors="replace"))
    short = text if len(text) <= LONGEST else f"{text[:LONGEST]}..."
    return f"{short or 'a process'} (pid {pid})"
