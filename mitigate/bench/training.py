"""How much of a training step of the reference agent goes into corruption: both in one run."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator
from dataclasses import dataclass
from types import ModuleType
from unittest import mock

import torch

from mitigate import cli, seeding, train  # noqa: F401 (train registers the config's types)
from mitigate.agents import rendered
from mitigate.build import build, build_agent
from recipes import perception

SCHEDULES = ("per_episode", "per_frame")
LAYOUTS = 8  # apartments, so that their making, which a long training pays once, does not count


@dataclass(frozen=True)
class Share:
    """Seconds of ``steps`` training steps, and those of them spent in corruption."""

    steps: int
    whole: float
    corrupting: float


class Clock:
    """Adds up the seconds spent in calls of a function."""

    def __init__(self) -> None:
        self.seconds = 0.0

    def around(self, function):
        def timed(*args, **named):
            started = time.perf_counter()
            try:
                return function(*args, **named)
            finally:
                self.seconds += time.perf_counter() - started

        return timed


@contextlib.contextmanager
def clocked(*modules: ModuleType) -> Iterator[Clock]:
    """Within it, every ``corrupt_observation`` called by these modules is on the clock."""
    clock = Clock()
    with contextlib.ExitStack() as stack:
        for module in modules:
            timed = clock.around(module.corrupt_observation)
            stack.enter_context(mock.patch.object(module, "corrupt_observation", timed))
        yield clock


def shares(steps: int) -> dict[tuple[str, str], Share]:
    """By (schedule, stage) of the recipes ``da_per_episode`` and ``da_per_frame``, as shipped."""
    found = {}
    for schedule in SCHEDULES:
        cfg = cli.load_config("train", [f"recipe=da_{schedule}", f"env.layouts={LAYOUTS}"])
        for name, stage in cfg.stages.items():
            agent = build_agent(cfg.agent, weights=cfg.init, seed=cfg.seed)
            agent.requires_grad_(True)
            recipe = build(stage.recipe, agent=agent)
            found[schedule, str(name)] = share(recipe, steps)
    return found


def share(recipe, steps: int) -> Share:
    """Time ``steps`` steps (data, loss, gradient, update) after one that warms up."""
    trained = [p for group in recipe.parameter_groups() for p in group["params"] if p.requires_grad]
    optimizer = torch.optim.AdamW(trained)
    recipe.train()
    started, before = 0.0, 0.0
    with clocked(rendered, perception) as clock:
        for number in range(steps + 1):
            if number == 1:
                started, before = time.perf_counter(), clock.seconds
            seeding.seed_everything(0, "bench", number)
            batch = recipe.batch(number)
            with torch.autocast("cpu", torch.bfloat16):
                loss = recipe(batch)["loss"]
            optimizer.zero_grad(set_to_none=True)
            loss.backward()
            optimizer.step()
        return Share(steps, time.perf_counter() - started, clock.seconds - before)
