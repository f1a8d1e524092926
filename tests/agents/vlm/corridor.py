"""A small world for tests: cells in a row, where FORWARD moves to one side and LEFT to the
other."""

from __future__ import annotations

import numpy as np

from mitigate.core.observation import FORWARD, LEFT, STOP, Observation, Sensor
from mitigate.worlds.episodes import Episode, Goal, Instruction

CELLS, PIXELS, MAX_STEPS = 9, 28, 20


class Corridor:
    sensors = {"rgb": Sensor("rgb", (PIXELS, PIXELS, 3), "uint8", low=0, high=255)}
    rule = "STOP in the goal's cell"

    def reset(self, episode):
        self.cell, self.goal = int(episode.start_position[0]), int(episode.goals[0].position[0])
        self.steps, self.stopped, self.done = 0, False, False
        return self.observe()

    def step(self, action):
        self.steps, self.stopped = self.steps + 1, action == STOP
        self.cell = min(max(self.cell + {FORWARD: 1, LEFT: -1}.get(action, 0), 0), CELLS - 1)
        self.done = self.stopped or self.steps >= MAX_STEPS
        return self.observe()

    def observe(self):
        return Observation({}, lambda: {"rgb": self.render()}, ("rgb",))

    def render(self):
        frame = np.full((PIXELS, PIXELS, 3), 90, np.uint8)
        frame[:, 3 * self.cell : 3 * self.cell + 3] = (40, 220, 40)
        frame[:4, 3 * self.goal : 3 * self.goal + 3] = (220, 40, 40)
        return frame

    def measures(self):
        success = self.stopped and self.cell == self.goal
        return {"success": int(success), "spl": float(success), "steps": self.steps}

    def expert(self):
        return self

    def action(self):
        return STOP if self.cell == self.goal else FORWARD if self.goal > self.cell else LEFT

    def beside(self):
        return Corridor()


def episode(start: int, goal: int, text: str = "Go to the red mark.") -> Episode:
    path = ((start, 0, 0), (goal, 0, 0))
    return Episode(
        f"{start}-{goal}", "0", "corridor", path[0], (0, 0, 0, 1), (Goal(path[1]),),
        Instruction(text), path,
    )  # fmt: skip


class Drawn:
    """Training episodes."""

    def draw(self, rng, share=(0, 1)):
        start, goal = rng.choice(CELLS, 2, replace=False)
        return episode(int(start), int(goal))
