"""Tests of the examples in docs/lerobot.md on a class with the methods of a lerobot policy.

pip cannot install lerobot next to this project, because lerobot requires an older PyTorch. The
class therefore has the methods and ``no_grad`` decorators of ``PreTrainedPolicy`` and
``ACTPolicy`` in lerobot 0.6.
"""

from __future__ import annotations

import re
import sys
from collections import deque
from types import ModuleType
from typing import Any

import gymnasium
import numpy as np
import pytest
import torch
from gymnasium import spaces
from torch import Tensor, nn

import mitigate
from mitigate.worlds.gym import GymWorld
from mitigate.worlds.seeded import seeded_episodes
from tests.documented import DOCS, example
from tests.lerobot_files import write_dataset

CHUNK, STEPS = 3, 7
EPISODES = seeded_episodes(range(2))


class Network(nn.Module):
    """Computes a chunk of actions from the brightness of the frame. Like ACT, it always reads the
    state, does not bound the actions, and returns a tuple whose first element is the chunk."""

    def __init__(self) -> None:
        super().__init__()
        self.layers = nn.Sequential(nn.AdaptiveAvgPool2d(2), nn.Flatten(), nn.Linear(12, CHUNK * 2))

    def forward(self, batch: dict[str, Any]) -> tuple[Tensor, None]:
        (image,) = batch["observation.images"]
        state = batch["observation.state"]
        return self.layers(image).view(-1, CHUNK, 2) + 0 * state[:, None], None


class ChunkPolicy(nn.Module):
    """A policy with the methods of a lerobot policy: it has a queue of actions, and ``forward``
    returns the loss."""

    def __init__(self) -> None:
        super().__init__()
        self.model = Network()
        self.calls = 0
        self.reset()

    def reset(self) -> None:
        self._action_queue: deque[Tensor] = deque(maxlen=CHUNK)

    @torch.no_grad()
    def select_action(self, batch: dict[str, Tensor]) -> Tensor:
        if not self._action_queue:
            self._action_queue.extend(self.predict_action_chunk(batch).transpose(0, 1))
        return self._action_queue.popleft()

    @torch.no_grad()
    def predict_action_chunk(self, batch: dict[str, Tensor]) -> Tensor:
        self.calls += 1
        return self.model({**batch, "observation.images": [batch["observation.image"]]})[0]

    def forward(self, batch: dict[str, Tensor]) -> tuple[Tensor, dict[str, float]]:
        raise AssertionError("`forward` of a lerobot policy computes its loss, so it needs actions")


class Reach(gymnasium.Env):
    """An environment in which the brighter half of the frame tells whether the first action should
    be 1 or -1."""

    def __init__(self) -> None:
        self.observation_space = spaces.Dict(
            pixels=spaces.Box(0, 255, (32, 32, 3), np.uint8),
            agent_pos=spaces.Box(-1.0, 1.0, (2,), np.float32),
        )
        self.action_space = spaces.Box(-1.0, 1.0, (2,), np.float32)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.steps = 0
        self.total = 0.0
        return self._observe(), {}

    def step(self, action):
        assert self.action_space.contains(action)
        reward = float(action[0] * self.side)
        self.steps += 1
        self.total += reward
        done = self.steps == STEPS
        return self._observe(), reward, done, False, {"is_success": self.total > STEPS - 1}

    def _observe(self):
        self.side = 1 if self.np_random.random() < 0.5 else -1
        frame = np.full((32, 32, 3), 40, np.uint8)
        frame[:, :16] += np.uint8(150 * (self.side > 0))
        frame[:, 16:] += np.uint8(150 * (self.side < 0))
        return {"pixels": frame, "agent_pos": np.zeros(2, np.float32)}


class FakeHook(ModuleType):
    """``mitigate_hook`` with an episode that inverts frames and stores its calls."""

    def __init__(self) -> None:
        super().__init__("mitigate_hook")
        self.calls: list[Any] = []

    def connect(self, name, scene):
        self.calls.append((name, scene))
        return self

    def corrupt(self, observation, cameras=None):
        self.calls.append(cameras)
        frames = {name: 255 - observation[name] for name in cameras or ["rgb"]}
        return {**observation, **frames}

    def finish(self, success):
        self.calls.append(bool(success))


def world() -> GymWorld:
    (call,) = re.findall(r"`(GymWorld\(.*?\))`", (DOCS / "lerobot.md").read_text(encoding="utf-8"))
    return eval(call, {"GymWorld": GymWorld, "env": Reach()})


