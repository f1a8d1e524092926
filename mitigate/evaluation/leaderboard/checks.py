"""What an entry's JSON may hold: the type, the length and the range of each value."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import PurePosixPath
from typing import Any

from mitigate.core.names import short
from mitigate.corruptions.registry import HALVES
from mitigate.evaluation.blocks import BLOCKS
from mitigate.evaluation.grid import METRICS

LONGEST_NAME, LONGEST_TEXT = 200, 2000  # characters (ours)
MOST_AGENTS, MOST_SENSORS, MOST_CONDITIONS = 100, 20, 500  # of an entry (ours)
MOST_ROWS = 10**8  # of an entry (ours)
GREATEST_PRS = 100.0  # a PRS is a ratio; near the floor it grows without bound (ours)
FORMATS = (2,)
_CORRUPTION = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.+-]{0,99}")
_HASH = re.compile(r"[A-Za-z0-9_.-]{1,64}")
_SCORES = (
    "[value, low, high] in range, or null, by titles: Clean SR and Clean SPL, and of others those "
    "like Mean SR and PRS-SR (RGB)"
)
_SHA256 = re.compile(r"[0-9a-f]{64}")
_LISTED = re.compile(r"[0-9a-f]{12}")


def titles() -> tuple[str, ...]:
    """Return the scores that an entry may have, in the order in which tables show them."""
    blocks = [*BLOCKS, "Pairs", "Other"]
    parts = [p for b in blocks for p in (b, *(f"{b}, {h}" for h in HALVES if "unseen" in b))]
    retained = (f"PRS-{metric} ({part})" for part in parts for metric in METRICS)
    return ("Clean SR", "Clean SPL", "Mean SR", *retained)


def problem(name: str, value: Any) -> str:
    """Return what is wrong with the entry's ``name``, as a predicate; empty if nothing is."""
    told = _CHECKS[name](value)
    return f"must be {told}, not {short(value)}" if told else ""


def check_texts(**texts: Any) -> None:
    """Raise ValueError for a text (name=..., link=...) that an entry cannot hold."""
    for name, value in texts.items():
        if wrong := problem(name, value):
            raise ValueError(f"{name} {wrong}.")


def _text(most: int, empty: bool = False) -> Callable[[Any], str]:
    def check(value: Any) -> str:
        good = isinstance(value, str) and len(value) <= most and (empty or value.strip() != "")
        return "" if good and value.isprintable() else f"a line of at most {most} printable signs"

    return check


def _number(low: float, high: float) -> Callable[[Any], str]:
    def check(value: Any) -> str:
        good = _real(value) and low <= value <= high
        return "" if good else f"a number from {low:g} to {high:g}"

    return check


def _whole(low: int, high: int) -> Callable[[Any], str]:
    def check(value: Any) -> str:
        good = type(value) is int and low <= value <= high
        return "" if good else f"a whole number from {low} to {high}"

    return check


def _real(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _agents(value: Any) -> str:
    good = isinstance(value, list) and 0 < len(value) <= MOST_AGENTS
    good = good and all(
        isinstance(one, dict)
        and one.keys() == {"agent", "seed"}
        and isinstance(one["agent"], str)
        and _HASH.fullmatch(one["agent"]) is not None
        and not _whole(-(2**63), 2**63)(one["seed"])
        for one in value
    )
    return "" if good else f'a list of 1 to {MOST_AGENTS} objects of "agent" (a hash) and "seed"'


def _sensors(value: Any) -> str:
    good = isinstance(value, list) and len(value) <= MOST_SENSORS
    good = good and not any(_text(LONGEST_NAME)(line) for line in value)
    return "" if good else f"a list of at most {MOST_SENSORS} lines"


def _interval(value: Any, high: float) -> bool:
    """Whether it is None or [value, low, high], in order, bounds perhaps None."""
    if value is None:
        return True
    if not isinstance(value, list) or len(value) != 3 or not _real(value[0]):
        return False
    known = [x for x in value if x is not None]
    ordered = value[1] is None or value[2] is None or (_real(value[1]) and _real(value[2]))
    if not ordered or not all(_real(x) and 0 <= x <= high for x in known):
        return False
    return None in value or value[1] <= value[2]


def _scores(value: Any) -> str:
    allowed = titles()
    good = isinstance(value, dict) and {"Clean SR", "Clean SPL"} <= value.keys() <= set(allowed)
    good = good and all(
        _interval(found, GREATEST_PRS if title.startswith("PRS") else 1.0)
        for title, found in value.items()
    )
    return "" if good else _SCORES


def _rates(value: Any) -> str:
    good = isinstance(value, dict) and 1 < len(value) <= MOST_CONDITIONS and "clean" in value
    good = good and all(
        _CORRUPTION.fullmatch(name) is not None and _interval(found, 1.0)
        for name, found in value.items()
    )
    return "" if good else "[value, low, high] from 0 to 1 by condition, clean among them"


def _rows(value: Any) -> str:
    good = isinstance(value, dict) and value.keys() == {"file", "sha256", "count"}
    good = good and not _text(LONGEST_NAME, empty=True)(value["file"])
    good = good and not _whole(1, MOST_ROWS)(value["count"])
    good = good and isinstance(value["sha256"], str) and bool(_SHA256.fullmatch(value["sha256"]))
    if good:
        path = PurePosixPath(value["file"])
        good = not path.is_absolute() and ".." not in path.parts and "\\" not in value["file"]
        good = good and not value["file"].startswith("~")
    return "" if good else 'an object of "file" (a path below this folder), "sha256" and "count"'


def _listed(value: Any) -> str:
    good = isinstance(value, str) and bool(_LISTED.fullmatch(value))
    return "" if good else "12 hexadecimal digits"


def _format(value: Any) -> str:
    good = type(value) is int and value in FORMATS
    return "" if good else f"one of {', '.join(map(str, FORMATS))}"


_CHECKS: dict[str, Callable[[Any], str]] = {
    "name": _text(LONGEST_NAME),
    "agents": _agents,
    "sensors": _sensors,
    "training_data": _text(LONGEST_TEXT, empty=True),
    "split": _text(LONGEST_NAME),
    "suite": _text(LONGEST_NAME),
    "rule": _text(LONGEST_NAME),
    "severity": _number(0, 1),
    "episodes": _whole(1, MOST_ROWS),
    "listed": _listed,
    "scores": _scores,
    "SR": _rates,
    "SPL": _rates,
    "rows": _rows,
    "link": _text(LONGEST_NAME, empty=True),
    "version": _text(LONGEST_NAME),
    "format": _format,
}
