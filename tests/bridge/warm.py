"""Programs as forks of a Python process that has imported NumPy already.

A new interpreter that imports NumPy needs a third of a second of CPU time, and the tests of the
bridge start hundreds. A fork gets the arguments, the environment, the path and the output of a new
interpreter. It imports ``sitecustomize`` as an interpreter does when it starts, and so the hook.
The tests of ``mitigate run`` start new interpreters.
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
from functools import cache
from pathlib import Path

IMPORTED = "argparse, contextlib, copy, hashlib, inspect, multiprocessing.popen_fork, numpy, uuid"


@cache
def parent() -> socket.socket:
    """Start the process that forks, and return the connection to it."""
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
    """Run a script, or ``-c`` and code, like ``subprocess.run`` with one pipe for all output.

    Raises:
        subprocess.TimeoutExpired: the program, or a process that holds its output, runs longer.
    """
    connection = parent()
    reader, writer = os.pipe()
    request = json.dumps([list(arguments), dict(environment), os.getcwd()]).encode()
    socket.send_fds(connection, [len(request).to_bytes(4, "big")], [writer])
    connection.sendall(request)
    os.close(writer)
    pid = int(_line(connection))
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


def _line(connection: socket.socket) -> str:
    """Return the next line that ``serve`` sent."""
    line = b""
    while not line.endswith(b"\n"):
        part = connection.recv(1)
        if not part:
            raise ChildProcessError("the process that forks has died")
        line += part
    return line.decode()


def serve(descriptor: int) -> None:
    """Fork for each request, until the tests end; in a fork, run its program and return."""
    connection = socket.socket(fileno=descriptor)
    while True:
        size, descriptors, _, _ = socket.recv_fds(connection, 4, 1)
        if not size:
            return
        request = b""
        while len(request) < int.from_bytes(size, "big"):
            request += connection.recv(1 << 16)
        pid = os.fork()
        if not pid:
            connection.close()
            return start(*json.loads(request), descriptors[0])
        os.close(descriptors[0])
        connection.sendall(f"{pid}\n".encode())
        status = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
        connection.sendall(f"{status}\n".encode())


def start(arguments: list[str], environment: dict[str, str], folder: str, output: int) -> None:
    """Run a program in this fork as ``python`` with ``arguments`` does in a new interpreter."""
    import __main__

    os.dup2(output, 1)
    os.dup2(output, 2)
    os.close(output)
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    code, name, first = arguments[1], "<string>", ""
    if arguments[0] != "-c":
        code, name = Path(arguments[0]).read_text("utf-8"), arguments[0]
        first = os.path.dirname(name)
    sys.argv = ["-c", *arguments[2:]] if arguments[0] == "-c" else arguments
    # without the folder of this file and the empty entry of ``-c``
    path = [*environment["PYTHONPATH"].split(os.pathsep), *sys.path[2:]]
    sys.path[:] = path
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
