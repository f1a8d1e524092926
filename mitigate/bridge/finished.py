"""``done.json``, which marks a condition as finished, and how it is compared with the events.

It records how many episodes ended, and the size and sha256 of the events at that moment. Whatever
reads a finished condition compares them first, so that a damaged file is never taken for a result.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from mitigate.bridge import results
from mitigate.bridge.events import EVENTS, damaged
from mitigate.core.files import atomic_text, sha256
from mitigate.core.json_files import read_object
from mitigate.core.names import short

DONE = "done.json"
_SHA256 = re.compile(r"[0-9a-f]{64}")


def _is_number(value: Any) -> bool:
    plain = isinstance(value, (int, float)) and not isinstance(value, bool)
    return plain and math.isfinite(value)


def _is_count(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and value >= 0


def _is_seal(value: Any) -> bool:
    if not isinstance(value, dict) or not _is_count(value.get("bytes")):
        return False
    return isinstance(value.get("sha256"), str) and bool(_SHA256.fullmatch(value["sha256"]))


SCHEMA: Mapping[str, tuple[Callable[[Any], bool], str]] = {
    "condition": (lambda value: isinstance(value, str) and value != "", "a name"),
    "severity": (lambda value: _is_number(value) and 0 <= value <= 1, "a number from 0 to 1"),
    "repeat": (_is_count, "a whole number >= 0"),
    "files": (lambda value: isinstance(value, dict), "an object"),
    "episodes_told": (_is_count, "a whole number >= 0"),
    "events": (_is_seal, "the size (bytes) and the sha256 of the events"),
}
OLDER = ("events",)  # entries that older versions did not write


def write_done(folder: Path, entries: Mapping[str, Any]) -> None:
    """Mark the condition in ``folder`` as finished with ``entries``, which lack ``events``."""
    seal = {"bytes": (folder / EVENTS).stat().st_size, "sha256": sha256(folder / EVENTS)}
    with atomic_text(folder / DONE) as file:
        json.dump({**entries, "events": seal}, file)


def read_done(folder: Path) -> dict[str, Any] | None:
    """Return the entries of a finished condition, None if it is not finished.

    Entries may be missing: older versions wrote fewer (:func:`lacks`).

    Raises:
        ValueError: ``done.json`` is damaged, or the events are not those that it was written with.
            The message names the file and what to do.
    """
    file = folder / DONE
    if not file.is_file():
        return None
    again = (
        f"No file was changed. Move {folder} out of {folder.parent} and run the same command "
        "again: it measures this condition again."
    )
    entries = read_object(file, again)
    for name, (is_valid, kind) in SCHEMA.items():
        if name in entries and not is_valid(entries[name]):
            raise ValueError(f"{file}: {name} must be {kind}, got {short(entries[name])}. {again}")
    if not lacks(entries):
        _compare(folder, entries)
    return entries


def lacks(entries: Mapping[str, Any]) -> list[str]:
    """Return the entries that every version of this file has and that are missing."""
    return [name for name in SCHEMA if name not in entries and name not in OLDER]


def _compare(folder: Path, entries: Mapping[str, Any]) -> None:
    """Raise ValueError if the events in ``folder`` are not those of the finished condition."""
    events, count = folder / EVENTS, entries["episodes_told"]
    if not events.is_file():
        raise damaged(folder, f"the file is missing, and {DONE} records {count} episodes")
    told = results.read(folder, count_closed=True)  # a damaged line is named by its number
    seal = entries.get("events")
    if seal is None:
        counts = {len(told.ends), len(results.read(folder).ends)}
        if count not in counts:
            raise damaged(folder, f"{len(told.ends)} episodes ended, and {DONE} records {count}")
        return
    size = events.stat().st_size
    if size != seal["bytes"]:
        raise damaged(folder, f"it has {size} bytes, and {DONE} records {seal['bytes']}")
    if sha256(events) != seal["sha256"]:
        raise damaged(folder, f"its sha256 is not the one that {DONE} records")


def check_finished(folder: Path) -> None:
    """Raise ValueError if a finished condition in the run's ``folder`` is damaged."""
    for file in sorted((folder / "conditions").glob(f"*/{DONE}")):
        read_done(file.parent)
