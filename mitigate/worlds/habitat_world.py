"""Habitat as a world (``worlds/world.py``): any scene that habitat-sim loads, VLN-CE's episodes.

habitat-sim 0.3 is not on the package index; how to get it, and scenes: ``docs/habitat.md``. The
lab is not needed: cameras, actions and measures are VLN-CE's, and measures equal those of
habitat-lab on the same walk (path by path, geodesics by the navmesh), but for nDTW: it is against
an episode's reference path, where VLN-CE's is against the denser locations of ``*_gt.json``.
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
from mitigate.worlds.world import Expert, World

EYE = 1.25  # metres, the height of VLN-CE's cameras
RADIUS, HEIGHT = 0.18, 1.5  # metres, of the agent
MOVES = {FORWARD: "move_forward", LEFT: "turn_left", RIGHT: "turn_right"}
SNAP = 0.5  # metres that a start or goal may lie beside the navmesh (ours)
NAVMESH = {"agent_radius": RADIUS, "agent_height": HEIGHT}


class HabitatWorld(World):
    """One agent in scenes of habitat-sim, which a process has one simulator of.

    Args:
        scenes: the folder that scene ids are paths in. size: pixels of a square view. views: 12, a
        panorama, or 1, a camera that looks ahead. rule: what counts as success, of
        ``measures.RULES``, or "apartments" (STOP within 2 m). navmesh: settings of
        ``habitat_sim.NavMeshSettings`` for scenes without a navmesh; a file or a mapping; None:
        those in ``scenes/../navmesh.json``, if it is there. gpu: number of the device to render
        on, -1 for none.
    Raises ValueError for another number of views, an unknown rule, and without
    habitat-sim when the first episode begins.
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
        rules = {"apartments": measures.Rule("vln", 2.0), **measures.RULES}
        allowed = [name for name, known in rules.items() if not known.view_points]
        if rule in rules and rule not in allowed:
            raise ValueError(
                f"rule={rule} counts from view points, which this world does not read. Choose one "
                f"of: {', '.join(allowed)}."
            )
        if rule not in allowed:
            raise ValueError(unknown("success rule", rule, allowed))
        if views not in (1, VIEWS):
            raise ValueError(f"views={views}: an agent sees {VIEWS} views, or 1 ahead.")
        self._given = {"scenes": str(scenes), "size": size, "views": views, "rule": rule}
        self._given |= {"navmesh": navmesh, "gpu": gpu}
        self.scenes_folder, self.size, self.views = Path(scenes), size, views
        self._rule, self.rule = rules[rule], str(rules[rule])
        self.sensors: dict[str, Sensor] = cameras(size, views)
        self.navmesh = _navmesh(navmesh, self.scenes_folder)
        self.gpu = gpu
        self._sim: Any = None
        self._scene = ""

    def __getstate__(self) -> dict[str, Any]:
        return self._given

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__init__(**state)  # type: ignore[misc]

    # episodes ---------------------------------------------------------------------------------

    @property
    def done(self) -> bool:  # type: ignore[override]
        return self.stopped or self.steps >= MAX_STEPS

    def reset(self, episode: Episode) -> Observation:
        """Raises FileNotFoundError for a scene that is not there, ValueError for an episode that
        starts or ends off the navmesh."""
        self._enter(episode.scene_id)
        self.episode = episode
        start = self._on_navmesh(episode.start_position, "starts")
        self.goals = [self._on_navmesh(g.position, "has a goal") for g in episode.goals]
        self._put(start, episode.start_rotation)
        self.path = [self._position()]
        self.steps = self.collisions = 0
        self.stopped = False
        self.start_distance = self.distance_to_goal()
        return self._observation()

    def step(self, action: int) -> Observation:
        """One low-level action. Raises ValueError for one that does not exist, RuntimeError after
        the last one."""
        if self.done:
            raise RuntimeError("The episode is over: reset first.")
        if action == STOP:
            self.stopped = True
        elif action in MOVES:
            self.collisions += bool(self._sim.get_agent(0).act(MOVES[action]))
            self.path.append(self._position())
        else:
            raise ValueError(
                f"Unknown action {action}; allowed: 0 STOP, 1 FORWARD, 2 LEFT, 3 RIGHT."
            )
        self.steps += 1
        return self._observation()

    def measures(self) -> dict[str, float]:
        """success, spl, path_length, geodesic_distance, distance_to_goal (metres), ndtw,
        collisions and steps; success and spl as habitat-lab's Success and SPL. ndtw is to the
        reference path, by the rule's metres."""
        walked, left = np.array(self.path), self.distance_to_goal()
        length = measures.path_length(walked)
        won = self._rule.met(left, self.stopped)
        start = self.start_distance
        found = {
            "success": int(won),
            "spl": round(measures.spl(won, start, length), 6) if math.isfinite(start) else 0.0,
            "path_length": round(length, 4),
            "collisions": self.collisions,
            "steps": self.steps,
        }
        distances = {"geodesic_distance": start, "distance_to_goal": left}
        found |= {n: round(d, 4) for n, d in distances.items() if math.isfinite(d)}
        if self.episode.reference_path:
            reference = np.array(self.episode.reference_path)
            by = self._rule.path_metres
            found["ndtw"] = round(measures.ndtw(walked, reference, threshold=by), 6)
        return found

    def distance_to_goal(self, position: np.ndarray | None = None) -> float:
        """Geodesic metres from a position [3] (default: the agent's) to the nearest goal."""
        import habitat_sim

        path = habitat_sim.MultiGoalShortestPath()
        path.requested_start = self._position() if position is None else position
        path.requested_ends = np.array(self.goals, np.float32)
        self._sim.pathfinder.find_path(path)
        return float(path.geodesic_distance)

    def expert(self) -> NavmeshExpert:
        """The oracle of the episode that is on."""
        return NavmeshExpert(self)

    def _observation(self) -> Observation:
        state = self._sim.get_agent(0).get_state()
        rotation = state.rotation
        heading = 2 * math.atan2(float(rotation.imag[1]), float(rotation.real))
        pose = np.array([*from_vlnce(state.position), heading], np.float32)
        return Observation({POSE: pose}, self._frames, (RGB, DEPTH))

    def _frames(self) -> dict[str, np.ndarray]:
        """RGB and depth as ``sensors`` says; depth beyond ``Z_MAX`` reads ``Z_MAX``."""
        seen = self._sim.get_sensor_observations()
        rgb = np.stack([seen[f"{RGB}{k}"][..., :3] for k in range(self.views)])
        depth = np.stack([seen[f"{DEPTH}{k}"] for k in range(self.views)])[..., None]
        depth = np.minimum(depth, np.float32(Z_MAX)).astype(np.float32)
        return {RGB: rgb, DEPTH: depth} if self.views > 1 else {RGB: rgb[0], DEPTH: depth[0]}

    # the simulator ----------------------------------------------------------------------------

    def _enter(self, scene: str) -> None:
        """Load a scene, if it is not the one that is there."""
        if scene == self._scene:
            return
        file = self.scenes_folder / scene
        file = file if file.suffix else file.with_suffix(".glb")
        if not file.is_file():
            raise FileNotFoundError(
                f"There is no scene {file}. Name the folder that holds the episodes' scenes: "
                "env.scenes=FOLDER (mitigate export-scene writes the apartments')."
            )
        settings, self._scene = self._settings(file), ""  # no scene, should it not load
        if self._sim is None:
            self._sim = _habitat_sim().Simulator(settings)
        else:
            self._sim.reconfigure(settings)
        if not file.with_suffix(".navmesh").is_file():
            self._make_navmesh(scene)
        self._scene = scene

    def _settings(self, file: Path) -> Any:
        """A configuration of habitat-sim: the cameras, VLN-CE's actions, sliding along walls."""
        habitat_sim = _habitat_sim()
        backend = habitat_sim.SimulatorConfiguration()
        backend.scene_id, backend.gpu_device_id = str(file), self.gpu
        backend.enable_physics, backend.allow_sliding = False, True
        backend.create_renderer = True
        agent = habitat_sim.agent.AgentConfiguration()
        agent.radius, agent.height = RADIUS, HEIGHT
        agent.sensor_specifications = [
            self._camera(kind, k) for kind in (RGB, DEPTH) for k in range(self.views)
        ]
        amounts = {FORWARD: FORWARD_METRES, LEFT: TURN_DEGREES, RIGHT: TURN_DEGREES}
        agent.action_space = {
            name: habitat_sim.agent.ActionSpec(
                name, habitat_sim.agent.ActuationSpec(amount=amounts[action])
            )
            for action, name in MOVES.items()
        }
        return habitat_sim.Configuration(backend, [agent])

    def _camera(self, kind: str, view: int) -> Any:
        """View ``view`` turns right by 30 degrees each; Habitat's yaw grows to the left."""
        habitat_sim = _habitat_sim()
        spec = habitat_sim.CameraSensorSpec()
        kinds = {RGB: habitat_sim.SensorType.COLOR, DEPTH: habitat_sim.SensorType.DEPTH}
        spec.uuid, spec.sensor_type = f"{kind}{view}", kinds[kind]
        spec.resolution, spec.hfov = [self.size, self.size], HFOV_DEGREES
        spec.position = [0.0, EYE, 0.0]
        spec.orientation = [0.0, -math.radians(VIEW_STEP_DEGREES * view), 0.0]
        return spec

    def _make_navmesh(self, scene: str) -> None:
        habitat_sim = _habitat_sim()
        settings = habitat_sim.NavMeshSettings()
        settings.set_defaults()
        for name, value in self.navmesh.items():
            if name not in dir(settings):
                raise ValueError(f"habitat-sim's NavMeshSettings have no {name}.")
            setattr(settings, name, value)
        if not self._sim.recompute_navmesh(self._sim.pathfinder, settings):
            raise ValueError(f"habitat-sim found nothing to walk on in {scene}.")

    def _on_navmesh(self, position: Any, what: str) -> np.ndarray:
        """The point [3] of the navmesh nearest to a position."""
        wanted = np.array(position, np.float32)
        snapped = np.array(self._sim.pathfinder.snap_point(wanted), np.float32)
        away = float(np.hypot(*(snapped - wanted)[[0, 2]]))
        if not away <= SNAP:
            raise ValueError(
                f"The episode {self.episode.episode_id} {what} at {list(position)}, {away:.1f} m "
                f"beside the navmesh of {self.episode.scene_id}. Are scene and episodes of one "
                "dataset, and the navmesh of an agent of this size?"
            )
        return snapped

    def _put(self, position: np.ndarray, rotation: Any) -> None:
        state = _habitat_sim().AgentState()
        state.position, state.rotation = position, np.array(rotation, np.float64)
        self._sim.get_agent(0).set_state(state)

    def _position(self) -> np.ndarray:
        return np.array(self._sim.get_agent(0).get_state().position, np.float32)

    def close(self) -> None:
        """Free the simulator."""
        if self._sim is not None:
            self._sim.close()
            self._sim, self._scene = None, ""


