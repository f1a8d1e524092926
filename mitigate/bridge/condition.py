"""One condition of a run: what the frames and words of a command meet."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from mitigate.bridge.words import Words
from mitigate.corruptions import Corruption, Key
from mitigate.guards.guard import NO_GUARDS, Guards


@dataclass
class Condition:
    """What a command meets: the corruption, its seed, and how it is applied.

    repeat: number of this run of the same condition; part of the keys where it is not 0. missing:
    metres that a hole reads. turn: where a growing yaw turns. guards: change words and
    frames behind the corruption. observers: told of every episode
    and frame, before its corruption (``recording.py``).
    """

    corruption: Corruption
    seed: int
    words: Words
    repeat: int = 0
    missing: float = 0.0
    turn: str = "left"
    keep: Callable[[list[str], int], list[int]] | None = None
    guards: Guards = NO_GUARDS
    observers: list[Any] = field(default_factory=list)

    def key(self, scene: str, episode: str, frame: int) -> Key:
        """Names the draw: seed, scene file and episode id, number of the call."""
        name = f"{scene.rpartition('/')[2]}/{episode}" + (f"#{self.repeat}" if self.repeat else "")
        return Key(self.seed, name, frame)
