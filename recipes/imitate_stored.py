"""Imitation on stored features: no rendering, hundreds of decisions a step.

The encoders are frozen; their features of a lattice of poses of every scene are computed once. For
an agent that has a ``store``. Otherwise as ``recipes/imitate.py``, whose loss it uses.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from torch import Tensor

from mitigate.core.seeding import generator
from mitigate.corruptions import Schedule
from mitigate.recipes.imitate import check_losses, falling_share, imitation, loss_weights
from mitigate.training import success
from mitigate.training.objective import Objective, check_share
from mitigate.training.parts import TRAINABLE, train_only
from mitigate.training.rollouts import PIECES, batch_of, check_episodes
from mitigate.worlds.world import TrainingEpisodes, World


@dataclass(eq=False, repr=False)
class StoredRollouts:
    """The source of batches of decisions on stored features.

    Args:
        agent: acts with its current weights; it has a ``store``.
        world: makes a world of the scenes whose features are stored.
        training: where episodes come from.
        folder: of the stores.
        steps: of the training.
        episodes: per step.
        follow_oracle: the expert's share of decisions at the end: it falls from 1 over the first
            0.6 of ``steps``.
        seed: of episodes, corruptions and actions.
        schedule: of the corruptions of the variants.
        variants: of each scene under corruptions of ``schedule``, stored beside the clean one.

    Raises:
        ValueError: for no episodes, for an invalid share, and for a schedule by success.
    """

    agent: Any
    world: Callable[[], World]
    training: TrainingEpisodes
    folder: str
    steps: int
    episodes: int = 40
    follow_oracle: float = 0.25
    seed: int = 0
    schedule: Schedule | None = None
    variants: int = 0

    def __post_init__(self) -> None:
        check_episodes(self.episodes)
        check_share("follow_oracle", self.follow_oracle)
        success.refuse(self.schedule if self.variants else None)

    def start(self, workers: int | None) -> None:
        """Make the store, in the precision of the training."""
        drawn = {"schedule": self.schedule, "variants": self.variants, "seed": self.seed}
        self.store = self.agent.store(self.world, self.folder, **(drawn if self.variants else {}))
        self.store.build(workers)

    @property
    def pieces(self) -> int:
        """How many jobs every step has."""
        return min(PIECES, self.episodes)

    def jobs(self, step: int) -> list[tuple]:
        """(step, piece, of how many, episodes) of each piece."""
        parts = np.array_split(np.arange(self.episodes), self.pieces)
        return [(step, i, len(parts), len(part)) for i, part in enumerate(parts)]

    def work(self, job: tuple) -> Any:
        """The decisions of a piece."""
        step, piece, pieces, count = job
        rngs = [generator(self.seed, "rollout", step, piece, i) for i in range(count)]
        episodes = [self.training.draw(rng, (piece, pieces)) for rng in rngs]
        expert_share = falling_share(step, self.steps, self.follow_oracle)
        return self.store.collect(episodes, expert_share=expert_share, rngs=rngs)


class ImitateStored(Objective):
    """Imitate the expert on stored features.

    Args:
        agent: its ``stored_parts`` are trained in place.
        rollouts: the source of its decisions.
        losses: as ``Imitate``.
    """

    sources: ClassVar[Mapping[str, Callable[..., Any]]] = {"rollouts": StoredRollouts}
    needs = ("store", "stored_parts", *TRAINABLE)
    otherwise = (
        "Only agents whose features are stored learn so (agent=topological); recipe=dagger trains "
        "the others from nothing."
    )

    def __init__(
        self,
        agent: Any,
        rollouts: StoredRollouts,
        losses: Mapping[str, float] | None = None,
    ) -> None:
        super().__init__()
        train_only(agent, agent.stored_parts)
        self.agent = agent
        self.rollouts = rollouts
        self.losses = loss_weights(agent, losses)

    def start(self) -> None:
        self.rollouts.start(self.workers)

    def jobs(self, step: int) -> list[tuple]:
        return self.rollouts.jobs(step)

    def pieces(self) -> int:
        return self.rollouts.pieces

    def work(self, job: tuple) -> Any:
        return self.rollouts.work(job)

    def collate(self, step: int, pieces: list[Any]) -> dict[str, Any]:
        return batch_of(self.agent.join(pieces))

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        decisions = batch["decisions"]
        out = self.agent.decide(decisions)
        check_losses(self.agent, self.losses, out)
        return imitation(out, decisions, self.losses)
