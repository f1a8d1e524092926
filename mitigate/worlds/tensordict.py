"""torchrl both ways: any world as an environment, and any environment with frames as a world.

Only this file, ``transforms.py`` and ``apartments/env.py`` import torchrl (4 s).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch
from tensordict import TensorDict, TensorDictBase
from torchrl.data import Bounded, Categorical, Composite, NonTensor, OneHot, Unbounded
from torchrl.data.tensor_specs import ContinuousBox
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
from mitigate.core.seeding import generator
from mitigate.worlds.episodes import Episode, read_episodes
from mitigate.worlds.seeded import SeededWorld, Success
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
        self.episodes: TrainingEpisodes | Sequence[Episode] = (
            episodes if isinstance(episodes, TrainingEpisodes) else _listed(episodes)
        )
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
        if isinstance(self.episodes, TrainingEpisodes):
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


class EnvWorld(SeededWorld):
    """Any torchrl environment that shows frames as a world, to evaluate in under the suite.

    Args: env: not batched. entries: by default those that are called "rgb", "depth" and "pose"; one
    within another is "camera.rgb". success: an entry of its tensordict, or a function.
    The others: as ``SeededWorld``.

    Raises ValueError as ``SeededWorld`` does, for an environment that is batched, and for actions
    that are not one discrete number.
    """

    def __init__(
        self,
        env: EnvBase,
        entries: Mapping[str, str] | None = None,
        *,
        success: Success | None = None,
        unit: float | None = None,
        limit: int | None = None,
        rule: str | None = None,
    ) -> None:
        if env.batch_size.numel() != 1:
            raise ValueError(
                f"The environment has the batch size {list(env.batch_size)}: give one."
            )
        action = env.full_action_spec
        actions = [action[key] for key in action.keys(True, True)]
        if len(actions) != 1 or not _is_discrete(actions[0]):
            shown = ", ".join(f"{type(spec).__name__} {list(spec.shape)}" for spec in actions)
            raise ValueError(
                "The actions of the environment must be one discrete number (Categorical or "
                f"OneHot), got {shown}. Wrap it in a transform that turns a whole number into an "
                "action of yours."
            )
        spec = env.observation_spec
        specs = {_dotted(key): spec[key] for key in spec.keys(True, True)}
        known = {name: name for name in (RGB, DEPTH, POSE) if name in specs}
        found = {name: _measured(spec) for name, spec in specs.items()}
        super().__init__(found, entries or known, success, unit, limit, rule)
        self.env = env

    def reset(self, episode: Episode) -> Observation:
        seed = self._begin(episode)
        with self._calling(f"{type(self.env).__name__}.reset()"):
            self.env.set_seed(seed)
            self._now = self.env.reset()
            parts = self._parts()
        return self._observation(parts)

    def step(self, action: int) -> Observation:
        """Raises ValueError for an action that the environment does not have, and at the end of an
        episode that has no entry ``success``."""
        self._check_going()
        spec = self.env.action_spec
        if not 0 <= action < spec.space.n:
            raise ValueError(f"Unknown action {action}: the environment has {spec.space.n}.")
        chosen = torch.tensor(action)
        if isinstance(spec, OneHot):
            chosen = torch.nn.functional.one_hot(chosen, spec.space.n).to(spec.dtype)
        self._now.set(self.env.action_key, chosen.reshape(spec.shape))
        with self._calling(f"{type(self.env).__name__}.step()"):
            self._now = self.env.step(self._now)["next"]
            reward = float(self._now.get(self.env.reward_key).sum())
            over = any(bool(self._now[key].any()) for key in self.env.done_keys)
            parts = self._parts()
        self._end_step(reward, over)
        return self._observation(parts)

    def _report(self) -> dict[str, Any]:
        return {_dotted(key): self._now[key] for key in self._now.keys(True, True)}

    def _parts(self) -> dict[str, np.ndarray]:
        keys = {_dotted(key): key for key in self._now.keys(True, True)}
        return {e: self._now[keys[e]].numpy(force=True) for e in self.entries.values()}


def _is_discrete(spec: Any) -> bool:
    """Return whether an action is one number of ``spec.space.n``; subclasses hold several."""
    return type(spec) in (Categorical, OneHot) and spec.shape.numel() == (
        spec.space.n if type(spec) is OneHot else 1
    )


def _dotted(key: str | tuple[str, ...]) -> str:
    return key if isinstance(key, str) else ".".join(key)


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
    dtype = torch.from_numpy(np.empty(0, sensor.dtype)).dtype
    if sensor.dtype == "uint8":
        return Bounded(0, 255, shape=sensor.shape, dtype=dtype)
    if math.isfinite(sensor.high):
        others = [] if sensor.missing is None else [sensor.missing]
        ends = torch.tensor([sensor.low, sensor.high, *others], dtype=dtype)
        return Bounded(ends.min(), ends.max(), shape=sensor.shape, dtype=dtype)
    return Unbounded(shape=sensor.shape, dtype=dtype)


def _measured(spec: Any) -> tuple[tuple[int, ...], str, float]:
    """Shape, dtype and greatest value of an entry; infinity where it has no end, for which torchrl
    has the greatest number of the dtype."""
    shape, dtype = tuple(spec.shape), str(spec.dtype).removeprefix("torch.")
    ends = isinstance(spec.space, ContinuousBox)
    far = float(spec.space.high.max()) if ends else math.inf
    endless = dtype.startswith("float") and far >= torch.finfo(spec.dtype).max / 2
    return shape, dtype, math.inf if endless else far
