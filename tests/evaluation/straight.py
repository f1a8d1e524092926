"""An agent that needs no weights and reads no frame."""

from __future__ import annotations

from mitigate.core.observation import FORWARD, STOP


class Straight:
    """An agent that moves a number of steps forward and stops, without reading a frame."""

    def __init__(self, steps: int) -> None:
        self.steps = steps

    def reset(self, instruction: str) -> None:
        self.left = self.steps

    def act(self, observation) -> int:
        self.left -= 1
        return FORWARD if self.left >= 0 else STOP
