"""ViZDoom environments with small frames, and their training by stable-baselines3."""

from __future__ import annotations

import os
import time
from pathlib import Path

import cv2
import gymnasium
import vizdoom.gymnasium_wrapper  # noqa: F401 - registers the environments
from gymnasium import spaces
from stable_baselines3 import PPO
from stable_baselines3.common.env_util import make_vec_env
from stable_baselines3.common.vec_env import VecNormalize

WEIGHTS = Path(__file__).parent / "weights"
HEIGHT, WIDTH = 48, 64
# metres per level of the depth buffer: 7.35 map units (measured), 32 map units per metre
METRES = 7.35 / 32
FEATURES = {"MultiInputPolicy": {"cnn_output_dim": 64}, "CnnPolicy": {"features_dim": 128}}


class SmallFrames(gymnasium.ObservationWrapper):
    """Reduce all frames to HEIGHT x WIDTH and drop the game variables."""

    def __init__(self, env: gymnasium.Env) -> None:
        super().__init__(env)
        self.observation_space = spaces.Dict(
            {
                name: spaces.Box(0, 255, (HEIGHT, WIDTH, space.shape[-1]), space.dtype)
                for name, space in env.observation_space.spaces.items()
                if len(space.shape) == 3
            }
        )

    def observation(self, observation):
        return {
            name: cv2.resize(
                observation[name],
                (WIDTH, HEIGHT),
                interpolation=cv2.INTER_NEAREST if name == "depth" else cv2.INTER_AREA,
            ).reshape(space.shape)
            for name, space in self.observation_space.spaces.items()
        }


def make_env(name: str, frame_skip: int) -> gymnasium.Env:
    """Return an environment with a screen (RGB) and Doom's depth buffer, both uint8."""
    env = gymnasium.make(
        name,
        frame_skip=frame_skip,
        screen_resolution="RES_160X120",
        depth_buffer_enabled=True,
        doom_config_path=os.devnull,  # the default is a file in the working folder
    )
    return SmallFrames(env)


def train_ppo(make, path: Path, steps: int, policy: str = "MultiInputPolicy") -> None:
    """Train a policy with PPO and save it without the state of its optimizer."""
    envs = VecNormalize(make_vec_env(make, n_envs=8, seed=100_000), norm_obs=False)
    model = PPO(
        policy,
        envs,
        learning_rate=5e-4,
        n_steps=128,
        batch_size=256,
        n_epochs=3,
        ent_coef=0.01,
        policy_kwargs={"features_extractor_kwargs": FEATURES[policy]},
        seed=0,
        verbose=1,
        device="cpu",
    )
    started = time.time()
    model.learn(steps, log_interval=5)
    print(f"{path.name}: {steps} steps in {time.time() - started:.0f} s")
    optimizer = model.policy.optimizer
    model.policy.optimizer = type(optimizer)(model.policy.parameters(), lr=model.learning_rate)
    path.parent.mkdir(exist_ok=True)
    model.save(path)
    envs.close()
