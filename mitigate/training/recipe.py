"""What the trainer asks of a training method: a module whose ``forward`` returns a loss."""

from __future__ import annotations

import math
from numbers import Real
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
import torch
from torch import Tensor, nn

from mitigate.core.contracts import lacking
from mitigate.core.precision import computing
from mitigate.training.parts import hold_statistics

if TYPE_CHECKING:
    from typing_extensions import Self


class Recipe(nn.Module):
    """Base class of every training method; the trainer knows nothing else about it.

    A recipe holds the module it trains and, where it needs one, a teacher, a schedule, a buffer.
    State beyond tensors (schedule weights, counters) goes through ``get_extra_state`` and
    ``set_extra_state`` as a JSON-able dict, so it is saved and restored with the weights.
    Parameters with ``requires_grad`` False are never given to the optimiser.
    """

    here = False  # whether jobs are done in the training's own process, never by a worker
    ahead = False  # whether jobs depend on no weights, so that workers may do them ahead of time
    needs: ClassVar[tuple[str, ...]] = ()  # what it uses of an agent, by name
    otherwise: ClassVar[str] = ""  # what to do with an agent that lacks some of it, a sentence
    workers: int | None = None  # processes that jobs() may start; None: a core each, 0: none

    @classmethod
    def misfit(cls, agent: Any) -> str:
        """Return why this kind of recipe cannot train ``agent`` and what to do, "" if it can; asked
        before the first stage of a run begins."""
        absent = lacking(agent, cls.needs)
        return f"it has no {', '.join(absent)}. {cls.otherwise}" if absent else ""

    def train(self, mode: bool = True) -> Self:
        """As a module's; frozen normalisations keep their statistics (``hold_statistics``)."""
        super().train(mode)
        hold_statistics(self)
        return self

    def start(self) -> None:
        """Make what must be there before the first batch, such as a cache of features; called once,
        under the trainer's precision."""

    def batch(self, step: int) -> dict[str, Any]:
        """Return the batch of ``step`` (from 0): a pure function of (seed, step, weights).

        Tensors are moved to the training device. ``episode_ids`` (list of str), if there, are
        named when the loss is not finite. Anything built up over steps (a buffer) must be rebuilt
        from the seed and the weights or saved as extra state, or a resumed run will differ.

        A recipe defines this, or :meth:`jobs`, :meth:`work` and :meth:`collate`, of which this then
        makes it without worker processes.
        """
        jobs = self.jobs(step)
        if not jobs:
            raise NotImplementedError(f"{type(self).__name__} defines no batch(step)")
        return self.collate(step, [do(self, job) for job in jobs])

    def jobs(self, step: int) -> list[Any]:
        """Return the pieces of work that the batch of ``step`` is made from, for worker processes;
        none if :meth:`batch` makes it alone.

        How many there are must not depend on the number of workers. A job is all that
        :meth:`work` needs beside the settings, the seed and the weights, such as the step, the
        piece's number and the schedule's state; it is pickled, as is the recipe.
        """
        return []

    def pieces(self) -> int | None:
        """Return how many jobs every step has, of which ranks have shares; asked before the first
        stage of a run begins. 1: one process alone can train so. None: it shows at the first step.
        """
        return None

    def work(self, job: Any) -> Any:
        """Return what ``job`` asks for, picklable: a pure function of job, seed and weights.

        Called in eval mode without gradients, on a copy of the recipe in a worker process.
        """
        raise NotImplementedError(f"{type(self).__name__} has jobs, but defines no work(job)")

    def collate(self, step: int, pieces: list[Any]) -> dict[str, Any]:
        """Return the batch of ``step`` from what its jobs gave, in their order."""
        raise NotImplementedError(f"{type(self).__name__} has jobs, but defines no collate")

    def micro_batches(self, batch: dict[str, Any]) -> list[dict[str, Any]]:
        """Return the parts of ``batch`` that go forward and backward one after the other, so that
        memory is that of one; their gradients and values are added up. By default it is one part:
        the batch."""
        return [batch]

    def weight(self, batch: dict[str, Any]) -> float:
        """Return how much a rank's batch counts beside those of the others: what its losses are
        means over. By default that of its decisions, if it has any, else 1."""
        found = getattr(batch.get("decisions"), "weight", None)
        return 1.0 if found is None else float(found.sum())

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        """Return scalars: ``loss`` (differentiable) and whatever else is worth logging."""
        raise NotImplementedError(f"{type(self).__name__} defines no forward(batch)")

    def parameter_groups(self) -> list[dict[str, Any]]:
        """Return AdamW groups; ``lr`` and ``weight_decay`` in a group override the trainer's.

        By default matrices and kernels decay; biases, norms and other vectors do not.
        """
        trained = [p for p in self.parameters() if p.requires_grad]
        return [
            {"params": [p for p in trained if p.ndim >= 2]},
            {"params": [p for p in trained if p.ndim < 2], "weight_decay": 0.0},
        ]

    def identity(self) -> dict[str, str]:
        """Return what the result depends on beside the settings, such as a teacher's sha256.

        It is kept in the checkpoints: a run is not resumed under another.
        """
        return {}

    def finish(self) -> None:
        """Set what follows from the trained weights, such as a gate's threshold; called after the
        last update, in eval mode without gradients, and again with the same weights if the run was
        ended meanwhile."""

    def evaluate(self, step: int) -> dict[str, float]:
        """Return scalars measured after ``step`` updates; called every ``eval_every`` steps."""
        return {}

    def figures(self, step: int) -> dict[str, np.ndarray]:
        """Return pictures to log, each uint8 ``[H, W, 3]``."""
        return {}


