"""Use a world as a torchrl environment, and a torchrl environment as a world.

Importing torchrl takes 4 s, so only this file, ``transforms.py`` and ``apartments/env.py`` import
it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch
from tensordict import TensorDict, TensorDictBase
from torchrl.data import Bounded, Categorical, Composite, NonTensor, OneHot, Unbounded
from torchrl.data.tensor_specs import ContinuousBox
from torchrl.envs import EnvBase, GymLikeEnv

from mitigate.core.observation import EPISODE, FRAME, INSTRUCTION, STOP, Observation, Sensor
from mitigate.core.seeding import generator
from mitigate.core.spaces import ActionSpace, Box, Discrete, MultiDiscrete
from mitigate.worlds.episodes import Episode, read_episodes
from mitigate.worlds.seeded import Arrays, SeededWorld
from mitigate.worlds.world import MOVES, TrainingEpisodes, World


class WorldEnv(EnvBase):
    """A torchrl environment that wraps a world. Its ``batch_size`` is [].

    Observations have one entry per sensor of the world. They also have ``instruction`` (str),
    ``episode`` (str, a name that is unique to each run of an episode) and ``frame`` (int64 [1], the
    number of steps). Actions are int64 from 0 to 3, where 0 is STOP. The reward
    (float32 [1]) is the world's ``success`` at the end of an episode, and 0 before. If the agent
    ends the episode with STOP, ``terminated`` is set; if the world ends it, ``truncated`` is set.

    Args:
        world: The world. No other environment may use it.
        episodes: A VLN-CE file or a list of episodes, which are run in order and repeated.
            Alternatively, a source of training episodes (``worlds/world.py``), from which episodes
            are sampled with ``seed``.
        seed: Seed for sampling episodes. The method ``set_seed`` replaces it and restarts with the
            first episode.
        worker: Index of this environment. The environment runs the episodes ``worker``, ``worker +
            workers``, and so on.
        workers: Number of environments among which the episodes of this seed are divided. Together,
            they run the same episodes as a single environment would.

    Raises:
        ValueError: If the list of episodes is empty, or ``worker`` is not between 0 and ``workers``
            - 1.
    """

    key = "world env"  # name of the random stream from which episodes are sampled

    def __init__(
        self,
        world: World,
        episodes: Path | str | Sequence[Episode] | TrainingEpisodes,
        *,
        seed: int = 0,
        worker: int = 0,
        workers: int = 1,
    ) -> None:
        super().__init__(device="cpu", batch_size=[])
        if not 0 <= worker < workers:
            raise ValueError(
                f"worker must be 0 to {workers - 1} with workers={workers}, got {worker}."
            )
        self.world = world

        self.seed = seed
        self.episodes: TrainingEpisodes | Sequence[Episode] = (
            episodes if isinstance(episodes, TrainingEpisodes) else _list_episodes(episodes)
        )
        self.worker = worker
        self.workers = workers
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
        self.action_spec = Categorical(len(MOVES) + 1, shape=(), dtype=torch.int64)
        self.reward_spec = Unbounded(shape=(1,), dtype=torch.float32)
        self.done_spec = Composite(
            {name: flag.clone() for name in ("done", "terminated", "truncated")}
        )

    def _reset(self, tensordict: TensorDictBase | None = None, **kwargs: object) -> TensorDictBase:
        self._episode, self._name = self._choose_episode(self._number)
        self._number += self.workers
        self._frame = 0
        return self._state(self.world.reset(self._episode), stopped=False)

    def _step(self, tensordict: TensorDictBase) -> TensorDictBase:
        action = int(tensordict["action"])
        observation = self.world.step(action)
        self._frame += 1
        reward = float(self.world.measures()["success"]) if self.world.done else 0.0
        state = self._state(observation, stopped=action == STOP)
        return state.set("reward", torch.tensor([reward]))

    def _set_seed(self, seed: int | None) -> None:
        self.seed = 0 if seed is None else int(seed)
        self._number = self.worker

    def _choose_episode(self, number: int) -> tuple[Episode, str]:
        """Return the episode with this number, and its unique name.

        Both depend only on ``number`` and on the list of episodes or the seed.
        """
        if isinstance(self.episodes, TrainingEpisodes):
            rng = generator(self.seed, self.key, number)
            episode, repetition = self.episodes.draw(rng, (0, 1)), number
        else:
            repetition, index = divmod(number, len(self.episodes))
            episode = self.episodes[index]
        return episode, episode.episode_id + (f"@{repetition}" if repetition else "")

    def _state(self, observation: Observation, stopped: bool) -> TensorDictBase:
        done = self.world.done
        over = {"done": done, "terminated": done and stopped, "truncated": done and not stopped}
        return TensorDict(
            {
                **{n: torch.from_numpy(np.array(observation[n])) for n in self.world.sensors},
                INSTRUCTION: self._episode.instruction.text,
                EPISODE: self._name,
                FRAME: torch.tensor([self._frame]),
                **{name: torch.tensor([value]) for name, value in over.items()},
            },
            batch_size=[],
        )


class EnvWorld(SeededWorld):
    """World that wraps a torchrl environment that is not batched and provides frames.

    The arguments are the same as for :class:`~mitigate.worlds.seeded.SeededWorld`. ``success``
    names an entry of the tensordict, or is a function.
    """

    def _spaces(self, env: EnvBase) -> tuple[ActionSpace, Arrays]:
        if env.batch_size.numel() != 1:
            raise ValueError(
                f"Pass a single environment, not one with batch size {list(env.batch_size)}."
            )
        action = env.full_action_spec
        actions = [action[key] for key in action.keys(True, True)]
        if len(actions) != 1:
            raise ValueError(
                f"The environment must have one action, got {len(actions)}. Combine its actions."
            )
        spec = env.observation_spec
        arrays = {_dotted(key): _describe(spec[key]) for key in spec.keys(True, True)}
        return _space_of(actions[0]), arrays

    def _reset_env(self, seed: int) -> dict[str, Any]:
        self.env.set_seed(seed)
        # torchrl resets a gymnasium environment twice.
        # Without the seed, the second reset would start a different episode than ``GymWorld`` does.
        is_gym = isinstance(getattr(self.env, "base_env", self.env), GymLikeEnv)
        self._now = self.env.reset(seed=seed) if is_gym else self.env.reset()
        return self._parts()

    def _step_env(self, action: Any) -> tuple[dict[str, Any], float, bool]:
        spec = self.env.action_spec
        chosen = torch.as_tensor(np.asarray(action))
        if isinstance(spec, OneHot):
            chosen = torch.nn.functional.one_hot(chosen, spec.space.n)
        self._now.set(self.env.action_key, chosen.to(spec.dtype).reshape(spec.shape))
        self._now = self.env.step(self._now)["next"]
        reward = float(self._now.get(self.env.reward_key).sum())
        over = any(bool(self._now[key].any()) for key in self.env.done_keys)
        ends = [value for name, value in self._report().items() if name.endswith("terminated")]
        self.terminated = any(bool(value.any()) for value in ends)
        return self._parts(), reward, over

    def _report(self) -> dict[str, Any]:
        return {_dotted(key): self._now[key] for key in self._now.keys(True, True)}

    def _parts(self) -> dict[str, Any]:
        entries = self._report()
        return {name: entries[name].numpy(force=True) for name in self.entries.values()}


def _space_of(spec: Any) -> ActionSpace:
    """Return the action space that corresponds to a torchrl spec.

    Raises:
        ValueError: If the spec is not Categorical, OneHot, MultiCategorical, or a bounded or
            unbounded array.
    """
    kind = type(spec).__name__
    if kind == "Categorical" and spec.shape.numel() == 1:
        return Discrete(int(spec.space.n))
    if kind == "OneHot" and spec.shape.numel() == spec.space.n:
        return Discrete(int(spec.space.n))
    if kind == "MultiCategorical":
        return MultiDiscrete(np.asarray(spec.nvec).reshape(spec.shape))
    if isinstance(spec.space, ContinuousBox):
        return Box(spec.space.low.numpy(force=True), spec.space.high.numpy(force=True))
    raise ValueError(
        "The action of the environment must be Categorical, OneHot, MultiCategorical, Bounded or "
        f"Unbounded, got {kind} {list(spec.shape)}. Wrap the environment in a transform that "
        "converts an action of one of these types into the environment's own type."
    )


def _dotted(key: str | tuple[str, ...]) -> str:
    return key if isinstance(key, str) else ".".join(key)


def _list_episodes(episodes: Any) -> list[Episode]:
    """Return the episodes of a file or an iterable. Raise ValueError if it is empty."""
    is_file = isinstance(episodes, (Path, str))
    listed = list(read_episodes(episodes)) if is_file else list(episodes)
    if not listed:
        raise ValueError(
            f"{episodes if is_file else 'The list'} must contain at least one episode."
        )
    return listed


def _spec_of(sensor: Sensor) -> Any:
    dtype = torch.from_numpy(np.empty(0, sensor.dtype)).dtype
    if sensor.dtype == "uint8":
        return Bounded(0, 255, shape=sensor.shape, dtype=dtype)
    if math.isfinite(sensor.high):
        others = [] if sensor.missing is None else [sensor.missing]
        ends = torch.tensor([sensor.low, sensor.high, *others], dtype=dtype)
        return Bounded(ends.min(), ends.max(), shape=sensor.shape, dtype=dtype)
    return Unbounded(shape=sensor.shape, dtype=dtype)


def _describe(spec: Any) -> tuple[tuple[int, ...], str, float]:
    """Return the shape, dtype and maximum of an entry. The maximum of an unbounded entry is inf."""
    dtype = str(spec.dtype).removeprefix("torch.")
    high = float(spec.space.high.max()) if isinstance(spec.space, ContinuousBox) else math.inf
    # torchrl uses the largest number of the dtype as the maximum of an unbounded entry
    unbounded = dtype.startswith("float") and high >= torch.finfo(spec.dtype).max / 2
    return tuple(spec.shape), dtype, math.inf if unbounded else high
