"""What happens in a condition, as lines of a file in its folder; the command line reads them."""

from __future__ import annotations

import fcntl
import json
import os
import time
from pathlib import Path
from typing import Any

EVENTS = "events.jsonl"


def note(folder: Path, **event: Any) -> None:
    """Add a line to the events in ``folder``; processes may do so side by side."""
    line = json.dumps({"time": round(time.time(), 3), "pid": os.getpid(), **event}) + "\n"
    with open(folder / EVENTS, "a", encoding="utf-8") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        file.write(line)
