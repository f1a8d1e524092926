"""Make the batches of an objective from pieces, in workers ahead of time or in this process.

The number of pieces of a step does not depend on the number of workers, and a piece is the same
wherever it is made. So any number of workers, including none, gives the same batches.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from functools import partial
from typing import Any

import torch

from mitigate.core import precision
from mitigate.training.objective import Objective, do
from mitigate.training.ranks import Ranks
from mitigate.training.workers import Workers

AHEAD = 4  # steps whose pieces are ordered before they are needed (heuristic)


class Batches:
    """The batches of ``objective`` up to ``steps``, made on ``device`` in the precision ``kind``.

    Pieces that do not depend on the weights (``objective.ahead``) are ordered ``AHEAD`` steps
    early. Other pieces are ordered ``lag`` steps early, with the weights of that time. No piece is
    ordered across a multiple of ``save_every``, so a resumed run makes the same pieces.
    """

    def __init__(
        self,
        objective: Objective,
        workers: Workers | None,
        steps: int,
        kind: str,
        device: torch.device,
        ranks: Ranks | None = None,
        lag: int = 0,
        save_every: int = 0,
    ) -> None:
        self.objective = objective
        self.steps = steps
        self.kind = kind
        self.device = device
        self.workers = workers if workers is not None and len(workers) else None
        self.ranks = ranks or Ranks()
        self.lag = lag
        self.save_every = save_every
        self._ordered: deque[tuple[int, Callable[[], list[Any]]]] = deque()  # step, its pieces
        self._taken = False

    def batch(self, step: int) -> dict[str, Any]:
        """Return the batch of ``step``; call it for each step in order."""
        objective = self.objective
        early = not objective.here and (
            self.workers is not None or (self.lag and not objective.ahead)
        )
        jobs = self._jobs(step) if early and not self._ordered else []
        if not self._ordered and not jobs:
            with precision.computing(self.kind, self.device):
                return self._alone(step)
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
        """Return the last step whose pieces may be ordered when ``step`` is due."""
        if self.objective.ahead:
            return min(step + AHEAD, self.steps - 1)
        saved = step - step % self.save_every + self.save_every if self.save_every else self.steps
        return min(step + self.lag, saved - 1, self.steps - 1)

    def _newest(self, step: int) -> int:
        """Return the last step whose pieces are ordered."""
        return self._ordered[-1][0] if self._ordered else step - 1

    def _jobs(self, step: int) -> list[Any]:
        """Return this rank's jobs of a step; empty if the objective has no jobs."""
        jobs = self.objective.jobs(step)
        return self.ranks.share(jobs) if jobs else []

    def _alone(self, step: int) -> dict[str, Any]:
        """Make the batch of ``step`` in this process."""
        if self.ranks.count == 1:
            return self.objective.batch(step)
        jobs = self.ranks.share(self.objective.jobs(step))
        return self.objective.collate(step, [do(self.objective, job) for job in jobs])

    def _order(self, step: int, jobs: list[Any]) -> None:
        """Order the pieces of ``step``, made with the current weights."""
        if self.workers is None:
            with precision.computing(self.kind, self.device):
                pieces = [do(self.objective, job) for job in jobs]
            self._ordered.append((step, lambda: pieces))
            return
        if not self._taken:
            self.workers.take(self.objective, self.kind)
            self._taken = True
        turn = self._turn(step)
        self.workers.order(jobs, turn)
        self._ordered.append((step, partial(self.workers.receive, len(jobs), turn)))

    def _turn(self, step: int) -> int:
        """Return the turn of ``step`` among workers for several steps.

        It is 0 if jobs need the current weights: then only one step is ordered at a time.
        """
        return step if self.objective.ahead or self.lag else 0