@torch.no_grad()
def do(recipe: Recipe, job: Any) -> Any:
    """Return ``recipe.work(job)``, done in eval mode and, on a CPU, on one thread."""
    threads, training = torch.get_num_threads(), recipe.training
    try:
        torch.set_num_threads(1)  # sums in the same order in any number of processes
        return recipe.eval().work(job)
    finally:
        recipe.train(training)
        torch.set_num_threads(threads)


def accumulate(
    recipe: Recipe, batch: dict[str, Any], kind: str, device: torch.device
) -> dict[str, Tensor]:
    """Go forward in the precision ``kind``, and backward, over the parts of ``batch``; return the
    sums of what ``forward`` gave. A part whose loss is not finite has no gradient."""
    values: dict[str, Tensor] = {}
    for part in recipe.micro_batches(batch):
        with computing(kind, device):
            found = _checked(recipe, recipe(part))
        if torch.isfinite(found["loss"]):
            found["loss"].backward()
        fresh = {name: torch.as_tensor(value).detach() for name, value in found.items()}
        values = {name: values.get(name, 0) + value for name, value in fresh.items()}
    return values


def _checked(recipe: Recipe, found: Any) -> dict[str, Any]:
    """What ``forward`` gave. Raises ValueError unless these are numbers with a loss to learn by."""
    wrong = ""
    if not isinstance(found, dict) or "loss" not in found:
        given = ", ".join(map(repr, found)) if isinstance(found, dict) else type(found).__name__
        wrong = f'returned no "loss", but {given or "nothing"}'
    else:
        for name, value in found.items():
            if not isinstance(value, (Tensor, np.ndarray, Real)):
                wrong = f"returned {name!r} as {type(value).__name__}"
            elif isinstance(value, (Tensor, np.ndarray)) and math.prod(value.shape) != 1:
                wrong = f"returned {name!r} of shape {list(value.shape)}"
    if not wrong and not (isinstance(found["loss"], Tensor) and found["loss"].requires_grad):
        wrong = 'returned a "loss" that depends on no weight that trains (is it detached?)'
    if wrong:
        raise ValueError(
            f"forward() of {type(recipe).__name__} {wrong}: it returns a dict of single numbers, "
            'of which "loss" is a tensor to go backward from (recipes/README.md, "A new one").'
        )
    return found
