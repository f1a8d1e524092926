"""Train on ViZDoom's ``VizdoomBasic-v1``, in which the agent must shoot the monster. The policy is
PPO of stable-baselines3 on RGB and depth."""

from __future__ import annotations

from stable_baselines3 import PPO

from mitigate.worlds.gym import GymWorld
from mitigate.worlds.seeded import Ending
from tools.third_party.doom import METRES, SmallFrames, make_env
from tools.third_party.ppo import WEIGHTS, load_ppo, train_ppo

PATH = WEIGHTS / "vizdoom_basic.safetensors"


def make() -> SmallFrames:
    return make_env("VizdoomBasic-v1", frame_skip=4)


def killed(end: Ending) -> bool:
    return end.reward > 50  # a kill gives 106 points; time and shots cost points


def make_world() -> GymWorld:
    return GymWorld(
        make(),
        entries={"rgb": "screen", "depth": "depth"},
        unit=METRES,
        success=killed,
        rule="monster killed",
    )


def load_policy() -> PPO:
    return load_ppo(make, PATH)


if __name__ == "__main__":
    train_ppo(make, PATH, steps=50_000)
