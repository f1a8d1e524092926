"""Open files for writing, and notice when an output folder disappears.

Every file that is written in place goes through :func:`open_output`, and every file that replaces
an existing file goes through ``mitigate/core/files.py``. A folder that was cloned or unpacked may
contain links, FIFOs and devices instead of our files. Links, FIFOs and devices are rejected before
anything is written.
"""

from __future__ import annotations

import os
import shutil
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any

_KINDS = (
    (stat.S_ISLNK, "a symbolic link"),
    (stat.S_ISFIFO, "a FIFO"),
    (stat.S_ISSOCK, "a socket"),
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
)


class UnsafePathError(ValueError):
    """Raised for an output path that is a link, a FIFO or a device, or goes through a link."""


class FolderLostError(OSError):
    """Raised if another process removed or replaced an output folder or a command's files in it."""


@dataclass
class Root:
    """An output folder that this process uses."""

    folder: Path  # the path as the user wrote it; it may be a link
    places: tuple[Path, ...]  # absolute paths of the folder: as written, and with links resolved
    # open file descriptor of the folder; while it is open, the inode is not reused
    descriptor: int
    # path and status of the lock file, or None without a lock
    lock: tuple[Path, os.stat_result] | None = None
    # files and folders that must exist when the command ends
    expected: list[Path] = field(default_factory=list)
    # subfolders that an earlier check found; they must not disappear
    seen: set[Path] = field(default_factory=set)

    def inner(self, path: Path) -> Path | None:
        """Return the absolute ``path`` relative to the folder, or None if it lies outside."""
        inner = (path.relative_to(p) for p in self.places if path.is_relative_to(p))
        return next(inner, None)

    def check(self) -> None:
        """Raise FolderLostError if the folder or its lock file was removed or replaced."""
        if not is_same(os.fstat(self.descriptor), self.places[0], follow_links=True):
            raise lost(self.folder)
        if self.lock is not None and not is_same(self.lock[1], self.lock[0]):
            raise lost(self.lock[0])

    def check_inside(self, inner: Path) -> None:
        """Check each folder along ``inner``, a path relative to the output folder.

        Raises:
            UnsafePathError: If one of these folders is a link or is not a folder.
            FolderLostError: If a folder that was checked earlier is missing now.
        """
        place = self.places[0]
        for part in inner.parts:
            place = place / part
            try:
                mode = os.lstat(place).st_mode
            except FileNotFoundError:
                if place in self.seen:
                    raise lost(place) from None
                return
            if not stat.S_ISDIR(mode):
                raise UnsafePathError(
                    f"{place} must be a folder, got {_kind(mode)}. {self.folder} itself may be a "
                    f"link, but must not contain links. Delete {place} and run the command again."
                )
            self.seen.add(place)

    def check_expected(self) -> None:
        """Raise FolderLostError if an expected file or folder is missing."""
        self.check()
        missing = [path for path in self.expected if not path.exists()]
        if missing:
            raise lost(*missing)


_roots: list[Root] = []


def is_same(status: os.stat_result, path: Path, follow_links: bool = False) -> bool:
    """Return whether ``path`` is still the file or folder that ``status`` describes."""
    try:
        return os.path.samestat(status, os.stat(path, follow_symlinks=follow_links))
    except (FileNotFoundError, NotADirectoryError):
        return False


def lost(*paths: Path) -> FolderLostError:
    """Return the error for files or folders that another process removed."""
    names = ", ".join(map(str, paths))
    verb = "was" if len(paths) == 1 else "were"
    return FolderLostError(
        f"{names} {verb} removed or replaced while this command was writing there, so its results "
        "are incomplete. Restore what was removed if you have a copy, check that no other program "
        "cleans this folder, and run the same command again."
    )


def register(folder: Path | str, lock: IO[str] | None = None) -> Root:
    """Watch an existing ``folder`` until :func:`unregister`.

    While the folder is watched, every write below it checks that the folder and its ``lock`` are
    unchanged, and that no subfolder on the path is a link.
    """
    folder = Path(folder)
    places = (Path(os.path.abspath(folder)), folder.resolve())
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    lock_state = None if lock is None else (Path(lock.name), os.fstat(lock.fileno()))
    root = Root(folder, places, descriptor, lock_state)
    _roots.append(root)
    return root


def unregister(root: Root) -> None:
    """Stop watching a folder."""
    if root in _roots:
        _roots.remove(root)
        os.close(root.descriptor)


@contextmanager
def writing(path: Path | str) -> Iterator[None]:
    """Explain system errors that occur while the block writes the file or folder ``path``.

    The error keeps its type. Its message states that the path cannot be written, and what to do.
    """
    try:
        yield
    except OSError as error:
        if error.strerror is None:  # the error already has an explanation
            raise
        raise type(error)(
            f"Cannot write {path}: {error.strerror}. Free some space, change the permissions, or "
            "choose another folder. Results that were already written are intact."
        ) from error


