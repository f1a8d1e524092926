"""Train on MuJoCo's ``Reacher-v5`` from pixels, with continuous actions and a plain ``nn.Module``.

Training uses DAgger: a controller that reads the simulator's state labels the frames of the
student's rollouts.
"""

from __future__ import annotations

import os
import time

os.environ.setdefault("MUJOCO_GL", "egl")  # set before mujoco is imported

import gymnasium
import numpy as np
import torch
from safetensors.torch import load_file, save_file
from torch import nn

from mitigate.worlds.gym import GymWorld
from tools.third_party.ppo import WEIGHTS

PATH = WEIGHTS / "mujoco_reacher.safetensors"
LINKS = 0.1, 0.11  # metres
# spring constant (torque per radian) and damping (torque per radian/s), tuned by hand
STIFFNESS, DAMPING = 0.5, 0.05
CAMERA = {"distance": 0.62, "elevation": -90.0, "azimuth": 90.0, "lookat": np.zeros(3)}
ROUNDS, EPISODES, EPOCHS = 8, 15, 4


class SpringDriven(gymnasium.ActionWrapper):
    """Wrapper in which a damped spring moves each joint; the action is the extension of the springs
    in radians.

    If actions were torques, a policy would need the speeds of the joints, which a single frame does
    not show.
    """

    def action(self, action):
        speeds = self.unwrapped.data.qvel[:2]
        return np.clip(STIFFNESS * action - DAMPING * speeds, -1, 1)


def make() -> gymnasium.Env:
    env = gymnasium.make(
        "Reacher-v5",
        render_mode="rgb_array",
        width=64,
        height=64,
        default_camera_config=CAMERA,
    )
    return gymnasium.wrappers.AddRenderObservation(SpringDriven(env), render_only=True)


def make_world() -> GymWorld:
    return GymWorld(make(), score="return")


def network() -> nn.Sequential:
    """Return a network that maps RGB [N, 3, 64, 64] with values from 0 to 1 to an action."""
    return nn.Sequential(
        nn.Conv2d(3, 16, 5, 2, 2),
        nn.ReLU(),
        nn.Conv2d(16, 32, 3, 2, 1),
        nn.ReLU(),
        nn.Conv2d(32, 32, 3, 2, 1),
        nn.ReLU(),
        nn.Flatten(),
        nn.Linear(32 * 8 * 8, 128),
        nn.ReLU(),
        nn.Linear(128, 2),
        nn.Tanh(),
    )


def load_policy() -> nn.Sequential:
    policy = network()
    policy.load_state_dict(load_file(PATH))
    return policy.eval()


def forward(policy: nn.Module, observation: torch.Tensor) -> torch.Tensor:
    """Return actions for frames uint8 [N, 64, 64, 3], as ``mitigate.harden(forward=...)`` needs."""
    return policy(observation.permute(0, 3, 1, 2) / 255)


def expert(env: gymnasium.Env) -> np.ndarray:
    """Return the action of a controller that computes the inverse kinematics."""
    positions = env.unwrapped.data.qpos
    angles = positions[:2]
    target = positions[2:4]
    first, second = LINKS
    reach = np.clip(np.hypot(*target), 0.01, first + second - 1e-3)
    cosine = (reach**2 - first**2 - second**2) / (2 * first * second)
    elbow = np.arccos(np.clip(cosine, -1, 1)) * (1 if angles[1] >= 0 else -1)
    direction = np.arctan2(target[1], target[0])
    shoulder = direction - np.arctan2(second * np.sin(elbow), first + second * np.cos(elbow))
    error = np.array([shoulder, elbow]) - angles
    error[0] = (error[0] + np.pi) % (2 * np.pi) - np.pi
    return np.clip(error, -1, 1).astype(np.float32)


def rollout(env: gymnasium.Env, policy: nn.Module | None, seed: int, frames: list, labels: list):
    """Run one episode with ``policy`` or, if it is None, with the controller; record the
    controller's labels.
    """
    observation, _ = env.reset(seed=seed)
    over = False
    total = 0.0
    while not over:
        label = expert(env)
        frames.append(observation)
        labels.append(label)
        action = label
        if policy is not None:
            with torch.no_grad():
                action = forward(policy, torch.from_numpy(observation.copy())[None])[0].numpy()
        observation, reward, terminated, truncated, _ = env.step(action)
        over = terminated or truncated
        total += reward
    return total


def train() -> None:
    torch.manual_seed(0)
    env = make()
    policy = network()
    optimizer = torch.optim.Adam(policy.parameters(), lr=1e-3)
    frames, labels = [], []
    started = time.time()
    for index in range(ROUNDS):
        student = policy if index else None
        seeds = range(100_000 + index * EPISODES, 100_000 + (index + 1) * EPISODES)
        totals = [rollout(env, student, seed, frames, labels) for seed in seeds]
        inputs = torch.from_numpy(np.stack(frames))
        targets = torch.from_numpy(np.stack(labels))
        for _ in range(EPOCHS):
            for batch in torch.randperm(len(inputs)).split(128):
                loss = nn.functional.mse_loss(forward(policy, inputs[batch]), targets[batch])
                optimizer.zero_grad()
                loss.backward()
                optimizer.step()
        print(
            f"round {index}: return {np.mean(totals):.2f}, loss {loss.item():.4f}, "
            f"{time.time() - started:.0f} s",
            flush=True,
        )
    save_file(policy.state_dict(), PATH)


if __name__ == "__main__":
    train()
