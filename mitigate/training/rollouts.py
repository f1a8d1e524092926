"""Collect batches of an agent's decisions in corrupted worlds, for imitation objectives.

Each step runs a few training episodes with the current weights, under the corruptions of the
schedule. The batch contains all decisions in these episodes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from mitigate.agents.agent import Decisions, as_agent
from mitigate.core.pictures import picture
from mitigate.core.seeding import generator
from mitigate.corruptions import Schedule
from mitigate.training.objective import OnSource, check_counts, check_share
from mitigate.training.parts import OWN, TRAINABLE
from mitigate.training.success import DrawsBySuccess, ScheduledJob
from mitigate.worlds.world import Corrupted, TrainingEpisodes, World

PIECES = 4  # number of jobs into which the episodes of a step are divided (heuristic)


@dataclass(eq=False, repr=False)
class Rollouts(DrawsBySuccess):
    """Source of batches of decisions, collected in rollouts of ``agent`` under a schedule of
    corruptions.

    Args:
        agent: the agent, which acts with its current weights and collects its decisions
            (``agents/agent.py``).
        world: function that constructs a world.
        training: source of the episodes.
        schedule: chooses the corruption of each frame, possibly by the success rates of ``agent``.
            If None, frames stay clean.
        episodes: number of episodes per step.
        follow_oracle: fraction of decisions that follow the expert.
        seed: seed of episodes, corruptions and actions.
        refresh_every: number of steps between two measurements of success rates; with 0, they are
            measured only if there are no rates yet.
        refresh_episodes: number of training episodes per corruption in each measurement.

    Raises:
        ValueError: If there are no episodes, or if a fraction is invalid.
    """

    agent: Any
    world: Callable[[], World]
    training: TrainingEpisodes
    schedule: Schedule = None  # type: ignore[assignment]
    episodes: int = 3
    follow_oracle: float = 0.5
    seed: int = 0
    refresh_every: int = 0
    refresh_episodes: int = 8

    def __post_init__(self) -> None:
        check_counts(rollouts=self.episodes)
        check_share("follow_oracle", self.follow_oracle)
        self.schedule = self.schedule or Schedule("clean", 0.0)
        self.clean = False
        self.teachers: tuple[Any, ...] = ()
        self.picture: np.ndarray | None = None

    def keep_clean(self, *teachers: Any) -> None:
        """Also keep the clean observations.

        From these, ``teachers`` compute their fixed features in advance.
        """
        self.clean = True
        self.teachers = teachers

    @property
    def pieces(self) -> int:
        """The number of jobs in every step."""
        return min(PIECES, self.episodes)

    def identity(self) -> dict[str, str]:
        """Return hashes of the files on which the batches depend."""
        # a user-defined source of episodes that reads no files needs no method identity()
        return dict(getattr(self.training, "identity", dict)())

    def jobs(self, step: int, workers: int | None = None) -> list[ScheduledJob]:
        """Return the jobs of a step, whose items are episodes.

        If the schedule needs success rates, they are measured with ``workers`` processes at the
        first step and every ``refresh_every`` steps.
        """
        due = bool(self.refresh_every) and step % self.refresh_every == 0
        self.refresh_if_needed(step, workers, due)
        return self.scheduled_jobs(step, self.episodes, self.pieces)

    def work(self, job: ScheduledJob) -> tuple[Any, np.ndarray | None]:
        """Run the episodes of a job; return their decisions and a picture of the last frame."""
        step, number, jobs, count, schedule_state = job
        self.schedule.load_state_dict(schedule_state)
        rngs = [generator(self.seed, "rollout", step, number, i) for i in range(count)]
        episodes = [self.training.draw(rng, (number, jobs)) for rng in rngs]
        worlds = [
            Corrupted(self.world(), self.schedule, self.seed, f"{step}-{number}-{i}")
            for i in range(count)
        ]
        decisions = self.agent.collect(
            worlds, episodes, expert_share=self.follow_oracle, rngs=rngs, clean=self.clean
        )
        for teacher in self.teachers:
            decisions = as_agent(teacher).precompute(decisions, clean=True)
        return decisions, picture(worlds[0].last)

    def collate(self, pieces: list[tuple]) -> Decisions:
        """Join the decisions of all jobs."""
        _, first_picture = pieces[0]
        self.picture = self.picture if first_picture is None else first_picture
        return self.agent.join([piece for piece, _ in pieces])

    def figures(self) -> dict[str, np.ndarray]:
        """Return a picture of an observation from the last batch."""
        return {} if self.picture is None else {"seen": self.picture}


class OnEpisodes(OnSource):
    """Base class of objectives that learn from rollouts."""

    sources: ClassVar[Mapping[str, Callable[..., Any]]] = {"rollouts": Rollouts}
    needs: ClassVar[tuple[str, ...]] = TRAINABLE
    otherwise = f"This recipe trains on episodes that the agent runs. {OWN}"
    rollouts: Rollouts

    def collate(self, step: int, pieces: list[Any]) -> dict[str, Any]:
        return batch_of(self.rollouts.collate(pieces))

    def evaluate(self, step: int) -> dict[str, float]:
        """Return the sampling weights of the schedule, which are logged."""
        return {f"p/{name}": p for name, p in self.rollouts.schedule.weights.items()}


def batch_of(decisions: Decisions) -> dict[str, Any]:
    """Put decisions into a batch for the trainer."""
    needed = ("episode_ids", "target", "weight")
    if absent := [name for name in needed if not hasattr(decisions, name)]:
        raise ValueError(
            f"join() of the agent must return an object with {', '.join(absent)} (Decisions in "
            f"mitigate/agents/agent.py), got {type(decisions).__name__}."
        )
    return {"decisions": decisions, "episode_ids": [str(name) for name in decisions.episode_ids]}
