"""Run the user's program, and end it and all its descendant processes.

``Command`` starts the program under a supervisor, a second process that runs this file::

    python program.py PARENT PIPE PROGRAM ...

A process that detaches itself (``setsid``, a double fork, ``nohup ... &``) leaves its session. When
the parent of such a process ends, the process is no longer a descendant of the command. The
supervisor is a child subreaper (prctl(2), Linux): such orphans become its children, so the
supervisor knows every descendant. The supervisor runs until the last descendant has ended. The
supervisor ends all descendants when it receives SIGTERM, or when PARENT, the process that started
it, has ended.

A fork of the supervisor starts the program and waits for it. If the program kills its parent, it
kills only this fork, and the supervisor stays alive.

The supervisor writes JSON lines to the file descriptor PIPE: first ``{"pid": N}`` or ``{"error":
TEXT}``, and ``{"status": N}`` when the program ends. The supervisor runs without other packages, so
this file imports only the standard library.
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
KILL_LIMIT = 10.0  # seconds after which killed processes must be gone (heuristic)
PAUSE = 0.05  # seconds between two checks
MAX_LINE = 200  # maximum length of a process's command line in a message, in characters


class Command:
    """Starts a command under a supervisor, and ends all of its processes.

    A process belongs to the command if it is a descendant of the command, or if its environment
    contains ``marker``. The marker identifies processes in a container, and processes that outlive
    the supervisor.

    Args:
        words: The command and its arguments.
        log: File that receives the output of the command.
        environment: All environment variables of the command.
        marker: A value in ``environment`` that no other command has; it identifies the processes of
            this command.

    Raises:
        OSError: If the command cannot be started.
    """

    def __init__(
        self, words: Sequence[str], log: IO[str], environment: Mapping[str, str], marker: str
    ) -> None:
        self.marker = marker.encode()
        self._status: int | None = None
        reader, writer = os.pipe()
        self._pipe = open(reader, "rb")  # noqa: SIM115 - closed by ``end``
        supervisor = [sys.executable, "-I", "-S", __file__, str(os.getpid()), str(writer)]
        try:
            self.process = subprocess.Popen(
                [*supervisor, *words],
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
        os.set_blocking(reader, False)

    def status(self) -> int | None:
        """Return the exit status of the command (negative for a signal), or None while it runs.

        Processes that the command started may still run.
        """
        if self._status is None:
            # poll before reading: if the supervisor has ended, its last line is then in the pipe
            supervisor_status = self.process.poll()
            line = self._next()
            if "status" in line:
                self._status = int(line["status"])
            elif supervisor_status is not None:  # the supervisor was killed
                self._status = supervisor_status or 1
        return self._status

    def running(self) -> list[int]:
        """Return the pids of all running processes that belong to the command."""
        known = descendants(self.process.pid)
        return sorted({*known, *_marked(self.marker)} - {self.process.pid, os.getpid()})

    def left(self) -> list[str]:
        """Wait up to ``GRACE`` seconds for all processes to end; describe those that remain."""
        until = time.monotonic() + GRACE
        while (pids := self.running()) and time.monotonic() < until:
            time.sleep(PAUSE)
        return [_describe(pid) for pid in pids]

    def end(self, connected: Callable[[], bool]) -> None:
        """End all processes with SIGTERM, and after ``GRACE`` with SIGKILL.

        Args:
            connected: Function that returns whether any of the processes is connected to the
                bridge. If the command has ended and no process is connected, SIGKILL follows at
                once.
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
        # a process of a different user keeps the supervisor alive
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.status()
        self._pipe.close()

    def _next(self) -> dict[str, Any]:
        """Return the content of the supervisor's next line, or {} if there is no new line.

        The supervisor writes a whole line in one call, so a part of a line is never read.
        """
        line = b"" if self._pipe.closed else self._pipe.readline()
        message: dict[str, Any] = json.loads(line) if line else {}
        return message


def _marked(marker: bytes) -> list[int]:
    """Return the pids of this user's processes whose environment contains ``marker``."""
    pids = []
    for folder in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            if marker in (folder / "environ").read_bytes():
                pids.append(int(folder.name))
    known = processes() if pids else {}
    return [pid for pid in pids if pid in known and known[pid][1]]