def trained() -> ChunkPolicy:
    """Return a policy that solves the task.

    Its action is the brightness of the left half of the frame minus that of the right half.
    """
    policy = ChunkPolicy()
    linear = policy.model.layers[2]
    with torch.no_grad():
        linear.weight.zero_()
        linear.bias.zero_()
        linear.weight[::2, 0:12:2] = 1.0
        linear.weight[::2, 1:12:2] = -1.0
    return policy


def test_examples_are_short():
    for name in ("loop", "eval", "agent", "forward"):
        assert sum(bool(line.strip()) for line in example("lerobot.md", name).splitlines()) <= 15


def test_loop_example_corrupts_and_reports(monkeypatch):
    hook = FakeHook()
    monkeypatch.setitem(sys.modules, "mitigate_hook", hook)
    observation, _ = Reach().reset(seed=3)
    names: dict[str, Any] = {"seed": 3, "info": {"is_success": True}, "observation": observation}
    exec(example("lerobot.md", "loop"), names)
    assert hook.calls == [(3, "pusht"), {"pixels": {"type": "rgb"}}, True]
    assert (names["observation"]["pixels"] == 255 - observation["pixels"]).all()


def test_eval_example_corrupts_each_frame_and_reports_each_episode(monkeypatch):
    """``lerobot_eval`` is replaced by a module with its functions ``main`` and ``rollout``."""
    hook = FakeHook()
    lerobot = ModuleType("lerobot_eval")
    received = []

    def rollout(seeds, env, return_observations):
        observation = lerobot.preprocess_observation({"pixels": env[None], "agent_pos": 5})
        received.append(observation)
        return {"success": np.array([[False, True]])}

    def main():
        for seed in (1, 2):
            lerobot.rollout(seeds=[seed], env=frame, return_observations=False)

    lerobot.rollout = rollout
    lerobot.main = main
    lerobot.preprocess_observation = dict
    scripts = ModuleType("lerobot.scripts")
    scripts.lerobot_eval = lerobot
    modules = {"mitigate_hook": hook, "lerobot": ModuleType("lerobot"), "lerobot.scripts": scripts}
    for name, module in modules.items():
        monkeypatch.setitem(sys.modules, name, module)
    frame = np.full((8, 8, 3), 9, np.uint8)
    exec(example("lerobot.md", "eval"), {})
    assert hook.calls == [(1, "pusht"), None, True, (2, "pusht"), None, True]
    for observation in received:
        assert (observation["pixels"] == 246).all() and observation["pixels"].shape[0] == 1
        assert observation["agent_pos"] == 5


def test_agent_example_replans_after_each_chunk_and_after_reset():
    names: dict[str, Any] = {"torch": torch}
    exec(example("lerobot.md", "agent"), names)
    agent = names["LerobotAgent"](trained())
    one = world()
    for episode in EPISODES:
        observation = one.reset(episode)
        agent.reset("")
        while not one.done:
            observation = one.step(agent.act(observation))
    assert agent.policy.calls == 2 * -(-STEPS // CHUNK)


def test_agent_example_is_measured_by_benchmark(tmp_path):
    names: dict[str, Any] = {"torch": torch}
    exec(example("lerobot.md", "agent"), names)
    agent = names["LerobotAgent"](trained())
    options = {"world": world, "listed": EPISODES, "out": tmp_path}
    mitigate.benchmark(agent, suite=["low_light"], **options)
    assert (tmp_path / "rows.jsonl").is_file()


def test_forward_example_is_hardened(tmp_path):
    settings = {"listed": EPISODES, "suite": ["low_light"], "steps": 4, "episodes": 2, "batch": 4}
    settings["validation"] = 0  # keep the trained weights

    class Short:  # mitigate.harden with few steps
        @staticmethod
        def harden(policy, world, *, forward):
            settings["training"] = seeded_episodes(range(10, 12))
            return mitigate.harden(policy, world, forward=forward, out=tmp_path, **settings)

    policy = trained()
    names: dict[str, Any] = {"mitigate": Short, "policy": policy, "world": world}
    exec(example("lerobot.md", "forward"), names)
    result = names["result"]
    assert type(result.policy) is ChunkPolicy
    before, after = (list(p.parameters()) for p in (policy, result.policy))
    assert any(not torch.equal(b, a) for b, a in zip(before, after, strict=True))


def test_episode_example_reads_a_dataset(tmp_path, monkeypatch):
    pytest.importorskip("pyarrow", reason="needs pyarrow: pip install -e '.[lerobot]'")
    pytest.importorskip("av", reason="needs av: pip install -e '.[lerobot]'")
    write_dataset(tmp_path / "my-dataset")
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    exec(example("lerobot.md", "episode"), names)
    assert {*names["observation"]} == {"rgb", "observation.state"}
