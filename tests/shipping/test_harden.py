"""Harden policies of other libraries without an expert: ``mitigate.harden``."""

import gymnasium
import numpy as np
import pytest
import torch
from gymnasium import spaces
from torch import nn

import mitigate
from mitigate.agents.policies import as_policy, load_policy
from mitigate.core import checkpoint
from mitigate.worlds.gym import GymWorld


class Lights(gymnasium.Env):
    """A light on the left or the right shows the side to choose, five times in a row."""

    def __init__(self, continuous=False):
        self.observation_space = spaces.Box(0, 255, (16, 16, 3), np.uint8)
        self.action_space = (
            spaces.Box(-1, 1, (1,), np.float32) if continuous else spaces.Discrete(2)
        )
        self.continuous = continuous

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.steps = self.right = 0
        return self.observe(), {}

    def observe(self):
        self.side = int(self.np_random.integers(2))
        frame = np.full((16, 16, 3), 90, np.uint8)
        frame[4:12, 8 * self.side + 2 : 8 * self.side + 7] = (40, 220, 40)
        return frame

    def step(self, action):
        chosen = float(action[0]) > 0 if self.continuous else int(action)
        reward = float(chosen == self.side)
        self.right += reward
        self.steps += 1
        return self.observe(), reward, self.steps == 5, False, {"success": self.right == 5}


class Net(nn.Module):
    def __init__(self, outputs=2):
        super().__init__()
        self.conv = nn.Conv2d(3, 8, 4, 4)
        self.head = nn.Linear(128, outputs)

    def forward(self, frames):
        return self.head(self.conv(frames.permute(0, 3, 1, 2).float() / 255).relu().flatten(1))


def trained(continuous=False):
    torch.manual_seed(0)
    net, env = Net(1 if continuous else 2), Lights(continuous)
    optimizer = torch.optim.Adam(net.parameters(), 1e-2)
    env.reset(seed=7)
    for _ in range(60):
        frames, sides = zip(*[(env.observe(), env.side) for _ in range(16)])
        output, target = net(torch.from_numpy(np.stack(frames))), torch.tensor(sides)
        loss = (
            (output[:, 0] - (2.0 * target - 1)).square().mean()
            if continuous
            else nn.functional.cross_entropy(output, target)
        )
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
    return net


def world():
    return GymWorld(Lights())


def continuous_world():
    return GymWorld(Lights(True), score="return")


SHORT = {"steps": 6, "every": 3, "episodes": 2, "batch": 8, "suite": ["low_light", "spatter"]}


def test_harden_keeps_the_given_policy_and_returns_its_class(tmp_path):
    net = trained()
    before = checkpoint.weights_sha(net)
    result = mitigate.harden(net, world, out=tmp_path, **SHORT)
    assert checkpoint.weights_sha(net) == before
    assert type(result.policy) is Net
    assert checkpoint.weights_sha(result.policy) != before
    assert "PRS-SR" in result.report and "before" in result.report
    print(result)


def test_harden_continuous(tmp_path):
    net = trained(True)
    result = mitigate.harden(net, continuous_world, out=tmp_path, **SHORT)
    print(result)
