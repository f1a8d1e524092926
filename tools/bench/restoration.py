"""Measure the milliseconds of a restorer per frame, on one core.

    python -m tools.bench.restoration checkpoints/restorer
    ONEDNN_MAX_CPU_ISA=AVX2 ATEN_CPU_CAPABILITY=avx2 python -m tools.bench.restoration

If the gate classifies a frame as clean, only the gate runs; for any other frame, the whole network
runs. Each time is that of the fastest of many calls (``tools/bench/timing.py``).
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence

for _name in ("OMP_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(_name, "1")  # set here, because libraries read it when they are imported

import torch  # noqa: E402

from mitigate.core.markdown import markdown_table  # noqa: E402
from mitigate.core.observation import DEPTH, RGB  # noqa: E402
from mitigate.guards.frames.restorer import Restorer, load_restorer  # noqa: E402
from tools.bench.suite import frames  # noqa: E402
from tools.bench.timing import machine, steady  # noqa: E402

SIZES = {"12 x 64 x 64": (12, 64, 64), "224 x 224": (1, 224, 224), "480 x 640": (1, 480, 640)}
FOLDER = "checkpoints/restorer"


def costs(restorer: Restorer, seconds: float) -> dict[tuple[str, str], tuple[float, float]]:
    """Return the time in milliseconds for a clean and for a restored frame, by size and sensor.

    Args:
        restorer: The restorer; its thresholds are changed and then set back.
        seconds: Duration of each measurement.
    """
    times: dict[tuple[str, str], tuple[float, float]] = {}
    for size, shape in SIZES.items():
        rgb, depth = frames(*shape)
        frame = {RGB: rgb, DEPTH: depth[..., None] if depth.ndim == 3 else depth}
        for sensor, net in restorer.parts().items():
            original = net.threshold.clone()
            values = []
            for threshold in (torch.inf, -torch.inf):
                net.threshold.fill_(threshold)
                values.append(_time(restorer, sensor, frame[sensor], seconds))
            net.threshold.copy_(original)
            times[size, sensor] = (values[0], values[1])
    return times


def _time(restorer: Restorer, sensor: str, frame: object, seconds: float) -> float:
    return steady(lambda _: restorer.restore(sensor, frame), seconds)  # type: ignore[arg-type]


def table(times: dict[tuple[str, str], tuple[float, float]]) -> str:
    """Return a Markdown table with a row per size and sensor."""
    rows = ([size, name, f"{a:.1f}", f"{b:.1f}"] for (size, name), (a, b) in times.items())
    return markdown_table(("frame", "sensor", "clean, ms", "restored, ms"), rows, words=2)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(prog="tools.bench.restoration", description=__doc__)
    parser.add_argument("folder", nargs="?", default=FOLDER, help=f"default {FOLDER}")
    parser.add_argument("--seconds", type=float, default=1.0, help="per measurement (default 1)")
    options = parser.parse_args(arguments)
    if options.seconds <= 0:
        parser.error(f"--seconds must be > 0, got {options.seconds:g}.")
    torch.set_num_threads(1)
    caps = os.environ.get("ONEDNN_MAX_CPU_ISA", "all instructions")
    times = costs(load_restorer(options.folder), options.seconds)
    print(f"{machine()}, one thread, {caps}\n\n{table(times)}")


if __name__ == "__main__":
    try:
        main()
    except (ValueError, FileNotFoundError) as error:
        sys.exit(f"error: {error}")
