"""Simulate continuous motion in an apartment, with RGB-D panoramas and geodesic distances."""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache

import numpy as np

from mitigate.core.observation import DEPTH, FORWARD_METRES, MAX_STEPS, POSE, RGB, STOP, VIEWS
from mitigate.corruptions.faults.camera import Mount
from mitigate.worlds.apartments.apartment import apartment_of
from mitigate.worlds.apartments.renderer import LEVEL, shared_renderer
from mitigate.worlds.episodes import Episode, Vector, from_vlnce, heading_of
from mitigate.worlds.measures import Rule
from mitigate.worlds.world import MOVES, Expert, greedy_action

# This is the maximum distance in metres from a start or goal to a free cell (heuristic).
# It is not 0 because a goal may be a piece of furniture.
NEAR = 0.5


# number of cached distance fields; a field takes 20 kB, and half a millisecond to compute
@lru_cache(maxsize=256)
def goal_field(scene_id: str, goal_cells: tuple[int, ...]) -> np.ndarray:
    """Return the geodesic distance in metres from each free cell to the nearest goal cell."""
    return apartment_of(scene_id).space.distances(list(goal_cells))


class Simulator:
    """Simulator of one agent in one apartment, with the actions and step limit of VLN-CE."""

    def __init__(self, size: int = 64) -> None:
        self.size = size

    def reset(self, episode: Episode) -> None:
        """Place the agent at the start of an episode, or in the nearest free cell.

        Raises ValueError if the start or a goal is more than ``NEAR`` metres from every free cell.
        """
        self.episode, self.apartment = episode, apartment_of(episode.scene_id)
        self.space = self.apartment.space
        self._check_place("starts", episode.start_position)
        for goal in episode.goals:
            self._check_place("has a goal", goal.position)
        self.goal_cells = [self.space.cell_of(from_vlnce(g.position)) for g in episode.goals]
        self.field = goal_field(episode.scene_id, tuple(self.goal_cells))
        self.xy = self.space.stand(from_vlnce(episode.start_position))
        self.heading = heading_of(episode.start_rotation)
        self.path = [self.xy.copy()]
        self.steps = self.collisions = 0
        self.stopped = False

    def _check_place(self, what: str, position: Vector) -> None:
        xy = from_vlnce(position)
        gap = float(np.hypot(*(self.space.centre(self.space.cell_of(xy)) - xy)))
        if not gap <= NEAR:
            raise ValueError(
                f"The episode {self.episode.episode_id} {what} at {list(position)}, which is "
                f"{gap:.1f} m from the nearest free position in {self.episode.scene_id}. "
                "Positions have VLN-CE's order (x, up, z), where z is -y of the floor plan."
            )

    @property
    def done(self) -> bool:
        return self.stopped or self.steps >= MAX_STEPS

    def odometry(self) -> dict[str, np.ndarray]:
        """Return the pose without frames: float32 [3] with x, y and heading."""
        return {POSE: np.array([self.xy[0], self.xy[1], self.heading], np.float32)}

    def observe(self) -> dict[str, np.ndarray]:
        """Return a full observation (see ``mitigate.core.observation``)."""
        rgb, depth, _ = self.observe_faces()
        return {RGB: rgb, DEPTH: depth, **self.odometry()}

    def observe_faces(
        self, views: Iterable[int] = range(VIEWS), mount: Mount = LEVEL
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Render RGB, depth and face ids of ``views`` of the panorama at the current pose."""
        renderer = shared_renderer(self.size)
        renderer.load(self.apartment)
        place = float(self.xy[0]), float(self.xy[1]), float(self.heading)
        return renderer.render(*place, views=views, mount=mount)

    def step(self, action: int) -> None:
        """Execute one low-level action.

        Raises ValueError if the action does not exist, and RuntimeError if the episode is over.
        """
        if action != STOP and action not in MOVES:
            raise ValueError(
                f"The action must be 0 STOP, 1 FORWARD, 2 LEFT or 3 RIGHT, got {action}."
            )
        self.move(*MOVES.get(action, (0.0, 0.0)))  # STOP is a step without movement
        self.stopped = action == STOP

    def move(self, metres: float, degrees: float) -> None:
        """Move ``metres`` forward, then turn ``degrees`` to the left, as one step.

        Raises RuntimeError if the episode is over.
        """
        if self.done:
            raise RuntimeError("The episode is over. Call reset() before step().")
        if metres > 0:
            self.xy, collided = self.space.move(self.xy, self.heading, metres)
            self.collisions += collided
            self.path.append(self.xy.copy())
        self.heading += np.radians(degrees)
        self.steps += 1


class GeodesicExpert(Expert):
    """Expert that greedily reduces the geodesic distances in ``field``.

    The expert turns to the heading in which the next step forward reduces the distance most. It
    stops at the distance that ``rule`` defines.
    """

    def __init__(self, simulator: Simulator, rule: Rule, field: np.ndarray) -> None:
        self.simulator, self.rule, self.field = simulator, rule, field

    def distance(self, xy: np.ndarray) -> float:
        return float(self.field[self.simulator.space.cell_of(xy)])

    def counts(self, metres: float) -> bool:
        return self.rule.met(metres, True)

    def action(self) -> int:
        simulator = self.simulator
        if self.distance(simulator.xy) < self.rule.stop_within:
            return STOP
        space = simulator.space

        def distance_after(heading: float) -> float:
            return self.distance(space.move(simulator.xy, heading, FORWARD_METRES)[0])

        return greedy_action(simulator.heading, distance_after)
