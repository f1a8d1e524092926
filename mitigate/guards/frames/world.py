"""A world whose frames a restorer has gone over; itself a world, as a corrupted one is."""

from __future__ import annotations

from typing import Any

from mitigate.core.observation import Observation
from mitigate.guards.frames.restorer import Restorer
from mitigate.worlds.world import World, WorldWrapper


class Restored(WorldWrapper):
    """``world`` seen through ``restorer``: frames are restored when they are read, so an agent that
    looks at none pays nothing. ``observation.clean`` stays what it was."""

    def __init__(self, world: World, restorer: Restorer) -> None:
        super().__init__(world)
        self.restorer = restorer

    def _seen(self, met: Observation) -> Observation:
        def restored() -> dict[str, Any]:
            return self.restorer({name: met[name] for name in met.frames})

        return Observation(met.ready, restored, met.frames, clean=met.clean)
