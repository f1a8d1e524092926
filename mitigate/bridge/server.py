"""The server of the bridge, with one process per connection, so that connections are independent.

A ``Listener`` serves one user command while it runs. A process that connects must send the
listener's token. The listener forks one process per connection. Corruptions can therefore use all
cores, and an error is reported and ends only one environment.
"""

from __future__ import annotations

import os
import secrets
import shutil
import signal
import socket
import tempfile
import traceback
from contextlib import suppress
from pathlib import Path

import numpy as np

from mitigate.bridge.condition import Condition
from mitigate.bridge.connection import Connection
from mitigate.bridge.hook import mitigate_hook
from mitigate.core.files import make_folder
from mitigate.core.signals import raise_ended
from mitigate.corruptions import FrameStream

HOOK = Path(mitigate_hook.__file__).parent
# exists on Linux; on other systems, the folder for temporary files is used
MEMORY = Path("/dev/shm")


class Listener:
    """Server for the processes of a command; it runs in a separate process until it is closed.

    Events are written to ``folder``. A process of the command waits ``patience`` seconds for an
    answer before it stops.
    """

    def __init__(self, condition: Condition, folder: Path, patience: float = 25.0) -> None:
        self.condition = condition
        self.folder = folder
        self.patience = patience
        self.token = secrets.token_hex(16)
        # a socket path has <= 107 bytes, unix(7)
        temporary = tempfile.gettempdir() if len(tempfile.gettempdir()) < 60 else "/tmp"
        self.socket_folder = Path(tempfile.mkdtemp(prefix="mitigate-", dir=temporary))
        shared = MEMORY if MEMORY.is_dir() and os.access(MEMORY, os.W_OK) else None
        self.memory = Path(tempfile.mkdtemp(prefix="mitigate-", dir=shared))
        self.address = str(self.socket_folder / "bridge")
        self.pid = 0

    def __enter__(self) -> Listener:
        # compile the code of the corruption before the command waits for answers
        frames = {"rgb": np.zeros((32, 32, 3), np.uint8), "depth": np.ones((32, 32, 1), np.float32)}
        FrameStream().corrupt(frames, self.condition.corruption, 0)
        listening = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        listening.bind(self.address)  # the socket is in a folder that only this user can access
        os.chmod(self.address, 0o600)
        listening.listen(256)
        make_folder(self.folder)
        self.pid = os.fork()
        if self.pid == 0:
            try:
                os.setpgid(0, 0)
                signal.signal(signal.SIGINT, signal.SIG_DFL)
                signal.signal(signal.SIGTERM, signal.SIG_DFL)
                # the parent does not wait for its forks
                signal.signal(signal.SIGCHLD, signal.SIG_IGN)
                self._accept(listening)
            except BaseException:
                traceback.print_exc()
            finally:
                os._exit(1)
        listening.close()
        # the child has already done this, or it has ended
        with suppress(PermissionError, ProcessLookupError):
            os.setpgid(self.pid, self.pid)  # its forks are in the same group and end with it
        return self

    def __exit__(self, *_: object) -> None:
        if self.pid:
            with suppress(ProcessLookupError):
                os.killpg(self.pid, signal.SIGKILL)
            with suppress(ChildProcessError):
                os.waitpid(self.pid, 0)
            self.pid = 0
        self._delete_folders()

    def _delete_folders(self) -> None:
        shutil.rmtree(self.socket_folder, ignore_errors=True)
        shutil.rmtree(self.memory, ignore_errors=True)

    def close_connections(self) -> None:
        """End all connections; each connection then records its unfinished episode."""
        with suppress(ProcessLookupError):
            os.killpg(self.pid, signal.SIGTERM)

    def is_alive(self) -> bool:
        """Return whether the server is still running."""
        with suppress(ChildProcessError):
            return os.waitpid(self.pid, os.WNOHANG) == (0, 0)
        return False

    def was_loaded(self) -> bool:
        """Return whether a Python process of the command loaded the hook."""
        return (self.socket_folder / mitigate_hook.LOADED).exists()

    def environment(self) -> dict[str, str]:
        """Return the environment variables that the command's processes need."""
        path = filter(None, [str(HOOK), os.environ.get("PYTHONPATH")])
        return {
            mitigate_hook.ADDRESS: self.address,
            mitigate_hook.TOKEN: self.token,
            mitigate_hook.PATIENCE: f"{self.patience:g}",
            "PYTHONPATH": os.pathsep.join(path),
        }

    def _accept(self, listening: socket.socket) -> None:
        parent = os.getppid()
        listening.settimeout(1.0)
        while True:
            try:
                channel, _ = listening.accept()
            except TimeoutError:
                if os.getppid() != parent:  # the parent was killed before it could end this process
                    self._delete_folders()
                    os.killpg(0, signal.SIGKILL)
                continue
            channel.setblocking(True)
            if os.fork() == 0:
                listening.close()
                signal.signal(signal.SIGTERM, raise_ended)  # this records an unfinished episode
                settings = (self.condition, self.folder, self.token, self.memory)
                try:
                    Connection(channel, *settings).serve()
                finally:
                    os._exit(0)
            channel.close()
