"""Whose rows lie in the folder of a benchmark: the hash by which an agent is known."""

from __future__ import annotations

import weakref
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from mitigate.core.held import held
from mitigate.core.identity import hash_of, made_of
from mitigate.core.observation import Sensor
from mitigate.evaluation.rows import read

# of agents without settings(), by id: itself, what it was made of after its last walk, and before
_last: dict[int, tuple[Callable[[], Any], Any, Any]] = {}


class Known:
    """``hash`` of ``agent`` behind ``sensors`` and ``front`` (``core/identity.py``), taken before a
    walk changes its arrays and attributes; use it as a context manager around all walks.

    An agent without ``settings`` has its attributes count, unless it was ``loaded`` from weights:
    of an object that only walks changed since, the hash is that of before them.
    """

    def __init__(
        self, agent: Any, sensors: Mapping[str, Sensor], front: str, *, loaded: bool
    ) -> None:
        self.agent, self.loose = agent, not loaded and not hasattr(agent, "settings")
        now = made_of(agent, attributes=self.loose)
        same, after, before = _last.get(id(agent), (lambda: None, None, None))
        self.made = before if same() is agent and after == now else now
        self.hash = hash_of(self.made, sensors, front)

    def __enter__(self) -> Known:
        return self

    def __exit__(self, *_: object) -> None:
        if not self.loose:
            return
        agent, key = self.agent, id(self.agent)
        try:
            same: Callable[[], Any] = weakref.ref(agent, lambda _: _last.pop(key, None))
        except TypeError:  # of a class that takes no references: it is kept

            def same() -> Any:
                return agent

        _last[key] = same, made_of(agent, attributes=True), self.made

    def check(self, file: Path, name: str) -> None:
        """Say so if all rows of ``name`` in ``file`` are of another agent. Raise ValueError if
        there are some, and nothing tells whether it has the weights that they were walked with."""
        rows = [row for row in read(file) if row["name"] == name] if file.exists() else []
        if not rows:
            return
        kind = type(self.agent).__name__
        unknown = [] if hasattr(self.agent, "settings") else held(self.agent).unknown
        if unknown:
            raise ValueError(
                f"{file} holds rows of {name}, perhaps of other weights: a {kind} has no "
                f"settings(), and its {unknown[0]} cannot be looked into, or not as a whole. Name "
                "another folder (out=...), or give it settings() that say which weights it has."
            )
        if any(row["agent"] == self.hash for row in rows):
            return
        counts = "attributes" if self.loose else "settings()"
        print(
            f"benchmark: the rows of {name} in {file} are of another agent, whose class, code, "
            f"weights or {counts} were others: it walks anew.",
            flush=True,
        )
        if self.loose:
            print(
                f"Every attribute of a {kind} counts, also one that changes by itself, such as a "
                "clock: give it settings() if only some of them should.",
                flush=True,
            )
