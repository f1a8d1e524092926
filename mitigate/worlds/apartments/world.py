"""The apartments as a world (``worlds/world.py``) with measures, an expert, labels and random
poses.
"""

from __future__ import annotations

import copy
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np

from mitigate.core.memory import Memory
from mitigate.core.names import unknown
from mitigate.core.observation import DEPTH, POSE, RGB, VIEWS, Observation, cameras
from mitigate.corruptions.faults.camera import Mount
from mitigate.worlds import measures
from mitigate.worlds.apartments.apartment import Apartment, apartment_of
from mitigate.worlds.apartments.drawing import draw_plan
from mitigate.worlds.apartments.labels import pose_labels
from mitigate.worlds.apartments.navigation import CELL
from mitigate.worlds.apartments.renderer import LEVEL, shared_renderer
from mitigate.worlds.apartments.simulator import GeodesicExpert, Simulator, goal_field
from mitigate.worlds.apartments.tasks import SUCCESS_METRES, landmarks, view_points
from mitigate.worlds.episodes import Episode, from_vlnce
from mitigate.worlds.world import World

MEMORY_BYTES = 1 << 26  # maximum bytes of rendered frames that ``remembering`` caches (heuristic)
LARGEST = 2048  # maximum size of a view in pixels (heuristic)
# A warning is logged if the recorded and the measured distance differ by more than this.
# The limit is in metres and is heuristic. Lists of older versions hold the lengths of paths in
# eight directions, which are up to 1 m longer.
MAX_DIFFERENCE = 1.0
RULES = {"apartments": measures.Rule("vln", SUCCESS_METRES), **measures.RULES}


