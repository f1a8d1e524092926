"""A program that runs an agent in the real habitat-lab 0.3, with the simulator in this file.

The program does not import mitigate.

usage: lab_agent.py OUT EPISODES.json.gz

habitat-sim is not on PyPI. habitat-lab only imports names from it, so empty modules replace it.
Tasks, measures, sensors, dataset and Env come from habitat-lab.
"""

import hashlib
import importlib.abc
import importlib.machinery
import json
import math
import sys
import types
from unittest.mock import MagicMock

import numpy as np


class Anything(type):
    def __getattr__(cls, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return MagicMock(name=name)


class Blank(types.ModuleType):
    __path__ = []

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        value = MagicMock(name=name)
        if name[0].isupper():
            value = Anything(name, (), {"__init__": lambda self, *a, **k: None})
        setattr(self, name, value)
        return value


class Blanks(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in ("habitat_sim", "magnum", "corrade"):
            return importlib.machinery.ModuleSpec(name, self, is_package=True)
        return None

    def create_module(self, spec):
        return Blank(spec.name)

    def exec_module(self, module):
        pass


sys.meta_path.insert(1, Blanks())  # the hook wraps this importer if the hook is loaded

import habitat  # noqa: E402
from gym import spaces  # noqa: E402
from habitat.config.default import get_config  # noqa: E402
from habitat.core.registry import registry  # noqa: E402
from habitat.core.simulator import AgentState, SensorSuite, Simulator  # noqa: E402


@registry.register_simulator(name="Plane-v0")
class Plane(Simulator):
    """A simulator of one infinite plane, which habitat-lab's RGB and depth sensors observe."""

    def __init__(self, config):
        agent = config.agents.main_agent
        sensors = [registry.get_sensor(c.type)(c) for c in agent.sim_sensors.values()]
        self.habitat_config, self._suite = config, SensorSuite(sensors)
        self.position, self.heading = np.zeros(3, np.float32), 0.0

    sensor_suite = property(lambda self: self._suite)
    action_space = property(lambda self: spaces.Discrete(4))
    previous_step_collided = False

    def _observe(self):
        frames = {}
        for uuid, sensor in self._suite.sensors.items():
            high, wide, channels = sensor.observation_space.shape
            rows, columns = np.mgrid[:high, :wide] / float(high)
            wave = 0.5 + 0.4 * np.sin(6 * columns + self.heading) * np.cos(5 * rows)
            frames[uuid] = (5 * wave).astype(np.float32)
            if channels == 3:
                frames[uuid] = np.stack([255 * wave] * 4, -1).astype(np.uint8)
        return self._suite.get_observations(frames)

    def reset(self):
        return self._observe()

    def step(self, action, *args, **kwargs):
        if action == 1:
            ahead = [-math.sin(self.heading), 0.0, -math.cos(self.heading)]
            self.position = self.position + 0.25 * np.array(ahead, np.float32)
        self.heading += {2: 1, 3: -1}.get(action, 0) * math.pi / 12
        return self._observe()

    def get_agent_state(self, agent_id=0):
        import quaternion

        half = self.heading / 2
        turn = quaternion.quaternion(math.cos(half), 0.0, math.sin(half), 0.0)
        return AgentState(self.position, turn)

    def geodesic_distance(self, start, ends, episode=None):
        ends = np.array(ends, np.float32).reshape(-1, 3)
        return float(np.linalg.norm(ends - np.array(start, np.float32), axis=1).min())

    def reconfigure(self, config, *args, **kwargs):
        start = config.agents.main_agent
        self.position = np.array(start.start_position, np.float32)
        self.heading = 2 * math.atan2(start.start_rotation[1], start.start_rotation[3])

    def step_physics(self, seconds):
        pass

    def seed(self, seed):
        pass

    def close(self, *args, **kwargs):
        pass


def main():
    out, episodes = sys.argv[1:]
    config = get_config(
        "benchmark/nav/vln_r2r.yaml",
        overrides=[
            "habitat.simulator.type=Plane-v0",
            "habitat.simulator.agents.main_agent.sim_sensors.rgb_sensor.width=32",
            "habitat.simulator.agents.main_agent.sim_sensors.rgb_sensor.height=32",
            "habitat.simulator.agents.main_agent.sim_sensors.depth_sensor.width=32",
            "habitat.simulator.agents.main_agent.sim_sensors.depth_sensor.height=32",
            "habitat.task.measurements.success.success_distance=3.0",
            f"habitat.dataset.data_path={episodes}",
            "habitat.dataset.scenes_dir=scenes",
            "habitat.environment.iterator_options.shuffle=False",
        ],
    )
    seen = []
    with habitat.Env(config) as env:
        for _ in range(len(env.episodes)):
            observations = env.reset()
            while not env.episode_over:
                frames = {n: observations[n] for n in ("rgb", "depth")}
                seen.append({n: hashlib.sha256(f.tobytes()).hexdigest() for n, f in frames.items()})
                seen[-1]["text"] = observations["instruction"]["text"]
                observations = env.step("move_forward" if len(seen) % 4 else "stop")
    with open(out, "w") as file:
        json.dump(seen, file)


if __name__ == "__main__":
    main()
