"""What the bridge costs a call beside the corruption itself: ``python -m tools.bench.bridge``.

The cameras are ETPNav's: 12 of 224 x 224 pixels in RGB and 12 of 256 x 256 in depth. The same
frames are corrupted in turns by ``corrupt_habitat`` in this process and over the bridge; the median
of each counts.
"""

from __future__ import annotations

import argparse
import math
import os
import statistics
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from mitigate.bridge.condition import Condition, Words
from mitigate.bridge.hook import mitigate_hook
from mitigate.bridge.server import Listener
from mitigate.core.seeding import generator
from mitigate.corruptions import CLEAN, NAMES, Corruption, Key
from mitigate.worlds.habitat import corrupt_habitat
from tools.bench.timing import machine

SEVERITY, HEADING, WARM = 0.6, 0.1, 5
LEVEL = {"hfov": 90, "position": [0, 1.25, 0]}


def cameras() -> tuple[dict[str, np.ndarray], list[dict[str, Any]]]:
    """ETPNav's observation with random frames, and what the hook says of its cameras."""
    rng, frames = generator("bench", "bridge"), {}
    told: list[dict[str, Any]] = []
    for kind, size in (("rgb", 224), ("depth", 256)):
        for k in range(12):
            name = f"{kind}_{30 * k}" if k else kind
            if kind == "rgb":  # habitat-sim has four channels, habitat-lab gives a view of three
                frames[name] = rng.integers(0, 256, (size, size, 4), dtype=np.uint8)[..., :3]
            else:
                frames[name] = rng.uniform(0.05, 0.95, (size, size, 1)).astype(np.float32)
            told.append({"name": name, "type": kind, "orientation": [0, k * math.pi / 6, 0]})
            told[-1] |= {**LEVEL, "min_depth": 0, "max_depth": 10, "normalize_depth": True}
    return frames, told


def beside(name: str, calls: int) -> tuple[float, float]:
    """Median milliseconds of a call in process, and over the bridge."""
    frames, told = cameras()
    corruption = CLEAN if name == "clean" else Corruption(name, SEVERITY)
    here, there = [], []
    with (
        tempfile.TemporaryDirectory() as folder,
        Listener(Condition(corruption, 0, Words()), Path(folder)) as listener,
    ):
        os.environ.update(listener.environment())
        walk = mitigate_hook.Walk()
        walk.begin("bench.glb", "1")
        for call in range(WARM + calls):
            began = time.perf_counter()
            key = Key(0, "bench.glb/1", call)
            corrupt_habitat(dict(frames), corruption, key, heading=HEADING)
            middle = time.perf_counter()
            walk.corrupt(dict(frames), told, HEADING)
            here.append(middle - began)
            there.append(time.perf_counter() - middle)
    return 1e3 * statistics.median(here[WARM:]), 1e3 * statistics.median(there[WARM:])


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(prog="tools.bench.bridge", description=__doc__)
    parser.add_argument("--calls", type=int, default=40, help="timed for each (default 40)")
    calls = parser.parse_args().calls
    print(f"{machine()}\n\n| corruption | in process, ms | over the bridge | beside |")
    print("| --- | ---: | ---: | ---: |")
    for name in ("clean", *NAMES):
        here, there = beside(name, calls)
        print(f"| {name} | {here:.2f} | {there:.2f} | {there - here:.2f} |", flush=True)


if __name__ == "__main__":
    main()
