"""What happens in a condition, as lines of a file in its folder; the command line reads them."""

from __future__ import annotations

import fcntl
import json
import os
import shutil
import time
from pathlib import Path
from typing import Any

from mitigate.core.output import open_output

EVENTS, LOCK = "events.jsonl", "lock"


def note(folder: Path, **event: Any) -> None:
    """Add a line to the events in ``folder``; processes may do so side by side."""
    line = json.dumps({"time": round(time.time(), 3), "pid": os.getpid(), **event}) + "\n"
    with open_output(folder / EVENTS, "a", encoding="utf-8") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        file.write(line)


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
