"""The server's side of the bridge: a process for each connection, so that one cannot harm another.

``Listener`` runs beside one command of the user's. What connects must know its token. Every
connection is served by a fork: corruptions run side by side on all cores, and a fault ends one
environment with a message.
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
from mitigate.corruptions import Corruption
from mitigate.corruptions.suite import corrupt

HOOK = Path(mitigate_hook.__file__).parent
MEMORY = Path("/dev/shm")  # Linux; elsewhere the folder for temporary files


class Listener:
    """Serves what connects, in a process of its own, until it is closed.

    Args: condition: what the command meets. folder: gets the events, a JSON line for each thing
    that happened. ``environment`` is what the command's processes need.
    """

    def __init__(self, condition: Condition, folder: Path, patience: float = 25.0) -> None:
        self.condition, self.folder, self.patience = condition, folder, patience
        self.token = secrets.token_hex(16)
        self.place = Path(tempfile.mkdtemp(prefix="mitigate-", dir=_short(tempfile.gettempdir())))
        self.memory = _memory_folder()
        self.address = str(self.place / "bridge")
        self.pid = 0

    def __enter__(self) -> Listener:
        listening = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        listening.bind(self.address)  # in a folder that only this user may enter
        os.chmod(self.address, 0o600)
        listening.listen(256)
        make_folder(self.folder)
        self.pid = os.fork()
        if self.pid == 0:
            try:
                os.setpgid(0, 0)
                signal.signal(signal.SIGINT, signal.SIG_DFL)
                signal.signal(signal.SIGTERM, signal.SIG_DFL)
                signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # nobody waits for connections
                self._accept(listening)
            except BaseException:
                traceback.print_exc()
            finally:
                os._exit(1)
        listening.close()
        with suppress(PermissionError, ProcessLookupError):  # the child did, or is gone
            os.setpgid(self.pid, self.pid)  # whoever comes first: its forks end with it
        return self

    def __exit__(self, *_: object) -> None:
        if self.pid:
            with suppress(ProcessLookupError):
                os.killpg(self.pid, signal.SIGKILL)
            with suppress(ChildProcessError):
                os.waitpid(self.pid, 0)
            self.pid = 0
        self._forget()

    def _forget(self) -> None:
        """Delete what it made."""
        shutil.rmtree(self.place, ignore_errors=True)
        shutil.rmtree(self.memory, ignore_errors=True)

    def close_connections(self) -> None:
        """Have connections note what is left in the middle, and end."""
        with suppress(ProcessLookupError):
            os.killpg(self.pid, signal.SIGTERM)

    def is_alive(self) -> bool:
        """Whether it still serves."""
        with suppress(ChildProcessError):
            return os.waitpid(self.pid, os.WNOHANG) == (0, 0)
        return False

    def was_loaded(self) -> bool:
        """Whether a Python process of the command loaded the hook."""
        return (self.place / mitigate_hook.LOADED).exists()

    def environment(self) -> dict[str, str]:
        """What the command's environment must hold."""
        path = os.environ.get("PYTHONPATH", "")
        return {
            mitigate_hook.ADDRESS: self.address,
            mitigate_hook.TOKEN: self.token,
            mitigate_hook.PATIENCE: f"{self.patience:g}",
            "PYTHONPATH": os.pathsep.join([str(HOOK), *([path] if path else [])]),
        }

    def _accept(self, listening: socket.socket) -> None:
        parent = os.getppid()
        warm(self.condition.corruption)
        listening.settimeout(1.0)
        while True:
            try:
                channel, _ = listening.accept()
            except TimeoutError:
                if os.getppid() != parent:  # killed without a chance to end us
                    self._forget()
                    os.killpg(0, signal.SIGKILL)
                continue
            channel.setblocking(True)
            if os.fork() == 0:
                listening.close()
                signal.signal(signal.SIGTERM, raise_ended)  # it notes what is left in the middle
                try:
                    Connection(
                        channel, self.condition, self.folder, self.token, self.memory
                    ).serve()
                finally:
                    os._exit(0)
            channel.close()


def _memory_folder() -> Path:
    parent = str(MEMORY) if MEMORY.is_dir() and os.access(MEMORY, os.W_OK) else None
    return Path(tempfile.mkdtemp(prefix="mitigate-", dir=parent))


def _short(folder: str) -> str:
    """The address of a socket has at most 107 bytes (unix(7))."""
    return folder if len(folder) < 60 else "/tmp"


def warm(corruption: Corruption) -> None:
    """Compile what the corruption needs, before anyone waits for it."""
    rgb, depth = np.zeros((32, 32, 3), np.uint8), np.ones((32, 32, 1), np.float32)
    frames: dict[str, np.ndarray] = {"rgb": rgb, "depth": depth}
    for part in corruption.parts:
        if part.modality in frames:
            corrupt(frames[part.modality], part.name, part.severity, key=0)