def _describe(pid: int) -> str:
    """Describe a process by its pid and its shortened command line."""
    words = b""
    with suppress(OSError):
        words = Path(f"/proc/{pid}/cmdline").read_bytes().strip(b"\0").replace(b"\0", b" ")
    text = "".join(c if c.isprintable() else " " for c in words.decode(errors="replace"))
    short = text if len(text) <= MAX_LINE else f"{text[:MAX_LINE]}..."
    return f"{short or 'a process'} (pid {pid})"


def processes() -> dict[int, tuple[int, bool]]:
    """Map each pid to its parent's pid and whether it runs (a zombie does not)."""
    states = {}
    for name in os.listdir("/proc"):
        if name.isdigit():
            with (
                suppress(OSError, ValueError, IndexError),
                open(f"/proc/{name}/stat", "rb") as file,
            ):
                text = file.read()
                fields = text[text.rindex(b")") + 2 :].split()  # proc_pid_stat(5), from field 3
                # if the main thread has ended but other threads remain, the process still runs
                zombie = fields[0] in (b"Z", b"X") and int(fields[17]) <= 1
                states[int(name)] = (int(fields[1]), not zombie)
    return states


def descendants(root: int) -> list[int]:
    """Return the pids of the running descendants of the process ``root``, without ``root``."""
    known = processes()
    children: dict[int, list[int]] = {}
    for pid, (parent, _) in known.items():
        children.setdefault(parent, []).append(pid)
    running: list[int] = []
    parents = [root]
    while parents:
        next_pids = children.get(parents.pop(), [])
        parents += next_pids
        running += [pid for pid in next_pids if known[pid][1]]
    return running


def signal_all(pids: Iterable[int], number: int) -> None:
    """Send a signal to processes; ignore those that have ended or belong to another user."""
    for pid in pids:
        with suppress(ProcessLookupError, PermissionError):
            os.kill(pid, number)


def main() -> None:
    """Run the program that the supervisor's command line names."""
    parent = int(sys.argv[1])
    pipe = int(sys.argv[2])
    program = sys.argv[3:]
    ending: list[bool] = []
    for number in (signal.SIGINT, signal.SIGHUP):
        # PARENT handles these signals, so the supervisor ignores them with an empty handler.
        # SIG_IGN is not used, because the program would inherit it.
        signal.signal(number, lambda *_: None)
    signal.signal(signal.SIGTERM, lambda *_: ending.append(True))
    child = os.fork()
    if child == 0:
        return _start(program, pipe)
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1)
    while _reap(child, pipe):
        if os.getppid() != parent:
            # PARENT was killed: end the command at once, because the user may start the run again
            return _end(child, pipe, 0.0)
        if ending:
            return _end(child, pipe, GRACE)
        time.sleep(PAUSE)


def _start(program: Sequence[str], pipe: int) -> None:
    """Start the program, wait until it ends, and report its status, even after SIGTERM."""
    try:
        child = subprocess.Popen(program, start_new_session=True)
    except OSError as error:
        return _report(pipe, error=error.strerror)
    _report(pipe, pid=child.pid)
    _report(pipe, status=child.wait())


def _report(pipe: int, **message: object) -> None:
    with suppress(OSError):  # the parent has ended
        os.write(pipe, (json.dumps(message) + "\n").encode())


def _reap(child: int, pipe: int) -> bool:
    """Reap ended processes; return whether any process still runs.

    The forked process ``child`` reports the exit status of the program. If the forked process
    itself failed or was killed, this function reports the status of the forked process instead.
    """
    while True:
        try:
            pid, status = os.waitpid(-1, os.WNOHANG)
        except ChildProcessError:
            return False
        if pid == 0:
            return True
        if pid == child and status:
            _report(pipe, status=os.waitstatus_to_exitcode(status))


def _end(child: int, pipe: int, grace: float) -> None:
    """End all descendants with SIGTERM, and after ``grace`` seconds with SIGKILL."""
    began = time.monotonic()
    signal_all(descendants(os.getpid()), signal.SIGTERM)
    while _reap(child, pipe) and time.monotonic() < began + grace + KILL_LIMIT:
        if time.monotonic() >= began + grace:
            signal_all(descendants(os.getpid()), signal.SIGKILL)
        time.sleep(PAUSE)


if __name__ == "__main__":
    main()
