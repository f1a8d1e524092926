"""The fingerprint under which an agent's rows are kept, and whether rows may be reused."""

from __future__ import annotations

import weakref
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from mitigate.agents.fingerprint import contents, hash_of
from mitigate.core.observation import Sensor
from mitigate.evaluation.rows import read

# of agents without settings(), by id: the agent, its parts after the last run, and before the first
_last: dict[int, tuple[Callable[[], Any], Any, Any]] = {}


class Known:
    """``hash`` of ``agent`` behind ``sensors`` and ``front``, taken before episodes change its
    arrays and attributes; a context manager around all episodes.

    The attributes of an agent without ``settings()`` count. If only episodes have changed the
    object since the last call, its hash is the one from before them.
    """

    def __init__(
        self, agent: Any, sensors: Mapping[str, Sensor], front: str, version: str | None = None
    ) -> None:
        if version is not None and not (isinstance(version, str) and version):
            raise ValueError(
                f"version must be a non-empty string, got {version!r:.80}. Name what the agent is, "
                'such as version="2026-11 weights", and change it whenever its behaviour changes.'
            )
        self.agent = agent
        self.version = version
        self.without_settings = not hasattr(agent, "settings")
        found = contents(agent, version)
        same, after, before = _last.get(id(agent), (lambda: None, None, None))
        self.parts = before if same() is agent and after == found.parts else found.parts
        self.unreadable = found.explain() if found.unreadable else ""
        self.hash = hash_of(self.parts, sensors, front)

    def __enter__(self) -> Known:
        return self

    def __exit__(self, *_: object) -> None:
        if not self.without_settings:
            return
        agent = self.agent
        key = id(agent)
        try:
            same: Callable[[], Any] = weakref.ref(agent, lambda _: _last.pop(key, None))
        except TypeError:  # its class takes no weak references: the agent is kept alive

            def same() -> Any:
                return agent

        _last[key] = same, contents(agent, self.version).parts, self.parts

    def check(self, file: Path, name: str) -> Known:
        """Report that all rows of ``name`` in ``file`` belong to another agent; return self.

        Raises:
            ValueError: there are earlier rows, and the agent cannot be read completely.
        """
        rows = read(file) if file.exists() else []
        known = any(row["agent"] == self.hash for row in rows)
        kind = type(self.agent).__name__
        if self.unreadable and known:
            raise ValueError(
                f"{file} holds rows of {name}, perhaps of another agent: of this {kind}, "
                f'{self.unreadable} cannot be read. Give version="..." to reuse rows of that '
                "version, and change it whenever the agent's behaviour changes; or name another "
                "folder (out=...)."
            )
        if self.unreadable:
            print(
                f"{name}: of this {kind}, {self.unreadable} cannot be read, so no later call can "
                'reuse these rows. Give version="..." to allow it.',
                flush=True,
            )
        if known or not any(row["name"] == name for row in rows):
            return self
        counts = "attributes" if self.without_settings else "settings()"
        print(
            f"{name}: the rows of this name in {file} are of another agent, with another class, "
            f"code, weights, {counts}, hooks or version: all episodes run again.",
            flush=True,
        )
        if self.without_settings:
            print(
                f"Every attribute of a {kind} counts, also one that changes by itself, such as a "
                "clock: give it settings() if only some of them should.",
                flush=True,
            )
        return self
