"""Sensors, and a simulator with an agent on an infinite plane."""

import enum
import math

import numpy as np


class SensorTypes(enum.Enum):
    COLOR, DEPTH, TEXT = 1, 2, 3


class Config:
    """A config with upper-case option names, as in habitat-lab before 0.2.3."""

    def __init__(self, **options):
        self.__dict__.update(options)


class Sensor:
    def __init__(self, uuid, sensor_type, config=None, read=None):
        self.uuid, self.sensor_type, self.config, self.read = uuid, sensor_type, config, read

    def get_observation(self, *args, **kwargs):
        return self.read(self, *args, **kwargs)


class SensorSuite:
    def __init__(self, sensors):
        self.sensors = {sensor.uuid: sensor for sensor in sensors}

    def get_observations(self, *args, **kwargs):
        return {uuid: s.get_observation(*args, **kwargs) for uuid, s in self.sensors.items()}


class AgentState:
    def __init__(self, position, heading):
        self.position = np.array(position, np.float32)
        self.rotation = [0.0, math.sin(heading / 2), 0.0, math.cos(heading / 2)]
        self.heading = heading


class Simulator:
    """A simulator with one camera, or with 12 cameras 30 degrees apart; RGB is 32 x 32, depth is 24
    x 24 from 0 to 10 m."""

    def __init__(self, cameras=1):
        self.sensor_suite = SensorSuite(list(self._sensors(cameras)))
        self.state = AgentState([0, 0, 0], 0.0)

    def _sensors(self, cameras):
        for kind, name in ((SensorTypes.COLOR, "rgb"), (SensorTypes.DEPTH, "depth")):
            for k in range(cameras):
                options = {
                    "HFOV": 90,
                    "POSITION": [0, 1.25, 0],
                    "ORIENTATION": [0, k * math.pi / 6, 0],
                }
                if kind is SensorTypes.DEPTH:
                    options.update(MIN_DEPTH=0.0, MAX_DEPTH=10.0, NORMALIZE_DEPTH=True)
                uuid = f"{name}_{30 * k}" if k else name
                yield Sensor(uuid, kind, Config(**options), self._frame)

    @staticmethod
    def _frame(sensor, sim_obs):
        x, z, heading = sim_obs
        yaw = heading + sensor.config.ORIENTATION[1]
        size = 32 if sensor.sensor_type is SensorTypes.COLOR else 24
        rows, columns = np.mgrid[:size, :size] / float(size)
        wave = 0.5 + 0.4 * np.sin(6 * columns + yaw + x) * np.cos(5 * rows + z)
        if sensor.sensor_type is SensorTypes.COLOR:
            shades = np.stack([wave, wave**2, 1 - wave, wave], -1)
            # like habitat-lab, this returns a view of the array instead of a copy
            return (255 * shades).astype(np.uint8)[:, :, :3]
        return wave[:, :, None].astype(np.float32)

    def reconfigure(self, episode):
        """Move the agent to the start of an episode, which is the same for all episodes."""
        self.state = AgentState([0, 0, 0], 0.0)

    def get_agent_state(self, agent_id=0):
        return self.state

    def _observations(self):
        x, _, z = self.state.position
        return self.sensor_suite.get_observations((float(x), float(z), self.state.heading))

    def reset(self):
        return self._observations()

    def step_without_obs(self, action):
        x, y, z = self.state.position
        heading = self.state.heading
        if action == 1:
            x, z = x - 0.25 * math.sin(heading), z - 0.25 * math.cos(heading)
        heading += {2: math.pi / 12, 3: -math.pi / 12}.get(action, 0.0)
        self.state = AgentState([x, y, z], heading)

    def step(self, action):
        self.step_without_obs(action)
        return self._observations()

    def get_observations_at(self, position, heading, keep_agent_at_new_pose=False):
        before = self.state
        self.state = AgentState(position, heading)
        observations = self._observations()
        if not keep_agent_at_new_pose:
            self.state = before
        return observations

    def render(self, mode="rgb"):
        return self._observations()[mode]

    def geodesic_distance(self, start, ends):
        return min(float(np.linalg.norm(np.array(start) - np.array(end))) for end in ends)

    def close(self):
        pass
