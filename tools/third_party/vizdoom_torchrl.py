"""Train on ViZDoom's ``VizdoomBasic-v1`` with RGB and depth. The policy is an actor of torchrl."""

from __future__ import annotations

import torch
from tensordict.nn import ProbabilisticTensorDictSequential, TensorDictModule
from torchrl.envs import CatTensors, GymWrapper, TransformedEnv

from tools.third_party.ppo import WEIGHTS
from tools.third_party.torchrl_ppo import load_actor, train_actor
from tools.third_party.vizdoom_basic import make, make_world  # noqa: F401 - for results.py

PATH = WEIGHTS / "vizdoom_torchrl.safetensors"
ENTRIES, FRAMES, ACTIONS, CHANNELS = ["screen", "depth"], "frames", 4, 4


def make_torchrl_env() -> TransformedEnv:
    env = GymWrapper(make(), categorical_action_encoding=True)
    return TransformedEnv(env, CatTensors(ENTRIES, out_key=FRAMES, dim=-1, del_keys=False))


def joined(screen: torch.Tensor, depth: torch.Tensor) -> torch.Tensor:
    return torch.cat([screen, depth], dim=-1)


def load_policy() -> ProbabilisticTensorDictSequential:
    actor = load_actor(PATH, FRAMES, ACTIONS, CHANNELS)
    return ProbabilisticTensorDictSequential(
        TensorDictModule(joined, in_keys=ENTRIES, out_keys=[FRAMES]), *actor.module
    )


if __name__ == "__main__":
    # a kill gives about 100 points
    train_actor(
        make_torchrl_env,
        PATH,
        FRAMES,
        ACTIONS,
        steps=200_000,
        target=75,
        channels=CHANNELS,
        reward_scale=0.01,
        entropy=0.01,
    )
