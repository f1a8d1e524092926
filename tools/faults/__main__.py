"""Break trainings and evaluations on purpose, and see whether they end as if nothing had happened.

``make test-faults``, or ``python -m tools.faults [--recipes ts_distill] [--faults SIGTERM]``. Each
recipe is trained (``debug=smoke``, four steps a stage) once unbroken, and once through all faults,
one after the other, each at a moment drawn from the seed; the weights must be the same bits.
Evaluations are broken likewise; their rows must be the same bytes. Prints what was tried and what
survived, and exits with 1 if anything did not, or nothing was tried. ``--write`` puts the table,
with what earlier calls of that seed found of other recipes, into docs/lab/fault-injection.md.
"""

from __future__ import annotations

import argparse
import json
import signal
import sys
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from mitigate.core.files import write_bytes
from mitigate.core.workers import cores
from tools.faults import evaluation, report, training

FAMILIES = {  # recipes that between them use every file of recipes/
    "safeguard_lora": "safeguard_lora",  # the longest is the first
    "da_per_episode": "imitate",
    "ts_distill": "distil",
    "conv_adapter": "adapt",
    "base": "pretrain, imitate_stored",
    "dagger": "pretrain, dagger",
    "encoder": "encoder",
    "restore": "restore, restore_gate",
}
EVALUATION = "evaluation"
PAGE = Path(__file__).resolve().parents[2] / "docs/lab/fault-injection.md"


def options(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m tools.faults",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    known = list(dict.fromkeys([*training.FAULTS, *evaluation.FAULTS]))
    add = parser.add_argument
    add("--recipes", nargs="*", default=[*FAMILIES, EVALUATION], help=f"or {EVALUATION}")
    add("--faults", nargs="*", default=known, choices=known, metavar="FAULT", help=str(known))
    add("--seed", type=int, default=0)
    add("--jobs", type=int, default=cores(), help="recipes at a time, each on about one core")
    add("--out", type=Path, default=Path("runs/faults"))
    add("--write", action="store_true", help="write docs/lab/fault-injection.md")
    return parser.parse_args(arguments)


def broken(name: str, chosen: argparse.Namespace) -> dict[str, str]:
    """Break a recipe, or the evaluation, and say what came of it."""
    out, began = chosen.out.resolve(), time.monotonic()
    if name == EVALUATION:
        faults = [fault for fault in evaluation.FAULTS if fault in chosen.faults]
        found = evaluation.break_evaluation(out / name, chosen.seed, faults)
    else:
        faults = [fault for fault in training.FAULTS if fault in chosen.faults]
        found = training.break_training(name, out, chosen.seed, faults)
    print(report.line(name, found, time.monotonic() - began), flush=True)
    return found


def main(arguments: Sequence[str] | None = None) -> int:
    """Run from the command line."""
    chosen = options(arguments)
    signal.signal(signal.SIGINT, signal.default_int_handler)  # what ignores it, has it ignored
    notes = chosen.out / f"faults-seed{chosen.seed}.json"
    with ThreadPoolExecutor(max(1, chosen.jobs)) as pool:
        made = pool.map(lambda name: broken(name, chosen), chosen.recipes)
        found = dict(zip(chosen.recipes, made, strict=True))
    tried, survived = report.count(found)
    print(f"tried {tried}, survived {survived}", flush=True)
    held = json.loads(notes.read_text(encoding="utf-8")) if notes.is_file() else {}
    for name, came in found.items():  # of one that fails unbroken nothing else is known
        before = {} if report.UNBROKEN in came else held.get(name, {})
        held[name] = {f: c for f, c in before.items() if f != report.UNBROKEN} | came
    write_bytes(notes, json.dumps(held, indent=1).encode())
    if chosen.write:
        report.write(PAGE, held, FAMILIES, chosen.seed)
        print(f"wrote docs/lab/{PAGE.name}")
    return int(survived < tried or (bool(chosen.recipes) and not tried))


if __name__ == "__main__":
    sys.exit(main())
