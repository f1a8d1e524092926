"""Build ViZDoom environments with small frames."""

from __future__ import annotations

import os

import cv2
import gymnasium
import vizdoom.gymnasium_wrapper  # noqa: F401 - registers the environments
from gymnasium import spaces

HEIGHT, WIDTH = 48, 64
# These are metres per level of the depth buffer.
# One level is 7.35 map units (measured), and a metre is 32 map units.
METRES = 7.35 / 32


class SmallFrames(gymnasium.ObservationWrapper):
    """Wrapper that shrinks all frames to HEIGHT x WIDTH and removes the game variables."""

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
        # by default, ViZDoom writes a config file into the working folder
        doom_config_path=os.devnull,
    )
    return SmallFrames(env)
