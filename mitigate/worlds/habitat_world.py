"""A world (``worlds/world.py``) that runs VLN-CE episodes in any scene of habitat-sim.

habitat-sim 0.3 is not on the package index. ``docs/habitat.md`` explains how to get habitat-sim and
scenes. habitat-lab is not needed. The cameras, actions and measures are the same as in VLN-CE. For
the same path, the measures equal the values of habitat-lab, except nDTW. This module computes nDTW
from the reference path of an episode, whereas VLN-CE uses the denser locations in ``*_gt.json``.
"""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import Any

import numpy as np

from mitigate.core.json_files import read_object
from mitigate.core.names import unknown
from mitigate.core.observation import (
    DEPTH,
    FORWARD,
    FORWARD_METRES,
    HFOV_DEGREES,
    LEFT,
    MAX_STEPS,
    POSE,
    RGB,
    RIGHT,
    STOP,
    TURN_DEGREES,
    VIEW_STEP_DEGREES,
    VIEWS,
    Z_MAX,
    Observation,
    Sensor,
    cameras,
)
from mitigate.worlds import measures
from mitigate.worlds.episodes import Episode, from_vlnce
from mitigate.worlds.world import Expert, World, greedy_action

CAMERA_HEIGHT = 1.25  # in metres, as in VLN-CE
RADIUS = 0.18  # radius of the agent in metres
HEIGHT = 1.5  # height of the agent in metres
MOVES = {FORWARD: "move_forward", LEFT: "turn_left", RIGHT: "turn_right"}
MAX_SNAP = 0.5  # maximum distance in metres between a start or goal and the navmesh (heuristic)
NAVMESH = {"agent_radius": RADIUS, "agent_height": HEIGHT}


