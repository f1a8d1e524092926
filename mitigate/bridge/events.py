"""What happens in a condition, as lines of a file in its folder; the command line reads them."""

from __future__ import annotations

import fcntl
import json
import os
import shutil
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

EVENTS, LOCK = "events.jsonl", "lock"


def note(folder: Path, **event: Any) -> None:
    """Add a line to the events in ``folder``; processes may do so side by side."""
    line = json.dumps({"time": round(time.time(), 3), "pid": os.getpid(), **event}) + "\n"
    with open(folder / EVENTS, "a", encoding="utf-8") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        file.write(line)


def damaged(folder: Path, what: str) -> ValueError:
    """Return the error for damaged events of a condition; ``what`` says where they are damaged."""
    return ValueError(
        f"{folder / EVENTS}: {what}, so the episodes of this condition cannot be trusted. No file "
        f"was changed. Copy the file back if you have it elsewhere. Or move {folder} "
        f"out of {folder.parent} and run the same command again: it measures this condition again."
    )


def read_events(folder: Path) -> Iterator[tuple[int, dict[str, Any]]]:
    """Yield the number and the content of each line of the events in ``folder``.

    A last line without its line break is left out: it is being written, or its writer was killed.

    Raises:
        ValueError: Another line is not a JSON object with a text ``event``.
    """
    file = folder / EVENTS
    lines = file.read_bytes().split(b"\n")[:-1] if file.is_file() else []
    for number, line in enumerate(lines, 1):
        try:
            event: Any = json.loads(line)  # distances may be infinite
        except (ValueError, RecursionError) as error:
            raise damaged(folder, f"line {number} is damaged") from error
        if not isinstance(event, dict) or not isinstance(event.get("event"), str):
            raise damaged(folder, f"line {number} is damaged")
        yield number, event


def put_aside(folder: Path, kind: str) -> None:
    """Empty the folder of a condition but for its lock: what an earlier attempt left there, the
    program's own results too, is put into ``<folder>.<kind>``, in place of what is there."""
    left = [path for path in folder.iterdir() if path.name != LOCK]
    if left:
        aside = folder.with_name(f"{folder.name}.{kind}")
        shutil.rmtree(aside, ignore_errors=True)
        aside.mkdir()
        for path in left:
            os.replace(path, aside / path.name)