class ApartmentsWorld(World):
    """World with one agent in one apartment. All worlds in a process share one renderer per size.

    Args:
        size: side of a square view in pixels.
        layouts: number of training apartments in ``scenes``.
        views: 12 for a panorama, or 1 for a camera that faces forward.
        rule: name of the success rule in ``RULES``.

    Raises:
        ValueError: If the size or the number of views is not allowed, or the success rule is
            unknown.
    """

    def __init__(
        self, size: int = 64, layouts: int = 400, views: int = VIEWS, rule: str = "apartments"
    ) -> None:
        if rule not in RULES:
            raise ValueError(unknown("success rule", rule, RULES))
        if views not in (1, VIEWS):
            raise ValueError(f"views must be {VIEWS} (panorama) or 1 (forward), got {views}.")
        if not 8 <= size <= LARGEST:
            raise ValueError(f"size must be 8 to {LARGEST} pixels, got {size}. The default is 64.")
        self.size = size
        self.layouts = layouts
        self.views = views
        self._rule = rule
        # older rows have the SPL of paths in eight directions, so the text of new rows must differ
        self.rule = f"{RULES[rule]}; SPL of any-angle paths"
        self.sensors = cameras(size, views)
        self.simulator = Simulator(size)
        self._memory = Memory(0)
        self._rendered: tuple[np.ndarray, ...] | None = None
        self._warned = False

    def __getstate__(self) -> dict[str, Any]:
        # a renderer cannot be pickled, so an unpickled world uses the renderer of its process
        return {"size": self.size, "layouts": self.layouts, "views": self.views, "rule": self._rule}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__init__(**state)  # type: ignore[misc]

    @contextmanager
    def remembering(self) -> Iterator[None]:
        """Return a context manager in which frames of repeated poses are cached."""
        before, self._memory = self._memory, Memory(MEMORY_BYTES)
        try:
            yield
        finally:
            self._memory = before

    def beside(self) -> ApartmentsWorld:
        """Return a second world that shares the cache of rendered frames."""
        other = copy.copy(self)
        other._memory = self._memory
        return other

    # episodes ---------------------------------------------------------------------------------

    @property
    def done(self) -> bool:  # type: ignore[override]
        return self.simulator.done

    def reset(self, episode: Episode) -> Observation:
        self.simulator.reset(episode)
        self._shortest = self._shortest_length(episode)
        return self._observation()

    def step(self, action: int) -> Observation:
        self.simulator.step(action)
        return self._observation()

    def move(self, metres: float, degrees: float) -> Observation:
        """Move ``metres`` forward, then turn ``degrees`` to the left, as one step."""
        self.simulator.move(metres, degrees)
        return self._observation()

    def measures(self) -> dict[str, float]:
        """Return the measures of the episode.

        The measures are success, spl, ndtw, collisions, steps, path_length, geodesic_distance and
        distance_to_goal. The last three are in metres. geodesic_distance is the length of the
        shortest path from the start of the episode to the target of the success rule.
        distance_to_goal is the length of the path on the 10 cm grid, in eight directions, from the
        agent to this target; success depends on it. ndtw compares the agent's path with the
        reference path. Its threshold is ``path_metres`` of the success rule.
        """
        simulator = self.simulator
        left = float(self._field()[simulator.space.cell_of(simulator.xy)])
        values = measures.of_episode(
            RULES[self._rule],
            np.array(simulator.path),
            [from_vlnce(point) for point in simulator.episode.reference_path],
            start=self._shortest,
            left=left,
            stopped=simulator.stopped,
        )
        return values | {"collisions": int(simulator.collisions), "steps": simulator.steps}

    def expert(self) -> GeodesicExpert:
        return GeodesicExpert(self.simulator, RULES[self._rule], self._field())

    def _field(self) -> np.ndarray:
        """Return the distance in metres from each free cell to the target of the success rule.

        The target is the goal or its view points.
        """
        episode = self.simulator.episode
        if not RULES[self._rule].view_points:
            return self.simulator.field
        return goal_field(episode.scene_id, tuple(view_points(episode)))

    def _shortest_length(self, episode: Episode) -> float:
        """Return the length in metres of the shortest path from the start to the target.

        If the file hides the goals, return the length that the file records. If the recorded length
        differs from the measured length, a warning is issued once per world.
        """
        recorded, simulator = episode.geodesic_distance, self.simulator
        if recorded is not None and not episode.goals:
            return recorded
        measured = simulator.space.shortest_length(simulator.xy, simulator.goal_cells)
        differs = recorded is not None and abs(recorded - measured) > MAX_DIFFERENCE
        if differs and not self._warned:
            self._warned = True
            warnings.warn(
                f"The file records a geodesic_distance of {recorded:g} m for episode "
                f"{episode.episode_id}, but its goal is {measured:.1f} m from its start. SPL uses "
                "the measured distance. Check that the list is for these apartments, in metres.",
                stacklevel=3,
            )
        if RULES[self._rule].view_points:
            measured = simulator.space.shortest_length(simulator.xy, view_points(episode))
        return round(measured, 4)

    def truth(self) -> Mapping[str, np.ndarray]:
        """Return the labels of the current pose.

        Returns:
            "concepts" (float32 [12, C]): which of the C ``labels.CONCEPTS`` are visible in the
            middle of each view. "seen" (bool [12, furniture]): which pieces of furniture are
            visible. "free" (float32 [120, 12]): which straight paths are free. "goal" (float32
            [12]): which views show the goal.

            With a single camera, the labels describe the four columns of its view. The shapes are
            then [4, C] for "concepts", [4, furniture] for "seen" and [4] for "goal". "free" is [30,
            12] and covers the directions in the view from left to right.
        """
        simulator = self.simulator
        _, depth, ids = self._frames()
        labels = pose_labels(simulator.apartment, simulator.xy, simulator.heading, ids, depth)
        goal = labels["seen"][:, landmarks(simulator.episode)].any(1)
        return {**labels, "goal": np.asarray(goal, np.float32)}

    # indices of the furniture (as in the label "seen") that marks the goal of an episode
    landmarks = staticmethod(landmarks)

    def draw(self, axes: Any) -> None:
        draw_plan(axes, self.simulator.apartment)

    def _observation(self) -> Observation:
        self._rendered = None
        return Observation(
            self.simulator.odometry(), lambda: self._copied(self._frames()), (RGB, DEPTH)
        )

    def _copied(self, rendered: Sequence[np.ndarray]) -> dict[str, np.ndarray]:
        """Return copies of the frames, because an agent may write into its observation.

        Frames of a single camera have no axis for views.
        """
        views = slice(None) if self.views > 1 else 0
        return {name: rendered[i][views].copy() for i, name in enumerate((RGB, DEPTH))}

    def displaced(self, mount: Mount) -> dict[str, np.ndarray]:
        key = (*self._pose(), mount)
        return self._copied(self._memory.recall(key, lambda: self._observe(mount)))

    def _pose(self) -> tuple[str, float, float, float]:
        """Return the scene id and the pose of the agent."""
        simulator = self.simulator
        place = (float(simulator.xy[0]), float(simulator.xy[1]), float(simulator.heading))
        return simulator.episode.scene_id, *place

    def _frames(self) -> tuple[np.ndarray, ...]:
        if self._rendered is None:
            self._rendered = self._memory.recall(self._pose(), self._observe)
        return self._rendered

    def _observe(self, mount: Mount = LEVEL) -> tuple[np.ndarray, ...]:
        """Render RGB, depth and face ids of all cameras."""
        rendered = self.simulator.observe_faces(range(self.views), mount)
        return tuple(part[: self.views] for part in rendered)

    # poses ------------------------------------------------------------------------------------

    @property
    def scenes(self) -> Sequence[str]:
        return [f"apartments/train/{seed:06d}" for seed in range(self.layouts)]

    def enter(self, scene: str) -> None:
        """Select the scene that ``point`` and ``put`` use. Raise ValueError if it is unknown."""
        self._entered: Apartment = apartment_of(scene)

    def point(self, rng: np.random.Generator) -> np.ndarray:
        space = self._entered.space
        return space.centre(int(rng.integers(len(space.cells)))) + rng.uniform(-0.05, 0.05, 2)

    def points(self) -> np.ndarray:
        """Return one point per free cell of the scene in metres, as [n, 2]."""
        return (self._entered.space.cells[:, ::-1] + 0.5) * CELL

    def put(
        self,
        xy: np.ndarray,
        heading: float,
        *,
        views: Sequence[int] | None = None,
        rgb: bool = True,
        mount: Mount = LEVEL,
    ) -> tuple[dict[str, np.ndarray], Mapping[str, np.ndarray]]:
        """Return the frames and the pose as one dict, and all labels except "goal".

        ``views`` selects the views to render. It has no effect with a single camera.
        """
        apartment = self._entered
        renderer = shared_renderer(self.size)
        renderer.load(apartment)
        selected = range(self.views) if views is None or self.views == 1 else views
        place = float(xy[0]), float(xy[1]), heading
        drawn = renderer.render(*place, views=selected, rgb=rgb, mount=mount)
        _, depth, ids = parts = [part[: self.views] for part in drawn]
        pose = np.array([*xy, heading], np.float32)
        return {**self._copied(parts), POSE: pose}, pose_labels(apartment, xy, heading, ids, depth)
