"""Run programs as forks of a Python process that has already imported NumPy.

A new interpreter needs a third of a second of CPU time to import NumPy. The tests of the bridge run
hundreds of programs. Each fork is set up like a new interpreter, with its own arguments,
environment, path and output. Like a new interpreter, it imports ``sitecustomize``, which loads the
hook. ``run`` starts one program. ``popen`` starts the supervisor of ``mitigate run``, which starts
its program as a fork. Some tests start new interpreters (``conftest.py``).
"""

from __future__ import annotations

import json
import os
import select
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from functools import cache
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import SimpleNamespace
from typing import IO, Any

IMPORTED = "argparse, contextlib, copy, hashlib, inspect, multiprocessing.popen_fork, numpy, uuid"


@cache
def parent() -> socket.socket:
    """Start the process that is forked for each program, and return the connection to it."""
    ours, theirs = socket.socketpair()
    code = (
        f"import sys; sys.path.insert(0, {str(Path(__file__).parent)!r}); "
        f"import {IMPORTED}; import warm; warm.serve({theirs.fileno()})"
    )
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    subprocess.Popen(
        [sys.executable, "-c", code],
        env=environment,
        pass_fds=[theirs.fileno()],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
    )
    theirs.close()
    return ours


def run(
    arguments: Sequence[str], environment: Mapping[str, str], timeout: float
) -> subprocess.CompletedProcess[str]:
    """Run a script or ``-c CODE``, like ``subprocess.run`` with one pipe for stdout and stderr.

    Raises:
        subprocess.TimeoutExpired: the program, or a process that keeps its output open, runs longer
        than the timeout.
    """
    connection = parent()
    reader, writer = os.pipe()
    pid = _fork("program", arguments, environment, [writer])
    os.close(writer)
    output, end = b"", time.monotonic() + timeout
    with open(reader, "rb", buffering=0) as pipe:
        while True:
            if not select.select([pipe], [], [], max(0.0, end - time.monotonic()))[0]:
                os.kill(pid, signal.SIGKILL)
                _line(connection)
                raise subprocess.TimeoutExpired(list(arguments), timeout, output)
            part = pipe.read(1 << 16)
            if not part:
                break
            output += part
    status = int(_line(connection))
    return subprocess.CompletedProcess(list(arguments), status, output.decode())


def _fork(
    kind: str, arguments: Sequence[str], environment: Mapping[str, str], files: list[int]
) -> int:
    """Ask the process that runs ``serve`` to fork; return the process id of the fork."""
    connection = parent()
    request = json.dumps([kind, list(arguments), dict(environment), os.getcwd()]).encode()
    socket.send_fds(connection, [len(request).to_bytes(4, "big")], files)
    connection.sendall(request)
    return int(_line(connection))


def popen(words: Sequence[str], **options: Any) -> subprocess.Popen[bytes] | Supervisor:
    """Replace ``subprocess.Popen``: start the supervisor of ``mitigate run`` as a fork."""
    if sys.platform != "linux" or list(words[:3]) != [sys.executable, "-I", "-S"]:
        return subprocess.Popen(words, **options)
    return Supervisor(words[3:], options["env"], options["stdout"], options["pass_fds"][0])


class Supervisor:
    """A forked supervisor with the methods of ``subprocess.Popen`` that are needed here; its exit
    status is unknown."""

    def __init__(
        self, words: Sequence[str], environment: Mapping[str, str], log: IO[str], pipe: int
    ) -> None:
        self.pid = _fork("supervisor", words, environment, [log.fileno(), pipe])
        self._ended = open(os.pidfd_open(self.pid), "rb")  # noqa: SIM115 - closed by ``wait``

    def poll(self) -> int | None:
        with suppress(subprocess.TimeoutExpired):
            return self.wait(0.0)
        return None

    def wait(self, timeout: float) -> int:
        if not self._ended.closed:
            if not select.select([self._ended], [], [], timeout)[0]:
                raise subprocess.TimeoutExpired("supervisor", timeout)
            self._ended.close()
        return 0

    def kill(self) -> None:
        os.kill(self.pid, signal.SIGKILL)


