"""Keep the sha256 of a file in a sidecar file, in the format of ``sha256sum -c``.

The states of training runs have sidecars. Folders have a manifest instead (``core/folders.py``).

While a file is being replaced, its sidecar lists the checksums of the old and of the new file.
The file therefore matches its sidecar even if the program is killed during the replacement.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

from mitigate.core.files import read_bounded, sha256, write_atomically, write_text

SUFFIX = ".sha256"
LARGEST = 4096  # maximum size of a sidecar in bytes (heuristic); a sidecar has one or two lines
DIGITS = 12  # number of hex digits of a fingerprint (48 bits)
_LINE = re.compile(r"([0-9a-f]{64})  (.+)")


def sidecar(path: Path) -> Path:
    """Return the path of the sidecar for ``path``, whether or not it exists."""
    return path.with_name(path.name + SUFFIX)


def write(path: Path, write: Callable[[Path], Any]) -> Path:
    """Write ``path`` like :func:`mitigate.core.files.write_atomically`, and write its sidecar."""
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
    """Return the checksums of the file that is being replaced, or [] if there is no such file."""
    try:
        if sidecar(path).is_file() and path.is_file():
            return _sums(path)
        return [sha256(path)] if path.is_file() else []
    except ValueError:  # a damaged sidecar will be replaced together with its file
        return []


def problem(path: Path) -> str:
    """Compare ``path`` with its sidecar and describe the problem.

    Returns:
        A predicate such as "does not have the sha256 ...", or "" if the file is intact or has no
        sidecar.

    Raises:
        PermissionError: If the user has no permission to read the file; it may be intact.
    """
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
    """Delete ``path`` and its sidecar.

    The sidecar is deleted first, because a file without a sidecar counts as valid.
    """
    sidecar(path).unlink(missing_ok=True)
    path.unlink(missing_ok=True)


def delete_orphans(folder: Path, pattern: str) -> None:
    """Delete sidecars in ``folder`` whose file no longer exists.

    The glob ``pattern`` matches the files that may have sidecars.
    """
    for note in folder.glob(pattern + SUFFIX):
        if not note.with_suffix("").is_file():
            note.unlink(missing_ok=True)


def _sums(path: Path) -> list[str]:
    """Return the checksums in the sidecar of ``path``; raise ValueError if it is damaged."""
    lines = read_bounded(sidecar(path), LARGEST).decode().splitlines()
    matches = [_LINE.fullmatch(line) for line in lines]
    sums = [line[1] for line in matches if line and line[2] == path.name]
    if not sums or len(sums) < len(lines):
        raise ValueError("it is damaged")
    return sums


def _note(path: Path, digests: list[str]) -> None:
    write_text(sidecar(path), "".join(f"{digest}  {path.name}\n" for digest in digests))
