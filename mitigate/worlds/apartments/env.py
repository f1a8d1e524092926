"""The apartments as a torchrl environment: ``ApartmentsEnv``, one agent, low-level actions.

Only this file and ``mitigate/worlds/transforms.py`` import torchrl (4 s); the simulator needs none.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import torch
from tensordict import TensorDict, TensorDictBase
from torchrl.data import Bounded, Categorical, Composite, NonTensor, Unbounded
from torchrl.envs import EnvBase

from mitigate.core.observation import DEPTH, EPISODE, FRAME, INSTRUCTION, POSE, RGB, VIEWS
from mitigate.core.seeding import generator
from mitigate.evaluation.metrics import success
from mitigate.worlds.apartments.renderer import shared_renderer
from mitigate.worlds.apartments.simulator import Simulator
from mitigate.worlds.apartments.tasks import SUCCESS_METRES, draw_training_episode
from mitigate.worlds.episodes import Episode, read_episodes

ACTIONS = 4  # STOP, FORWARD, LEFT, RIGHT of mitigate.core.observation


class ApartmentsEnv(EnvBase):
    """Vision-and-language navigation in apartments (``batch_size`` []).

    Observation: the entries of ``core/observation.py`` (``rgb`` uint8 [12, S, S, 3], ``depth``
    float32 metres [12, S, S, 1], ``pose`` float32 [3]), ``instruction`` (str), ``episode`` (str,
    unique to each run of an episode) and ``frame`` int64 [1], the low-level steps
    taken. Action: int64 in 0-3. Reward float32 [1]: 1 for a STOP nearer than ``SUCCESS_METRES``
    to the goal (geodesic), else 0. ``terminated`` on STOP, ``truncated`` at the step limit.

    Args:
        episodes: a VLN-CE file, or a list of episodes, run in order and over again; None draws
            training episodes from ``seed``.
        seed: of the drawn episodes; ``set_seed`` replaces it and starts from the first one again.
        apartments, ogn_share: of the drawn episodes (see ``draw_training_episode``).
        worker, workers: this environment runs the episodes ``worker``, ``worker + workers``, ...;
            four environments that share the work and the seed meet what a single one meets.
        size: pixels of a view.

    Raises ValueError for an empty list and for a worker outside 0 ... workers - 1; on reset, for an
    episode of a scene that is not an apartment.
    """

    def __init__(
        self,
        episodes: Path | str | Sequence[Episode] | None = None,
        *,
        seed: int = 0,
        apartments: int = 2000,
        ogn_share: float = 0.15,
        worker: int = 0,
        workers: int = 1,
        size: int = 64,
    ) -> None:
        super().__init__(device="cpu", batch_size=[])
        if not 0 <= worker < workers:
            raise ValueError(
                f"worker={worker} of workers={workers}: worker counts from 0 to {workers - 1}."
            )
        self.episodes = None if episodes is None else _listed(episodes)
        self.seed, self.apartments, self.ogn_share = seed, apartments, ogn_share
        self.worker, self.workers, self.size = worker, workers, size
        self._number = worker
        self._simulator: Simulator | None = None
        self._make_specs()

    @property
    def simulator(self) -> Simulator:
        """The simulator of the current episode; opened at first use, so specs cost no rendering."""
        if self._simulator is None:
            self._simulator = Simulator(self.size, renderer=shared_renderer(self.size))
        return self._simulator

    def _make_specs(self) -> None:
        frame = (VIEWS, self.size, self.size)
        flag = Categorical(2, shape=(1,), dtype=torch.bool)
        self.observation_spec = Composite(
            {
                RGB: Bounded(0, 255, shape=(*frame, 3), dtype=torch.uint8),
                DEPTH: Unbounded(shape=(*frame, 1), dtype=torch.float32),
                POSE: Unbounded(shape=(3,), dtype=torch.float32),
                INSTRUCTION: NonTensor(shape=(), example_data="Wait by the table."),
                EPISODE: NonTensor(shape=(), example_data="000000-vln-0"),
                FRAME: Unbounded(shape=(1,), dtype=torch.int64),
            }
        )
        self.action_spec = Categorical(ACTIONS, shape=(), dtype=torch.int64)
        self.reward_spec = Unbounded(shape=(1,), dtype=torch.float32)
        self.done_spec = Composite(
            {name: flag.clone() for name in ("done", "terminated", "truncated")}
        )

    def _reset(self, tensordict: TensorDictBase | None = None, **kwargs: object) -> TensorDictBase:
        episode, self._name = self._episode(self._number)
        self._number += self.workers
        self.simulator.reset(episode)
        return self._state()

    def _step(self, tensordict: TensorDictBase) -> TensorDictBase:
        simulator = self.simulator
        simulator.step(int(tensordict["action"]))
        won = success(simulator.distance_to_goal(), simulator.stopped, threshold=SUCCESS_METRES)
        return self._state().set("reward", torch.tensor([float(won)]))

    def _set_seed(self, seed: int | None) -> None:
        self.seed, self._number = 0 if seed is None else int(seed), self.worker

    def _episode(self, number: int) -> tuple[Episode, str]:
        """Episode ``number`` and its unique name: a function of (list or seed, number)."""
        if self.episodes is None:
            rng = generator(self.seed, "apartments env", number)
            episode, again = draw_training_episode(rng, self.apartments, self.ogn_share), number
        else:
            again, place = divmod(number, len(self.episodes))
            episode = self.episodes[place]
        return episode, f"{episode.episode_id}@{again}" if again else episode.episode_id

    def _state(self) -> TensorDictBase:
        simulator = self.simulator
        seen = {name: torch.from_numpy(array) for name, array in simulator.observe().items()}
        over = {
            "done": simulator.done,
            "terminated": simulator.stopped,
            "truncated": simulator.done and not simulator.stopped,
        }
        return TensorDict(
            {
                **seen,
                INSTRUCTION: simulator.episode.instruction.text,
                EPISODE: self._name,
                FRAME: torch.tensor([simulator.steps]),
                **{name: torch.tensor([value]) for name, value in over.items()},
            },
            batch_size=[],
        )


def _listed(episodes: Path | str | Sequence[Episode]) -> list[Episode]:
    if isinstance(episodes, Path | str):
        found, place = list(read_episodes(episodes)), str(episodes)
    else:
        found, place = list(episodes), "the list"
    if not found:
        raise ValueError(
            f"There is no episode in {place}: give at least one, or None to draw from the "
            "training seeds."
        )
    return found
