"""Train on ViZDoom's ``VizdoomBasic-v1`` with RGB and depth. The policy is an actor of torchrl."""

from __future__ import annotations

from tensordict.nn import TensorDictSequential

from tools.third_party.ppo import WEIGHTS
from tools.third_party.torchrl_ppo import load_actor, train_actor
from tools.third_party.vizdoom_basic import make_world  # noqa: F401 - for results.py
from tools.third_party.vizdoom_torchrl import ACTIONS, make_torchrl_env

PATH = WEIGHTS / "vizdoom_torchrl_depth.safetensors"
FRAMES = {"screen": 3, "depth": 1}


def load_policy() -> TensorDictSequential:
    return load_actor(PATH, FRAMES, ACTIONS)


if __name__ == "__main__":
    train_actor(
        make_torchrl_env,
        PATH,
        FRAMES,
        ACTIONS,
        steps=200_000,
        target=75,
        reward_scale=0.01,
        entropy=0.03,  # with 0.01, the policy did not learn
        seed=1,
    )
