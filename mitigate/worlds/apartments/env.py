"""The apartments as a torchrl environment: ``ApartmentsEnv``, one agent, low-level actions."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from mitigate.worlds.apartments.simulator import Simulator
from mitigate.worlds.apartments.tasks import OGN_SHARE, DrawnEpisodes
from mitigate.worlds.apartments.world import ApartmentsWorld
from mitigate.worlds.episodes import Episode
from mitigate.worlds.tensordict import WorldEnv


class ApartmentsEnv(WorldEnv):
    """Vision-and-language navigation in apartments: a ``WorldEnv`` of ``ApartmentsWorld``.

    Args:
        episodes: a VLN-CE file, or a list of episodes, run in order and over again; None draws
            training episodes from ``seed``.
        apartments, ogn_share: of the drawn episodes (see ``draw_training_episode``).
        size: pixels of a view. seed, worker, workers: as ``WorldEnv``.

    Raises ValueError as ``WorldEnv`` does; on reset, for an episode of a scene that is not an
    apartment.
    """

    key = "apartments env"
    world: ApartmentsWorld

    def __init__(
        self,
        episodes: Path | str | Sequence[Episode] | None = None,
        *,
        seed: int = 0,
        apartments: int = 2000,
        ogn_share: float = OGN_SHARE,
        worker: int = 0,
        workers: int = 1,
        size: int = 64,
    ) -> None:
        drawn = DrawnEpisodes(apartments, ogn_share)
        super().__init__(
            ApartmentsWorld(size),
            drawn if episodes is None else episodes,
            seed=seed,
            worker=worker,
            workers=workers,
        )

    @property
    def simulator(self) -> Simulator:
        """The simulator of the current episode; opened at first use, so specs cost no rendering."""
        return self.world.simulator
