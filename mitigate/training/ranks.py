"""Train one agent with several processes: ``torchrun --nproc-per-node 2 -m mitigate.train``.

Each rank computes the gradients for its part of a step's batch. The gradients are averaged, so all
ranks make the same update. With one rank, which is the usual case, this module adds no cost.
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

FIND = timedelta(seconds=40)  # time limit for all ranks to find each other (heuristic)
WAIT = timedelta(hours=2)  # time limit for a rank that builds a cache or evaluates (heuristic)


class Ranks:
    """One of ``count`` training processes, with the index ``number``; a context manager.

    It opens and closes the process group (gloo for CPU tensors, nccl for GPU tensors) and silences
    the output of all ranks except the first.
    """

    def __init__(self, number: int = 0, count: int = 1) -> None:
        self.number = number
        self.count = count

    @classmethod
    def of_environment(cls) -> Ranks:
        """Return the rank that torchrun's environment variables describe.

        If they are not set, return a single rank.
        """
        return cls(int(os.environ.get("RANK", 0)), int(os.environ.get("WORLD_SIZE", 1)))

    def __enter__(self) -> Ranks:
        if self.count > 1:
            if torch.cuda.is_available():
                torch.cuda.set_device(int(os.environ.get("LOCAL_RANK", 0)))
            # If this timeout expires, the ranks exit and torchrun restarts them.
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
        """Whether this rank logs, saves and evaluates."""
        return self.number == 0

    def share(self, jobs: list[Any]) -> list[Any]:
        """Return this rank's jobs; raise ValueError if there are fewer jobs than ranks."""
        self.check(len(jobs))
        return jobs[self.number :: self.count]

    def check(self, pieces: int, stage: str = "this recipe") -> None:
        """Raise ValueError if a step of ``stage`` has fewer work items than there are ranks."""
        if self.count > 1 and pieces < self.count:
            most = max(1, pieces)
            raise ValueError(
                f"A step of {stage} has {counted(pieces, 'work item')}, too few for "
                f"{self.count} ranks: start torchrun with --nproc-per-node {most} or fewer (make "
                f"train NPROC={most})."
            )

    def average(
        self, parameters: Iterable[nn.Parameter], values: dict[str, Tensor], weight: float = 1.0
    ) -> None:
        """Replace gradients and logged values by their weighted means over the ranks.

        If the loss is a mean weighted by ``Objective.weight``, the result equals the gradient that
        a single process would compute from the whole batch. For other losses, the result is only
        similar. Examples of other losses are the KL divergence of distillation, the auxiliary
        losses of agents, and errors that are divided by the variance of a batch.
        """
        if self.count == 1:
            return
        parameters = list(parameters)
        message = dict.fromkeys(values, float(weight)), [p.grad is not None for p in parameters]
        messages: list[Any] = [None] * self.count
        dist.all_gather_object(messages, message)
        weights, has_gradient = zip(*messages, strict=True)
        share = weight / max(sum(max(entry.values()) for entry in weights), 1e-12)
        any_has_gradient = map(any, zip(*has_gradient, strict=True))
        for parameter, any_gradient in zip(parameters, any_has_gradient, strict=True):
            if not any_gradient:  # the optimizer skips the parameter, as in a single process
                continue
            if parameter.grad is None:  # this rank's part of the batch did not use this parameter
                parameter.grad = torch.zeros_like(parameter)
            dist.all_reduce(parameter.grad.mul_(share))
        template = next(iter(values.values()))
        # a rank may have no value for some names
        for name in sorted({name for entry in weights for name in entry}):
            factor = weight / max(sum(entry.get(name, 0.0) for entry in weights), 1e-12)
            value = values[name] * factor if name in values else torch.zeros_like(template)
            dist.all_reduce(value)
            values[name] = value

    def of_first(self, value: Any) -> Any:
        """Broadcast the first rank's ``value`` to all ranks, and return it."""
        if self.count == 1:
            return value
        values = [value]
        dist.broadcast_object_list(values, src=0)
        return values[0]

    def wait(self) -> None:
        """Wait until all ranks have called this method."""
        if self.count > 1:
            dist.barrier()
