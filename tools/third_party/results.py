"""Harden a policy of another library with several seeds, and compare it before and after.

    python -m tools.third_party.results vizdoom_basic --seeds 0 1 2

An interrupted command continues. The tables are in docs/results/third-party.md.
"""

from __future__ import annotations

import argparse
from importlib import import_module
from pathlib import Path

import mitigate
from mitigate.evaluation import rows
from mitigate.evaluation.comparison import compare
from mitigate.worlds.seeded import seeded_episodes

UNSEEN = "unseen_test"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("world", help="a module of tools/third_party")
    parser.add_argument("--seeds", type=int, nargs="+", default=[0, 1, 2])
    parser.add_argument("--episodes", type=int, default=300)
    parser.add_argument("--suite", default="full")
    parser.add_argument("--tune", default="all")
    parser.add_argument("--steps", type=int, default=1500)
    parser.add_argument("--runs", type=Path, default=Path("runs/third_party"))
    options = parser.parse_args()
    module = import_module(f"tools.third_party.{options.world}")
    forward = getattr(module, "forward", None)
    listed = seeded_episodes(range(options.episodes))
    known, unseen = [], []
    for seed in options.seeds:
        out = options.runs / f"{options.world}-{options.tune}-seed{seed}"
        result = mitigate.harden(
            module.load_policy(),
            module.make_world,
            forward=forward,
            listed=listed,
            suite=options.suite,
            tune=options.tune,
            steps=options.steps,
            seed=seed,
            out=out,
        )
        known += result.rows
        before = mitigate.as_policy(module.load_policy(), module.make_world(), forward=forward)
        for name, policy in {"before": before, "after": result.agent}.items():
            mitigate.benchmark(
                policy,
                world=module.make_world,
                listed=listed,
                name=name,
                version=policy.version,
                suite=UNSEEN,
                seed=seed,
                out=out / UNSEEN,
            )
        unseen += rows.read(out / UNSEEN / rows.ROWS)
    print(
        f"\nCorruptions of the suite\n\n{compare(known)}\n\nUnseen corruptions\n\n{compare(unseen)}"
    )


if __name__ == "__main__":
    main()
