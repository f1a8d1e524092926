"""One process at a time in a folder, and nothing left there of those that were killed."""

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
from pathlib import Path
from typing import IO

from mitigate.core import output
from mitigate.core.files import make_folder
from mitigate.core.output import writing

NAME = ".lock"
_LEFT = re.compile(r"\..+\.(\d+)\.tmp")  # as mitigate/core/files.py names what is not yet whole
# by this process, which a record lock would let in twice, and which would lose it with any file of
# that path that it closes
_held: dict[Path, IO[str]] = {}


class FolderLock:
    """Use it as a context manager around all that is written to ``folder``, which it makes, and to
    the folders of the names ``within`` it.

    It is a record lock of the system (``fcntl``) on a file in the folder: it ends with its process,
    however that ends, is not inherited by workers, and holds for other machines where the file
    system has locks for them. Where it has none, nothing is locked.

    While it is held, every write below the folder checks that folder and lock are still the same
    (``core/output.py``), as does the end of the block.

    Raises ValueError, naming the process, if another one is there or if the lock file is not a
    regular file; OSError if the folder cannot be written; FolderLostError if it was removed.
    """

    def __init__(self, folder: str | Path, within: Iterable[str] = ()) -> None:
        self.folder, self.within = Path(folder), tuple(within)
        self.path = self.folder.resolve() / NAME
        self._file: IO[str] | None = None
        self._root: output.Root | None = None

    def __enter__(self) -> FolderLock:
        make_folder(self.folder)
        if self.path in _held:
            raise ValueError(self._taken(_held[self.path]))
        while True:
            with writing(self.folder):
                file = output.open_output(self.path, "a+", encoding="utf-8")
            try:
                fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except (BlockingIOError, PermissionError):
                problem = self._taken(file)
                file.close()
                raise ValueError(problem) from None
            except OSError:  # a file system without locks
                file.close()
                self._root = output.register(self.folder)
                return self
            if output.is_same(os.fstat(file.fileno()), self.path):
                break
            file.close()  # the one before us deleted it in this moment
        self._file = file
        _held[self.path] = file
        file.truncate(0)
        json.dump({"pid": os.getpid(), "host": socket.gethostname(), "command": _command()}, file)
        file.flush()
        self._root = output.register(self.folder, file)
        delete_leftovers(self.folder, self.within)
        return self

    def expect(self, *paths: Path) -> None:
        """Have the end of the block check that the files ``paths`` exist."""
        if self._root is not None:
            self._root.expected += paths

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        try:
            if self._root is not None and kind is None:
                self._root.check_expected()
        finally:
            self._leave()

    def _leave(self) -> None:
        if self._root is not None:
            output.unregister(self._root)
            self._root = None
        if self._file is not None:
            status = os.fstat(self._file.fileno())
            if output.is_same(status, self.path):  # else it is the lock of another process
                self.path.unlink(missing_ok=True)
            _held.pop(self.path, None)
            self._file.close()
            self._file = None

    def _taken(self, file: IO[str]) -> str:
        file.seek(0)
        try:
            note = json.loads(file.read(4096))
            who = f"process {int(note['pid'])} on {note['host']!s:.60} ({note['command']!s:.200})"
        except (ValueError, TypeError, KeyError):
            who = "another process"
        return (
            f"{self.folder} is in use: {who} is writing there. Wait for it or stop it, or name "
            "another folder (folder=... of a training, out=... of an evaluation)."
        )


def delete_leftovers(folder: Path, within: Iterable[str] = ()) -> list[Path]:
    """Delete what processes that are no more left in mid-write in ``folder``, and in those of the
    names ``within`` it that are no run of their own; return it. Nothing further below is theirs.

    Call it with the lock: what has the number of this process is of one before it, as in a
    container that is started again.
    """
    inside = [folder / name for name in within if not (folder / name / NAME).exists()]
    inside = [place for place in inside if not place.is_symlink()]
    drafts = [path for place in (folder, *inside) for path in place.glob(".*.tmp")]
    return delete_abandoned(drafts, own=True)


def delete_abandoned(drafts: Iterable[Path], own: bool = False) -> list[Path]:
    """Delete those of ``drafts`` whose process is no more; return them.

    Args:
        drafts: Files and folders that may be drafts of ``mitigate/core/files.py``.
        own: Whether drafts of this process are abandoned too.
    """
    abandoned = []
    for path in drafts:
        name = _LEFT.fullmatch(path.name)
        if name and ((own and int(name[1]) == os.getpid()) or not is_alive(int(name[1]))):
            abandoned.append(path)
    for path in abandoned:
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path, ignore_errors=True)
        else:
            path.unlink(missing_ok=True)
    return abandoned


def is_alive(pid: int) -> bool:
    """Whether there is such a process on this machine, of any user."""
    try:
        os.kill(pid, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except PermissionError:
        return True
    return pid > 0


def _command() -> str:
    return shlex.join([Path(sys.argv[0]).name, *sys.argv[1:]])
