"""What happens in a condition, as lines of a file in its folder; the command line reads them.

What an agent's process reports of an episode is checked before it is written.
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
COUNTS = ("steps", "calls")
METRES = ("start_distance", "distance")  # infinite where a goal is out of reach
FIELDS = ("metrics", *COUNTS, "path", *METRES, "stopped", "how", "farthest")
HOW = (OVER, RESET, CLOSE)  # an episode may end and count
# of the metrics, what rows say beside success and SPL
MEASURES = ("path_length", "geodesic_distance", "distance_to_goal", "ndtw", "collisions")


def note(folder: Path, **event: Any) -> None:
    """Add a line to the events in ``folder``; processes may do so side by side."""
    line = json.dumps({"time": round(time.time(), 3), "pid": os.getpid(), **event}) + "\n"
    with open_output(folder / EVENTS, "a", encoding="utf-8") as file:
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
    lines = file.read_bytes().split(b"\n")[:-1] if is_regular(file) else []
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
    program's own results too, is put into ``<folder>.<kind>``, in place of what is there.
    ``done.json`` is deleted first, so that the condition counts as unfinished from then on.

    Raises UnsafePathError, before anything is changed, if ``<folder>.<kind>`` is a link, a FIFO or
    a file.
    """
    if any(path.name != LOCK for path in folder.iterdir()):
        aside = folder.with_name(f"{folder.name}.{kind}")
        delete_folder(aside)
        aside.mkdir()
        (folder / DONE).unlink(missing_ok=True)
        for path in [path for path in folder.iterdir() if path.name != LOCK]:
            os.replace(path, aside / path.name)


def name_of(scene: str, episode: str) -> str:
    """The name of an episode in rows: ids repeat from scene to scene in ObjectNav's files."""
    stem = stem_of(scene)
    return f"{stem}/{episode}" if stem else str(episode)


def begun(message: Mapping[str, Any]) -> tuple[str, str]:
    """Scene and id of an episode that begins. Raises ValueError where no row can name it."""
    scene, episode = str(message["scene"]), str(message["id"])
    wanted = allowed("episode_id", name_of(scene, episode))
    if wanted:
        raise ValueError(
            f"an episode is called {short(name_of(scene, episode))}, and no row can be: scene file "
            f"and id must make {wanted}. Number the episodes."
        )
    return scene, episode


def ended(message: Mapping[str, Any], episode: str) -> dict[str, Any]:
    """Those of ``FIELDS`` that a message says of how ``episode`` ended. What is NaN, or a path that
    holds it, is not known, and left out.

    Raises ValueError for metrics that are no finite numbers by name (``distance_to_goal`` may be
    infinite) or that rows refuse, an SPL outside [0, 1], counts and distances that are negative or
    no numbers, and a path that is no list of points [2] or [3].
    """
    try:
        return _checked({name: message[name] for name in FIELDS if message.get(name) is not None})
    except ValueError as error:
        raise ValueError(f"episode {short(episode)} ended with {error}.") from error


def _checked(said: dict[str, Any]) -> dict[str, Any]:
    metrics = said.get("metrics", {})
    if not isinstance(metrics, dict):
        raise ValueError("metrics that are no names and numbers")
    for name, value in metrics.items():
        far = name == "distance_to_goal" and value == math.inf
        if not _number(value) or not (far or math.isfinite(value)):
            raise _wrong(name, value, "a finite number")
        if name in MEASURES and not far and (wanted := allowed(name, value)):
            raise _wrong(name, value, wanted)
    if not 0 <= metrics.get("spl", 0) <= 1:
        raise _wrong("spl", metrics["spl"], "a number from 0 to 1")
    said = {n: value for n, value in said.items() if n not in METRES or value == value}
    for name in (*COUNTS, *METRES):
        value = said.get(name, 0)
        far = name in METRES and value == math.inf
        if not _number(value) or not (far or 0 <= value <= GREATEST):
            raise _wrong(name, value, f"a number from 0 to {GREATEST:g}")
    farthest = said.get("farthest", {})
    if not isinstance(farthest, dict) or not all(
        v is None or _number(v) for v in farthest.values()
    ):
        raise _wrong("farthest", farthest, "metres by camera")
    if said.get("how", OVER) not in HOW:
        raise _wrong("how", said["how"], " or ".join(HOW))
    path = _known(said.pop("path", []))
    return {**said, "path": path} if path else said


def _known(path: Any) -> list[list[float]]:
    """A path that was told; none where a point of it is not known."""
    if not isinstance(path, list) or not all(map(_point, path)) or len({*map(len, path)}) > 1:
        raise _wrong("path", path, "a list of points [x, y] or [x, y, z] in metres")
    if any(x != x for point in path for x in point):
        return []
    if path and not path_length(np.array(path)) <= GREATEST:
        raise _wrong("path", path, f"one of at most {GREATEST:g} metres")
    return path


def _number(value: Any) -> bool:
    return isinstance(value, float) or (isinstance(value, int) and abs(value) < 1 << 63)


def _point(value: Any) -> bool:
    return (
        isinstance(value, list)
        and len(value) in (2, 3)
        and all(_number(x) and not abs(x) > GREATEST for x in value)
    )


def _wrong(name: str, value: Any, wanted: str) -> ValueError:
    shown = name if name.isidentifier() and len(name) <= 60 else short(name)
    return ValueError(f"{shown} = {value!r:.80}: it must be {wanted}")
