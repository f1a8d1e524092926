"""Small worlds and an untrained agent for the tests of agents."""

from __future__ import annotations

import numpy as np
import torch

from mitigate.agents.topological import TopologicalAgent
from mitigate.core import seeding
from mitigate.core.observation import MAX_STEPS, Observation
from mitigate.worlds.apartments.labels import free_directions
from mitigate.worlds.apartments.navigation import CELL, FreeSpace
from mitigate.worlds.apartments.world import ApartmentsWorld
from mitigate.worlds.episodes import Episode


def room(width: float, depth: float) -> FreeSpace:
    """An empty room with sizes in metres, whose walls are one cell thick."""
    blocked = np.ones((round(depth / CELL), round(width / CELL)), bool)
    blocked[1:-1, 1:-1] = False
    return FreeSpace(blocked)


class Brief(ApartmentsWorld):
    """Apartments in which an episode ends after 30 steps."""

    def reset(self, episode: Episode) -> Observation:
        seen = super().reset(episode)
        self.simulator.steps = MAX_STEPS - 30
        return seen


class Corner(ApartmentsWorld):
    """Apartments limited to their first 400 points, so that only a few features are stored."""

    def points(self) -> np.ndarray:
        return super().points()[:400]


def sure(space: FreeSpace, xy: np.ndarray, heading: float) -> np.ndarray:
    """Return the logits [120, 12] that a perfect waypoint predictor would return."""
    return np.where(free_directions(space, xy, heading) > 0.5, 20.0, -20.0)


def wanderer(*blind: str, stop: float = -50.0) -> TopologicalAgent:
    """Return an untrained agent that predicts free space everywhere.

    ``stop`` is the bias of the stop score. At -50, the agent stops only at the decision limit. Near
    0, the frames determine when it stops.
    """
    seeding.seed_everything(0, "wanderer")
    small = {"heads": 2, "text_layers": 1, "layers": 1}
    agent = TopologicalAgent(16, small, blind, size=16).eval()
    with torch.no_grad():
        agent.waypoint_head.out.bias.fill_(8.0)
        agent.planner.stop[-1].bias.fill_(stop)
    return agent
