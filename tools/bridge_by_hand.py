"""Run programs for `mitigate run` on the real Habitat, with unchanged files of other projects.

    mitigate export_scene habitat/
    mitigate run conditions=[low_light] -- python tools/bridge_by_hand.py lab habitat/ --task vln
    mitigate run conditions=[low_light] -- python tools/bridge_by_hand.py vector habitat/
    mitigate run conditions=[low_light] -- python tools/bridge_by_hand.py etpnav habitat/ ETPNav/
    mitigate run conditions=[low_light] -- python tools/bridge_by_hand.py l3mvn habitat/ L3MVN/
    mitigate run conditions=[low_light] -- python tools/bridge_by_hand.py wmnav habitat/ WMNav/

This needs habitat-sim and habitat-lab 0.3 (docs/habitat.md) and, for the last three programs, a
checkout of the agent. The programs print means of the frames; results are in
docs/lab/bridge-trials.md. The agents' files need older versions of habitat-lab, so this file
defines the names that they import but that version 0.3 lacks.
"""

from __future__ import annotations

import argparse
import gzip
import json
import math
import sys
import types
from pathlib import Path
from typing import Any

import numpy as np

if "l3mvn" in sys.argv:  # this also applies to workers, which import this file first
    import habitat.config

    habitat.config.Config = dict

CPU = "habitat.simulator.habitat_sim_v0.gpu_device_id=-1"
CAMERAS = ("rgb", "rgb_30", "rgb_330", "depth", "depth_90")


def config(folder: Path, task: str, *more: str) -> Any:
    """Return habitat-lab's config of a task, with this project's scenes and episodes."""
    from habitat.config.default import get_config

    name = {"vln": "vln_r2r", "objectnav": "objectnav/objectnav_hm3d"}[task]
    lists = {"vln": "vln/val_unseen", "objectnav": "objectnav/val_unseen/val_unseen"}[task]
    options = [
        f"habitat.dataset.data_path={folder}/datasets/{lists}.json.gz",
        f"habitat.dataset.scenes_dir={folder}/scenes",
        "habitat.dataset.split=val_unseen",
        "habitat.environment.iterator_options.shuffle=False",
    ]
    return get_config(f"benchmark/nav/{name}.yaml", overrides=[CPU, *options, *more])


def means(observations: Any, names: Any = CAMERAS) -> list[float]:
    """Return the mean of each frame."""
    return [round(float(np.mean(observations[n])), 3) for n in names if n in observations]


def module(name: str, **names: Any) -> None:
    """Create a module that a file imports."""
    created = types.ModuleType(name)
    vars(created).update(names)
    sys.modules[name] = created


def lab(options: argparse.Namespace) -> None:
    """Run habitat-lab's Env with its shortest-path follower."""
    import habitat
    from habitat.tasks.nav.shortest_path_follower import ShortestPathFollower

    success = {"vln": 3.0, "objectnav": 0.5}[options.task]
    distance = f"habitat.task.measurements.success.success_distance={success}"
    env = habitat.Env(config(options.habitat, options.task, distance))
    for _ in range(options.episodes):
        observations = env.reset()
        follower = ShortestPathFollower(env.sim, 0.3, False)
        goals = env.current_episode.goals
        views = [v.agent_state for g in goals for v in getattr(g, "view_points", None) or []]
        start = env.sim.get_agent_state().position
        ends = [target.position for target in views or goals]
        goal = min(ends, key=lambda end: env.sim.geodesic_distance(start, end))
        while not env.episode_over:
            observations = env.step(follower.get_next_action(goal) or 0)
        print("end", means(observations), env.get_metrics().get("success"), flush=True)
    env.close()


def worker(folder: Path, scene: int) -> Any:
    """Return a gym environment with the episodes of one scene."""
    from habitat.gym import make_gym_from_config

    measures = (
        "habitat.task.reward_measure=distance_to_goal",
        "habitat.task.success_measure=success",
    )
    scenes = f"habitat.dataset.content_scenes=[{scene}]"
    return make_gym_from_config(config(folder, "vln", *measures, scenes))


