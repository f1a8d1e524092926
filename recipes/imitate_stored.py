"""Imitation on stored features: no rendering, hundreds of decisions a step.

The encoders are frozen; their features of a lattice of poses of every scene are computed once. For
an agent that has a ``store``. Otherwise as ``recipes/imitate.py``, whose loss it uses.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from torch import Tensor

from mitigate.core.seeding import generator
from mitigate.corruptions import Schedule
from mitigate.recipes.imitate import check_losses, falling_share, imitation, loss_weights
from mitigate.training import limits, success
from mitigate.training.parts import TRAINABLE, train_only
from mitigate.training.recipe import Recipe
from mitigate.training.rollouts import PIECES, batch_of
from mitigate.worlds.world import TrainingEpisodes, World


class ImitateStored(Recipe):
    """Args: agent: ``agent.stored_parts`` of it is trained in place. world, training: of the scenes
    whose features are stored. folder: of the stores. episodes: a step. steps: over 0.6 of them the
    oracle's share of rollout decisions falls from 1 to ``follow_oracle``. losses: as ``Imitate``.
    variants: of each scene under corruptions that ``schedule`` draws, stored beside the clean one;
    0: clean alone.
    """

    needs = ("store", "stored_parts", *TRAINABLE)
    otherwise = (
        "Only agents whose features are stored learn so (agent=topological); recipe=dagger trains "
        "the others from nothing."
    )

    def __init__(
        self,
        agent: Any,
        world: Callable[[], World],
        training: TrainingEpisodes,
        folder: str,
        steps: int,
        episodes: int = 40,
        follow_oracle: float = 0.25,
        seed: int = 0,
        losses: Mapping[str, float] | None = None,
        schedule: Schedule | None = None,
        variants: int = 0,
    ) -> None:
        super().__init__()
        if episodes < 1:
            raise ValueError(f"episodes={episodes} a step are none: give 1 or more (rollouts=20).")
        limits.check_share("follow_oracle", follow_oracle)
        success.refuse(schedule if variants else None)
        train_only(agent, agent.stored_parts)
        self.agent, self.world, self.source, self.folder = agent, world, training, folder
        self.steps, self.episodes, self.follow_oracle, self.seed = (
            steps,
            episodes,
            follow_oracle,
            seed,
        )
        self.losses = loss_weights(agent, losses)
        self.variants = (
            {"schedule": schedule, "variants": variants, "seed": seed} if variants else {}
        )

    def start(self) -> None:
        """Make the store, in the precision of the training."""
        self.store = self.agent.store(self.world, self.folder, **self.variants)
        self.store.build(self.workers)

    def jobs(self, step: int) -> list[tuple]:
        """(step, piece, of how many, episodes) of each piece."""
        parts = np.array_split(np.arange(self.episodes), self.pieces())
        return [(step, i, len(parts), len(part)) for i, part in enumerate(parts)]

    def pieces(self) -> int:
        return min(PIECES, self.episodes)

    def work(self, job: tuple) -> Any:
        step, piece, pieces, count = job
        rngs = [generator(self.seed, "rollout", step, piece, i) for i in range(count)]
        episodes = [self.source.draw(rng, (piece, pieces)) for rng in rngs]
        expert_share = falling_share(step, self.steps, self.follow_oracle)
        return self.store.collect(episodes, expert_share=expert_share, rngs=rngs)

    def collate(self, step: int, pieces: list[Any]) -> dict[str, Any]:
        return batch_of(self.agent.join(pieces))

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        decisions = batch["decisions"]
        out = self.agent.decide(decisions)
        check_losses(self.agent, self.losses, out)
        return imitation(out, decisions, self.losses)