@contextmanager
def output_folder(folder: Path | str, *expected: str) -> Iterator[Root]:
    """Create ``folder`` and watch it while the block runs.

    Args:
        folder: the folder that the user named; it may be a link.
        expected: names of files that must be in the folder when the block ends.

    Raises:
        FolderLostError: If the folder was removed or replaced while the block ran.
    """
    folder = Path(folder)
    with writing(folder):
        make_checked(folder)
    root = register(folder)
    root.expected += [folder / name for name in expected]
    try:
        yield root
        root.check_expected()
    finally:
        unregister(root)


def check(path: Path | str) -> None:
    """Check the parent folder of ``path`` before writing to ``path``.

    Raises:
        FolderLostError: If an output folder that is in use was removed or replaced.
        UnsafePathError: If a folder between the output folder and ``path`` is a link.
    """
    _check_folder(Path(os.path.abspath(path)).parent)


def make_checked(folder: Path | str) -> None:
    """Create ``folder`` and its parents if needed. Raises the same errors as :func:`check`."""
    _check_folder(Path(os.path.abspath(folder)))
    Path(folder).mkdir(parents=True, exist_ok=True)
    _check_folder(Path(os.path.abspath(folder)))


def forget(folder: Path | str) -> None:
    """Declare that ``folder`` will be deleted, so that its absence is not reported as an error."""
    folder = Path(os.path.abspath(folder))
    for root in _roots:
        root.seen = {path for path in root.seen if not path.is_relative_to(folder)}


def delete_folder(folder: Path | str) -> None:
    """Delete ``folder`` with its content, if it exists. Links are never followed.

    Raises:
        UnsafePathError: If ``folder`` is a symbolic link, a FIFO or a file, or its path goes
            through a symbolic link inside an output folder. Nothing was deleted.
        FolderLostError: If the output folder was removed or replaced.
    """
    check(folder)
    try:
        mode = os.lstat(folder).st_mode
    except FileNotFoundError:
        return
    if not stat.S_ISDIR(mode):
        raise UnsafePathError(
            f"{folder} must be a folder, got {_kind(mode)}. Nothing was deleted. Delete {folder} "
            "and run the command again."
        )
    forget(folder)
    shutil.rmtree(folder, ignore_errors=True)


def is_regular(path: Path | str) -> bool:
    """Return whether the file ``path`` exists; links are followed.

    Raises:
        UnsafePathError: If ``path`` is a FIFO, a socket or a device, since reading it could block
            forever.
    """
    try:
        mode = os.stat(path).st_mode
    except (FileNotFoundError, NotADirectoryError):
        return False
    if not stat.S_ISREG(mode) and not stat.S_ISDIR(mode):
        raise UnsafePathError(
            f"{path} must be a regular file, got {_kind(mode)}. Reading it could block forever. "
            "Delete it, or name another folder, and run the command again."
        )
    return stat.S_ISREG(mode)


def _check_folder(folder: Path) -> None:
    inner = [(root, path) for root in _roots if (path := root.inner(folder)) is not None]
    for root, _ in inner:
        root.check()
    if inner:
        deepest, path = min(inner, key=lambda pair: len(pair[1].parts))
        deepest.check_inside(path)


def open_output(path: Path | str, mode: str = "w", **options: Any) -> IO[Any]:
    """Open a regular file for writing.

    Args:
        path: Path of the file; its folder must exist.
        mode: A mode of ``open``: "w", "a", "x" or "r+", with "b" and "+".
        options: Other arguments of ``open``, such as ``encoding``.

    Raises:
        UnsafePathError: If ``path`` is a symbolic link, a folder, a FIFO, a socket or a device, has
            more than one hard link, or goes through a symbolic link inside an output folder.
        FolderLostError: If the output folder was removed or replaced.
        OSError: If the file cannot be opened.
    """
    check(path)
    _check_file(path)

    def no_link(name: str, flags: int) -> int:
        # without O_NONBLOCK, opening a FIFO that was created after the check would wait
        return os.open(name, flags | os.O_NOFOLLOW | os.O_NONBLOCK, 0o666)

    return open(path, mode, opener=no_link, **options)


def _check_file(path: Path | str) -> None:
    """Raise UnsafePathError if ``path`` exists, unless it is a regular file with one hard link."""
    with suppress(FileNotFoundError):
        status = os.lstat(path)
        regular = stat.S_ISREG(status.st_mode)
        if regular and status.st_nlink <= 1:
            return
        kind = "a hard link to a file with another name" if regular else _kind(status.st_mode)
        raise UnsafePathError(
            f"{path} must be a regular file, got {kind}. Writing to it could change something "
            "outside this folder. Delete it, or name another folder, and run the command again."
        )


def _kind(mode: int) -> str:
    return next((name for matches, name in _KINDS if matches(mode)), "a regular file")