def vector(options: argparse.Namespace) -> None:
    """Run habitat-lab's VectorEnv with one worker per scene, for two scenes."""
    from habitat.core.vector_env import VectorEnv

    envs = VectorEnv(
        make_env_fn=worker,
        env_fn_args=[(options.habitat, 200000 + k) for k in range(2)],
        multiprocessing_start_method=options.start,
        auto_reset_done=False,
    )
    for _ in range(options.episodes):
        envs.reset()
        for step in range(6):
            answers = envs.step([int(step < 5)] * 2)
        print("end", [means(answer[0]) for answer in answers], flush=True)
    envs.close()


def etpnav(options: argparse.Namespace) -> None:
    """Run ETPNav's VLNCEDaggerEnv, with panoramas by get_observations_at, teleports and STOP."""
    import habitat
    from habitat.config import read_write
    from habitat.core.registry import registry
    from habitat.sims.habitat_simulator.habitat_simulator import HabitatSim

    from mitigate.worlds.habitat_lab import panorama

    class Registry:
        def register_env(self, to_register: Any = None, name: str | None = None) -> Any:
            return lambda kind: kind

    class Simulator(HabitatSim):
        previous_step_collided = False

        def step_without_obs(self, action: int, dt: float = 1 / 60) -> None:
            self.get_agent(0).act(action)

    def heading(rotation: Any) -> float:
        return 2 * math.atan2(rotation.imag[1], rotation.real) % (2 * math.pi)

    habitat.Config = dict
    module("habitat_baselines")
    module("habitat_baselines.common")
    module("habitat_baselines.common.baseline_registry", baseline_registry=Registry())
    module("habitat_extensions")
    frames = dict.fromkeys(("generate_video", "navigator_video_frame", "planner_video_frame"))
    module("habitat_extensions.utils", heading_from_quaternion=heading, **frames)
    sys.path.insert(0, str(options.agent / "vlnce_baselines" / "common"))
    import environments

    environments.HabitatSimActions = types.SimpleNamespace(
        STOP=0, MOVE_FORWARD=1, TURN_LEFT=2, TURN_RIGHT=3
    )
    registry.register_simulator(to_register=Simulator, name="Sim-v1")
    task_config = config(options.habitat, "vln", "habitat.simulator.type=Sim-v1")
    with read_write(task_config):
        task_config.habitat.simulator.agents.main_agent.sim_sensors = panorama(64, 64)
    env = environments.VLNCEDaggerEnv(
        types.SimpleNamespace(TASK_CONFIG=task_config, VIDEO_OPTION=[], VIDEO_DIR="")
    )
    defaults = {"back_path": None, "tryout": False}
    for _ in range(options.episodes):
        observations = env.reset()
        text = observations["instruction"]["text"]
        print("reset", means(observations), text[:60], flush=True)
        for step in range(2):
            position = env._env.sim.get_agent_state().position
            target = position + np.array([0.5, 0.0, 0.3 * step], np.float32)
            action = {"act": 4, "front_pos": position, "ghost_pos": target, **defaults}
            print("waypoint", means(env.step(action, None)[0]), flush=True)
        position = env._env.sim.get_agent_state().position
        _, _, done, _ = env.step({"act": 0, "stop_pos": position, **defaults}, None)
        print("stop", done, flush=True)
    env.close()


def l3mvn_worker(folder: Path, scene: int) -> Any:
    """Return an environment like L3MVN's with the episodes of one scene."""
    import habitat

    class Nav(habitat.RLEnv):
        """Like L3MVN's environment: In this environment, STOP is action 3, and the Env never
        ends."""

        def reset(self) -> Any:
            self.steps = 0
            return self.state(super().reset()), {}

        def step(self, action: int) -> Any:
            self.steps += 1
            observations, *rest = super().step(action or 3)
            return (self.state(observations), *rest)

        def state(self, observations: Any) -> np.ndarray:
            return np.concatenate((observations["rgb"], observations["depth"]), 2)

        def get_reward_range(self) -> tuple[float, float]:
            return 0.0, 1.0

        def get_reward(self, observations: Any) -> float:
            return 0.0

        def get_done(self, observations: Any) -> bool:
            return self.steps >= 4

        def get_info(self, observations: Any) -> dict:
            return {}

    return Nav(config(folder, "objectnav", f"habitat.dataset.content_scenes=[{scene}]"))


def l3mvn(options: argparse.Namespace) -> None:
    """Run L3MVN's copy of VectorEnv."""
    sys.path.insert(0, str(options.agent / "envs" / "habitat" / "utils"))
    import vector_env

    envs = vector_env.VectorEnv(
        make_env_fn=l3mvn_worker,
        env_fn_args=[(options.habitat, 200000 + k) for k in range(2)],
    )
    envs.reset()
    for step in range(4 * options.episodes):
        states, *_ = envs.step([int(step % 4 < 3)] * 2)
        print("step", [round(float(s[..., :3].mean()), 2) for s in states], flush=True)
    envs.close()


