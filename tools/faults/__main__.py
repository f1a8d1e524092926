"""Inject faults into training and evaluation, and compare results with undisturbed runs.

``make test-faults``, or ``python -m tools.faults [--recipes ts_distill] [--faults SIGTERM]``. Each
recipe is trained twice (``debug=smoke``, four steps per stage): once undisturbed, and once with all
faults in turn, each at a seeded random time. The weights of both runs must be equal bit for bit.
Faults are injected into evaluations in the same way, and the rows must be equal byte for byte.
Other commands must end with the documented result. The tool prints how many faults were injected
and how many of them the programs survived. It exits with status 1 if a program did not survive a
fault, or if no fault was injected. ``--write`` inserts the table into docs/lab/fault-injection.md.
Recipes that were not run keep their earlier results of the same seed.
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

from mitigate.core.files import write_json
from mitigate.core.workers import cores
from tools.faults import commands, evaluation, report, training

FAMILIES = {  # these recipes together use every file in recipes/
    "safeguard_lora": "safeguard_lora",  # is started first, because it takes longest
    "da_per_episode": "imitate",
    "ts_distill": "distil",
    "conv_adapter": "adapt",
    "base": "pretrain, imitate_stored",
    "dagger": "pretrain, dagger",
    "encoder": "encoder",
    "restore": "restore, restore_gate",
}
EVALUATION = "evaluation"
COMMANDS = "commands"  # ``mitigate run``, ``mitigate export`` and a safeguard's endpoint
PAGE = Path(__file__).resolve().parents[2] / "docs/lab/fault-injection.md"


def parse_options(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m tools.faults",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    known = list(dict.fromkeys([*training.FAULTS, *evaluation.FAULTS, *commands.FAULTS]))
    add = parser.add_argument
    everything = [*FAMILIES, EVALUATION, COMMANDS]
    add("--recipes", nargs="*", default=everything, help=f"or {EVALUATION}, {COMMANDS}")
    add("--faults", nargs="*", default=known, choices=known, metavar="FAULT", help=str(known))
    add("--seed", type=int, default=0)
    add("--jobs", type=int, default=cores(), help="parallel recipes, each on about one core")
    add("--out", type=Path, default=Path("runs/faults"))
    add("--write", action="store_true", help="write docs/lab/fault-injection.md")
    return parser.parse_args(arguments)


def inject_faults(name: str, options: argparse.Namespace) -> dict[str, str]:
    """Inject faults into a recipe or the evaluation; print and return the outcome of each fault."""
    out = options.out.resolve()
    start = time.monotonic()
    if name == EVALUATION:
        faults = [fault for fault in evaluation.FAULTS if fault in options.faults]
        outcomes = evaluation.break_evaluation(out / name, options.seed, faults)
    elif name == COMMANDS:
        faults = [fault for fault in commands.FAULTS if fault in options.faults]
        outcomes = commands.break_commands(out / name, options.seed, faults)
    else:
        faults = [fault for fault in training.FAULTS if fault in options.faults]
        outcomes = training.break_training(name, out, options.seed, faults)
    print(report.line(name, outcomes, time.monotonic() - start), flush=True)
    return outcomes


def main(arguments: Sequence[str] | None = None) -> int:
    """Run from the command line."""
    options = parse_options(arguments)
    # some faults send SIGINT, and child processes would inherit an ignored SIGINT
    signal.signal(signal.SIGINT, signal.default_int_handler)
    file = options.out / f"faults-seed{options.seed}.json"
    stored = json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}
    outcomes = {}
    with ThreadPoolExecutor(max(1, options.jobs)) as pool:
        results = pool.map(lambda name: inject_faults(name, options), options.recipes)
        for name, new in zip(options.recipes, results, strict=True):
            outcomes[name] = new
            # a failed run without faults has the single outcome UNBROKEN, which replaces all others
            before = {} if report.UNBROKEN in new else stored.get(name, {})
            stored[name] = {f: o for f, o in before.items() if f != report.UNBROKEN} | new
            write_json(file, stored, indent=1)
    tried, survived = report.count(outcomes)
    print(f"tried {tried}, survived {survived}", flush=True)
    if options.write:
        report.write(PAGE, stored, FAMILIES, options.seed)
        print(f"wrote docs/lab/{PAGE.name}")
    return int(survived < tried or (bool(options.recipes) and not tried))


if __name__ == "__main__":
    sys.exit(main())
