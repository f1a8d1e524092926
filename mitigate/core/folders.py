"""Write folders of weights atomically, with a manifest, and check them before use.

Every folder that this project ships or trains has the same layout::

    manifest.json      the kind of folder, and the size and sha256 of every file
    config.yaml        settings: plain data (``core/settings.py``), never instantiated directly
    *.safetensors      weights
    card.json, README.md, program.*    optional

A folder in the format of another library keeps the names of that library, such as
``adapter_config.json`` of PEFT.

When a folder is updated, files are replaced one by one. During the update, the manifest lists both
the new files and the files that they replace. A reader therefore gets either all old files or all
new files, or rejects the folder.
"""

from __future__ import annotations

import glob
import hashlib
import os
import re
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

from mitigate.core import output
from mitigate.core.files import (
    LONGEST_DRAFT,
    draft_path,
    lfs_problem,
    make_folder,
    put_folder,
    sha256,
    write_json,
    write_text,
)
from mitigate.core.json_files import read_object
from mitigate.core.locks import delete_abandoned
from mitigate.core.names import short
from mitigate.core.output import writing
from mitigate.core.signals import uninterrupted

MANIFEST = "manifest.json"
FORMAT = 1
# maximum number of entries of a manifest (heuristic); the manifest of a hardened folder has 8
MOST_FILES = 1000
LONGEST = 255  # maximum length of a file name in bytes (Linux, NAME_MAX)
AGAIN = "Fetch the folder again, or write it again with the command that made it."
_OLD = "old"  # name that a replaced folder gets when it is moved into the temporary folder
_SHA256 = re.compile(r"[0-9a-f]{64}")


class Entry(NamedTuple):
    """Entry of a manifest; ``size`` is in bytes."""

    sha256: str
    size: int


class Manifest(NamedTuple):
    """The kind and the files of a folder."""

    kind: str  # "weights", "agent", "hardened", "adapters", "encoder", "restorer" or "safeguard"
    files: dict[str, Entry]  # by name
    replaced: dict[str, Entry]  # the previous files, while a folder is being replaced


@contextmanager
def write_folder(folder: str | Path, kind: str) -> Iterator[Path]:
    """Yield an empty temporary folder; its files replace those in ``folder`` after the block.

    Nothing is replaced if the block raises an error. Files of the earlier manifest that are not in
    the temporary folder are deleted. Files that no manifest lists are kept.

    Raises:
        OSError: If the folder cannot be written.
        ValueError: If the folder holds files of a different kind.
    """
    folder = make_folder(folder)
    _check_kind(folder, kind)
    with writing(folder):
        draft = tempfile.TemporaryDirectory(f".{os.getpid()}.tmp", ".draft-", folder)
    with draft as place:
        yield Path(place)
        _replace(Path(place), folder, kind)


@contextmanager
def replace_folder(target: Path) -> Iterator[Path]:
    """Yield an empty temporary folder that is renamed to ``target`` if the block succeeds.

    An existing ``target`` is replaced as a whole. If the process is killed at any moment, the next
    call repairs ``target`` (:func:`repair_folder`).
    """
    repair_folder(target)
    aside = draft_path(target)
    with writing(target):
        output.make_checked(aside / target.name)
    try:
        yield aside / target.name
        with uninterrupted():
            put_folder(aside / target.name, target, aside / _OLD)
    finally:
        output.delete_folder(aside)


def repair_folder(target: Path) -> None:
    """Restore ``target`` if a process was killed while it replaced the folder; delete leftovers."""
    drafts = [*target.parent.glob(f".{glob.escape(target.name[:LONGEST_DRAFT])}.*.tmp")]
    for draft in drafts:
        if (draft / _OLD).is_dir() and not target.exists():
            (draft / _OLD).rename(target)
    delete_abandoned(drafts, ours=True)


