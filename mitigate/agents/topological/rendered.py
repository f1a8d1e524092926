"""An episode in the simulator whose frames a schedule corrupts: where imitation rolls out."""

from __future__ import annotations

import numpy as np

from mitigate.agents.topological.controller import Controller
from mitigate.core.observation import CLEAN_DEPTH, CLEAN_RGB, DEPTH, POSE, RGB
from mitigate.corruptions import Schedule, corrupt_observation
from mitigate.worlds.apartments.labels import free_directions, view_labels
from mitigate.worlds.apartments.renderer import Renderer
from mitigate.worlds.apartments.simulator import Simulator
from mitigate.worlds.apartments.tasks import landmarks
from mitigate.worlds.episodes import Episode


class RenderedWorld:
    """A world of ``rollout.py``; ``looks`` keeps what each decision saw.

    Args: episode; name: of the episode for the schedule's keys; schedule, seed: which frame is hurt
    by what; renderer: may be shared with other worlds.
    """

    def __init__(
        self, episode: Episode, name: str, schedule: Schedule, seed: int, renderer: Renderer
    ) -> None:
        self.episode, self.name, self.schedule, self.seed = episode, name, schedule, seed
        self.simulator = Simulator(renderer.size, renderer=renderer)
        self.simulator.reset(episode)
        self.looks: list[dict[str, np.ndarray]] = []

    def observe(self) -> None:
        """Render, label and corrupt the panorama at the current pose; append it to ``looks``.

        A look holds rgb and depth (``core/observation.py``), the same before the corruption
        (clean_rgb, clean_depth), concepts [12, C], free [120, 12] (what the waypoint head should
        find) and shows [12] (which views show the goal's landmarks).
        """
        simulator = self.simulator
        rgb, depth, ids = simulator.observe_faces()
        concepts, seen = view_labels(simulator.apartment, ids, depth)
        frames = {RGB: rgb, DEPTH: depth, **simulator.odometry()}
        drawn = self.schedule.draw(self.seed, self.name, len(self.looks))
        hurt = corrupt_observation(frames, *drawn)
        self.looks.append(
            {
                RGB: hurt[RGB],
                DEPTH: hurt[DEPTH],
                CLEAN_RGB: rgb,
                CLEAN_DEPTH: depth,
                "concepts": concepts,
                "free": free_directions(simulator.space, simulator.xy, simulator.heading),
                "shows": np.asarray(seen[:, landmarks(self.episode)].any(1), np.float32),
            }
        )

    def pose(self) -> np.ndarray:
        return self.simulator.odometry()[POSE].astype(np.float64)

    def go(self, route: list[np.ndarray]) -> None:
        controller = Controller()
        controller.follow(route)
        while (action := controller.action(self.pose())) is not None:
            self.simulator.step(action)

    def distance(self, xy: np.ndarray) -> float:
        return self.simulator.distance_to_goal(xy)