def _line(connection: socket.socket) -> str:
    """Read the next line that ``serve`` sent."""
    line = b""
    while not line.endswith(b"\n"):
        part = connection.recv(1)
        if not part:
            raise ChildProcessError("the fork server has died")
        line += part
    return line.decode()


def serve(descriptor: int) -> None:
    """Fork for each request until the tests end. In a fork, run the requested program and
    return."""
    connection = socket.socket(fileno=descriptor)
    while True:
        size, files, _, _ = socket.recv_fds(connection, 4, 2)
        if not size:
            return
        request = b""
        while len(request) < int.from_bytes(size, "big"):
            request += connection.recv(1 << 16)
        with suppress(ChildProcessError):
            while os.waitpid(-1, os.WNOHANG)[0]:  # supervisors that have ended
                pass
        pid = os.fork()
        if not pid:
            connection.close()
            kind, arguments, environment, folder = json.loads(request)
            os.chdir(folder)
            os.dup2(files[0], 1)
            os.dup2(files[0], 2)
            os.close(files[0])
            os.environ.clear()
            os.environ.update(environment)
            if kind == "program":
                return start(arguments)
            os.setsid()
            return supervise(arguments, files[1])
        for file in files:
            os.close(file)
        connection.sendall(f"{pid}\n".encode())
        if len(files) == 1:
            status = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
            connection.sendall(f"{status}\n".encode())


def supervise(arguments: list[str], pipe: int) -> None:
    """Run ``bridge/program.py`` in this fork; it starts the user's program with
    ``start_program``."""
    spec = spec_from_file_location("program", arguments[0])
    assert spec is not None and spec.loader is not None
    program: Any = module_from_spec(spec)
    spec.loader.exec_module(program)
    program.subprocess = SimpleNamespace(Popen=start_program)
    sys.argv = [arguments[0], str(os.getppid()), str(pipe), *arguments[3:]]
    program.main()


class Fork:
    """A program that runs in a fork of its supervisor."""

    def __init__(self, arguments: list[str]) -> None:
        self.pid = os.fork()
        if self.pid:
            return
        os.setsid()
        os.close(int(sys.argv[2]))  # close the supervisor's pipe
        signal.signal(signal.SIGINT, signal.default_int_handler)
        for number in (signal.SIGHUP, signal.SIGTERM):
            signal.signal(number, signal.SIG_DFL)
        start(arguments)
        sys.exit()

    def wait(self) -> int:
        return os.waitstatus_to_exitcode(os.waitpid(self.pid, 0)[1])


def start_program(words: list[str], start_new_session: bool) -> Fork | subprocess.Popen[bytes]:
    """Fork to run a Python script or ``-c CODE``; start any other command as a new process."""
    is_python = len(words) > 1 and words[0] == sys.executable
    if is_python and (words[1] == "-c" or Path(words[1]).is_file()):
        return Fork(words[1:])
    return subprocess.Popen(words, start_new_session=start_new_session)


def start(arguments: list[str]) -> None:
    """Run a program in this fork as a new interpreter would run ``python *arguments``."""
    import __main__

    code, name, first = arguments[1] if len(arguments) > 1 else "", "<string>", ""
    if arguments[0] != "-c":
        code, name = Path(arguments[0]).read_text("utf-8"), arguments[0]
        first = os.path.dirname(os.path.abspath(name))
    sys.argv = ["-c", *arguments[2:]] if arguments[0] == "-c" else arguments
    # removes the folder of this file and the empty entry that ``-c`` adds
    sys.path[:] = [*os.environ["PYTHONPATH"].split(os.pathsep), *sys.path[2:]]
    sys.path_importer_cache.clear()
    sys.modules.pop("sitecustomize", None)
    import sitecustomize  # noqa: F401

    sys.path.insert(0, first)
    namespace = __main__.__dict__
    namespace.clear()
    namespace.update(__name__="__main__", __builtins__=__builtins__, __spec__=None)
    if arguments[0] != "-c":
        namespace["__file__"] = name
    exec(compile(code, name, "exec"), namespace)
