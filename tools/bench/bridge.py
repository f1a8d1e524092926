"""Measure the time that the bridge adds to a corruption, per call: ``python -m
tools.bench.bridge``.

The cameras are those of ETPNav: 12 RGB cameras of 224 x 224 pixels and 12 depth cameras of 256 x
256. The same frames are corrupted alternately by ``corrupt_habitat`` in this process and over the
bridge. Reports medians.
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

SEVERITY = 0.6
HEADING = 0.1  # radians
WARM_UP = 5  # number of calls that are not timed
LEVEL = {"hfov": 90, "position": [0, 1.25, 0]}


def cameras() -> tuple[dict[str, np.ndarray], list[dict[str, Any]]]:
    """Return ETPNav's observation with random frames, and the descriptions of its cameras."""
    rng = generator("bench", "bridge")
    frames = {}
    descriptions: list[dict[str, Any]] = []
    for kind, size in (("rgb", 224), ("depth", 256)):
        for k in range(12):
            name = f"{kind}_{30 * k}" if k else kind
            # frames of habitat-sim have four channels, of which habitat-lab returns a view of three
            if kind == "rgb":
                frames[name] = rng.integers(0, 256, (size, size, 4), dtype=np.uint8)[..., :3]
            else:
                frames[name] = rng.uniform(0.05, 0.95, (size, size, 1)).astype(np.float32)
            camera = {"name": name, "type": kind, "orientation": [0, k * math.pi / 6, 0], **LEVEL}
            camera |= {"min_depth": 0, "max_depth": 10, "normalize_depth": True}
            descriptions.append(camera)
    return frames, descriptions


def compare(name: str, calls: int) -> tuple[float, float]:
    """Return the median milliseconds of a call in this process, and over the bridge."""
    frames, descriptions = cameras()
    corruption = CLEAN if name == "clean" else Corruption(name, SEVERITY)
    in_process, over_bridge = [], []
    with (
        tempfile.TemporaryDirectory() as folder,
        Listener(Condition(corruption, 0, Words()), Path(folder)) as listener,
    ):
        os.environ.update(listener.environment())
        session = mitigate_hook.Session()
        session.begin("bench.glb", "1")
        for call in range(WARM_UP + calls):
            start = time.perf_counter()
            key = Key(0, "bench.glb/1", call)
            corrupt_habitat(dict(frames), corruption, key, heading=HEADING)
            middle = time.perf_counter()
            session.corrupt(dict(frames), descriptions, HEADING)
            in_process.append(middle - start)
            over_bridge.append(time.perf_counter() - middle)
    return (
        1e3 * statistics.median(in_process[WARM_UP:]),
        1e3 * statistics.median(over_bridge[WARM_UP:]),
    )


def main() -> None:
    """Print a Markdown table."""
    parser = argparse.ArgumentParser(prog="tools.bench.bridge", description=__doc__)
    parser.add_argument("--calls", type=int, default=40, help="timed per corruption (default 40)")
    calls = parser.parse_args().calls
    print(f"{machine()}\n\n| corruption | in process, ms | over the bridge | difference |")
    print("| --- | ---: | ---: | ---: |")
    for name in ("clean", *NAMES):
        local, bridge = compare(name, calls)
        print(f"| {name} | {local:.2f} | {bridge:.2f} | {bridge - local:.2f} |", flush=True)


if __name__ == "__main__":
    main()
