"""Run the two control agents of ``mitigate controls``: a shortest-path oracle and a random
agent.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from mitigate.core.build import maker
from mitigate.core.locks import FolderLock
from mitigate.core.observation import FORWARD, LEFT, RIGHT, STOP
from mitigate.core.seeding import generator
from mitigate.corruptions import CLEAN
from mitigate.evaluation import provenance, rows
from mitigate.evaluation.config import EvaluateConfig
from mitigate.evaluation.episode_lists import episodes
from mitigate.evaluation.evaluator import EpisodeJob, EpisodeTask, jobs_of, label_of, run_missing
from mitigate.worlds.world import World, expert_of

# probability that a random action is STOP; episodes then have about 100 actions
_STOP_SHARE = 0.01


class OracleAgent:
    """Agent that takes the actions of the world's expert and does not read frames."""

    def __init__(self, world: World) -> None:
        self.world = world

    def reset(self, instruction: str) -> None:
        self.expert = expert_of(self.world)

    def act(self, observation: Mapping[str, np.ndarray]) -> int:
        return self.expert.action()


class RandomAgent:
    """Agent that takes random actions: forward, left or right, and with a small probability STOP.

    The random generator depends on the id in ``episode``, because several episodes may have the
    same text.
    """

    episode = ""

    def reset(self, instruction: str) -> None:
        self.rng = generator("random agent", self.episode)

    def act(self, observation: Mapping[str, np.ndarray]) -> int:
        if self.rng.random() < _STOP_SHARE:
            return STOP
        return int(self.rng.choice([FORWARD, FORWARD, LEFT, RIGHT]))


class ControlTask(EpisodeTask):
    """Worker task that runs the episodes of a control agent, with one episode per group."""

    def work(self, jobs: Sequence[EpisodeJob]) -> Iterator[rows.Row]:
        if isinstance(self.agent, RandomAgent):
            self.agent.episode = jobs[0].episode.episode_id
        return super().work(jobs)


def run(config: EvaluateConfig, out: Path) -> list[rows.Row]:
    """Run both control agents on the episodes of ``config`` and return their rows.

    The rows are also written to the folder ``out``. Rows that this folder already contains are
    reused.
    """
    env, split = config.env, config.split
    chosen = episodes(env, split, config.episodes)
    make_world = maker(env.world)
    results: list[rows.Row] = []
    with FolderLock(out) as lock:
        world, made_by = provenance.first_world(make_world)
        note = provenance.keep(out, world, made_by, split, chosen, env.episodes[split])
        lock.expect(out / rows.ROWS, note)
        for name, agent in {"oracle": OracleAgent(world), "random": RandomAgent()}.items():
            jobs = jobs_of(chosen, [CLEAN], label_of(name, name, split, 0, world))
            task = ControlTask(agent, make_world, world=world)
            results += run_missing(task, jobs, out / rows.ROWS, name)
    return results
