"""Train on MiniWorld's ``OneRoomS6Fast``. The policy is an actor of torchrl."""

from __future__ import annotations

from tensordict.nn import TensorDictSequential
from torchrl.envs import GymWrapper

from tools.third_party.miniworld_room import make, make_world  # noqa: F401 - for results.py
from tools.third_party.ppo import WEIGHTS
from tools.third_party.torchrl_ppo import load_actor, train_actor

PATH = WEIGHTS / "miniworld_torchrl.safetensors"
FRAMES, ACTIONS = {"pixels": 3}, 3


def make_torchrl_env() -> GymWrapper:
    return GymWrapper(make(), pixels_only=True, categorical_action_encoding=True)


def load_policy() -> TensorDictSequential:
    return load_actor(PATH, FRAMES, ACTIONS)


if __name__ == "__main__":
    train_actor(make_torchrl_env, PATH, FRAMES, ACTIONS, steps=60_000, target=0.93)
