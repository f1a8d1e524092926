"""An objective: a loss and the source of its batches. The trainer asks for nothing else.

A stage of a recipe (YAML) names an objective and lists its arguments. :class:`ObjectiveSpec` gives
each argument to the constructor that names it: that of the objective or that of its source.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Container, Mapping
from dataclasses import dataclass, field
from inspect import Parameter, signature
from numbers import Real
from typing import Any, ClassVar

import numpy as np
import torch
from torch import Tensor, nn

from mitigate.core.build import arguments_of, located
from mitigate.core.contracts import lacking
from mitigate.core.names import unknown
from mitigate.core.precision import computing
from mitigate.training.config import in_range, number_text
from mitigate.training.parts import hold_statistics

WEIGHT = 1e9  # largest weight of a loss, a generous bound


class Objective(nn.Module):
    """Base class of every training method: a loss and the source of its batches.

    An objective holds the module that it trains and, where it needs one, a teacher or a buffer.
    State beyond tensors (schedule weights, counters) goes through ``get_extra_state`` and
    ``set_extra_state`` as a JSON-able dict, so it is saved and restored with the weights.
    The optimizer never receives parameters whose ``requires_grad`` is False.

    Attributes:
        sources: functions that build the source of the batches, by the name of the constructor's
            parameter that takes it (``{"rollouts": Rollouts}``).
        here: run jobs in the training process, never in a worker.
        ahead: jobs depend on no weights, so workers may run them ahead of time.
        needs: names of the agent's attributes that the objective uses.
        otherwise: a sentence that says what to do if the agent lacks one of them.
        workers: processes that ``jobs`` may start; None: one per core, 0: none.
    """

    sources: ClassVar[Mapping[str, Callable[..., Any]]] = {}
    here = False
    ahead = False
    needs: ClassVar[tuple[str, ...]] = ()
    otherwise: ClassVar[str] = ""
    workers: int | None = None

    @classmethod
    def misfit(cls, agent: Any) -> str:
        """Return why this objective cannot train ``agent`` and what to do, "" if it can.

        The plan of a run asks before the first stage begins.
        """
        absent = lacking(agent, cls.needs)
        return f"it has no {', '.join(absent)}. {cls.otherwise}" if absent else ""

    def train(self, mode: bool = True) -> Any:
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

        An objective defines this, or :meth:`jobs`, :meth:`work` and :meth:`collate`, of which this
        then makes it without worker processes.
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
        piece's number and the schedule's state; it is pickled, as is the objective.
        """
        return []

    def pieces(self) -> int | None:
        """Return how many jobs every step has, of which ranks have shares; asked before the first
        stage of a run begins. 1: one process alone can train so. None: it shows at the first step.
        """
        return None

    def work(self, job: Any) -> Any:
        """Return what ``job`` asks for, picklable: a pure function of job, seed and weights.

        Called in eval mode without gradients, on a copy of the objective in a worker process.
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
        decisions = batch.get("decisions")
        return 1.0 if decisions is None else float(decisions.weight.sum())

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
def do(objective: Objective, job: Any) -> Any:
    """Return ``objective.work(job)``, done in eval mode and, on a CPU, on one thread."""
    threads = torch.get_num_threads()
    training = objective.training
    try:
        torch.set_num_threads(1)  # sums in the same order in any number of processes
        return objective.eval().work(job)
    finally:
        objective.train(training)
        torch.set_num_threads(threads)


def accumulate(
    objective: Objective, batch: dict[str, Any], kind: str, device: torch.device
) -> dict[str, Tensor]:
    """Go forward in the precision ``kind``, and backward, over the parts of ``batch``; return the
    sums of what ``forward`` gave. A part whose loss is not finite has no gradient."""
    values: dict[str, Tensor] = {}
    for part in objective.micro_batches(batch):
        with computing(kind, device):
            found = _checked(objective, objective(part))
        if torch.isfinite(found["loss"]):
            found["loss"].backward()
        fresh = {name: torch.as_tensor(value).detach() for name, value in found.items()}
        values = {name: values.get(name, 0) + value for name, value in fresh.items()}
    return values


def _checked(objective: Objective, found: Any) -> dict[str, Any]:
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
            f"forward() of {type(objective).__name__} {wrong}: it returns a dict of single "
            'numbers, of which "loss" is a tensor to go backward from (recipes/README.md, "A new '
            'objective").'
        )
    return found


@dataclass(frozen=True)
class ObjectiveSpec:
    """What builds the objective of a stage: its class, and the arguments of each constructor.

    Attributes:
        target: the ``_target_`` of the stage's config.
        arguments: of the objective's own constructor, as plain data.
        source: arguments of the source's constructor; None if the objective makes its own batches.
        parameter: the objective's parameter that takes the source.
    """

    target: str
    arguments: dict[str, Any] = field(default_factory=dict)
    source: dict[str, Any] | None = None
    parameter: str = ""

    @classmethod
    def of(cls, recipe: Mapping[str, Any]) -> ObjectiveSpec:
        """Split the flat ``recipe`` node of a stage by the signatures of both constructors.

        Raises:
            ValueError: for an argument that neither of them has, for a class that is no objective,
                and for one that takes no agent.
        """
        target = str(recipe["_target_"])
        kind = located(target)
        check_kind(kind, target)
        given = {name: value for name, value in recipe.items() if name != "_target_"}
        parameter = _source_of(kind, given)
        own, others = split_arguments(kind, parameter, given, target)
        return cls(target, own, others if parameter else None, parameter)

    def build(self, agent: nn.Module) -> Objective:
        """Build the objective for ``agent``; it chooses which parameters train.

        Raises:
            ValueError: if the target builds something else, and as its constructor does.
        """
        for parameter in agent.parameters():
            parameter.requires_grad_(parameter.is_floating_point())  # 8-bit weights never train
        kind = located(self.target)
        given: dict[str, Any] = {"agent": agent}
        if self.source is not None:
            make_source = kind.sources[self.parameter]
            given[self.parameter] = make_source(agent=agent, **arguments_of(self.source))
        objective = kind(**arguments_of(self.arguments), **given)
        if not isinstance(objective, Objective):
            raise ValueError(not_an_objective(self.target))
        return objective


def split_arguments(
    kind: Any, parameter: str, given: Mapping[str, Any], target: str
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the arguments of the objective ``kind`` and those of its source.

    An argument that both constructors name goes to both. Raises ValueError for one that neither
    names.
    """
    own_names, own_open = _parameters(kind)
    source_names, source_open = _parameters(kind.sources[parameter]) if parameter else ((), False)
    names = [n for n in (*own_names, *source_names) if n != parameter]
    for name in given:
        if not (name.startswith("_") or name in names or own_open or source_open):
            raise ValueError(f"{target}: {unknown('argument', name, [*dict.fromkeys(names)])}")
    others = {
        n: v for n, v in given.items() if n in source_names or (source_open and n not in own_names)
    }
    own = {n: v for n, v in given.items() if n in own_names or n not in others}
    return own, others


