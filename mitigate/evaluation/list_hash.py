"""The hash of the episode list that the rows in a folder are of, kept beside them."""

from __future__ import annotations

import re
from pathlib import Path

from mitigate.core.files import atomic_text, find, sha256
from mitigate.evaluation.rows import ROWS, read

LIST = "episodes-{split}.sha256"  # of the file that the episodes of a split came from
_SHA256 = re.compile(r"[0-9a-f]{64}")
OLD_LIST = "episodes.sha256"  # the same by an older version: a line a file, of whichever splits


def keep(folder: Path, split: str, source: str) -> None:
    """Keep the hash of a split's episode file beside the rows, as ``sha256sum`` writes it; raise
    ValueError if it was another: a row names its episode by id alone, so another list's rows would
    count as done."""
    note, found = folder / LIST.format(split=split), sha256(find(source))
    held = _held(folder, split, source)
    if held and found not in held:
        raise ValueError(
            f"{folder} holds rows of another list of {split} than {source} is now. Name another "
            "folder (out=..., of a training folder=...), or delete this one."
        )
    with atomic_text(note) as file:
        file.write(f"{found}  {source}\n")


def _held(folder: Path, split: str, source: str) -> list[str]:
    """The hashes of the lists that the rows of ``split`` in ``folder`` may be of, none if it is not
    known; an older version kept those of all splits in one file, by their paths."""
    note, old = folder / LIST.format(split=split), folder / OLD_LIST
    if note.is_file():
        words = note.read_text(encoding="utf-8", errors="replace").split()[:1]
        if not words or not _SHA256.fullmatch(words[0]):
            raise ValueError(
                f"{note} must begin with a sha256, and is empty or damaged. Copy it back, or move "
                f"{folder} aside and evaluate again."
            )
        return words
    written = (folder / ROWS).is_file() and any(r["split"] == split for r in read(folder / ROWS))
    if not written or not old.is_file():
        return []
    lines = [line.partition("  ") for line in old.read_text(encoding="utf-8").splitlines()]
    return [d for d, _, name in lines if name == source] or [d for d, _, _ in lines]
