"""Execute actions under a motion fault (``mitigate/corruptions/faults/motion.py``).

The effect of a fault depends on the kind of action:

* FORWARD, LEFT and RIGHT in a world that defines ``move`` (apartments, Habitat): slip and gain
  scale both the step of 0.25 m and the turn of 15 degrees. Drift turns the robot after
  FORWARD. A dropped action is a step without movement. STOP is always executed.
* Actions in a ``Box``: slip and gain scale the action, and drift adds a bias to all
  its elements. A dropped action becomes zero. The result is clipped to the bounds of the ``Box``.
* Other actions: only the fault ``repeated_action`` is possible, because it works with all actions.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from mitigate.core.observation import FORWARD, STOP, Observation
from mitigate.core.spaces import Box
from mitigate.corruptions import Corruption, Key, registry
from mitigate.corruptions.faults.motion import DRIFT, Movement
from mitigate.corruptions.record import MOTION
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import MOVES, World, WorldWrapper

# drift bias at severity 1, as a fraction of half the range of a Box element (heuristic)
BIAS = 0.25


class FaultyMotion(WorldWrapper):
    """A world whose actions are executed under one fault. The random numbers depend only on (seed,
    episode, step).

    Args:
        world: The world.
        fault: A motion fault.
        seed: Corruption seed.

    Raises:
        ValueError: If the fault is not possible with the actions of the world.
    """

    def __init__(self, world: World, fault: Corruption, seed: int) -> None:
        super().__init__(world)
        self.fault = fault
        self.seed = seed
        self._navigates = hasattr(_innermost(world), "move")
        space = self.action_space
        self._box = space if isinstance(space, Box) else None
        if not (self._navigates or self._box or fault.name == "repeated_action"):
            raise ValueError(
                f"{fault.name!r} cannot change the actions of {type(_innermost(world)).__name__}. "
                "It needs continuous actions (a Box), or a world that defines move(metres, "
                "degrees). The only motion fault for all kinds of actions is repeated_action."
            )

    def reset(self, episode: Episode) -> Observation:
        self._episode = episode.episode_id
        self._step = 0
        self._previous: Any = None
        return self._inner.reset(episode)

    def step(self, action: Any) -> Observation:
        """Execute an action after the fault has changed it."""
        draw = registry.record(self.fault.name).draw
        assert draw is not None, "a fault has a function"
        movement = draw(self.fault.severity, Key(self.seed, self._episode, self._step))
        self._step += 1
        if self._navigates and action == STOP:
            return self._inner.step(action)
        if movement.repeated and self._previous is not None:
            action = self._previous
        self._previous = action
        if movement in (Movement(), Movement(repeated=True)):
            return self._inner.step(action)
        if self._box is not None:
            return self._inner.step(_changed(action, movement, self._box))
        if action not in MOVES:  # the world raises the error for an invalid action
            return self._inner.step(action)
        robot: Any = self._inner  # a world that defines move, or a wrapper of such a world
        metres, degrees = MOVES[action]
        if movement.dropped:
            return robot.move(0.0, 0.0)
        drift = DRIFT * movement.drift if action == FORWARD else 0.0
        return robot.move(movement.gain * metres, movement.turn * degrees + drift)


def with_motion(world: World, corruption: Corruption, seed: int) -> World:
    """Wrap ``world`` with the motion faults of a corruption, if the corruption contains any."""
    for part in corruption.parts:
        if registry.record(part.name).family == MOTION:
            world = FaultyMotion(world, part, seed)
    return world


def _changed(action: Any, movement: Movement, box: Box) -> np.ndarray:
    """Return ``action`` as changed by a motion fault, clipped to ``box``."""
    values = box.check(action)
    if movement.dropped:
        changed = np.zeros_like(values)
    else:
        bounded = np.isfinite(box.low) & np.isfinite(box.high)
        half = np.where(bounded, (box.high - box.low) / 2.0, 1.0)
        changed = movement.gain * values + movement.drift * BIAS * half
    return np.clip(changed, box.low, box.high).astype(values.dtype)


def _innermost(world: Any) -> Any:
    while isinstance(world, WorldWrapper):
        world = world.world
    return world
