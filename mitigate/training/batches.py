"""Assemble an objective's batches from smaller parts, called pieces.

A piece is the result of one job. Workers compute pieces in advance, or this process computes them.
The number of pieces per step does not depend on the number of workers, and a piece is the same in
every process. So the batches are the same for any number of workers, including zero.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import torch

from mitigate.core import precision
from mitigate.training.objective import Objective, do
from mitigate.training.ranks import Ranks
from mitigate.training.workers import Workers

AHEAD = 4  # pieces are requested this number of steps in advance (heuristic)


@dataclass(eq=False, repr=False)
class Batches:
    """The batches of ``objective`` for all training steps.

    If pieces do not depend on the weights (``objective.ahead``), they are requested ``AHEAD`` steps
    in advance. Other pieces are requested ``lag`` steps in advance, and are computed with the
    weights at that time. Pieces for the steps after a checkpoint (a multiple of ``save_every``) are
    requested only after the checkpoint, so a resumed run computes them with the same weights.
    """

    objective: Objective
    workers: Workers | None
    steps: int
    kind: str
    device: torch.device
    ranks: Ranks = field(default_factory=Ranks)
    lag: int = 0
    save_every: int = 0

    def __post_init__(self) -> None:
        self.workers = self.workers or None  # with no processes, this process computes the pieces
        self._ordered: deque[tuple[int, Callable[[], list[Any]]]] = deque()  # step, its pieces
        self._taken = False

    def batch(self, step: int) -> dict[str, Any]:
        """Return the batch of ``step``. The method must be called for each step in order."""
        objective = self.objective
        early = not objective.here and (
            self.workers is not None or (self.lag and not objective.ahead)
        )
        jobs = self._jobs(step) if early and not self._ordered else []
        if not self._ordered and not jobs:
            with precision.computing(self.kind, self.device):
                if self.ranks.count == 1:
                    return objective.batch(step)
                jobs = self.ranks.share(objective.jobs(step))
                return objective.collate(step, [do(objective, job) for job in jobs])
        fresh = self._taken and not objective.ahead and self._last(step) > self._newest(step)
        if fresh and self.workers is not None:
            self.workers.send_weights(objective)
        if jobs:
            self._order(step, jobs)
        while self._newest(step) < self._last(step):
            later = self._newest(step) + 1
            self._order(later, self._jobs(later))
        ordered, receive = self._ordered.popleft()
        assert ordered == step, f"batch({step}) was called, but {ordered} is next"
        return objective.collate(step, receive())

    def _last(self, step: int) -> int:
        """Return the last step for which jobs may be queued while training is at ``step``."""
        if self.objective.ahead:
            return min(step + AHEAD, self.steps - 1)
        saved = step - step % self.save_every + self.save_every if self.save_every else self.steps
        return min(step + self.lag, saved - 1, self.steps - 1)

    def _newest(self, step: int) -> int:
        """Return the last step whose pieces have been requested."""
        return self._ordered[-1][0] if self._ordered else step - 1

    def _jobs(self, step: int) -> list[Any]:
        """Return this rank's jobs for a step. The list is empty if the objective has no jobs."""
        jobs = self.objective.jobs(step)
        return self.ranks.share(jobs) if jobs else []

    def _order(self, step: int, jobs: list[Any]) -> None:
        """Request the pieces of ``step``. The pieces are computed with the current weights."""
        if self.workers is None:
            with precision.computing(self.kind, self.device):
                pieces = [do(self.objective, job) for job in jobs]
            self._ordered.append((step, lambda: pieces))
            return
        if not self._taken:
            self.workers.take(self.objective, self.kind)
            self._taken = True
        # Consecutive values of ``turn`` select different workers for consecutive steps.
        # If jobs need the current weights, steps are requested one at a time, so ``turn`` stays 0.
        turn = step if self.objective.ahead or self.lag else 0
        self.workers.order(jobs, turn)
        self._ordered.append((step, partial(self.workers.receive, len(jobs), turn)))
