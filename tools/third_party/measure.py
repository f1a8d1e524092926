"""Measure a third-party policy: success, return and seconds per episode, clean and corrupted.

python -m tools.third_party.measure vizdoom_basic --suite full --episodes 30
"""

from __future__ import annotations

import argparse
from collections import defaultdict
from importlib import import_module
from pathlib import Path

import numpy as np
from mitigate.agents.policies import as_policy
from mitigate.evaluation.returns import RandomPolicy

import mitigate
from mitigate.evaluation import rows
from mitigate.worlds.seeded import seeded_episodes


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("world", help="a module of tools/third_party")
    parser.add_argument("--suite", nargs="+", default=["full"])
    parser.add_argument("--severity", type=float, default=0.6)
    parser.add_argument("--episodes", type=int, default=30)
    parser.add_argument("--first", type=int, default=5000, help="seed of the first episode")
    parser.add_argument("--random", action="store_true", help="random actions, not the policy")
    options = parser.parse_args()
    module = import_module(f"tools.third_party.{options.world}")
    world = module.make_world()
    if options.random:
        agent = RandomPolicy(world.action_space)
    else:
        agent = as_policy(module.load_policy(), world, forward=getattr(module, "forward", None))
    name = f"{options.world}{'-random' if options.random else ''}"
    out = Path("runs/third_party") / f"{name}-{options.first}-s{options.severity:g}"
    mitigate.benchmark(
        agent,
        name=name,
        version=None if options.random else agent.version,
        world=module.make_world,
        listed=seeded_episodes(range(options.first, options.first + options.episodes)),
        suite=options.suite[0] if len(options.suite) == 1 else options.suite,
        severity=options.severity,
        out=out,
    )
    by_condition = defaultdict(list)
    for row in rows.read(out / rows.ROWS):
        by_condition[row["corruption"]].append([row["success"], row["return"], row["steps"]])
    print(f"{'condition':18}{'SR %':>7}{'return':>10}{'steps':>8}{'episodes':>10}")
    for condition, values in by_condition.items():
        success, total, steps = np.mean(values, axis=0)
        print(f"{condition:18}{100 * success:7.1f}{total:10.2f}{steps:8.1f}{len(values):10}")


if __name__ == "__main__":
    main()