class HabitatWorld(World):
    """World with one agent in scenes of habitat-sim.

    Args:
        scenes: Folder that contains the scene files; scene ids are paths relative to it.
        size: Height and width of a view in pixels.
        views: 12 for a panorama, or 1 for a single camera that faces forward.
        rule: Name of a success rule in ``measures.RULES``, or "apartments", which requires STOP
            within 2 m.
        navmesh: Settings of ``habitat_sim.NavMeshSettings`` for scenes that have no navmesh, as a
            file or a mapping. If None, they are read from ``scenes/../navmesh.json`` if this file
            exists.
        gpu: Index of the GPU for rendering, or -1 for the CPU.

    Raises:
        ValueError: If ``views`` or ``rule`` is invalid, or if habitat-sim is not installed. The
            latter is reported when the first episode starts.
    """

    def __init__(
        self,
        scenes: str,
        size: int = 64,
        views: int = VIEWS,
        rule: str = "vln_ce",
        navmesh: str | dict[str, Any] | None = None,
        gpu: int = -1,
    ) -> None:
        rules = {name: known for name, known in measures.RULES.items() if not known.view_points}
        rules["apartments"] = measures.Rule("vln", 2.0)
        if rule not in rules:
            raise ValueError(
                f"{unknown('success rule', rule, rules)} This world has no view points."
            )
        if views not in (1, VIEWS):
            raise ValueError(f"views must be {VIEWS} (panorama) or 1 (forward), got {views}.")
        self.scenes_folder = Path(scenes)
        self.size = size
        self.views = views
        self._rule = rules[rule]
        self.rule = str(self._rule)
        self.sensors: dict[str, Sensor] = cameras(size, views)
        self.navmesh = _navmesh_settings(navmesh, self.scenes_folder)
        self.gpu = gpu
        self._sim: Any = None
        self._scene = ""

    def __getstate__(self) -> dict[str, Any]:
        # a simulator cannot be pickled, so an unpickled world opens a new simulator
        return {**vars(self), "_sim": None, "_scene": ""}

    # episodes ---------------------------------------------------------------------------------

    @property
    def done(self) -> bool:  # type: ignore[override]
        return self.stopped or self.steps >= MAX_STEPS

    def reset(self, episode: Episode) -> Observation:
        """Start an episode.

        Raises:
            FileNotFoundError: If the scene does not exist.
            ValueError: If the start or a goal is not on the navmesh.
        """
        self._load_scene(episode.scene_id)
        self.episode = episode
        start = self._on_navmesh(episode.start_position, "starts")
        self.goals = [self._on_navmesh(g.position, "has a goal") for g in episode.goals]
        state = _habitat_sim().AgentState()
        state.position = start
        state.rotation = np.array(episode.start_rotation, np.float64)
        self._sim.get_agent(0).set_state(state)
        self.path = [self._position()]
        self.steps = self.collisions = 0
        self.stopped = False
        self.start_distance = self.distance_to_goal()
        return self._observation()

    def step(self, action: int) -> Observation:
        if self.done:
            raise RuntimeError("The episode is over. Call reset() before step().")
        if action == STOP:
            self.stopped = True
        elif action in MOVES:
            self.collisions += bool(self._sim.get_agent(0).act(MOVES[action]))
            self.path.append(self._position())
        else:
            raise ValueError(
                f"The action must be 0 STOP, 1 FORWARD, 2 LEFT or 3 RIGHT, got {action}."
            )
        self.steps += 1
        return self._observation()

    def move(self, metres: float, degrees: float) -> Observation:
        """Move ``metres`` forward, then turn ``degrees`` to the left, as one step."""
        if self.done:
            raise RuntimeError("The episode is over. Call reset() before step().")
        agent = self._sim.get_agent(0)
        for action, amount in ((FORWARD, metres), (LEFT if degrees > 0 else RIGHT, abs(degrees))):
            if amount > 0:
                actuation = agent.agent_config.action_space[MOVES[action]].actuation
                usual = actuation.amount
                actuation.amount = amount
                try:
                    self.collisions += bool(agent.act(MOVES[action]))
                finally:
                    actuation.amount = usual
        self.path.append(self._position())
        self.steps += 1
        return self._observation()

    def measures(self) -> dict[str, float]:
        """Return the measures of the episode so far, with lengths and distances in metres.

        ``success`` and ``spl`` are defined as in habitat-lab. ``ndtw`` compares the path with the
        reference path; its threshold is ``Rule.path_metres``.
        """
        values = measures.of_episode(
            self._rule,
            np.array(self.path),
            self.episode.reference_path,
            start=self.start_distance,
            left=self.distance_to_goal(),
            stopped=self.stopped,
        )
        return values | {"collisions": self.collisions, "steps": self.steps}

    def distance_to_goal(self, position: np.ndarray | None = None) -> float:
        """Return the geodesic distance in metres from a position [3] to the nearest goal.

        The default position is the agent's.
        """
        import habitat_sim

        path = habitat_sim.MultiGoalShortestPath()
        path.requested_start = self._position() if position is None else position
        path.requested_ends = np.array(self.goals, np.float32)
        self._sim.pathfinder.find_path(path)
        return float(path.geodesic_distance)

    def expert(self) -> NavmeshExpert:
        return NavmeshExpert(self)

    def _observation(self) -> Observation:
        pose = np.array([*from_vlnce(tuple(self._position())), self._heading()], np.float32)
        return Observation({POSE: pose}, self._frames, (RGB, DEPTH))

    def _frames(self) -> dict[str, np.ndarray]:
        """Render the frames that ``sensors`` describes. Depth is clipped to ``Z_MAX``."""
        images = self._sim.get_sensor_observations()
        rgb = np.stack([images[f"{RGB}{k}"][..., :3] for k in range(self.views)])
        depth = np.stack([images[f"{DEPTH}{k}"] for k in range(self.views)])[..., None]
        depth = np.minimum(depth, np.float32(Z_MAX)).astype(np.float32)
        views = slice(None) if self.views > 1 else 0
        return {RGB: rgb[views], DEPTH: depth[views]}

    # the simulator ----------------------------------------------------------------------------

    def _load_scene(self, scene: str) -> None:
        """Load a scene unless it is already loaded."""
        if scene == self._scene:
            return
        file = self.scenes_folder / scene
        file = file if file.suffix else file.with_suffix(".glb")
        if not file.is_file():
            raise FileNotFoundError(
                f"There is no scene {file}. Set env.scenes= to the folder with the scenes of the "
                "episodes (mitigate export-scene writes the scenes of the apartments)."
            )
        settings = self._settings(file)
        self._scene = ""  # so that the attribute is empty if loading fails
        if self._sim is None:
            self._sim = _habitat_sim().Simulator(settings)
        else:
            self._sim.reconfigure(settings)
        if not file.with_suffix(".navmesh").is_file():
            self._make_navmesh(scene)
        self._scene = scene

    def _settings(self, file: Path) -> Any:
        """Return a habitat-sim configuration with the cameras and actions of VLN-CE.

        Agents slide along walls.
        """
        habitat_sim = _habitat_sim()
        backend = habitat_sim.SimulatorConfiguration()
        backend.scene_id = str(file)
        backend.gpu_device_id = self.gpu
        backend.enable_physics = False
        backend.allow_sliding = True
        backend.create_renderer = True
        agent = habitat_sim.agent.AgentConfiguration()
        agent.radius = RADIUS
        agent.height = HEIGHT
        agent.sensor_specifications = [
            self._camera(kind, k) for kind in (RGB, DEPTH) for k in range(self.views)
        ]
        amounts = {FORWARD: FORWARD_METRES, LEFT: TURN_DEGREES, RIGHT: TURN_DEGREES}
        spec = habitat_sim.agent
        agent.action_space = {
            name: spec.ActionSpec(name, spec.ActuationSpec(amount=amounts[action]))
            for action, name in MOVES.items()
        }
        return habitat_sim.Configuration(backend, [agent])

    def _camera(self, kind: str, view: int) -> Any:
        """Return the camera of a view.

        Successive views are 30 degrees further to the right, and Habitat's yaw is positive to the
        left.
        """
        habitat_sim = _habitat_sim()
        types = habitat_sim.SensorType
        spec = habitat_sim.CameraSensorSpec()
        spec.uuid = f"{kind}{view}"
        spec.sensor_type = types.COLOR if kind == RGB else types.DEPTH
        spec.resolution = [self.size, self.size]
        spec.hfov = HFOV_DEGREES
        spec.position = [0.0, CAMERA_HEIGHT, 0.0]
        spec.orientation = [0.0, -math.radians(VIEW_STEP_DEGREES * view), 0.0]
        return spec

    def _make_navmesh(self, scene: str) -> None:
        habitat_sim = _habitat_sim()
        settings = habitat_sim.NavMeshSettings()
        settings.set_defaults()
        for name, value in self.navmesh.items():
            if name not in dir(settings):
                raise ValueError(f"{name} must be an attribute of habitat-sim's NavMeshSettings.")
            setattr(settings, name, value)
        if not self._sim.recompute_navmesh(self._sim.pathfinder, settings):
            raise ValueError(
                f"habitat-sim computed an empty navmesh for {scene}. Check the scene and navmesh=."
            )

    def _on_navmesh(self, position: Any, what: str) -> np.ndarray:
        """Return the point [3] of the navmesh that is nearest to a position."""
        point = np.array(position, np.float32)
        snapped = np.array(self._sim.pathfinder.snap_point(point), np.float32)
        distance = float(np.hypot(*(snapped - point)[[0, 2]]))
        if not distance <= MAX_SNAP:
            raise ValueError(
                f"The episode {self.episode.episode_id} {what} at {list(position)}, "
                f"{distance:.1f} m from the navmesh of {self.episode.scene_id}. Check that scene, "
                "episodes and navmesh belong together, and that the agent's size is right."
            )
        return snapped

    def _position(self) -> np.ndarray:
        return np.array(self._sim.get_agent(0).get_state().position, np.float32)

    def _heading(self) -> float:
        rotation = self._sim.get_agent(0).get_state().rotation
        return 2 * math.atan2(float(rotation.imag[1]), float(rotation.real))

    def close(self) -> None:
        """Free the simulator. The next episode opens a new one."""
        if self._sim is not None:
            self._sim.close()
            self._sim, self._scene = None, ""


