"""A task with the episode's instruction, a goal picture, and a success measure."""

from habitat.core.simulator import Sensor, SensorSuite, SensorTypes


class Measurements:
    def __init__(self):
        self.metrics = {}

    def reset_measures(self, *args, **kwargs):
        self._measure(kwargs["task"])

    def update_measures(self, *args, **kwargs):
        self._measure(kwargs["task"])

    def _measure(self, task):
        goal = task.episode.goals[0].position
        metres = task._sim.geodesic_distance(task._sim.get_agent_state().position, [goal])
        won = float(task.is_stop_called and metres < 3.0)
        self.metrics = {"distance_to_goal": metres, "success": won, "top_down_map": {"a": None}}

    def get_metrics(self):
        return dict(self.metrics)


class EmbodiedTask:
    def __init__(self, sim):
        self._sim, self.measurements, self.is_stop_called = sim, Measurements(), False
        self.episode = None
        self.sensor_suite = SensorSuite(
            [
                Sensor("instruction", SensorTypes.TEXT, read=self._words),
                Sensor("goal", SensorTypes.COLOR, read=self._goal_picture),
            ]
        )

    def _words(self, sensor, episode, **_):
        return {
            "text": episode.instruction.instruction_text,
            "tokens": episode.instruction.instruction_tokens,
        }

    def _goal_picture(self, sensor, episode, **_):
        return self._sim.get_observations_at(episode.goals[0].position, 0.0)["rgb"]

    def reset(self, episode):
        self.episode, self.is_stop_called = episode, False
        observations = self._sim.reset()
        observations.update(
            self.sensor_suite.get_observations(
                observations=observations, episode=episode, task=self
            )
        )
        return observations

    def step(self, action, episode):
        number = action["action"]
        self.is_stop_called = number == 0
        observations = self._sim.step(number)
        observations.update(
            self.sensor_suite.get_observations(
                observations=observations, episode=episode, action=action, task=self
            )
        )
        return observations
