"""Milliseconds that a restorer costs for each frame, on one core.

    python -m tools.bench.restoration checkpoints/restorer
    ONEDNN_MAX_CPU_ISA=AVX2 ATEN_CPU_CAPABILITY=avx2 python -m tools.bench.restoration

A frame that the gate takes for clean costs the judgement alone; one that it does not, the whole
network. Both are the fastest of many calls (``tools/bench/timing.py``).
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence

for _name in ("OMP_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(_name, "1")  # before the libraries read it

import torch  # noqa: E402

from mitigate.core.markdown import markdown_table  # noqa: E402
from mitigate.core.observation import DEPTH, RGB  # noqa: E402
from mitigate.guards.frames.restorer import Restorer, load_restorer  # noqa: E402
from tools.bench.suite import frames  # noqa: E402
from tools.bench.timing import machine, steady  # noqa: E402

SIZES = {"12 x 64 x 64": (12, 64, 64), "224 x 224": (1, 224, 224), "480 x 640": (1, 480, 640)}
FOLDER = "checkpoints/restorer"


def costs(restorer: Restorer, seconds: float) -> dict[tuple[str, str], tuple[float, float]]:
    """By size and sensor: milliseconds of a frame taken for clean, and of one restored. About
    ``seconds`` for each clock; the thresholds of ``restorer`` are put back."""
    found: dict[tuple[str, str], tuple[float, float]] = {}
    for size, shape in SIZES.items():
        rgb, depth = frames(*shape)
        shown = {RGB: rgb, DEPTH: depth[..., None] if depth.ndim == 3 else depth}
        for sensor, net in restorer.parts().items():
            kept, times = net.threshold.clone(), []
            for threshold in (torch.inf, -torch.inf):
                net.threshold.fill_(threshold)
                times.append(_clocked(restorer, sensor, shown[sensor], seconds))
            net.threshold.copy_(kept)
            found[size, sensor] = (times[0], times[1])
    return found


def _clocked(restorer: Restorer, sensor: str, frame: object, seconds: float) -> float:
    return steady(lambda _: restorer.restore(sensor, frame), seconds)  # type: ignore[arg-type]


def table(found: dict[tuple[str, str], tuple[float, float]]) -> str:
    """Markdown: a row a size and sensor."""
    rows = ([size, name, f"{a:.1f}", f"{b:.1f}"] for (size, name), (a, b) in found.items())
    return markdown_table(("frame", "sensor", "taken for clean, ms", "restored, ms"), rows, words=2)


def main(arguments: Sequence[str] | None = None) -> None:
    """Command line: see the module's first lines."""
    parser = argparse.ArgumentParser(prog="tools.bench.restoration", description=__doc__)
    parser.add_argument("folder", nargs="?", default=FOLDER, help=f"default {FOLDER}")
    parser.add_argument("--seconds", type=float, default=1.0, help="of each clock (default 1)")
    options = parser.parse_args(arguments)
    if options.seconds <= 0:
        parser.error("--seconds must be above 0.")
    torch.set_num_threads(1)
    caps = os.environ.get("ONEDNN_MAX_CPU_ISA", "all instructions")
    found = costs(load_restorer(options.folder), options.seconds)
    print(f"{machine()}, one thread, {caps}\n\n{table(found)}")


if __name__ == "__main__":
    try:
        main()
    except (ValueError, FileNotFoundError) as error:
        sys.exit(f"error: {error}")
