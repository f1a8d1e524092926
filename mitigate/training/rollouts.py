"""Batches of decisions that an agent takes in corrupted worlds, for recipes that imitate.

Every step rolls out a few training episodes with the current weights under the schedule's
corruptions; its batch is all their decisions.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from mitigate.agents.agent import Decisions, as_agent
from mitigate.core.files import sha256
from mitigate.core.pictures import picture
from mitigate.core.seeding import generator
from mitigate.corruptions import Schedule
from mitigate.training import limits
from mitigate.training.parts import OWN, TRAINABLE, hold_statistics
from mitigate.training.recipe import Recipe
from mitigate.training.success import measure, prior_rates
from mitigate.worlds.world import Corrupted, TrainingEpisodes, World

PIECES = 4  # jobs that the episodes of a step are shared out to (ours)


class Rollouts:
    """Args:
    agent: walks with its current weights, and gives the batches (``agents/agent.py``).
    world: makes a world. training: where episodes come from. schedule: which frame is corrupted by
    what, a success-distributed one by rates of ``agent``.
    episodes: a step. expert_share: of their decisions that the expert takes.
    prior: rows of one earlier evaluation, from which a success-distributed schedule starts.
    refresh_every: steps between two measurements of the success rates that such a schedule draws
    by, each on ``refresh_episodes`` training episodes under every corruption; 0: none after the
    first, which is made where there are no rates.
    clean: keep what there was to see before the corruption; ``teachers`` compute from it what does
    not change.

    Raises ValueError for no episodes, for a share that is none, and as ``prior_rates`` does.
    """

    def __init__(
        self,
        agent: Any,
        world: Callable[[], World],
        training: TrainingEpisodes,
        schedule: Schedule,
        *,
        episodes: int,
        expert_share: float,
        seed: int,
        prior: str | None = None,
        refresh_every: int = 0,
        refresh_episodes: int = 8,
        clean: bool = False,
        teachers: Sequence[Any] = (),
    ) -> None:
        if episodes < 1:
            raise ValueError(f"episodes={episodes} a step are none: give 1 or more (rollouts=20).")
        limits.check_share("follow_oracle", expert_share)
        self.agent, self.world, self.training, self.schedule = agent, world, training, schedule
        self.episodes, self.expert_share, self.seed = episodes, expert_share, seed
        self.prior, self.refresh_every = prior, refresh_every
        self.refresh_episodes, self.clean, self.teachers = refresh_episodes, clean, teachers
        self.picture: np.ndarray | None = None
        if prior is not None:
            schedule.refresh(prior_rates(prior))

    @property
    def pieces(self) -> int:
        """How many jobs every step has."""
        return min(PIECES, self.episodes)

    def identity(self) -> dict[str, str]:
        """Hashes of the files that the batches are made of."""
        prior = {} if self.prior is None else {"prior_sha256": sha256(self.prior)}
        return {**getattr(self.training, "identity", dict)(), **prior}

    def jobs(self, step: int, workers: int | None = None) -> list[tuple]:
        """(step, piece, of how many, episodes, the schedule's state) of each piece; ``workers``:
        processes that measure success rates where they are due."""
        due = bool(self.refresh_every) and step % self.refresh_every == 0
        due = due and not (step == 0 and self.prior)
        if self.schedule.mode == "success_distributed" and (due or self.schedule.success is None):
            self.refresh(step, workers)
        parts = np.array_split(np.arange(self.episodes), self.pieces)
        state = self.schedule.state_dict()
        return [(step, i, len(parts), len(part), state) for i, part in enumerate(parts)]

    def work(self, job: tuple) -> tuple[Any, np.ndarray | None]:
        """What was decided in the episodes of a piece, and a picture of the last look."""
        step, piece, pieces, count, state = job
        if state != self.schedule.state_dict():
            self.schedule.load_state_dict(state)
        rngs = [generator(self.seed, "rollout", step, piece, i) for i in range(count)]
        episodes = [self.training.draw(rng, (piece, pieces)) for rng in rngs]
        worlds = [
            Corrupted(self.world(), self.schedule, self.seed, f"{step}-{piece}-{i}")
            for i in range(count)
        ]
        made = self.agent.collect(
            worlds, episodes, expert_share=self.expert_share, rngs=rngs, clean=self.clean
        )
        for teacher in self.teachers:
            made = as_agent(teacher).precompute(made, clean=True)
        return made, picture(worlds[0].last)

    def collate(self, pieces: list[tuple]) -> Decisions:
        """The decisions of all pieces."""
        self.picture = pieces[0][1] if pieces[0][1] is not None else self.picture
        return self.agent.join([piece for piece, _ in pieces])

    def figures(self) -> dict[str, np.ndarray]:
        """A panorama as the agent saw it in the last batch."""
        return {} if self.picture is None else {"seen": self.picture}

    def refresh(self, step: int, workers: int | None = None) -> None:
        """Measure the success under every corruption on training episodes, for the schedule."""
        self.schedule.refresh(
            measure(
                self.agent,
                self.schedule,
                self.world,
                self.training,
                episodes=self.refresh_episodes,
                seed=self.seed,
                step=step,
                workers=workers,
            )
        )
        hold_statistics(self.agent.train())


class OnEpisodes(Recipe):
    """A recipe that learns from ``rollouts``, which its constructor makes."""

    needs = TRAINABLE
    otherwise = f"This recipe learns from episodes that the agent walks. {OWN}"
    rollouts: Rollouts

    def identity(self) -> dict[str, str]:
        return self.rollouts.identity()

    def jobs(self, step: int) -> list[tuple]:
        return self.rollouts.jobs(step, self.workers)

    def pieces(self) -> int:
        return self.rollouts.pieces

    def work(self, job: tuple) -> Any:
        return self.rollouts.work(job)

    def collate(self, step: int, pieces: list[Any]) -> dict[str, Any]:
        return batch_of(self.rollouts.collate(pieces))

    def evaluate(self, step: int) -> dict[str, float]:
        """The schedule's weights, for the log."""
        return {f"p/{name}": p for name, p in self.rollouts.schedule.weights.items()}

    def figures(self, step: int) -> dict[str, np.ndarray]:
        return self.rollouts.figures()

    def get_extra_state(self) -> dict[str, Any]:
        return {"schedule": self.rollouts.schedule.state_dict()}

    def set_extra_state(self, state: dict[str, Any]) -> None:
        self.rollouts.schedule.load_state_dict(state["schedule"])


def batch_of(decisions: Decisions) -> dict[str, Any]:
    """Decisions as the trainer takes a batch."""
    return {"decisions": decisions, "episode_ids": [str(name) for name in decisions.episode_ids]}
