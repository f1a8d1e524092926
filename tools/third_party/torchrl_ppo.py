"""Train and load actors of torchrl: ``ActorValueOperator``, ``ClipPPOLoss`` and ``Collector``."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable
from pathlib import Path

import numpy as np
import torch
from safetensors.torch import load_file, save_file
from tensordict.nn import TensorDictModule, TensorDictSequential
from torch import nn
from torch.distributions import Categorical
from torchrl.collectors import Collector
from torchrl.envs import EnvBase, RewardSum, SerialEnv, TransformedEnv
from torchrl.modules import ActorValueOperator, ConvNet, ProbabilisticActor, ValueOperator
from torchrl.objectives import ClipPPOLoss
from torchrl.objectives.value import GAE

ENVS, FRAMES, BATCH, EPOCHS = 8, 1024, 256, 3


class Features(nn.Sequential):
    """Layers that read one or several frames uint8 [..., H, W, C], joined along their channels."""

    def forward(self, *frames):
        return super().forward(torch.cat(frames, -1))


class Scale(nn.Module):
    """Convert frames uint8 [..., H, W, C] to float32 [..., C, H, W] in 0-1."""

    def forward(self, frames):
        return frames.movedim(-1, -3).float() / 255


def make_actor_critic(frames: dict[str, int], actions: int) -> ActorValueOperator:
    """Return an actor and a critic that share the features of the entries ``frames``.

    ``frames`` contains the number of channels for each entry.
    """
    convolutions = ConvNet(
        in_features=sum(frames.values()),
        num_cells=[16, 32, 32],
        kernel_sizes=[8, 4, 3],
        strides=[4, 2, 1],
        activation_class=nn.ReLU,
    )
    features = Features(Scale(), convolutions, nn.LazyLinear(128), nn.ReLU())
    # this call initialises the lazy layer with the right size
    features(torch.zeros(1, 48, 64, sum(frames.values()), dtype=torch.uint8))
    action, value = nn.Linear(128, actions), nn.Linear(128, 1)
    for layer in [*features.modules(), action, value]:
        if isinstance(layer, nn.Conv2d | nn.Linear):
            nn.init.orthogonal_(layer.weight, {action: 0.01, value: 1.0}.get(layer, 2**0.5))
            nn.init.zeros_(layer.bias)
    actor = ProbabilisticActor(
        TensorDictModule(action, in_keys=["features"], out_keys=["logits"]),
        in_keys=["logits"],
        distribution_class=Categorical,
        return_log_prob=True,
    )
    return ActorValueOperator(
        TensorDictModule(features, in_keys=[*frames], out_keys=["features"]),
        actor,
        ValueOperator(value, in_keys=["features"]),
    )


def load_actor(path: Path, frames: dict[str, int], actions: int) -> TensorDictSequential:
    """Return the actor whose weights :func:`train_actor` saved."""
    actor = make_actor_critic(frames, actions).get_policy_operator()
    actor.load_state_dict(load_file(path))
    return actor.eval()


def train_actor(
    make: Callable[[], EnvBase],
    path: Path,
    frames: dict[str, int],
    actions: int,
    steps: int,
    target: float,
    reward_scale: float = 1.0,
    entropy: float = 0.0,
    seed: int = 0,
) -> None:
    """Train an actor until the mean return of 100 episodes reaches ``target``; save its weights.

    ``reward_scale`` multiplies the rewards of the losses, but not the reported return.
    """
    recent = deque(maxlen=100)  # returns of episodes
    torch.manual_seed(seed)
    env = SerialEnv(ENVS, lambda: TransformedEnv(make(), RewardSum()))
    env.set_seed(100_000)
    actor_critic = make_actor_critic(frames, actions)
    actor, critic = actor_critic.get_policy_operator(), actor_critic.get_value_operator()
    loss_module = ClipPPOLoss(
        actor,
        critic,
        entropy_coeff=entropy,
        normalize_advantage=True,
        critic_coeff=0.5,
        loss_critic_type="l2",
    )
    advantage = GAE(gamma=0.99, lmbda=0.95, value_network=critic)
    optimizer = torch.optim.Adam(loss_module.parameters(), lr=5e-4)
    started = time.time()
    collector = Collector(env, actor, frames_per_batch=FRAMES, total_frames=steps)
    for index, data in enumerate(collector):
        data["next", "reward"] = data["next", "reward"] * reward_scale
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
        if len(recent) == recent.maxlen and np.mean(recent) >= target:
            break
    collector.shutdown()
    save_file(actor.state_dict(), path)
