"""Imitate an expert on stored features. No rendering is needed, so a step can use hundreds of
decisions.

The encoders are frozen. Their features are computed once, on a grid of poses in every scene. The
agent must have a method ``store``. The loss is defined in ``recipes/imitate.py``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from torch import Tensor

from mitigate.core.seeding import generator
from mitigate.corruptions import Schedule
from mitigate.recipes.imitate import decide, falling_share, loss_weights
from mitigate.training.objective import Job, Objective, check_counts, check_share, divide
from mitigate.training.parts import TRAINABLE, train_only
from mitigate.training.rollouts import PIECES, batch_of
from mitigate.training.success import reject_success_distributed
from mitigate.worlds.world import TrainingEpisodes, World


@dataclass(eq=False, repr=False)
class StoredRollouts:
    """Source of batches of decisions that the agent computes from stored features.

    Args:
        agent: the agent, which acts with its current weights and has a method ``store``.
        world: function that constructs a world; the features of its scenes are stored.
        training: source of the episodes.
        folder: folder of the stored features.
        steps: number of training steps.
        episodes: number of episodes per step.
        follow_oracle: final fraction of decisions that follow the expert. The fraction falls from 1
            during the first 60 % of ``steps``.
        seed: seed of episodes, corruptions and actions.
        schedule: schedule that selects the corruptions of the corrupted copies.
        variants: number of corrupted copies of each scene's features, in addition to the clean
            features.

    Raises:
        ValueError: If there are no episodes, if the fraction is invalid, or if the schedule samples
            corruptions by success rate.
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
        check_counts(episodes=self.episodes)
        check_share("follow_oracle", self.follow_oracle)
        reject_success_distributed(self.schedule if self.variants else None)

    def start(self, workers: int | None) -> None:
        """Compute and store the features, in the precision of the training run."""
        variants = {"schedule": self.schedule, "variants": self.variants, "seed": self.seed}
        self.store = self.agent.store(
            self.world, self.folder, **(variants if self.variants else {})
        )
        self.store.build(workers)

    @property
    def pieces(self) -> int:
        """The number of jobs in every step."""
        return min(PIECES, self.episodes)

    def jobs(self, step: int) -> list[Job]:
        """Return the jobs of a step, whose items are episodes."""
        return divide(step, self.episodes, self.pieces)

    def work(self, job: Job) -> Any:
        """Run the episodes of a job and return their decisions."""
        step, number, jobs, count = job
        rngs = [generator(self.seed, "rollout", step, number, i) for i in range(count)]
        episodes = [self.training.draw(rng, (number, jobs)) for rng in rngs]
        expert_share = falling_share(step, self.steps, self.follow_oracle)
        return self.store.collect(episodes, expert_share=expert_share, rngs=rngs)


class ImitateStored(Objective):
    """Imitate the expert on stored features.

    Args:
        agent: the agent, whose ``stored_parts`` are trained in place.
        rollouts: the source of its decisions.
        losses: same as in ``Imitate``.
    """

    sources: ClassVar[Mapping[str, Callable[..., Any]]] = {"rollouts": StoredRollouts}
    needs = ("store", "stored_parts", *TRAINABLE)
    otherwise = (
        "This recipe needs an agent that stores features (agent=topological). recipe=dagger trains "
        "other agents from scratch."
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
        self.loss_weights = loss_weights(agent, losses)

    def start(self) -> None:
        self.rollouts.start(self.workers)

    def jobs(self, step: int) -> list[Job]:
        return self.rollouts.jobs(step)

    def pieces(self) -> int:
        return self.rollouts.pieces

    def work(self, job: Job) -> Any:
        return self.rollouts.work(job)

    def collate(self, step: int, pieces: list[Any]) -> dict[str, Any]:
        return batch_of(self.agent.join(pieces))

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        return decide(self.agent, batch["decisions"], self.loss_weights)[1]