class NavmeshExpert(Expert):
    """Distances by the navmesh, and the greedy follower of them: it turns to the heading whose
    step lowers the distance most."""

    def __init__(self, world: HabitatWorld) -> None:
        self.world = world

    def distance(self, xy: np.ndarray) -> float:
        """Geodesic metres from a plan position [2], on the floor where the agent is."""
        height = float(self.world._position()[1])
        return self.world.distance_to_goal(np.array([xy[0], height, -xy[1]], np.float32))

    def counts(self, metres: float) -> bool:
        """Whether STOP so far from the goal is a success."""
        return self.world._rule.met(metres, True)

    def action(self) -> int:
        """The low-level action that comes nearest to the goal."""
        world = self.world
        if world.distance_to_goal() < world._rule.stop_within:
            return STOP
        here, finder = world._position(), world._sim.pathfinder
        rotation = world._sim.get_agent(0).get_state().rotation
        heading = 2 * math.atan2(float(rotation.imag[1]), float(rotation.real))
        turns = sorted(range(-12, 13), key=abs)
        ends = []
        for turn in turns:
            angle = heading + math.radians(TURN_DEGREES) * turn
            step = np.array([-math.sin(angle), 0.0, -math.cos(angle)]) * FORWARD_METRES
            ends.append(world.distance_to_goal(np.array(finder.try_step(here, here + step))))
        best = turns[int(np.argmin(ends))]
        return FORWARD if best == 0 else LEFT if best > 0 else RIGHT


def _habitat_sim() -> Any:
    for variable in ("HABITAT_SIM_LOG", "MAGNUM_LOG"):  # it warns of every scene's missing labels
        os.environ.setdefault(variable, "quiet")
    try:
        import habitat_sim
    except ImportError as error:
        raise ValueError(
            "The Habitat world needs habitat-sim 0.3, which is not on the package index: "
            "docs/habitat.md says how to get it."
        ) from error
    return habitat_sim


def _navmesh(given: str | dict[str, Any] | None, scenes: Path) -> dict[str, Any]:
    """Settings of a navmesh by name, as ``mitigate export-scene`` writes them."""
    if given is None:
        given = str(scenes.parent / "navmesh.json")
        if not Path(given).is_file():
            return dict(NAVMESH)
    again = "Write it again with `mitigate export-scene`."
    held = read_object(Path(given), again) if isinstance(given, str) else given
    return {**NAVMESH, **{n: v for n, v in dict(held).items() if n != "camera_height"}}
