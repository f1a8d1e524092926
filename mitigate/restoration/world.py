"""A world whose frames a restorer has gone over; itself a world, as a corrupted one is."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from mitigate.core.observation import Observation, Sensor
from mitigate.restoration.restorer import Restorer
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import Expert, World


class Restored:
    """``world`` seen through ``restorer``: frames are restored when they are read, so an agent that
    looks at none pays nothing. ``observation.clean`` stays what it was."""

    def __init__(self, world: World, restorer: Restorer) -> None:
        self.world, self.restorer = world, restorer

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or name == "world":
            raise AttributeError(name)
        return getattr(self.world, name)

    @property
    def sensors(self) -> Mapping[str, Sensor]:
        return self.world.sensors

    @property
    def done(self) -> bool:
        return self.world.done

    def reset(self, episode: Episode) -> Observation:
        return self._seen(self.world.reset(episode))

    def step(self, action: int) -> Observation:
        return self._seen(self.world.step(action))

    def measures(self) -> dict[str, float]:
        return self.world.measures()

    def expert(self) -> Expert | None:
        return getattr(self.world, "expert", lambda: None)()

    def truth(self) -> Mapping[str, Any]:
        return getattr(self.world, "truth", dict)()

    def _seen(self, met: Observation) -> Observation:
        def restored() -> dict[str, Any]:
            return self.restorer({name: met[name] for name in met.frames})

        return Observation(met.ready, restored, met.frames, clean=met.clean)