def _check_kind(folder: Path, kind: str) -> None:
    try:
        manifest = read_manifest(folder)
    except ValueError:  # a damaged manifest is written again
        return
    loose = {"weights", "agent"}
    if manifest is not None and manifest.kind != kind and not {manifest.kind, kind} <= loose:
        raise ValueError(
            f"{folder} holds files of another kind ({manifest.kind}, not {kind}). They are not "
            "replaced. Name another folder, or delete this one."
        )


def _replace(draft: Path, folder: Path, kind: str) -> None:
    new = _entries(draft)
    old = _sound_files(folder, new)
    _write_manifest(folder, Manifest(kind, new, old if old != new else {}))
    # safetensors writes files that only the owner can read, so copy the mode of the manifest
    mode = (folder / MANIFEST).stat().st_mode
    for name in new:
        (draft / name).chmod(mode)
        with open(draft / name, "rb+") as file:
            os.fsync(file.fileno())
        output.check(folder / name)
        with writing(folder / name):
            os.replace(draft / name, folder / name)
    if old and old != new:
        for name in old.keys() - new.keys():
            (folder / name).unlink(missing_ok=True)
        _write_manifest(folder, Manifest(kind, new, {}))


def seal(folder: str | Path, kind: str) -> None:
    """Write the manifest of the files in ``folder``.

    Use this only for a complete temporary folder that no other process changes before it is
    renamed.
    """
    _write_manifest(Path(folder), Manifest(kind, _entries(Path(folder)), {}))


def add_file(folder: str | Path, name: str, text: str) -> None:
    """Write a text file into ``folder``, and add it to the manifest if there is one."""
    folder = Path(folder)
    manifest = check(folder)
    if manifest is None:
        return write_text(folder / name, text)
    raw = text.encode()
    entry = Entry(hashlib.sha256(raw).hexdigest(), len(raw))
    new = Manifest(manifest.kind, {**manifest.files, name: entry}, {})
    _write_manifest(folder, new._replace(replaced=manifest.files))
    write_text(folder / name, text)
    _write_manifest(folder, new)


def _entries(folder: Path) -> dict[str, Entry]:
    files = [file for file in sorted(folder.iterdir()) if file.name != MANIFEST]
    return {file.name: Entry(sha256(file), file.stat().st_size) for file in files}


def _sound_files(folder: Path, new: Iterable[str]) -> dict[str, Entry]:
    """Return the entries of the files that are being replaced, or {} if any is damaged."""
    try:
        manifest = check(folder)
        if manifest is not None:
            return manifest.files
        present = [folder / name for name in new if (folder / name).is_file()]
        return {file.name: Entry(sha256(file), file.stat().st_size) for file in present}
    except (ValueError, OSError):
        return {}


def _write_manifest(folder: Path, manifest: Manifest) -> None:
    def plain(files: dict[str, Entry]) -> dict[str, dict[str, Any]]:
        return {name: {"bytes": e.size, "sha256": e.sha256} for name, e in files.items()}

    text = {"format": FORMAT, "kind": manifest.kind, "files": plain(manifest.files)}
    if manifest.replaced:
        text["replaced"] = plain(manifest.replaced)
    write_json(folder / MANIFEST, text, indent=1)


def read_manifest(folder: str | Path, again: str = AGAIN) -> Manifest | None:
    """Return the manifest of ``folder``, or None if it has none.

    Raises:
        ValueError: If the manifest is invalid. The message ends with the advice ``again``.
    """
    file = Path(folder) / MANIFEST
    if not output.is_regular(file):
        return None
    record = read_object(file, again)
    kind = record.get("kind")
    if record.get("format") != FORMAT or not isinstance(kind, str) or "files" not in record:
        raise ValueError(
            f"{file} must be a manifest of format {FORMAT} with kind and files. {again}"
        )
    return Manifest(
        kind,
        _read_entries(file, record["files"], again),
        _read_entries(file, record.get("replaced", {}), again),
    )


