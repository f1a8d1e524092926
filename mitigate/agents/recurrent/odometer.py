"""What an agent knows of its own motion: the actions it took, and no sensor."""

from __future__ import annotations

import math

import numpy as np

from mitigate.core.observation import FORWARD, FORWARD_METRES, LEFT, RIGHT, TURN_DEGREES

MOVES = 5 + 4  # last action (none, or one of four); heading as sine and cosine, metres gone, steps
_METRES, _STEPS = 5.0, 50.0  # units in which metres gone and steps taken are given


class Odometer:
    """Counts the actions of an episode."""

    def __init__(self) -> None:
        self.last = -1
        self.heading = self.metres = 0.0
        self.steps = 0

    def add(self, action: int) -> None:
        """Count an action."""
        self.last, self.steps = action, self.steps + 1
        self.heading += math.radians(TURN_DEGREES) * ((action == LEFT) - (action == RIGHT))
        self.metres += FORWARD_METRES * (action == FORWARD)

    def correct(self, action: int, metres: float, radians: float) -> None:
        """Count in place of the last action another one, or none (-1), which went so far."""
        self.heading -= math.radians(TURN_DEGREES) * ((self.last == LEFT) - (self.last == RIGHT))
        self.metres -= FORWARD_METRES * (self.last == FORWARD)
        self.last = action
        self.heading += radians
        self.metres += max(0.0, metres)

    def moves(self) -> np.ndarray:
        """float32 [9]: which action was the last one (none, or one of four), sine and cosine of the
        turns since the start, metres gone / 5, steps taken / 50."""
        out = np.zeros(MOVES, np.float32)
        out[1 + self.last] = 1.0
        out[5:] = (
            math.sin(self.heading),
            math.cos(self.heading),
            self.metres / _METRES,
            self.steps / _STEPS,
        )
        return out
