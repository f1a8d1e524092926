"""Train on MiniWorld's ``OneRoomS6Fast`` with a torchrl actor: ClipPPOLoss and its collector."""

from __future__ import annotations

import time
from collections import deque

import numpy as np
import torch
from safetensors.torch import load_file, save_file
from tensordict.nn import TensorDictModule
from torch import nn
from torch.distributions import Categorical
from torchrl.collectors import Collector
from torchrl.envs import GymWrapper, RewardSum, SerialEnv, TransformedEnv
from torchrl.modules import ConvNet, ProbabilisticActor, ValueOperator
from torchrl.objectives import ClipPPOLoss
from torchrl.objectives.value import GAE

from tools.third_party.miniworld_room import make, make_world  # noqa: F401 - for results.py
from tools.third_party.ppo import WEIGHTS

PATH = WEIGHTS / "miniworld_torchrl.safetensors"
ACTIONS = 3
ENVS, FRAMES, BATCH, EPOCHS = 8, 1024, 256, 3


class Scale(nn.Module):
    """Convert frames uint8 [..., H, W, 3] to float32 [..., 3, H, W] in 0-1."""

    def forward(self, frames):
        return frames.movedim(-1, -3).float() / 255


def features() -> nn.Sequential:
    convolutions = ConvNet(
        in_features=3,
        num_cells=[16, 32, 32],
        kernel_sizes=[8, 4, 3],
        strides=[4, 2, 1],
        activation_class=nn.ReLU,
    )
    return nn.Sequential(Scale(), convolutions, nn.LazyLinear(128), nn.ReLU())


def make_actor() -> ProbabilisticActor:
    """Return an actor that reads "pixels" and writes "action"."""
    network = nn.Sequential(features(), nn.Linear(128, ACTIONS))
    # this call initialises the lazy layer with the right size
    network(torch.zeros(1, 48, 64, 3, dtype=torch.uint8))
    return ProbabilisticActor(
        TensorDictModule(network, in_keys=["pixels"], out_keys=["logits"]),
        in_keys=["logits"],
        distribution_class=Categorical,
        return_log_prob=True,
    )


def load_policy() -> ProbabilisticActor:
    actor = make_actor()
    actor.load_state_dict(load_file(PATH))
    return actor.eval()


def make_torchrl_env() -> TransformedEnv:
    env = GymWrapper(make(), pixels_only=True, categorical_action_encoding=True)
    return TransformedEnv(env, RewardSum())


def train(steps: int = 60_000, target: float = 0.93) -> None:
    recent = deque(maxlen=100)  # returns of episodes
    torch.manual_seed(0)
    env = SerialEnv(ENVS, make_torchrl_env)
    env.set_seed(100_000)
    actor = make_actor()
    critic = ValueOperator(nn.Sequential(features(), nn.Linear(128, 1)), in_keys=["pixels"])
    critic(env.reset())
    loss_module = ClipPPOLoss(actor, critic, entropy_coeff=0.0)
    advantage = GAE(gamma=0.99, lmbda=0.95, value_network=critic)
    optimizer = torch.optim.Adam(loss_module.parameters(), lr=5e-4)
    started = time.time()
    collector = Collector(env, actor, frames_per_batch=FRAMES, total_frames=steps)
    for index, data in enumerate(collector):
        with torch.no_grad():
            advantage(data)
        flat = data.reshape(-1)
        for _ in range(EPOCHS):
            for rows in torch.randperm(len(flat)).split(BATCH):
                losses = loss_module(flat[rows])
                loss = sum(value for key, value in losses.items() if key.startswith("loss_"))
                optimizer.zero_grad()
                loss.backward()
                nn.utils.clip_grad_norm_(loss_module.parameters(), 0.5)
                optimizer.step()
        recent.extend(data["next", "episode_reward"][data["next", "done"]].tolist())
        done = (index + 1) * FRAMES
        print(
            f"{done} steps, {time.time() - started:.0f} s: return {np.mean(recent):.2f}", flush=True
        )
        if len(recent) == 100 and np.mean(recent) >= target:
            break
    collector.shutdown()
    save_file(actor.state_dict(), PATH)


if __name__ == "__main__":
    train()
