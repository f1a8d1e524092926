"""Measure a third-party policy: success, return and seconds per episode, clean and corrupted.

python -m tools.third_party.measure vizdoom_basic --suite full --episodes 30
"""

from __future__ import annotations

import argparse
import time
from collections import defaultdict
from importlib import import_module
from pathlib import Path

import numpy as np

import mitigate
from mitigate.evaluation import rows
from mitigate.worlds.gym import GymWorld
from mitigate.worlds.seeded import seeded_episodes
from mitigate.worlds.world import WorldWrapper


class WithReturn(WorldWrapper):
    """A world that also measures the return and the seconds of an episode."""

    world: GymWorld

    def reset(self, episode):
        self.started = time.time()
        return super().reset(episode)

    def _observe(self, observation):
        return observation

    def measures(self):
        seconds = time.time() - self.started
        return self.world.measures() | {"return": self.world._total, "seconds": seconds}


class PolicyAgent:
    """An agent that gives a policy the observation of its own environment."""

    def __init__(self, policy, act, world: GymWorld) -> None:
        self.policy = policy
        self.act_on = act
        self.entries = world.entries
        self.unit = world.unit
        self.space = world.env.observation_space

    def settings(self):
        return {}

    def reset(self, instruction: str) -> None:
        pass

    def act(self, observation):
        if list(self.entries.values()) == [""]:
            return self.act_on(self.policy, observation["rgb"])
        native = {}
        for name, entry in self.entries.items():
            frame = observation[name]
            if name == "depth":
                frame = frame / self.unit
            space = self.space[entry]
            if space.dtype == np.uint8:
                frame = np.clip(np.rint(frame), 0, 255)
            native[entry] = frame.astype(space.dtype)
        return self.act_on(self.policy, native)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("world", help="a module of tools/third_party")
    parser.add_argument("--suite", nargs="+", default=["full"])
    parser.add_argument("--severity", type=float, default=0.6)
    parser.add_argument("--episodes", type=int, default=30)
    parser.add_argument("--first", type=int, default=5000, help="seed of the first episode")
    options = parser.parse_args()
    module = import_module(f"tools.third_party.{options.world}")
    out = Path("runs/third_party") / f"{options.world}-{options.first}-s{options.severity:g}"
    agent = PolicyAgent(module.load_policy(), module.act, module.make_world())
    suite = options.suite[0] if len(options.suite) == 1 else options.suite
    print(
        mitigate.benchmark(
            agent,
            name=options.world,
            world=lambda: WithReturn(module.make_world()),
            listed=seeded_episodes(range(options.first, options.first + options.episodes)),
            suite=suite,
            severity=options.severity,
            out=out,
        )
    )
    by_condition = defaultdict(list)
    for row in rows.read(out / "rows.jsonl"):
        values = [row["success"], row["return"], row["steps"], row["seconds"]]
        by_condition[row["corruption"]].append(values)
    print(f"{'condition':18}{'SR %':>7}{'return':>10}{'steps':>8}{'s':>7}{'n':>5}")
    for condition, values in by_condition.items():
        success, total, steps, seconds = np.mean(values, axis=0)
        print(
            f"{condition:18}{100 * success:7.1f}{total:10.2f}{steps:8.1f}{seconds:7.2f}"
            f"{len(values):5}"
        )


if __name__ == "__main__":
    main()
