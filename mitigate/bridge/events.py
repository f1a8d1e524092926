"""Write and read the events of a condition, which are JSON lines in its folder.

The reports that an agent's process sends about an episode are checked before they are written.
"""

from __future__ import annotations

import fcntl
import json
import math
import os
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from mitigate.bridge.hook.mitigate_hook import CLOSE, OVER, RESET
from mitigate.core.names import short
from mitigate.core.output import delete_folder, is_regular, open_output
from mitigate.evaluation.rows import GREATEST, allowed, stem_of
from mitigate.worlds.measures import path_length

EVENTS, LOCK, DONE = "events.jsonl", "lock", "done.json"
# maximum size of one event in bytes (heuristic); a message has at most 1 << 24 bytes
LONGEST_LINE = 1 << 26
COUNTS = ("steps", "calls")
METRES = ("start_distance", "distance")  # these may be infinite, if no goal can be reached
FIELDS = ("metrics", *COUNTS, "path", *METRES, "stopped", "how", "farthest")
HOW = (OVER, RESET, CLOSE)  # ways in which an episode can end with a result
# metrics that rows contain in addition to success and SPL
MEASURES = ("path_length", "geodesic_distance", "distance_to_goal", "ndtw", "collisions")


def write_event(folder: Path, **event: Any) -> None:
    """Append an event to the file in ``folder``; several processes may append in parallel."""
    line = json.dumps({"time": round(time.time(), 3), "pid": os.getpid(), **event}) + "\n"
    with open_output(folder / EVENTS, "a", encoding="utf-8") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        file.write(line)


def damaged(folder: Path, what: str) -> ValueError:
    """Return the error for a damaged file of events; ``what`` describes the damage."""
    return ValueError(
        f"{folder / EVENTS}: {what}, so the episodes of this condition cannot be trusted. No file "
        "was changed. Copy the file back if you have it elsewhere. Otherwise "
        f"{measure_again(folder)}"
    )


def measure_again(folder: Path) -> str:
    """Return the advice for a condition with damaged files."""
    return (
        f"move {folder} out of {folder.parent} and run the same command again: it measures this "
        "condition again."
    )


def read_events(folder: Path) -> Iterator[tuple[int, dict[str, Any]]]:
    """Yield the number and the content of each line of the events in ``folder``.

    If the last line has no line break, it is skipped: it is still being written, or the process
    that wrote it was killed. Raises ValueError if any other line is not a JSON object with a string
    field ``event``.
    """
    file = folder / EVENTS
    if not is_regular(file):
        return
    with open(file, "rb") as lines:
        for number, line in enumerate(iter(lambda: lines.readline(LONGEST_LINE), b""), 1):
            if not line.endswith(b"\n") and len(line) < LONGEST_LINE:
                return
            try:
                event: Any = json.loads(line)  # distances may be infinite
            except (ValueError, RecursionError) as error:
                raise damaged(folder, f"line {number} is damaged") from error
            if not isinstance(event, dict) or not isinstance(event.get("event"), str):
                raise damaged(folder, f"line {number} is damaged")
            yield number, event


def put_aside(folder: Path, kind: str) -> None:
    """Move the files of an earlier attempt to ``<folder>.<kind>``, replacing that folder.

    The lock file stays. Results that the program wrote to ``folder`` are also moved. ``done.json``
    is deleted first, so that the condition immediately counts as unfinished.

    Raises:
        UnsafePathError: If ``<folder>.<kind>`` is a link, a FIFO or a file; nothing was changed.
    """
    if any(path.name != LOCK for path in folder.iterdir()):
        aside = folder.with_name(f"{folder.name}.{kind}")
        delete_folder(aside)
        aside.mkdir()
        (folder / DONE).unlink(missing_ok=True)
        for path in [path for path in folder.iterdir() if path.name != LOCK]:
            os.replace(path, aside / path.name)


def episode_name(scene: str, episode: str) -> str:
    """Return the name by which result rows identify an episode.

    The name includes the scene, because ObjectNav uses the same ids in every scene.
    """
    stem = stem_of(scene)
    return f"{stem}/{episode}" if stem else str(episode)


