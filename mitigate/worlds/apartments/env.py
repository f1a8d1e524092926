"""The apartments as a torchrl environment with one agent and low-level actions."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from mitigate.worlds.apartments.tasks import OGN_SHARE, DrawnEpisodes
from mitigate.worlds.apartments.world import ApartmentsWorld
from mitigate.worlds.episodes import Episode
from mitigate.worlds.tensordict import WorldEnv


class ApartmentsEnv(WorldEnv):
    """Vision-and-language navigation in apartments: a ``WorldEnv`` of ``ApartmentsWorld``.

    Args:
        episodes: a VLN-CE file or a list of episodes. The episodes repeat in order. If None,
            training episodes are generated from ``seed``.
        seed, worker, workers: see ``WorldEnv``.
        apartments: number of training apartments from which episodes are generated.
        ogn_share: fraction of object-goal episodes among generated episodes.
        size: side of a square view in pixels.

    Raises:
        ValueError: If an argument is invalid (see ``WorldEnv``), or if the scene of an episode is
            not an apartment. The scene is checked at reset.
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
        source = DrawnEpisodes(apartments, ogn_share) if episodes is None else episodes
        super().__init__(ApartmentsWorld(size), source, seed=seed, worker=worker, workers=workers)
