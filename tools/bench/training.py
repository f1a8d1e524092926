"""Measure the time of each part of a training step, in every stage of the recipes.

    python -m tools.bench.training da_per_episode ts_distill --steps 8

Each stage runs as ``make train`` runs it, with a worker process per core. The tool measures three
durations: a whole step, the wait for the batch, and the computation (forward pass, backward pass
and update). Then the tool computes the same batches in its own process and times each part of the
computation. ``make bench`` runs the tool twice: with all processor instructions, and with AVX2 at
most.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from importlib import import_module
from statistics import median_high
from typing import Any
from unittest import mock

import torch

from mitigate.agents.building import build_agent
from mitigate.core import conf, precision, seeding
from mitigate.core.markdown import markdown_table
from mitigate.core.workers import cores
from mitigate.training.batches import Batches
from mitigate.training.config import read
from mitigate.training.objective import Objective, ObjectiveSpec, accumulate
from mitigate.training.workers import Workers
from tools.bench.timing import clock

RECIPES = (
    "da_per_episode",
    "ts_distill",
    "conv_adapter",
    "harden",
    "stacked",
    "base",
    "safeguard_lora",
)
CAPS = {"ONEDNN_MAX_CPU_ISA": "AVX2", "ATEN_CPU_CAPABILITY": "avx2"}
# number of apartments; in a long training run, the time to generate them is negligible
LAYOUTS = 8
NETWORK = "network"
PARTS = {  # parts of computing a batch; each function is given by module, class (or None) and name
    "rendering": (("mitigate.worlds.apartments.renderer", "Renderer", "render"),),
    "scenes": (("mitigate.worlds.apartments.renderer", "Renderer", "load"),),
    "geodesics": (
        ("mitigate.worlds.apartments.navigation", "FreeSpace", "distances"),
        ("mitigate.worlds.apartments.navigation", "FreeSpace", "rays"),
    ),
    "corruption": (
        ("mitigate.worlds.world", None, "corrupt_observation"),
        ("mitigate.training.poses", None, "corrupt_observation"),
    ),
    NETWORK: (
        ("mitigate.agents.topological.agent", "TopologicalAgent", "perceive"),
        ("mitigate.agents.topological.planner", "Planner", "forward"),
        ("mitigate.agents.topological.planner", "Planner", "look"),
        ("mitigate.agents.topological.planner", "Planner", "read"),
    ),
}
OTHER = "other"


@dataclass(frozen=True)
class Stage:
    """Times in milliseconds per step of one stage of a recipe. All are medians, except ``parts``.

    Attributes:
        recipe: Name of the recipe.
        stage: Name of the stage.
        precision: Precision of the networks.
        whole: The whole step.
        waiting: Time of a step during which the trainer waits for the batch.
        alone: Time of forward pass, backward pass and update without other processes.
        parts: Mean time of each part of computing a batch on one core.
    """

    recipe: str
    stage: str
    precision: str
    whole: float
    waiting: float
    alone: float
    parts: dict[str, float]

    @property
    def elsewhere(self) -> float:
        """Return the fraction of a step in which no network is running.

        This is the waiting time minus the time in which networks compute rollouts.
        """
        total = sum(self.parts.values())
        network = self.parts.get(NETWORK, 0.0) / total if total else 0.0
        return self.waiting * (1 - network) / self.whole


def timed(function: Callable, seconds: dict[str, float], part: str) -> Callable:
    """Return a function that calls ``function`` and adds the time to ``seconds[part]``."""

    def call(*args: Any, **named: Any) -> Any:
        start = time.perf_counter()
        try:
            return function(*args, **named)
        finally:
            seconds[part] += time.perf_counter() - start

    return call


@contextlib.contextmanager
def clocked() -> Iterator[dict[str, float]]:
    """Yield the seconds in the functions of each part in ``PARTS``, inside the ``with`` block."""
    seconds = dict.fromkeys(PARTS, 0.0)
    with contextlib.ExitStack() as stack:
        for part, functions in PARTS.items():
            for module, owner, name in functions:
                holder = import_module(module)
                holder = getattr(holder, owner) if owner else holder
                call = timed(getattr(holder, name), seconds, part)
                stack.enter_context(mock.patch.object(holder, name, call))
        yield seconds


def measure(name: str, steps: int, options: Sequence[str] = ()) -> list[Stage]:
    """Measure each stage of the recipe ``name`` for ``steps`` steps, after two warm-up steps."""
    small = ["refresh_episodes=1", f"env.layouts={LAYOUTS}", "env.cached=2"]
    config = read(conf.load_config("train", [f"recipe={name}", *small, *options]))
    stages = []
    agent = build_agent(config.agent, weights=config.init, seed=config.seed)
    with Workers(cores()) as workers:
        for stage, node in config.active_stages.items():
            objective = ObjectiveSpec.of(node.recipe).build(agent)
            stages.append(measure_stage(objective, name, stage, steps, workers))
    return stages


def measure_stage(recipe: Objective, name: str, stage: str, steps: int, workers: Workers) -> Stage:
    """Time one stage."""
    device = torch.device("cpu")
    kind = precision.choose("auto", device)
    with precision.computing(kind, device):
        recipe.start()
    recipe.train()
    update = _make_update(recipe, kind, device)
    batches = Batches(recipe, workers, steps + 2, kind, device)
    waits, updates = [], []
    for step in range(steps + 2):
        seeding.seed_everything(0, "bench", step)
        start = time.perf_counter()
        batch = batches.batch(step)
        arrival = time.perf_counter()
        update(batch)
        waits.append(arrival - start)
        updates.append(time.perf_counter() - arrival)
    alone = [clock(update, batch) for _ in range(steps)]
    whole = [1e3 * (a + b) for a, b in zip(waits, updates, strict=True)]
    waiting = 1e3 * median_high(waits[-steps:])
    parts = {part: 1e3 * seconds for part, seconds in _time_parts(recipe, kind, steps).items()}
    return Stage(name, stage, kind, median_high(whole[-steps:]), waiting, median_high(alone), parts)


def _make_update(recipe: Objective, kind: str, device: torch.device) -> Callable[[dict], None]:
    """Return a function that runs the forward pass, backward pass and update for a batch."""
    trained = [p for group in recipe.parameter_groups() for p in group["params"] if p.requires_grad]
    optimizer = torch.optim.AdamW(trained, lr=1e-6)

    def update(batch: dict) -> None:
        optimizer.zero_grad(set_to_none=True)
        accumulate(recipe, batch, kind, device)
        optimizer.step()

    return update


def _time_parts(recipe: Objective, kind: str, steps: int) -> dict[str, float]:
    """Compute batches in this process; return the seconds per step of each part."""
    batches = Batches(recipe, None, steps, kind, torch.device("cpu"))
    batches.batch(0)
    with clocked() as seconds:
        start = time.perf_counter()
        for step in range(steps):
            batches.batch(step)
        whole = time.perf_counter() - start
    parts = {part: total / steps for part, total in seconds.items()}
    return {**parts, OTHER: max(0.0, whole / steps - sum(parts.values()))}


def measured(recipes: Sequence[str], steps: int, caps: bool) -> list[Stage]:
    """Run this module in a separate process with all cores, optionally limited to AVX2."""
    environment = {k: v for k, v in os.environ.items() if k not in ("OMP_NUM_THREADS", *CAPS)}
    command = [sys.executable, "-m", __name__, *recipes, "--steps", str(steps), "--json"]
    done = subprocess.run(
        command,
        env={**environment, **(CAPS if caps else {})},
        stdout=subprocess.PIPE,
        text=True,
        check=True,
    )
    return [Stage(**stage) for stage in json.loads(done.stdout.strip().splitlines()[-1])]


def table(stages: Sequence[Stage]) -> str:
    """Return a Markdown table with one row per stage."""
    names = [*PARTS, OTHER]
    head = [
        "recipe",
        "stage",
        "precision",
        "steps/s",
        "ms per step",
        "waiting",
        "forward + backward",
    ]
    head += ["step / forward + backward alone", "no network", *names]
    rows = []
    for s in stages:
        cells = [f"`{s.recipe}`", s.stage, s.precision, f"{1e3 / s.whole:.2f}", f"{s.whole:.0f}"]
        cells += [f"{s.waiting / s.whole:.0%}", f"{1 - s.waiting / s.whole:.0%}"]
        cells += [f"{s.whole / s.alone:.2f}", f"{s.elsewhere:.0%}"]
        rows.append([*cells, *(f"{s.parts.get(name, 0.0):.0f}" for name in names)])
    return markdown_table(head, rows, words=3)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(prog=__name__, description=(__doc__ or "").splitlines()[0])
    parser.add_argument("recipes", nargs="*", default=list(RECIPES), help="default: all")
    parser.add_argument("--steps", type=int, default=8, help="timed per stage (default 8)")
    parser.add_argument("--json", action="store_true", help="print the times as one JSON line")
    options = parser.parse_args(arguments)
    if options.steps < 1:
        parser.error(f"--steps must be >= 1, got {options.steps}.")
    stages = []
    for name in options.recipes:
        print(f"timing {name}", file=sys.stderr, flush=True)
        stages += measure(name, options.steps)
    if options.json:
        print(json.dumps([asdict(stage) for stage in stages]))
    else:
        print(table(stages))


if __name__ == "__main__":
    main()
