"""Harden a policy of another library with several seeds, or adapt it at test time, and compare it
on known and unseen corruptions.

    python -m tools.third_party.results vizdoom_basic --seeds 0 1 2
    python -m tools.third_party.results vizdoom_basic --method ppo --set w_kl=0.1
    python -m tools.third_party.results vizdoom_basic --adapt recentre

An interrupted command continues. The tables are in docs/results/third-party.md.
"""

from __future__ import annotations

import argparse
from importlib import import_module
from pathlib import Path
from typing import Any

import mitigate
from mitigate.evaluation import rows
from mitigate.evaluation.comparison import compare
from mitigate.evaluation.rows import Row
from mitigate.shipping.harden import METHODS
from mitigate.worlds.seeded import seeded_episodes

UNSEEN = "unseen_test"
BEFORE, AFTER = "before", "after"


def hardened(module: Any, options: argparse.Namespace, seed: int) -> tuple[list[Row], list[Row]]:
    """Harden the policy; return the rows before and after on known and on unseen corruptions."""
    settings = {name: float(value) for name, value in (s.split("=", 1) for s in options.set)}
    name = "-".join([options.tune, *([] if options.method == "self_distil" else [options.method])])
    out = options.runs / "-".join([options.world, name, *options.set, f"seed{seed}"])
    forward = getattr(module, "forward", None)
    result = mitigate.harden(
        module.load_policy(),
        module.make_world,
        forward=forward,
        method=options.method,
        listed=seeded_episodes(range(options.episodes)),
        suite=options.suite,
        tune=options.tune,
        steps=options.steps,
        seed=seed,
        out=out,
        **{n: int(value) if value.is_integer() else value for n, value in settings.items()},
    )
    before = mitigate.as_policy(module.load_policy(), module.make_world(), forward=forward)
    for name, policy in {BEFORE: before, AFTER: result.agent}.items():
        measure(module, options, seed, policy, name, UNSEEN, out / UNSEEN)
    return result.rows, rows.read(out / UNSEEN / rows.ROWS)


def adapted(module: Any, options: argparse.Namespace, seed: int) -> tuple[list[Row], list[Row]]:
    """Measure the policy without and with adaptation; return the rows as :func:`hardened`."""
    adaptation = options.adapt.replace(":", "-")
    out = options.runs / f"{options.world}-{adaptation}-seed{seed}"
    forward = getattr(module, "forward", None)
    policy = mitigate.as_policy(module.load_policy(), module.make_world(), forward=forward)
    compared = []
    for suite in (options.suite, UNSEEN):
        folder = out / suite
        for name, adapt in {BEFORE: None, AFTER: options.adapt}.items():
            measure(module, options, seed, policy, name, suite, folder, adapt)
        stored = rows.read(folder / rows.ROWS)
        compared.append([{**row, "name": row["name"].partition("+")[0]} for row in stored])
    return compared[0], compared[1]


def measure(
    module: Any,
    options: argparse.Namespace,
    seed: int,
    policy: Any,
    name: str,
    suite: str,
    out: Path,
    adapt: str | None = None,
) -> None:
    """Evaluate a policy; its rows are in ``out``."""
    mitigate.benchmark(
        policy,
        world=module.make_world,
        listed=seeded_episodes(range(options.episodes)),
        name=name,
        version=policy.version,
        suite=suite,
        seed=seed,
        adapt=adapt,
        out=out,
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("world", help="a module of tools/third_party")
    parser.add_argument("--seeds", type=int, nargs="+", default=[0, 1, 2])
    parser.add_argument("--episodes", type=int, default=300)
    parser.add_argument("--suite", default="full")
    parser.add_argument("--tune", default="all")
    parser.add_argument("--steps", type=int, default=1500)
    parser.add_argument("--method", default="self_distil", choices=list(METHODS))
    parser.add_argument(
        "--set",
        nargs="+",
        default=[],
        metavar="NAME=NUMBER",
        help="other arguments of the method, such as w_kl=0.1",
    )
    parser.add_argument(
        "--adapt", help="adapt the policy at test time (norm, tent, recentre) and do not train it"
    )
    parser.add_argument("--runs", type=Path, default=Path("runs/third_party"))
    options = parser.parse_args()
    module = import_module(f"tools.third_party.{options.world}")
    known, unseen = [], []
    for seed in options.seeds:
        compared = (
            adapted(module, options, seed) if options.adapt else hardened(module, options, seed)
        )
        known += compared[0]
        unseen += compared[1]
    print(
        f"\nCorruptions of the suite\n\n{compare(known)}\n\nUnseen corruptions\n\n{compare(unseen)}"
    )


if __name__ == "__main__":
    main()
