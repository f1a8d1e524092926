"""Training rollouts copy their frames, because a world may reuse its arrays."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import torch

from mitigate.agents.recurrent.rollout import TrainingWalk
from mitigate.agents.stepwise import StepwiseAgent
from mitigate.agents.topological.rollout import LiveWalk
from mitigate.core.observation import DEPTH, FORWARD, POSE, RGB, VIEWS, Observation, cameras
from mitigate.worlds.episodes import Episode, Instruction

EPISODE = Episode("e7", "0", "room", (0, 0, 0), (0, 0, 0, 1), (), Instruction("Go."), ())


class Expert:
    def action(self) -> int:
        return FORWARD


class Reusing:
    """World with three steps per episode, whose frames show the step number and reuse the same
    arrays."""

    rule = "none"

    def __init__(self, views: int) -> None:
        self.sensors = cameras(8, views)
        self.arrays = {
            name: np.zeros(sensor.shape, sensor.dtype) for name, sensor in self.sensors.items()
        }

    @property
    def done(self) -> bool:
        return self.count == 3

    def reset(self, episode):
        self.count = -1
        return self.step(0)

    def step(self, action):
        self.count += 1
        self.arrays[RGB][:], self.arrays[DEPTH][:] = self.count, self.count + 1.0
        pose = {POSE: self.arrays[POSE]}
        return Observation({**pose, RGB: self.arrays[RGB], DEPTH: self.arrays[DEPTH]})

    def truth(self):
        return {"seen": self.arrays[RGB]}

    def expert(self):
        return Expert()


class Forward(StepwiseAgent):
    needs = (RGB, DEPTH)

    def __init__(self) -> None:
        super().__init__()
        self.scale = torch.nn.Parameter(torch.ones(1))

    def forward(self, frames, texts):
        return self.scale.expand(len(texts), 4), {}


def stepwise() -> list[dict[str, np.ndarray]]:
    rng = [np.random.default_rng(0)]
    steps = Forward().collect([Reusing(1)], [EPISODE], expert_share=1.0, rngs=rng, clean=True)
    return [{**s["frames"], **{f"clean_{n}": f for n, f in s["clean"].items()}} for s in steps]


def recurrent() -> list[dict[str, np.ndarray]]:
    walk = TrainingWalk(Reusing(1), EPISODE, (RGB, DEPTH))
    for _ in range(3):
        walk.record({}, clean=True, frames=True)
        walk.observation = walk.world.step(FORWARD)
    return [step["seen"] for step in walk.steps]


def topological() -> list[dict[str, np.ndarray]]:
    walk = LiveWalk(Reusing(VIEWS), EPISODE, ["seen"], clean=True)
    for _ in range(3):
        walk.record()
        walk.observation = walk.world.step(FORWARD)
    return walk.records


@pytest.mark.parametrize("walked", [stepwise, recurrent, topological])
def test_collect_copies_frames(walked: Callable) -> None:
    remaining = walked()
    assert len(remaining) == 3
    for number, frames in enumerate(remaining):
        assert {RGB, DEPTH, f"clean_{RGB}", f"clean_{DEPTH}"} <= {*frames}
        for name, frame in frames.items():
            assert np.all(frame == number + (DEPTH in name)), name
