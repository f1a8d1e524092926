"""A JSON object of an episode file, read key by key with errors that say where it stands."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, NoReturn

from mitigate.core.names import short

Vector = tuple[float, ...]
FARTHEST = 1e6  # metres (ours)
OFF_ONE = 1e-2  # of a quaternion's length, for digits that were cut (ours)
TILTED = 0.1  # of a quaternion's x and z: 11 degrees (ours)
NEEDED = (
    "An episode needs episode_id, trajectory_id, scene_id, start_position [x, y, z], "
    "start_rotation [x, y, z, w], goals [{position, radius}], instruction {instruction_text} and "
    "reference_path [[x, y, z], ...] (goals and reference_path may be absent from a test split "
    "read with hidden_goals=True); a ground-truth entry needs locations [[x, y, z], ...]. "
    "Correct the file, or download it again."
)


class Record:
    """A JSON object of a file, read with errors that say where it stands."""

    def __init__(self, raw: Any, path: Path | str, where: str) -> None:
        self.raw, self.path, self.where = raw, path, where
        if not isinstance(raw, dict):
            self.fail("is not a JSON object")

    def fail(self, problem: str) -> NoReturn:
        """Raise ValueError with file, place, ``problem`` and what is needed."""
        raise ValueError(f"{self.path}: {self.where} {problem}. {NEEDED}")

    def get(self, key: str, kinds: type | tuple[type, ...], default: Any = ...) -> Any:
        """Return the value of ``key``, checked against ``kinds``; ``...`` means required."""
        value = self.raw.get(key)
        if value is None and default is not ...:
            return default
        if value is None:
            self.fail(f"lacks the key {key!r}")
        if not isinstance(value, kinds) or isinstance(value, bool):
            self.fail(f"has a wrong {key!r}: {short(value)}")
        return value

    def metres(self, key: str) -> float | None:
        """Return the finite number ``key``, 0 or more, None if it is absent."""
        value = self.get(key, (int, float), None)
        if value is not None and not (_finite(value) and value >= 0):
            self.fail(f"has a wrong {key!r}: metres from 0 on are needed, not {short(value)}")
        return value

    def vector(self, key: str, size: int) -> Vector:
        """Return ``key`` as ``size`` finite numbers."""
        return self._vector(key, self.get(key, list), size)

    def rotation(self, key: str) -> Vector:
        """Return ``key`` as a unit quaternion (x, y, z, w) about the vertical y."""
        found = self.vector(key, 4)
        x, _, z, _ = found
        if abs(math.hypot(*found) - 1) > OFF_ONE or max(abs(x), abs(z)) > TILTED:
            self.fail(
                f"has a wrong {key!r}: a unit quaternion [x, y, z, w] about the vertical y is "
                f"needed, not {short(list(found))} (is it [w, x, y, z]?)"
            )
        return found

    def vectors(self, key: str, size: int) -> tuple[Vector, ...]:
        """Return ``key`` as a non-empty list of vectors."""
        values = self.get(key, list)
        if not values:
            self.fail(f"has an empty {key!r}")
        return tuple(self._vector(key, value, size) for value in values)

    def records(self, key: str) -> list[Record]:
        """Return the objects of the non-empty list ``key``."""
        values = self.get(key, list)
        if not values:
            self.fail(f"has an empty {key!r}")
        return [Record(v, self.path, f"{self.where}, {key}[{i}],") for i, v in enumerate(values)]

    def rest(self, *known: str) -> dict[str, Any]:
        """Return the keys that are not ``known``."""
        return {key: value for key, value in self.raw.items() if key not in known}

    def _vector(self, key: str, value: Any, size: int) -> Vector:
        if not isinstance(value, list) or len(value) != size or not all(map(_finite, value)):
            self.fail(f"has a wrong {key!r}: {size} finite numbers are needed, not {short(value)}")
        return tuple(map(float, value))


def _finite(value: Any) -> bool:
    return isinstance(value, (int, float)) and abs(value) <= FARTHEST  # not of NaN, nor of True