def _read_entries(file: Path, listed: Any, again: str) -> dict[str, Entry]:
    if not isinstance(listed, dict) or len(listed) > MOST_FILES:
        raise ValueError(f"{file} must list at most {MOST_FILES} files by name. {again}")
    entries = {}
    for name, entry in listed.items():
        fields = entry if isinstance(entry, dict) else {}
        size, digest = fields.get("bytes"), fields.get("sha256")
        if type(size) is not int or not isinstance(digest, str) or not _SHA256.fullmatch(digest):
            raise ValueError(f"{file} must give bytes and sha256 of {short(name)}. {again}")
        plain = Path(name).name == name and name not in ("", ".", "..") and name.isprintable()
        if not plain or len(name.encode()) > LONGEST:
            raise ValueError(
                f"{file} lists {short(name)}, which is not a plain file name. Do not use this "
                "folder: its manifest was not written by this project."
            )
        entries[name] = Entry(digest, size)
    return entries


def check(
    folder: str | Path, *, optional: Iterable[str] = (), again: str = AGAIN
) -> Manifest | None:
    """Compare every file of ``folder`` with the manifest, and return the manifest (or None).

    Args:
        folder: the folder.
        optional: names that may be missing.
        again: advice at the end of each message: how to replace a damaged folder.

    Raises:
        FileNotFoundError: If a file is missing.
        ValueError: If a file was changed or truncated, or the manifest is damaged.
    """
    folder = Path(folder)
    manifest = read_manifest(folder, again)
    if manifest is None:
        return None
    try:
        _compare(folder, manifest.files, optional, again)
    except (ValueError, FileNotFoundError):
        if not manifest.replaced:
            raise
        _compare(folder, manifest.replaced, optional, again)
        return manifest._replace(files=manifest.replaced, replaced={})
    return manifest


def _compare(folder: Path, files: dict[str, Entry], optional: Iterable[str], again: str) -> None:
    for name, entry in files.items():
        file = folder / name
        if name in optional and not os.path.lexists(file):
            continue
        if not file.is_file():
            raise FileNotFoundError(f"{folder} is incomplete: {name} is missing. {again}")
        if not _matches(file, entry):
            if pointer := lfs_problem(file):
                raise ValueError(f"{file} {pointer}.")
            raise ValueError(
                f"{file} does not have the sha256 that {MANIFEST} states: it was changed or "
                f"truncated. {again}"
            )


def _matches(file: Path, entry: Entry) -> bool:
    """Return whether a file matches its entry; the file is read only if its size is right."""
    return entry.size == file.stat().st_size and sha256(file) == entry.sha256


def problem(file: Path) -> str:
    """Compare ``file`` with the manifest of its folder.

    Returns:
        A predicate such as "does not have the sha256 ...". It is "" if the file is intact, or if no
        manifest lists it.

    Raises:
        PermissionError: If the user has no permission to read the file; it may be intact.
    """
    try:
        manifest = read_manifest(file.parent)
    except ValueError as error:
        return f"cannot be compared with its manifest ({error})"
    versions = (manifest.files, manifest.replaced) if manifest else ()
    listed = [entries[file.name] for entries in versions if file.name in entries]
    if not listed or any(_matches(file, entry) for entry in listed):
        return ""
    return f"does not have the sha256 in {MANIFEST}"


def read_checked(file: Path, again: str) -> dict[str, Any]:
    """Return the object in an untrusted JSON file, after comparing the file with its manifest.

    Raises:
        ValueError: If the file does not match the manifest of its folder, is damaged, or does not
            hold a JSON object. The message ends with the advice ``again``.
        PermissionError: If the user has no permission to read the file; it may be intact.
    """
    if damage := problem(file):
        raise ValueError(f"{file} is truncated or damaged: it {damage}. {again}")
    return read_object(file, again)


def is_listed(file: Path) -> bool:
    """Return whether the manifest of its folder contains the sha256 of ``file``."""
    manifest = read_manifest(file.parent)
    return manifest is not None and file.name in manifest.files
