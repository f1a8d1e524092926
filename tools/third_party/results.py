"""Harden a policy from another library with several seeds, or add a guard to it.

The tool compares the success of the original and the changed policy under known and unseen
corruptions.

    python -m tools.third_party.results vizdoom_basic --seeds 0 1 2
    python -m tools.third_party.results vizdoom_basic --method ppo --set w_kl=0.1
    python -m tools.third_party.results vizdoom_basic --adapt recentre
    python -m tools.third_party.results vizdoom_basic --restore checkpoints/restorer
    python -m tools.third_party.results --table docs/results/third-party/vizdoom_basic.jsonl.gz

An interrupted command continues. The last command prints the tables of stored rows for
docs/results/third-party.md.
"""

from __future__ import annotations

import argparse
from importlib import import_module
from pathlib import Path
from typing import Any

import mitigate
from mitigate.core import conf
from mitigate.corruptions.registry import modality
from mitigate.evaluation import rows
from mitigate.evaluation.comparison import CLEAN, compare
from mitigate.evaluation.rows import Row
from mitigate.shipping.harden import METHODS
from mitigate.worlds.seeded import seeded_episodes

UNSEEN = "unseen_test"
BEFORE, AFTER = "before", "after"


def hardened(module: Any, options: argparse.Namespace, seed: int) -> tuple[list[Row], list[Row]]:
    """Harden the policy; return its rows before and after, on known and on unseen corruptions."""
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


def guarded(module: Any, options: argparse.Namespace, seed: int) -> tuple[list[Row], list[Row]]:
    """Evaluate the policy without and with a guard; return rows in the same form as
    :func:`hardened`.
    """
    guards = {"adapt": options.adapt, "restore": options.restore}
    label = "-".join(str(Path(g).name).replace(":", "-") for g in guards.values() if g)
    out = options.runs / f"{options.world}-{label}-seed{seed}"
    forward = getattr(module, "forward", None)
    policy = mitigate.as_policy(module.load_policy(), module.make_world(), forward=forward)
    compared = []
    for suite in (options.suite, UNSEEN):
        folder = out / suite
        for name, chosen in {BEFORE: {}, AFTER: guards}.items():
            measure(module, options, seed, policy, name, suite, folder, **chosen)
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
    **guards: str | None,
) -> None:
    """Evaluate a policy under a suite's corruptions of the frames that it reads."""
    conditions = conf.load_config("evaluate", [f"suite={suite}"]).suite.conditions
    mitigate.benchmark(
        policy,
        world=module.make_world,
        listed=seeded_episodes(range(options.episodes)),
        name=name,
        version=policy.version,
        suite=[c for c in conditions if c == CLEAN or modality(c) in policy.sensors],
        seed=seed,
        out=out,
        **guards,
    )


def tables(known: list[Row], unseen: list[Row]) -> str:
    parts = {"Corruptions of the suite": known, "Unseen corruptions": unseen}
    return "\n\n".join(f"{title}\n\n{compare(part)}" for title, part in parts.items() if part)


def stored_tables(file: Path) -> str:
    """Return the result tables for a file of rows; rows of unseen corruptions have the split
    ``UNSEEN``.
    """
    stored = rows.read(file)
    known = [row for row in stored if row["split"] != UNSEEN]
    return tables(known, [row for row in stored if row["split"] == UNSEEN])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("world", nargs="?", help="a module of tools/third_party")
    parser.add_argument("--table", type=Path, help="print the tables of stored rows")
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
    parser.add_argument("--restore", help="restore the frames with this restorer and do not train")
    parser.add_argument("--runs", type=Path, default=Path("runs/third_party"))
    parser.add_argument("--out", type=Path, help="also write the rows of all seeds to this file")
    options = parser.parse_args()
    if options.table:
        print(stored_tables(options.table))
        return
    if not options.world:
        parser.error("name a world, such as vizdoom_basic, or --table FILE")
    module = import_module(f"tools.third_party.{options.world}")
    measured = guarded if options.adapt or options.restore else hardened
    known, unseen = [], []
    for seed in options.seeds:
        compared = measured(module, options, seed)
        known += compared[0]
        unseen += [{**row, "split": UNSEEN} for row in compared[1]]
    if options.out:
        rows.write(options.out, known + unseen)
    print(tables(known, unseen))


if __name__ == "__main__":
    main()
