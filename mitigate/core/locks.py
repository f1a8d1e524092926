"""Lock a folder for one process, and delete unfinished files of killed processes."""

from __future__ import annotations

import fcntl
import json
import os
import re
import shlex
import shutil
import socket
import sys
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import IO

from mitigate.core import output
from mitigate.core.files import make_folder
from mitigate.core.names import escaped
from mitigate.core.output import writing

NAME = ".lock"
# Names of unfinished files, as mitigate/core/files.py writes them.
_DRAFT = re.compile(r"\..+\.(\d+)\.tmp")
# These are the locks of this process.
# A record lock does not prevent the same process from locking again.
# The process loses a lock when it closes any file descriptor of the locked file.
_locks: dict[Path, IO[str]] = {}


class FolderLock:
    """Context manager that creates ``folder`` and locks it while a process writes to it.

    The lock is a record lock of the system (``fcntl``) on a file in the folder. The system releases
    the lock when the process ends, even if the process is killed. Worker processes do not inherit
    the lock. The lock also excludes processes on other machines if the file system supports this.
    On a file system without locks, nothing is locked.

    While a folder is locked, every write below the folder checks that the folder and the lock file
    are still the same (``core/output.py``). The same check is made at the end of the block.

    If the block raises an error before it has written anything, the folders that the lock created
    are deleted again.

    Args:
        folder: the folder.
        within: names of subfolders to which the process also writes.

    Raises:
        ValueError: If a different process has the lock (the message names it), or the lock file is
            not a regular file.
        OSError: If the folder cannot be written.
        FolderLostError: If the folder was removed.
    """

    def __init__(self, folder: str | Path, within: Iterable[str] = ()) -> None:
        self.folder = Path(folder)
        self.within = tuple(within)
        self.path = self.folder.resolve() / NAME
        self._file: IO[str] | None = None
        self._root: output.Root | None = None
        self._created: list[Path] = []

    def __enter__(self) -> FolderLock:
        self._created = [path for path in (self.folder, *self.folder.parents) if not path.exists()]
        make_folder(self.folder)
        if self.path in _locks:
            raise ValueError(self._in_use_message(_locks[self.path]))
        while True:
            with writing(self.folder):
                file = output.open_output(self.path, "a+", encoding="utf-8")
            try:
                fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except (BlockingIOError, PermissionError):
                problem = self._in_use_message(file)
                file.close()
                raise ValueError(problem) from None
            except OSError:  # the file system does not support locks
                file.close()
                self._root = output.register(self.folder)
                return self
            if output.is_same(os.fstat(file.fileno()), self.path):
                break
            file.close()  # the previous process has just deleted the lock file
        self._file = file
        _locks[self.path] = file
        file.truncate(0)
        command = shlex.join([Path(sys.argv[0]).name, *sys.argv[1:]])
        json.dump({"pid": os.getpid(), "host": socket.gethostname(), "command": command}, file)
        file.flush()
        self._root = output.register(self.folder, file)
        delete_leftovers(self.folder, self.within)
        return self

    def expect(self, *paths: Path) -> None:
        """Register files that must exist at the end of the block."""
        if self._root is not None:
            self._root.expected += paths

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        try:
            if self._root is not None and kind is None:
                self._root.check_expected()
        finally:
            self._leave()
            if kind is not None:
                with suppress(OSError):  # delete empty folders, innermost first
                    for folder in self._created:
                        folder.rmdir()

    def _leave(self) -> None:
        if self._root is not None:
            output.unregister(self._root)
            self._root = None
        if self._file is not None:
            status = os.fstat(self._file.fileno())
            # if the lock file was replaced, it belongs to another process and must stay
            if output.is_same(status, self.path):
                self.path.unlink(missing_ok=True)
            _locks.pop(self.path, None)
            self._file.close()
            self._file = None

    def _in_use_message(self, file: IO[str]) -> str:
        """Return the error message for a lock that another process holds."""
        file.seek(0)
        try:
            note = json.loads(file.read(4096))
            host, command = escaped(str(note["host"]), 60), escaped(str(note["command"]))
            who = f"process {int(note['pid'])} on {host} ({command})"
        except (ValueError, TypeError, KeyError, OverflowError, RecursionError):
            who = "another process"
        return (
            f"{self.folder} is in use: {who} is writing there. Wait for it or stop it, or choose "
            "another folder (folder=... for a training run, out=... for an evaluation)."
        )


def delete_leftovers(folder: Path, within: Iterable[str] = ()) -> list[Path]:
    """Delete unfinished files in ``folder`` whose processes have ended, and return their paths.

    The subfolders ``within`` are also searched, unless they have their own lock. Deeper folders are
    not searched.

    Call this only while this process holds the lock. An unfinished file with the id of this
    process is then left from an earlier process that had the same id, for example before a
    container restarted.
    """
    inside = [folder / name for name in within]
    inside = [p for p in inside if not (p.is_symlink() or (p / NAME).exists())]
    drafts = [path for place in (folder, *inside) for path in place.glob(".*.tmp")]
    return delete_abandoned(drafts, ours=True)


def delete_abandoned(drafts: Iterable[Path], ours: bool = False) -> list[Path]:
    """Delete those ``drafts`` whose processes have ended, and return their paths.

    Args:
        drafts: Paths that may be unfinished files of ``mitigate/core/files.py``.
        ours: Also delete drafts of this process.
    """
    abandoned = []
    for path in drafts:
        name = _DRAFT.fullmatch(path.name)
        if name and ((ours and int(name[1]) == os.getpid()) or not is_alive(int(name[1]))):
            abandoned.append(path)
    for path in abandoned:
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path, ignore_errors=True)
        else:
            path.unlink(missing_ok=True)
    return abandoned


def is_alive(pid: int) -> bool:
    """Return whether a process with the id ``pid``, of any user, runs on this machine."""
    try:
        os.kill(pid, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except PermissionError:
        return True
    return pid > 0
