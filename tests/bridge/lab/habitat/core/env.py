"""Env, which runs episodes one after the other."""

from habitat.core.embodied_task import EmbodiedTask
from habitat.core.simulator import Simulator


class Words:
    def __init__(self, text, tokens=None):
        self.instruction_text, self.instruction_tokens = text, tokens


class Goal:
    def __init__(self, position):
        self.position = position


class Episode:
    def __init__(self, name, scene, text, goal, tokens=None):
        self.episode_id, self.scene_id, self.goals = name, scene, [Goal(goal)]
        self.instruction = Words(text, tokens)


class Dataset:
    def __init__(self, episodes):
        self.episodes = episodes


def make_dataset(count=4, tokens=None):
    return Dataset(
        [
            Episode(
                i,
                f"data/scenes/s{i % 2}.glb",
                f"Walk to the door {i}.",
                [0.0, 0.0, -1.0 - 3 * (i % 2)],
                tokens,
            )
            for i in range(count)
        ]
    )


class Env:
    def __init__(self, config=None, dataset=None):
        self._dataset = make_dataset() if dataset is None else dataset
        self.number_of_episodes = len(self._dataset.episodes)
        self._iterator = iter(self._dataset.episodes)
        options = dict(config or {})
        self.sim = self._sim = options.pop("simulator", Simulator)(**options)
        self.task = self._task = EmbodiedTask(self.sim)
        self.episode_over, self._steps, self.current_episode = False, 0, None

    def get_metrics(self):
        return self.task.measurements.get_metrics()

    def reset(self):
        self.current_episode = next(self._iterator)
        self.episode_over, self._steps = False, 0
        self.sim.reconfigure(self.current_episode)
        observations = self.task.reset(episode=self.current_episode)
        self.task.measurements.reset_measures(episode=self.current_episode, task=self.task)
        return observations

    def step(self, action):
        observations = self.task.step(action={"action": action}, episode=self.current_episode)
        self.task.measurements.update_measures(
            episode=self.current_episode, action=action, task=self.task
        )
        self._steps += 1
        self.episode_over = self.task.is_stop_called or self._steps >= 50
        return observations

    def render(self, mode="rgb"):
        return self.sim.render(mode)

    def close(self):
        self.sim.close()