def _parameters(kind: Any) -> tuple[tuple[str, ...], bool]:
    """Return the parameters that a callable names, and whether it takes any others."""
    try:
        parameters = signature(kind).parameters.values()
    except (ValueError, TypeError):  # a callable written in C has no signature
        return (), True
    is_open = any(parameter.kind is Parameter.VAR_KEYWORD for parameter in parameters)
    return tuple(p.name for p in parameters if p.kind is not Parameter.VAR_KEYWORD), is_open


def _source_of(kind: Any, given: Container[str]) -> str:
    """Return the parameter of ``kind`` that takes its source, "" without one or if it is given."""
    if not is_objective(kind):
        return ""
    names, _ = _parameters(kind)
    return next((name for name in kind.sources if name in names and name not in given), "")


def is_objective(kind: Any) -> bool:
    """Return whether ``kind`` is a class of objectives, not a function that makes one."""
    return isinstance(kind, type) and issubclass(kind, Objective)


def check_kind(kind: Any, target: str) -> None:
    """Raise ValueError for a class that is no objective, or whose constructor takes no agent.

    A function is checked by what it returns.
    """
    if not isinstance(kind, type):
        return
    if not is_objective(kind):
        raise ValueError(not_an_objective(target))
    names, is_open = _parameters(kind)
    if "agent" not in names and not is_open:
        raise ValueError(
            f"{target} takes no agent: give its constructor a parameter agent, the module that it "
            "trains."
        )


def not_an_objective(target: str) -> str:
    """Return the message for a ``target`` that is no objective."""
    return (
        f"{target} is no objective: make it a subclass of mitigate.training.objective.Objective "
        '(recipes/README.md, "A new objective").'
    )


def check_weights(**weights: float) -> None:
    """Raise ValueError unless every weight of a loss is from 0 (no such loss) to ``WEIGHT``."""
    for name, value in weights.items():
        if not in_range(value, 0, WEIGHT):
            raise ValueError(
                f"recipe.{name}={number_text(value)} must be a number from 0 to {WEIGHT:g}: it is "
                "the weight of a loss, and 0 leaves that out."
            )


def check_share(name: str, value: float) -> None:
    """Raise ValueError unless ``value`` is a share from 0 to 1."""
    if not in_range(value, 0, 1):
        raise ValueError(f"recipe.{name}={number_text(value)} must be a share from 0 to 1, as 0.5.")
