"""A simulator with two agents: one acts, and the camera of the other one shows the goal."""

import enum

import numpy as np


class SensorType(enum.Enum):
    COLOR, DEPTH = 1, 2


class Specification:
    def __init__(self, uuid, sensor_type):
        self.uuid, self.sensor_type, self.hfov = uuid, sensor_type, 79
        self.position, self.orientation = [0.0, 1.5, 0.0], [0.0, 0.0, 0.0]


class Settings:
    def __init__(self, **options):
        self.__dict__.update(options)


class Simulator:
    def __init__(self):
        acting = [
            Specification("color_sensor", SensorType.COLOR),
            Specification("depth_sensor", SensorType.DEPTH),
        ]
        goal = [Specification("goal_sensor", SensorType.COLOR)]
        agents = [Settings(sensor_specifications=s) for s in (acting, goal)]
        self.config, self._default_agent_id = Settings(agents=agents), 0
        self._async_draw_agent_ids = None

    def get_agent(self, number):
        state = Settings(position=np.zeros(3), rotation=[0.0, 0.0, 0.0, 1.0])
        return Settings(get_state=lambda: state)

    def get_sensor_observations(self, agent_ids=None):
        if isinstance(agent_ids, list):
            return {number: self.get_sensor_observations(number) for number in agent_ids}
        return Simulator.seen(agent_ids)

    @staticmethod
    def seen(agent_ids):
        colours = np.full((12, 16, 4), 130, np.uint8)
        colours[..., 3] = 255
        if agent_ids:
            return {"goal_sensor": colours}
        return {"color_sensor": colours, "depth_sensor": np.full((12, 16), 2.5, np.float32)}

    def start_async_render(self, agent_ids=0):
        self._async_draw_agent_ids = agent_ids

    def get_sensor_observations_async_finish(self):
        drawn, self._async_draw_agent_ids = self._async_draw_agent_ids, None
        return Simulator.seen(drawn)

    def step(self, action):
        return self.get_sensor_observations()
