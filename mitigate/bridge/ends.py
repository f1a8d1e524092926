"""What an agent's process tells at the end of an episode, checked before it is kept."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

COUNTS = ("steps", "calls")
METRES = ("start_distance", "distance")  # infinite where a goal is out of reach
FIELDS = ("metrics", *COUNTS, "path", *METRES, "stopped")


def ended(message: Mapping[str, Any]) -> dict[str, Any]:
    """Those of ``FIELDS`` that a message says.

    Raises ValueError for metrics that are no finite numbers by name (``distance_to_goal`` may be
    infinite), an SPL outside [0, 1], counts and distances that are negative or no numbers, and a
    path that is no list of points [2] or [3].
    """
    said = {name: message[name] for name in FIELDS if message.get(name) is not None}
    metrics = said.get("metrics", {})
    if not isinstance(metrics, dict):
        raise ValueError("the metrics of an episode are no names and numbers.")
    for name, value in metrics.items():
        far = name == "distance_to_goal" and value == math.inf
        if not _number(value) or not (far or math.isfinite(value)):
            raise _wrong(name, value, "a finite number")
    if not 0 <= metrics.get("spl", 0) <= 1:
        raise _wrong("spl", metrics["spl"], "a number from 0 to 1")
    for name in (*COUNTS, *METRES):
        value = said.get(name, 0)
        if not _number(value) or not value >= 0:
            raise _wrong(name, value, "a number that is not negative")
    path = said.get("path", [])
    if not isinstance(path, list) or not all(map(_point, path)) or len({*map(len, path)}) > 1:
        raise _wrong("path", path, "a list of points [x, y] or [x, y, z] in metres")
    return said


def _number(value: Any) -> bool:
    return isinstance(value, float) or (isinstance(value, int) and abs(value) < 1 << 63)


def _point(value: Any) -> bool:
    return (
        isinstance(value, list)
        and len(value) in (2, 3)
        and all(_number(x) and math.isfinite(x) for x in value)
    )


def _wrong(name: str, value: Any, wanted: str) -> ValueError:
    return ValueError(f"an episode ended with {name} = {value!r:.80}: it must be {wanted}.")