def wmnav(options: argparse.Namespace) -> None:
    """Run WMNav's Env and SimWrapper, which use habitat-sim without habitat-lab."""
    import habitat_sim

    original_init = habitat_sim.Simulator.__init__

    def init_on_cpu(self: Any, settings: Any) -> None:
        settings.sim_cfg.enable_physics = False
        settings.sim_cfg.gpu_device_id = -1
        original_init(self, settings)

    habitat_sim.Simulator.__init__ = init_on_cpu
    for name in ("WMNav_agent", "custom_agent", "pandas", "requests"):
        module(name)
    sys.path.insert(0, str(options.agent / "src"))
    import WMNav_env
    from simWrapper import PolarAction, SimWrapper

    file = options.habitat / "datasets" / "objectnav" / "val_unseen" / "content" / "200000.json.gz"
    dataset = json.loads(gzip.decompress(file.read_bytes()))
    camera = {"pitch": -0.25, "fov": 79, "height": 0.88, "img_height": 120, "img_width": 160}
    shape = {"agent_radius": 0.17, "agent_height": 0.88, "allow_slide": True, "scene_id": "x"}
    goal = {"use_goal_image_agent": True, "goal_image_agent_fov": 79, "scene_config": "default"}

    class ScriptedEnv(WMNav_env.Env):
        def __init__(self) -> None:
            self.all_episodes = dataset["episodes"]
            self.cfg = {"max_steps": 3}
            self.curr_run_name = "scripted"
            scene = str(options.habitat / "scenes" / self.all_episodes[0]["scene_id"])
            self.simWrapper = SimWrapper(
                {"scene_path": scene, "sensor_cfg": camera, **shape, **goal}
            )
            settings = habitat_sim.NavMeshSettings()
            settings.set_defaults()
            self.simWrapper.sim.recompute_navmesh(self.simWrapper.sim.pathfinder, settings)

        def _initialize_episode(self, number: int) -> Any:
            episode = self.all_episodes[number]
            category = episode["object_category"]
            self.step, self.agent_distance_traveled = 0, 0.0
            self.current_episode = {"object": category}
            goals = dataset["goals_by_category"][f"200000.glb_{category}"]
            self.path_calculator = habitat_sim.MultiGoalShortestPath()
            self.path_calculator.requested_ends = np.array(
                [g["position"] for g in goals], np.float32
            )
            start = np.array(episode["start_position"])
            self.simWrapper.set_state(pos=start, quat=episode["start_rotation"])
            return self.simWrapper.step(PolarAction.null)

        def _step_env(self, observations: Any) -> Any:
            state = observations["agent_state"]
            color = observations["color_sensor"]
            goal_image = self.simWrapper.get_goal_image(state.position, state.rotation)
            frames = [color[..., :3], color[..., 3]]
            frames += [observations["depth_sensor"], goal_image[..., :3]]
            values = [round(float(frame.mean()), 2) for frame in frames]
            category = self.current_episode["object"]
            print("color, alpha, depth, goal:", values, category, flush=True)
            self.path_calculator.requested_start = state.position
            metres = self.simWrapper.get_path(self.path_calculator)
            self.wandb_log_data = {"spl": 0.5 * (metres < 1), "goal_reached": metres < 1}
            return PolarAction(0.25, -0.5)

        def _post_episode(self) -> None:
            pass

    env = ScriptedEnv()
    for number in range(options.episodes):
        env._run_episode(number)


PROGRAMS = {program.__name__: program for program in (lab, vector, etpnav, l3mvn, wmnav)}


def main() -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("program", choices=PROGRAMS)
    parser.add_argument("habitat", type=Path, help="folder of mitigate export_scene")
    parser.add_argument("agent", type=Path, nargs="?", help="checkout of the agent")
    parser.add_argument("--task", choices=("vln", "objectnav"), default="vln")
    parser.add_argument("--start", default="forkserver", help="of vector's workers")
    parser.add_argument("--episodes", type=int, default=2)
    options = parser.parse_args()
    PROGRAMS[options.program](options)


if __name__ == "__main__":
    main()
