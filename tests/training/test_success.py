"""Tests that the success rates for a schedule do not depend on the number of processes."""

from __future__ import annotations

from functools import partial

import numpy as np
import torch
from torch import nn

from mitigate.core.observation import Observation, cameras
from mitigate.core.precision import computing
from mitigate.corruptions import Schedule
from mitigate.evaluation.evaluator import EpisodeTask
from mitigate.training.rollouts import Rollouts
from mitigate.worlds.apartments.tasks import DrawnEpisodes
from mitigate.worlds.apartments.world import ApartmentsWorld
from tests.agents.rooms import wanderer


class Grey:
    """A world with one grey view. An episode has one step, and STOP is correct."""

    rule, sensors, done = "STOP", cameras(16, views=1), True

    def reset(self, episode):
        self.done = False
        return self.look()

    def step(self, action):
        self.done, self.won = True, action == 0
        return self.look()

    def look(self):
        frames = {
            "rgb": np.full((16, 16, 3), 128, np.uint8),
            "depth": np.full((16, 16, 1), 2.0, np.float32),
        }
        return Observation({"pose": np.zeros(3, np.float32)}, lambda: frames, tuple(frames))

    def measures(self):
        return {"success": int(self.won), "spl": float(self.won)}


class Careful(nn.Module):
    """An agent that stops if the RGB frame is grey."""

    def reset(self, instruction):
        pass

    def act(self, observation):
        return int((observation["rgb"] != 128).any())


def test_rates_do_not_depend_on_the_number_of_processes(capsys):
    names = ("low_light", "missing_data")
    for workers in (0, 1, 2):
        schedule = Schedule("success_distributed", 0.6, names=names)
        source = Rollouts(Careful(), Grey, DrawnEpisodes(2), schedule, refresh_episodes=2)
        source.refresh(60, workers)
        assert schedule.success == {"low_light": 0.0, "missing_data": 1.0}
    assert "success at step 60: 4 episodes" in capsys.readouterr().out


def test_rollouts_use_fp32_inside_a_bf16_training():
    """With bf16, success rates would depend on whether this process or new workers measure them."""
    cpu = torch.device("cpu")
    with computing("bf16", cpu), EpisodeTask(wanderer(), partial(ApartmentsWorld, 16)).ready():
        assert not torch.is_autocast_enabled("cpu")
    with computing("bf16", cpu):
        assert torch.is_autocast_enabled("cpu")
