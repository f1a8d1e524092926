"""Measure the time of corruptions (of this project and of other libraries), training stages,
evaluation and the renderer.

    make bench ARGS="--seconds 0.2 --steps 1"

Training stages and one evaluation are run in separate processes. All other measurements run in this
process, on one thread. ``--write`` inserts the tables into ``docs/benchmarks.md``; use it on an
idle machine.
"""

from __future__ import annotations

import argparse
import os
import shlex
import sys
from pathlib import Path

for _name in ("OMP_NUM_THREADS", "NUMBA_NUM_THREADS", "NO_ALBUMENTATIONS_UPDATE"):
    # set before the libraries are imported, because they read it then
    os.environ.setdefault(_name, "1")

import cv2  # noqa: E402
import torch  # noqa: E402

from mitigate.core.files import write_bytes  # noqa: E402
from tools.bench import evaluation, renderers, report, suite, tensors, training  # noqa: E402

PAGE = Path(__file__).resolve().parents[2] / "docs" / "benchmarks.md"


def main(arguments: list[str] | None = None) -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(
        prog="tools.bench",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--seconds", type=float, default=1.0, help="per measurement (default 1)")
    parser.add_argument("--steps", type=int, default=6, help="steps per stage (default 6)")
    parser.add_argument("--recipes", nargs="+", default=training.RECIPES, help="recipes to time")
    parser.add_argument("--size", type=int, default=64, help="pixels of a view (default 64)")
    parser.add_argument("--episodes", type=int, default=8, help="episodes to run (default 8)")
    parser.add_argument("--write", action="store_true", help="write docs/benchmarks.md")
    options = parser.parse_args(arguments)
    if min(options.steps, options.episodes) < 1 or options.seconds <= 0:
        parser.error(
            f"--steps and --episodes must be >= 1 and --seconds > 0, got {options.steps}, "
            f"{options.episodes} and {options.seconds:g}."
        )
    torch.set_num_threads(1)
    cv2.setNumThreads(1)
    text = report.page(
        suite.measure(options.seconds),
        suite.worst_pair(options.seconds),
        {caps: training.measured(options.recipes, options.steps, caps) for caps in (False, True)},
        renderers.compare(options.size, options.seconds),
        options.size,
        options.seconds,
        evaluation.paces(options.episodes),
        evaluation.seconds_by_workers(options.episodes),
        tensors.measure(options.seconds),
        shlex.join(sys.argv[1:] if arguments is None else arguments),
    )
    print(text)
    if options.write:
        write_bytes(PAGE, text.encode())
        print(f"wrote docs/{PAGE.name}")


if __name__ == "__main__":
    main()
