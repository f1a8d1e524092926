"""Compare the throughput of two processes with one: ``python -m tools.bench.scaling [--write]``.

- training: steps of ``da_per_episode`` by one process, and by two ranks of torchrun (gloo), each
  on one thread and without workers.
- evaluation: rows of the suite by 1 and 2 workers.
- recording: calls of one RGB-D camera of 128 pixels over the bridge, written to disk, by 1 and 2
  environments.

All loads are measured in one run, so that ratios are comparable. ``--write`` inserts the table into
docs/lab/gpu-and-clusters.md. Linux only.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import re
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from mitigate.core.markdown import markdown_table
from mitigate.corruptions import CLEAN
from tools.bench.evaluation import seconds_by_workers
from tools.bench.pages import put
from tools.bench.timing import machine

PAGE = Path(__file__).resolve().parents[2] / "docs/lab/gpu-and-clusters.md"
BEGIN = "<!-- table: python -m tools.bench.scaling --write -->"
END = "<!-- end of the table -->"
SUITE = 13  # conditions of the default suite
CALLS = 60  # calls per episode
SIZE = 128  # side of a frame in pixels
_session: Any = None  # the mitigate_hook.Session of a pool process
_SPEED = re.compile(r"steps_per_s ([\d.]+)")


def training(processes: int, steps: int, folder: Path) -> float:
    """Return the median steps per second of ``steps`` steps after the first three."""
    ranks = ["torch.distributed.run", "--standalone", "--nproc-per-node", str(processes), "-m"]
    options = [
        "recipe=da_per_episode",
        "experiment=frozen",
        "workers=0",
        "evaluation.enabled=false",
    ]
    options += [f"trainer.steps={steps + 3}", "trainer.log_every=1", "trainer.save_every=1000"]
    done = subprocess.run(
        [sys.executable, "-m", *(ranks if processes > 1 else []), "mitigate.train", *options,
         f"folder={folder}", f"runs={folder.parent}"],
        env={**os.environ, "OMP_NUM_THREADS": "1"}, capture_output=True, text=True,
    )  # fmt: skip
    speeds = [float(speed) for speed in _SPEED.findall(done.stdout)]
    if done.returncode or len(speeds) <= 3:
        raise RuntimeError(
            f"The training ended with status {done.returncode}: {done.stderr[-500:]}"
        )
    return statistics.median(speeds[3:])


def recording(processes: int, episodes: int, folder: Path) -> float:
    """Return calls per second of parallel environments with one server, written to disk."""
    from mitigate.bridge.condition import Condition, Words
    from mitigate.bridge.recording import Recorder
    from mitigate.bridge.server import Listener

    condition = Condition(CLEAN, 0, Words(), observers=[Recorder(folder / "recorded")])
    with Listener(condition, folder / "bridge") as listener:
        os.environ.update(listener.environment())
        context = multiprocessing.get_context("spawn")
        with context.Pool(processes, initializer=_open_session) as pool:
            pool.map(_run_episode, range(-processes, 0))  # each process connects
            began = time.perf_counter()
            pool.map(_run_episode, range(episodes), chunksize=1)
            return episodes * CALLS / (time.perf_counter() - began)


def _open_session() -> None:
    from mitigate.bridge.hook import mitigate_hook

    global _session
    _session = mitigate_hook.Session()


def _run_episode(number: int) -> None:
    """Run one episode in the session of this process."""
    from mitigate.bridge.hook import mitigate_hook

    rng = np.random.default_rng(abs(number))
    smooth = rng.integers(0, 256, (SIZE // 8, SIZE // 8, 3), dtype=np.uint8)
    rgb = np.kron(smooth, np.ones((8, 8, 1), np.uint8))
    depth = np.full((SIZE, SIZE, 1), 2.0, np.float32)
    episode = mitigate_hook.Episode(_session, f"{number}", "scaling", None)
    for _ in range(CALLS):
        episode.corrupt({"rgb": rgb.copy(), "depth": depth.copy()})
    episode.finish(success=True, spl=1.0)


def measured(steps: int, episodes: int) -> dict[str, tuple[float, float]]:
    """Return the throughput of one process and of two, by load."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        seconds = seconds_by_workers(episodes)

        def both(load: Callable[[int, int, Path], float], amount: int) -> tuple[float, float]:
            folders = [folder / f"{load.__name__}-{count}" for count in (1, 2)]
            for path in folders:
                path.mkdir()
            return load(1, amount, folders[0] / "run"), load(2, amount, folders[1] / "run")

        return {
            "training, steps of 20 episodes (`experiment=frozen`)": both(training, steps),
            "evaluation, rows": (
                episodes * SUITE / seconds[1],
                episodes * SUITE / seconds.get(2, float("nan")),
            ),
            "recording, calls": both(recording, 4 * episodes),
        }


def table(rates: dict[str, tuple[float, float]]) -> str:
    """Return a Markdown table with a row per load."""
    rows = ([name, f"{a:.3g}", f"{b:.3g}", f"{b / a:.2f}"] for name, (a, b) in rates.items())
    head = ("per second", "1 process", "2 processes", "ratio")
    return f"{machine()}\n\n{markdown_table(head, rows)}"


def main(arguments: Sequence[str] | None = None) -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(prog="python -m tools.bench.scaling", description=__doc__)
    parser.add_argument("--steps", type=int, default=12, help="per training (default 12)")
    parser.add_argument("--episodes", type=int, default=8, help="to evaluate (default 8)")
    parser.add_argument("--write", action="store_true", help="write docs/lab/gpu-and-clusters.md")
    options = parser.parse_args(arguments)
    if min(options.steps, options.episodes) < 1:
        parser.error(
            f"--steps and --episodes must be >= 1, got {options.steps} and {options.episodes}."
        )
    text = table(measured(options.steps, options.episodes))
    print(text)
    if options.write:
        put(text, PAGE, BEGIN, END)


if __name__ == "__main__":
    main()