def read_start(message: Mapping[str, Any]) -> tuple[str, str]:
    """Return the scene and the id from the message that begins an episode.

    Raises ValueError if the episode's name is not allowed in result rows.
    """
    scene, episode = str(message["scene"]), str(message["id"])
    constraint = allowed("episode_id", episode_name(scene, episode))
    if constraint:
        raise ValueError(
            f"an episode's name (its scene file and its id) must be {constraint}, got "
            f"{short(episode_name(scene, episode))}. Use numbers as episode ids."
        )
    return scene, episode


def read_end(message: Mapping[str, Any], episode: str) -> dict[str, Any]:
    """Check the report about the end of ``episode``, and return its ``FIELDS``.

    A distance that is NaN, or a path that contains NaN, is treated as unknown and omitted.

    Raises:
        ValueError: If a field is invalid. Metrics must be finite numbers that are allowed in rows
            (only ``distance_to_goal`` may be infinite), the SPL must lie in [0, 1], counts and
            distances must be >= 0, and the path must be a list of points [2] or [3].
    """
    try:
        return _check_end({name: message[name] for name in FIELDS if message.get(name) is not None})
    except ValueError as error:
        raise ValueError(f"episode {short(episode)} ended with {error}.") from error


def _check_end(end: dict[str, Any]) -> dict[str, Any]:
    """Check the report about the end of an episode; return it without unknown values."""
    metrics = end.get("metrics", {})
    if not isinstance(metrics, dict):
        raise ValueError("metrics that do not map names to numbers")
    for name, value in metrics.items():
        unreachable = name == "distance_to_goal" and value == math.inf
        if not _is_number(value) or not (unreachable or math.isfinite(value)):
            raise _invalid(name, value, "a finite number")
        if name in MEASURES and not unreachable and (constraint := allowed(name, value)):
            raise _invalid(name, value, constraint)
    if not 0 <= metrics.get("spl", 0) <= 1:
        raise _invalid("spl", metrics["spl"], "a number from 0 to 1")
    end = {n: value for n, value in end.items() if n not in METRES or value == value}
    for name in (*COUNTS, *METRES):
        value = end.get(name, 0)
        unreachable = name in METRES and value == math.inf
        if not _is_number(value) or not (unreachable or 0 <= value <= GREATEST):
            raise _invalid(name, value, f"a number from 0 to {GREATEST:g}")
    farthest = end.get("farthest", {})
    if not isinstance(farthest, dict) or not all(
        v is None or _is_number(v) for v in farthest.values()
    ):
        raise _invalid("farthest", farthest, "a mapping from camera names to metres")
    if end.get("how", OVER) not in HOW:
        raise _invalid("how", end["how"], " or ".join(HOW))
    path = _check_path(end.pop("path", []))
    return {**end, "path": path} if path else end


def _check_path(path: Any) -> list[list[float]]:
    """Return the reported path, or an empty list if a point of the path is unknown."""
    if not isinstance(path, list) or not all(map(_is_point, path)) or len({*map(len, path)}) > 1:
        raise _invalid("path", path, "a list of points [x, y] or [x, y, z] in metres")
    if any(x != x for point in path for x in point):
        return []
    if path and not path_length(np.array(path)) <= GREATEST:
        raise _invalid("path", path, f"at most {GREATEST:g} metres long")
    return path


def _is_number(value: Any) -> bool:
    return isinstance(value, float) or (isinstance(value, int) and abs(value) < 1 << 63)


def _is_point(value: Any) -> bool:
    return (
        isinstance(value, list)
        and len(value) in (2, 3)
        and all(_is_number(x) and not abs(x) > GREATEST for x in value)
    )


def _invalid(name: str, value: Any, constraint: str) -> ValueError:
    label = name if name.isidentifier() and len(name) <= 60 else short(name)
    return ValueError(f"{label} = {value!r:.80}: it must be {constraint}")
