"""Measure corruptions of batches of torch tensors, on the CPU and on a GPU if there is one.

    python -m tools.bench.tensors --seconds 0.3

This command prints only the tables of this part of the benchmark and uses one thread.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
import torch

from mitigate.corruptions import NAMES, Key
from mitigate.corruptions.registry import modality
from mitigate.corruptions.tensors import corrupt_tensors
from tools.bench.peers import Calls, kornia
from tools.bench.suite import SEED, SEVERITY, frames
from tools.bench.timing import LEAST, machine, version

SHAPES = {"8x1x224x224": (8, 1, 224, 224), "2x1x480x640": (2, 1, 480, 640)}
GPU_SHAPES = {**SHAPES, "256x1x224x224": (256, 1, 224, 224)}


@dataclass(frozen=True)
class Batch:
    """Milliseconds per batch of one corruption.

    Attributes:
        name: Name of the corruption.
        shape: Number of batch rows and views, height and width.
        kornia: Time of kornia's transform; None if kornia has no such transform or is not
            installed.
        numpy: Time of the numpy backend; None for frames on a GPU.
        torch: Time of the torch backend.
    """

    name: str
    shape: str
    kornia: float | None
    numpy: float | None
    torch: float


def measure(seconds: float) -> dict[str, list[Batch]]:
    """Return the times by device."""
    label = f"{machine()}, kornia {version('kornia')}"
    results = {label: [row for item in SHAPES.items() for row in costs("cpu", *item, seconds)]}
    if torch.cuda.is_available():
        rows = [row for item in GPU_SHAPES.items() for row in costs("cuda", *item, seconds)]
        results[torch.cuda.get_device_name()] = rows
    return results


def costs(device: str, label: str, shape: tuple[int, int, int, int], seconds: float) -> list[Batch]:
    """Time the standard suite for a batch [B, V, H, W] on one device."""
    rows, views, height, width = shape
    rgb, depth = frames(views, height, width)
    batches = {
        "rgb": torch.from_numpy(np.stack([rgb] * rows)).to(device),
        "depth": torch.from_numpy(np.stack([depth[..., None]] * rows)).to(device),
    }
    peers = _kornia(np.concatenate([rgb] * rows), device)
    timed = partial(fastest, seconds=seconds, on_gpu=device != "cpu")

    def ours(name: str, backend: str) -> float:
        batch = batches[modality(name)]
        keys = [Key(SEED, str(row)) for row in range(rows)]
        return timed(lambda: corrupt_tensors(batch, name, SEVERITY, keys=keys, backend=backend))

    return [
        Batch(
            name,
            label,
            timed(peers[name]) if name in peers else None,
            ours(name, "numpy") if device == "cpu" else None,
            ours(name, "torch"),
        )
        for name in NAMES
    ]


def fastest(call: Callable[[], object], seconds: float, on_gpu: bool) -> float:
    """Return the shortest time of a call in milliseconds.

    On a CPU, the CPU time of this process is measured, which hardly depends on other programs.
    """
    clock = time.perf_counter if on_gpu else time.process_time
    call()  # compiles
    end = time.perf_counter() + seconds
    times: list[float] = []
    while len(times) < LEAST or time.perf_counter() < end:
        start = clock()
        call()
        if on_gpu:
            torch.cuda.synchronize()
        times.append(clock() - start)
    return 1e3 * min(times)


def _kornia(views: np.ndarray, device: str) -> Calls:
    """Return kornia's functions, or an empty dict if it is not installed."""
    try:
        return kornia(views, SEVERITY, device)
    except ImportError as error:
        print(f"kornia is not measured: {error}. Install it with `pip install -e '.[bench]'`.")
        return {}


def main() -> None:
    """Run from the command line."""
    from tools.bench.report import tensor_tables

    parser = argparse.ArgumentParser(prog="tools.bench.tensors", description=__doc__)
    parser.add_argument("--seconds", type=float, default=0.3, help="per measurement (default 0.3)")
    options = parser.parse_args()
    torch.set_num_threads(1)
    print(tensor_tables(measure(options.seconds)))


if __name__ == "__main__":
    main()
