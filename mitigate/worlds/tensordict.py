"""torchrl both ways: any world as an environment, and any environment with frames as a world.

Only this file, ``transforms.py`` and ``apartments/env.py`` import torchrl (4 s).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch
from tensordict import TensorDict, TensorDictBase
from torchrl.data import Bounded, Categorical, Composite, NonTensor, OneHot, Unbounded
from torchrl.envs import EnvBase

from mitigate.core.observation import (
    DEPTH,
    EPISODE,
    FRAME,
    INSTRUCTION,
    POSE,
    RGB,
    STOP,
    Observation,
    Sensor,
)
from mitigate.core.seeding import digest, generator
from mitigate.worlds.episodes import Episode, read_episodes
from mitigate.worlds.world import TrainingEpisodes, World


class WorldEnv(EnvBase):
    """Any world as a torchrl environment (``batch_size`` []).

    Observation: an entry for each of the world's sensors, ``instruction`` (str), ``episode`` (str,
    unique to each run of an episode) and ``frame`` int64 [1], the steps taken. Action: int64 from 0
    to ``actions`` - 1, 0 is STOP. Reward float32 [1]: the world's ``success`` when the episode is
    over, else 0. ``terminated`` on STOP, ``truncated`` at the world's own end.

    Args:
        world: shared with nobody else.
        episodes: a VLN-CE file or a list, run in order and over again; or training episodes
            (``worlds/world.py``), drawn from ``seed``.
        seed: of the drawn episodes; ``set_seed`` replaces it and starts from the first one again.
        worker, workers: this environment runs the episodes ``worker``, ``worker + workers``, ...;
            four environments that share the work and the seed meet what a single one meets.

    Raises ValueError for an empty list and for a worker outside 0 ... workers - 1.
    """

    key = "world env"  # of the draws of episodes

    def __init__(
        self,
        world: World,
        episodes: Path | str | Sequence[Episode] | TrainingEpisodes,
        *,
        actions: int = 4,
        seed: int = 0,
        worker: int = 0,
        workers: int = 1,
    ) -> None:
        super().__init__(device="cpu", batch_size=[])
        if not 0 <= worker < workers:
            raise ValueError(
                f"worker={worker} of workers={workers}: worker counts from 0 to {workers - 1}."
            )
        self.world, self.actions, self.seed = world, actions, seed
        self.episodes = episodes if hasattr(episodes, "draw") else _listed(episodes)
        self.worker, self.workers = worker, workers
        self._number = worker
        self._make_specs()

    def _make_specs(self) -> None:
        flag = Categorical(2, shape=(1,), dtype=torch.bool)
        self.observation_spec = Composite(
            {
                **{name: _spec_of(sensor) for name, sensor in self.world.sensors.items()},
                INSTRUCTION: NonTensor(shape=(), example_data="Wait by the table."),
                EPISODE: NonTensor(shape=(), example_data="000000-vln-0"),
                FRAME: Unbounded(shape=(1,), dtype=torch.int64),
            }
        )
        self.action_spec = Categorical(self.actions, shape=(), dtype=torch.int64)
        self.reward_spec = Unbounded(shape=(1,), dtype=torch.float32)
        self.done_spec = Composite(
            {name: flag.clone() for name in ("done", "terminated", "truncated")}
        )

    def _reset(self, tensordict: TensorDictBase | None = None, **kwargs: object) -> TensorDictBase:
        self._episode, self._name = self._drawn(self._number)
        self._number += self.workers
        self._frame = 0
        return self._state(self.world.reset(self._episode), stopped=False)

    def _step(self, tensordict: TensorDictBase) -> TensorDictBase:
        action = int(tensordict["action"])
        seen = self.world.step(action)
        self._frame += 1
        won = float(self.world.measures()["success"]) if self.world.done else 0.0
        return self._state(seen, stopped=action == STOP).set("reward", torch.tensor([won]))

    def _set_seed(self, seed: int | None) -> None:
        self.seed, self._number = 0 if seed is None else int(seed), self.worker

    def _drawn(self, number: int) -> tuple[Episode, str]:
        """Episode ``number`` and its unique name: a function of (list or seed, number)."""
        if hasattr(self.episodes, "draw"):
            rng = generator(self.seed, self.key, number)
            episode, again = self.episodes.draw(rng, (0, 1)), number
        else:
            again, place = divmod(number, len(self.episodes))
            episode = self.episodes[place]
        return episode, f"{episode.episode_id}@{again}" if again else episode.episode_id

    def _state(self, seen: Observation, stopped: bool) -> TensorDictBase:
        done = self.world.done
        over = {"done": done, "terminated": done and stopped, "truncated": done and not stopped}
        return TensorDict(
            {
                **{name: torch.from_numpy(np.array(seen[name])) for name in self.world.sensors},
                INSTRUCTION: self._episode.instruction.text,
                EPISODE: self._name,
                FRAME: torch.tensor([self._frame]),
                **{name: torch.tensor([value]) for name, value in over.items()},
            },
            batch_size=[],
        )


class EnvWorld:
    """Any torchrl environment that shows frames as a world, to evaluate in under the suite.

    An episode is a seed: ``info["seed"]`` of it, or else a number made of its id. Success is what
    ``success`` says at the end: the name of an entry, or None: a reward above 0 in the last step.

    Args: env: not batched. entries: names of its frames by ours ("rgb", "depth", "pose"). unit:
    metres of one unit of depth. limit: steps after which an episode is over at the latest. rule:
    what success means, in words, for the rows.

    Raises ValueError for an environment that is batched or lacks an entry.
    """

    def __init__(
        self,
        env: EnvBase,
        entries: Mapping[str, str] | None = None,
        *,
        success: str | None = None,
        unit: float = 1.0,
        limit: int = 500,
        rule: str = "reward > 0 at the end",
    ) -> None:
        if env.batch_size.numel() != 1:
            raise ValueError(
                f"The environment has the batch size {list(env.batch_size)}: give one."
            )
        found = dict(env.observation_spec.items())
        self.env, self.rule, self.unit, self.success, self.limit = env, rule, unit, success, limit
        self.entries = dict(entries or {name: name for name in (RGB, DEPTH, POSE) if name in found})
        lacking = [entry for entry in self.entries.values() if entry not in found]
        if lacking or not self.entries:
            raise ValueError(
                f"The environment has no entry {', '.join(lacking) or 'rgb or depth'}; it has "
                f"{', '.join(map(str, found))}. Name its frames: entries={{'rgb': 'pixels'}}."
            )
        self.sensors = {name: _sensor_of(name, found[e]) for name, e in self.entries.items()}
        if RGB in self.sensors and self.sensors[RGB].dtype != "uint8":
            raise ValueError(
                f"RGB must be uint8 in 0-255, but it is {self.sensors[RGB].dtype}: "
                "take transforms that scale frames off."
            )

    @property
    def done(self) -> bool:
        return bool(self._now["done"].any()) or self._steps >= self.limit

    def reset(self, episode: Episode) -> Observation:
        seed = episode.info.get("seed", digest("episode", episode.episode_id))
        self.env.set_seed(int(seed) % 2**31)
        self._now, self._steps, self._reward = self.env.reset(), 0, 0.0
        return self._seen()

    def step(self, action: int) -> Observation:
        """Raises ValueError for an action that the environment does not have."""
        spec = self.env.action_spec
        if not 0 <= action < spec.space.n:
            raise ValueError(f"Unknown action {action}: the environment has {spec.space.n}.")
        chosen = torch.tensor(action)
        if isinstance(spec, OneHot):
            chosen = torch.nn.functional.one_hot(chosen, spec.space.n).to(spec.dtype)
        self._now.set(self.env.action_key, chosen.reshape(spec.shape))
        self._now = self.env.step(self._now)["next"]
        self._reward = float(self._now.get(self.env.reward_key).sum())
        self._steps += 1
        return self._seen()

    def measures(self) -> dict[str, float]:
        """success, spl (the same: no shortest path is known) and steps."""
        won = self._reward > 0 if self.success is None else bool(self._now[self.success].any())
        return {
            "success": int(won and self.done),
            "spl": float(won and self.done),
            "steps": self._steps,
        }

    def expert(self) -> None:
        return None

    def truth(self) -> dict[str, np.ndarray]:
        return {}

    def _seen(self) -> Observation:
        frames = {name: self._now[entry].numpy().copy() for name, entry in self.entries.items()}
        if DEPTH in frames:
            frames[DEPTH] = frames[DEPTH].astype(np.float32) * np.float32(self.unit)
        pose = {POSE: frames.pop(POSE)} if POSE in frames else {}
        return Observation(pose, lambda: frames, tuple(frames))


def _listed(episodes: Any) -> list[Episode]:
    if isinstance(episodes, (Path, str)):
        found, place = list(read_episodes(episodes)), str(episodes)
    else:
        found, place = list(episodes), "the list"
    if not found:
        raise ValueError(
            f"There is no episode in {place}: give at least one, or training episodes to draw from."
        )
    return found


def _spec_of(sensor: Sensor) -> Any:
    dtype = getattr(torch, sensor.dtype)
    if sensor.dtype == "uint8":
        return Bounded(0, 255, shape=sensor.shape, dtype=dtype)
    return Unbounded(shape=sensor.shape, dtype=dtype)


def _sensor_of(name: str, spec: Any) -> Sensor:
    dtype = str(spec.dtype).removeprefix("torch.")
    return Sensor(name, tuple(spec.shape), dtype, "m" if name == DEPTH else "")
