"""ViZDoom's ``VizdoomHealthGathering-v1``: walk to medkits on an acid floor, for 60 s.

PPO of stable-baselines3 on RGB and depth.
"""

from __future__ import annotations

import gymnasium
import vizdoom
from stable_baselines3 import PPO

from mitigate.worlds.gym import GymWorld
from mitigate.worlds.seeded import Ending
from tools.third_party.doom import METRES, WEIGHTS, SmallFrames, make_env, train_ppo

PATH = WEIGHTS / "vizdoom_health.zip"


class HealthReward(gymnasium.Wrapper):
    """Reward changes of health, for training only; a death then costs 1, as four medkits gain."""

    def reset(self, **options):
        result = self.env.reset(**options)
        self.health = self._read()
        return result

    def step(self, action):
        observation, _, terminated, truncated, info = self.env.step(action)
        health = self._read()
        reward = -1.0 if terminated and not truncated else 0.25 * (health > self.health)
        self.health = health
        return observation, reward, terminated, truncated, info

    def _read(self) -> float:
        return self.unwrapped.game.get_game_variable(vizdoom.GameVariable.HEALTH)


def make() -> SmallFrames:
    return make_env("VizdoomHealthGathering-v1", frame_skip=8)


def alive(end: Ending) -> bool:
    return end.reward > 0  # a death costs 100, a step in life is worth its tics


def make_world() -> GymWorld:
    return GymWorld(
        make(),
        entries={"rgb": "screen", "depth": "depth"},
        unit=METRES,
        success=alive,
        rule="alive after 60 s",
    )


def load_policy() -> PPO:
    return PPO.load(PATH, device="cpu")


if __name__ == "__main__":
    train_ppo(lambda: HealthReward(make()), PATH, steps=60_000)
