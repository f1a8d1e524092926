"""A small program that uses the API of habitat-lab, as an example for ``mitigate run``.

    mitigate run "conditions=[low_light_noise,missing_data]" -- python docs/tutorials/habitat_agent.py

An agent must walk to a red door, which it sees in RGB and depth frames, and call STOP there. The
program never mentions ``mitigate``. A small stand-in takes the place of habitat-lab: it has the
same classes and methods, but needs no simulator and no scenes.
"""

import math
import sys
from pathlib import Path

import numpy as np

# your own program does not need this line if habitat-lab is installed
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tests/bridge/lab"))

import habitat
from habitat.core.env import Dataset, Episode
from habitat.core.simulator import SensorTypes, Simulator

STOP, FORWARD, LEFT, RIGHT = range(4)  # 0.25 m, 15 degrees
EPISODES = 10
STOP_DISTANCE = 1.0  # metres
MAX_DEPTH = 10.0  # metres; the depth sensor returns values between 0 and 1
DOOR_WIDTH = 1.5  # metres


class Agent:
    """Turns left until the red door is in the centre, walks to it, and stops."""

    def act(self, observations):
        rgb = observations["rgb"].astype(float)  # uint8 [32, 32, 3]
        red = rgb[..., 0] > 1.5 * rgb[..., 1]
        columns = np.nonzero(red.any(axis=0))[0]
        if not len(columns):
            return LEFT
        offset = (columns.mean() + 0.5) / red.shape[1] - 0.5
        if abs(offset) > 0.15:
            return LEFT if offset < 0 else RIGHT
        depth = MAX_DEPTH * observations["depth"][..., 0]  # metres [24, 24]
        return STOP if np.percentile(depth, 10) < STOP_DISTANCE else FORWARD


class Room(Simulator):
    """A simulator that draws a red door at the goal of the episode."""

    def reconfigure(self, episode):
        super().reconfigure(episode)
        self.goal = episode.goals[0].position

    def _frame(self, sensor, sim_obs):
        x, z, heading = sim_obs
        dx, dz = self.goal[0] - x, self.goal[2] - z
        distance = math.hypot(dx, dz)
        size = 32 if sensor.sensor_type is SensorTypes.COLOR else 24
        column_angles = math.pi / 2 * (0.5 - (np.arange(size) + 0.5) / size)
        angles = heading + column_angles - math.atan2(-dx, -dz)
        angles = np.arctan2(np.sin(angles), np.cos(angles))
        door = np.abs(angles) < math.atan2(DOOR_WIDTH / 2, distance)
        if sensor.sensor_type is SensorTypes.COLOR:
            row = np.where(door[:, None], (200, 50, 40), (110, 110, 120)).astype(np.uint8)
        else:
            row = np.where(door, distance / MAX_DEPTH, 1.0).astype(np.float32)[:, None]
        return np.repeat(row[None], size, axis=0)


def make_dataset():
    """Return episodes with the door 4 to 7 m from the start, in different directions."""
    episodes = []
    for number in range(EPISODES):
        generator = np.random.default_rng(number)
        angle = generator.uniform(-math.pi, math.pi)
        distance = generator.uniform(4.0, 7.0)
        goal = [-distance * math.sin(angle), 0.0, -distance * math.cos(angle)]
        episodes.append(Episode(number, "room.glb", "Walk to the red door.", goal))
    return Dataset(episodes)


def main():
    env = habitat.Env(config={"simulator": Room}, dataset=make_dataset())
    agent = Agent()
    successes = []
    for _ in range(env.number_of_episodes):
        observations = env.reset()
        while not env.episode_over:
            observations = env.step(agent.act(observations))
        successes.append(env.get_metrics()["success"])
    env.close()
    print(f"{sum(successes):.0f} of {len(successes)} episodes succeeded.")


if __name__ == "__main__":
    main()