class NavmeshExpert(Expert):
    """Oracle that uses geodesic distances on the navmesh.

    It turns to the heading in which the next step forward reduces the distance most.
    """

    def __init__(self, world: HabitatWorld) -> None:
        self.world = world

    def distance(self, xy: np.ndarray) -> float:
        """Return the geodesic distance in metres to the goal from a plan position [2].

        The position is on the agent's floor.
        """
        height = float(self.world._position()[1])
        return self.world.distance_to_goal(np.array([xy[0], height, -xy[1]], np.float32))

    def counts(self, metres: float) -> bool:
        return self.world._rule.met(metres, True)

    def action(self) -> int:
        world = self.world
        if world.distance_to_goal() < world._rule.stop_within:
            return STOP
        position = world._position()

        def distance_after(heading: float) -> float:
            step = np.array([-math.sin(heading), 0.0, -math.cos(heading)]) * FORWARD_METRES
            end = world._sim.pathfinder.try_step(position, position + step)
            return world.distance_to_goal(np.array(end))

        return greedy_action(world._heading(), distance_after)


def _habitat_sim() -> Any:
    """Import habitat-sim without its log, which warns about missing labels in every scene."""
    for variable in ("HABITAT_SIM_LOG", "MAGNUM_LOG"):
        os.environ.setdefault(variable, "quiet")
    try:
        import habitat_sim
    except ImportError as error:
        raise ValueError(
            "The Habitat world needs habitat-sim 0.3. docs/habitat.md explains how to get it."
        ) from error
    return habitat_sim


def _navmesh_settings(navmesh: str | dict[str, Any] | None, scenes: Path) -> dict[str, Any]:
    """Return navmesh settings by name.

    A file with settings must have the format that ``mitigate export-scene`` writes.
    """
    if navmesh is None:
        navmesh = str(scenes.parent / "navmesh.json")
        if not Path(navmesh).is_file():
            return dict(NAVMESH)
    fix = "Write it again with `mitigate export-scene`."
    settings = read_object(Path(navmesh), fix) if isinstance(navmesh, str) else navmesh
    return {**NAVMESH, **{n: v for n, v in dict(settings).items() if n != "camera_height"}}
