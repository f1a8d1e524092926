"""The sha256 of a single file in a sidecar beside it, in the format of ``sha256sum -c``.

The states of a training have one. Folders have a manifest in its place (``core/folders.py``).

While a file is replaced, its sidecar lists the sums of the old one and of the new one: a program
that is killed at any moment leaves a file that has one of them.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

from mitigate.core.files import atomic_text, sha256, write_atomically

SUFFIX = ".sha256"
LARGEST = 4096  # characters of a sidecar, which has a line or two
DIGITS = 12  # hex digits of a fingerprint: 48 bits
_LINE = re.compile(r"([0-9a-f]{64})  (.+)")


def sidecar(path: Path) -> Path:
    """Return where the sum of ``path`` is kept, whether it is there or not."""
    return path.with_name(path.name + SUFFIX)


def write(path: Path, write: Callable[[Path], Any]) -> Path:
    """As :func:`mitigate.core.files.write_atomically`, with the file's sum beside it."""
    digest = ""

    def write_and_announce(temporary: Path) -> None:
        nonlocal digest
        write(temporary)
        digest = sha256(temporary)
        _note(path, [*dict.fromkeys([*_sums_before(path), digest])])

    write_atomically(path, write_and_announce)
    if _sums(path) != [digest]:
        _note(path, [digest])
    return path


def _sums_before(path: Path) -> list[str]:
    """Return the sums of the file that is replaced, none if there is none."""
    try:
        if sidecar(path).is_file() and path.is_file():
            return _sums(path)
        return [sha256(path)] if path.is_file() else []
    except ValueError:  # a damaged sidecar goes with its file
        return []


def problem(path: Path) -> str:
    """Return what is wrong with ``path`` by its sidecar (a predicate, such as "does not have the
    sha256 ..."), empty if nothing is or if it has none. Raises PermissionError if it may not be
    read, which is no damage."""
    note = sidecar(path)
    if not note.is_file():
        return ""
    try:
        return "" if sha256(path) in _sums(path) else f"does not have the sha256 in {note.name}"
    except PermissionError:
        raise
    except (ValueError, OSError) as error:
        return f"cannot be compared with {note.name} ({error})"


def delete(path: Path) -> None:
    """Delete ``path`` and its sidecar, this one first: a file without one is no damaged file."""
    sidecar(path).unlink(missing_ok=True)
    path.unlink(missing_ok=True)


def delete_orphans(folder: Path, pattern: str) -> None:
    """Delete the sidecars of files in ``folder`` that are gone; ``pattern`` is a glob of these."""
    for note in folder.glob(pattern + SUFFIX):
        if not note.with_suffix("").is_file():
            note.unlink(missing_ok=True)


def _sums(path: Path) -> list[str]:
    """Return the sums that the sidecar of ``path`` lists; ValueError if it is damaged."""
    with open(sidecar(path), encoding="utf-8") as file:
        text = file.read(LARGEST + 1)
    if len(text) > LARGEST:
        raise ValueError("it is damaged")
    lines = text.splitlines()
    found = [_LINE.fullmatch(line) for line in lines]
    sums = [line[1] for line in found if line and line[2] == path.name]
    if not sums or len(sums) < len(lines):
        raise ValueError("it is damaged")
    return sums


def _note(path: Path, digests: list[str]) -> None:
    with atomic_text(sidecar(path)) as file:
        file.writelines(f"{digest}  {path.name}\n" for digest in digests)
