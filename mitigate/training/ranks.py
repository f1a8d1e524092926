"""Processes that train one agent together: ``torchrun --nproc-per-node 2 -m mitigate.train``.

Each rank makes and learns from its share of a step's pieces; gradients are averaged, so all ranks
take the same step. One rank is the ordinary case, and costs nothing.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable
from datetime import timedelta
from typing import Any

import torch
import torch.distributed as dist
from torch import Tensor, nn
from torch.distributed.distributed_c10d import _set_pg_timeout

from mitigate.core.names import counted

FIND = timedelta(seconds=40)  # until all ranks have found each other (ours)
WAIT = timedelta(hours=2)  # for a rank that makes a cache, or evaluates (ours)


class Ranks:
    """``number`` of ``count`` processes, as torchrun's variables say; use it as a context manager,
    which opens and closes the process group (gloo for tensors of CPUs, nccl for those of GPUs) and
    silences all but the first."""

    def __init__(self, number: int = 0, count: int = 1) -> None:
        self.number, self.count = number, count

    @classmethod
    def of_environment(cls) -> Ranks:
        """Those that torchrun started, else one alone."""
        return cls(int(os.environ.get("RANK", 0)), int(os.environ.get("WORLD_SIZE", 1)))

    def __enter__(self) -> Ranks:
        if self.count > 1:
            if torch.cuda.is_available():
                torch.cuda.set_device(int(os.environ.get("LOCAL_RANK", 0)))
            # ranks that do not find each other end, and torchrun starts them again
            backend = "cpu:gloo,cuda:nccl" if torch.cuda.is_available() else "gloo"
            dist.init_process_group(backend, timeout=FIND)
            _set_pg_timeout(WAIT)
            if not self.first:
                sys.stdout = open(os.devnull, "w", encoding="utf-8")
        return self

    def __exit__(self, *_: object) -> None:
        if self.count > 1:
            dist.destroy_process_group()

    @property
    def first(self) -> bool:
        """Whether this one logs, saves and evaluates."""
        return self.number == 0

    def share(self, jobs: list[Any]) -> list[Any]:
        """The jobs of this rank. Raises ValueError if there are fewer than ranks."""
        self.check(len(jobs))
        return jobs[self.number :: self.count]

    def check(self, pieces: int, stage: str = "this recipe") -> None:
        """Raise ValueError if a step of ``stage`` has fewer pieces than there are ranks."""
        if self.count > 1 and pieces < self.count:
            held, most = counted(pieces, "piece"), max(1, pieces)
            raise ValueError(
                f"A step of {stage} has {held}, too few for {self.count} ranks: start "
                f"torchrun with --nproc-per-node {most} or fewer (make train NPROC={most})."
            )

    def average(
        self, parameters: Iterable[nn.Parameter], values: dict[str, Tensor], weight: float = 1.0
    ) -> None:
        """Replace gradients, and the figures to log, by their means over the ranks, each counting
        as its ``weight`` (``Recipe.weight``). For a loss that is a mean by that weight this is what
        one process would have on all their pieces; others, such as the distillation's KL, an
        agent's auxiliary losses and errors in units of a batch's variance, are means of ranks."""
        if self.count == 1:
            return
        parameters = list(parameters)
        told = dict.fromkeys(values, float(weight)), [p.grad is not None for p in parameters]
        held: list[Any] = [None] * self.count
        dist.all_gather_object(held, told)
        weights, moved = zip(*held, strict=True)
        share = weight / max(sum(max(one.values()) for one in weights), 1e-12)
        for parameter, moves in zip(parameters, map(any, zip(*moved, strict=True)), strict=True):
            if not moves:  # on no rank: the optimizer leaves it alone, as in one process
                continue
            if parameter.grad is None:  # it had no part in this rank's pieces
                parameter.grad = torch.zeros_like(parameter)
            dist.all_reduce(parameter.grad.mul_(share))
        some = next(iter(values.values()))
        for name in sorted({name for one in weights for name in one}):  # a rank may lack some
            own = weight / max(sum(one.get(name, 0.0) for one in weights), 1e-12)
            value = values[name] * own if name in values else torch.zeros_like(some)
            dist.all_reduce(value)
            values[name] = value

    def of_first(self, value: Any) -> Any:
        """Return the ``value`` that the first rank has."""
        if self.count == 1:
            return value
        held = [value]
        dist.broadcast_object_list(held, src=0)
        return held[0]

    def wait(self) -> None:
        """Return when all ranks are here."""
        if self.count > 1:
            dist.barrier()
