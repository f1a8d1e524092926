"""Train on MiniWorld's ``OneRoomS6Fast``, in which the agent must go to the red box.

The policy is trained on RGB frames with the PPO of stable-baselines3.
"""

from __future__ import annotations

import gymnasium
import pyglet

pyglet.options["headless"] = True  # set before miniworld opens a window

import miniworld  # noqa: E402, F401 - registers the environments
from stable_baselines3 import PPO  # noqa: E402

from mitigate.worlds.gym import GymWorld  # noqa: E402
from mitigate.worlds.seeded import Ending  # noqa: E402
from tools.third_party.ppo import WEIGHTS, load_ppo, train_ppo  # noqa: E402

PATH = WEIGHTS / "miniworld_room.safetensors"


def make() -> gymnasium.Env:
    return gymnasium.make("MiniWorld-OneRoomS6Fast-v0", obs_width=64, obs_height=48)


def reached(end: Ending) -> bool:
    return end.total > 0


def make_world() -> GymWorld:
    return GymWorld(make(), success=reached, rule="red box reached")


def load_policy() -> PPO:
    return load_ppo(make, PATH, "CnnPolicy")


if __name__ == "__main__":
    train_ppo(make, PATH, steps=60_000, policy="CnnPolicy", target=0.9, ent_coef=0.0)
