"""Run the user's program and end all processes that come from it.

``Command`` starts the program under a supervisor, a second process that runs this file::

    python program.py PARENT PIPE PROGRAM ...

A process that detaches itself (``setsid``, a double fork, ``nohup ... &``) leaves its session and,
when its parent ends, its place among the children. The supervisor is a child subreaper (prctl(2),
Linux): such orphans become its children, so that it knows every descendant. It stays until the last
one is gone. When PARENT, which started it, is gone or it receives SIGTERM, it ends all of them.

Between the supervisor and the program stands a fork of the supervisor that starts the program and
waits for it. A program that kills its parent kills this fork, and the supervisor lives on.

It writes JSON lines to the file descriptor PIPE: first ``{"pid": N}`` or ``{"error": TEXT}``, and
``{"status": N}`` when the program ends. A bare Python runs it, so this file imports the standard
library only.
"""

from __future__ import annotations

import ctypes
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import IO, Any

PR_SET_CHILD_SUBREAPER = 36  # linux/prctl.h
GRACE = 3.0  # seconds between SIGTERM and SIGKILL (heuristic)
KILL_LIMIT = 10.0  # seconds in which killed processes must be gone (heuristic)
PAUSE = 0.05  # seconds between two checks
LONGEST = 200  # characters of a process's command line in a message


class Command:
    """Starts a command under a supervisor, and ends all of its processes.

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
        own = [sys.executable, "-I", "-S", __file__, str(os.getpid()), str(writer)]
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
        below = descendants(self.process.pid)
        return sorted({*below, *_marked(self.marker)} - {self.process.pid, os.getpid()})

    def left(self) -> list[str]:
        """Wait up to ``GRACE`` for the processes of a command that ended; describe those left."""
        until = time.monotonic() + GRACE
        while (pids := self.running()) and time.monotonic() < until:
            time.sleep(PAUSE)
        return [_described(pid) for pid in pids]

    def end(self, connected: Callable[[], bool]) -> None:
        """End all processes: by SIGTERM, and by SIGKILL what is left after ``GRACE``.

        Args:
            connected: Whether any of them is connected to the bridge. If none is and the command
                ended, SIGKILL follows at once.
        """
        until = time.monotonic() + GRACE
        signal_all(self.running(), signal.SIGTERM)
        while self.running() and time.monotonic() < until:
            if self.status() is not None and not connected():
                break
            time.sleep(PAUSE)
        until = time.monotonic() + KILL_LIMIT
        while (pids := self.running()) and time.monotonic() < until:
            signal_all(pids, signal.SIGKILL)
            time.sleep(PAUSE)
        try:
            self.process.wait(KILL_LIMIT)
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
    pids = []
    for folder in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            if marker in (folder / "environ").read_bytes():
                pids.append(int(folder.name))
    known = processes() if pids else {}
    return [pid for pid in pids if pid in known and known[pid][1]]


def _described(pid: int) -> str:
    """Return a process's command line, printable and short, with its pid."""
    words = b""
    with suppress(OSError):
        words = Path(f"/proc/{pid}/cmdline").read_bytes().strip(b"\0").replace(b"\0", b" ")
    text = "".join(c if c.isprintable() else " " for c in words.decode(errors="replace"))
    short = text if len(text) <= LONGEST else f"{text[:LONGEST]}..."
    return f"{short or 'a process'} (pid {pid})"


def processes() -> dict[int, tuple[int, bool]]:
    """Return {pid: (parent, whether it runs)} of all processes; a zombie does not run."""
    if not os.path.isdir("/proc/self"):
        return _processes_of_ps()
    found = {}
    for name in os.listdir("/proc"):
        if name.isdigit():
            with (
                suppress(OSError, ValueError, IndexError),
                open(f"/proc/{name}/stat", "rb") as file,
            ):
                text = file.read()
                fields = text[text.rindex(b")") + 2 :].split()  # proc_pid_stat(5), from field 3
                zombie = fields[0] in (b"Z", b"X") and int(fields[17]) <= 1  # of one thread
                found[int(name)] = (int(fields[1]), not zombie)
    return found


def _processes_of_ps() -> dict[int, tuple[int, bool]]:
    found = {}
    listed = subprocess.run(["ps", "-A", "-o", "pid=,ppid=,stat="], stdout=subprocess.PIPE)
    for line in listed.stdout.split(b"\n"):
        fields = line.split()
        if len(fields) == 3:
            found[int(fields[0])] = (int(fields[1]), not fields[2].startswith(b"Z"))
    return found


def descendants(root: int) -> list[int]:
    """Return the pids of the running descendants of the process ``root``, without itself."""
    known = processes()
    children: dict[int, list[int]] = {}
    for pid, (parent, _) in known.items():
        children.setdefault(parent, []).append(pid)
    found, left = [], [root]
    while left:
        below = children.get(left.pop(), [])
        left += below
        found += [pid for pid in below if known[pid][1]]
    return found


def signal_all(pids: Iterable[int], number: int) -> None:
    """Send a signal to processes; those that are gone or of another user are passed over."""
    for pid in pids:
        with suppress(ProcessLookupError, PermissionError):
            os.kill(pid, number)


def main() -> None:
    """Run the program that the command line names."""
    parent, pipe, program = int(sys.argv[1]), int(sys.argv[2]), sys.argv[3:]
    ending: list[bool] = []
    for number in (signal.SIGINT, signal.SIGHUP):
        signal.signal(number, lambda *_: None)  # the parent decides; the program gets the default
    signal.signal(signal.SIGTERM, lambda *_: ending.append(True))
    child = os.fork()
    if child == 0:
        return _start(program, pipe)
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1)
    while _reap(child, pipe):
        if os.getppid() != parent:  # it was killed, and another may start the program again
            return _end(child, pipe, 0.0)
        if ending:
            return _end(child, pipe, GRACE)
        time.sleep(PAUSE)


def _start(program: Sequence[str], pipe: int) -> None:
    """Start the program, wait for its end and report its status; SIGTERM ends the program only."""
    try:
        child = subprocess.Popen(program, start_new_session=True)
    except OSError as error:
        return _tell(pipe, error=error.strerror)
    _tell(pipe, pid=child.pid)
    _tell(pipe, status=child.wait())


def _tell(pipe: int, **news: object) -> None:
    with suppress(OSError):  # the parent is gone
        os.write(pipe, (json.dumps(news) + "\n").encode())


def _reap(child: int, pipe: int) -> bool:
    """Reap what ended; return whether any process is left. Report the status of ``child``, which
    waits for the program, if somebody killed it."""
    while True:
        try:
            pid, status = os.waitpid(-1, os.WNOHANG)
        except ChildProcessError:
            return False
        if pid == 0:
            return True
        if pid == child and status:
            _tell(pipe, status=os.waitstatus_to_exitcode(status))


def _end(child: int, pipe: int, grace: float) -> None:
    """End all descendants: by SIGTERM, and what is left after ``grace`` seconds by SIGKILL."""
    began = time.monotonic()
    signal_all(descendants(os.getpid()), signal.SIGTERM)
    while _reap(child, pipe) and time.monotonic() < began + grace + KILL_LIMIT:
        if time.monotonic() >= began + grace:
            signal_all(descendants(os.getpid()), signal.SIGKILL)
        time.sleep(PAUSE)


if __name__ == "__main__":
    main()
