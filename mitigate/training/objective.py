"""Define the interface of objectives, which consist of a loss and a source of batches.

A stage of a recipe (YAML) names an objective and lists arguments. Some arguments belong to the
constructor of the objective, and others to the constructor of its source. :class:`ObjectiveSpec`
passes each argument to the constructor that declares it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Container, Mapping
from dataclasses import dataclass, field
from inspect import Parameter, signature
from numbers import Real
from typing import Any, ClassVar, NamedTuple

import numpy as np
import torch
from torch import Tensor, nn

from mitigate.core.build import arguments_of, locate
from mitigate.core.contracts import missing_members
from mitigate.core.names import unknown
from mitigate.core.precision import computing
from mitigate.training.config import in_range, number_text
from mitigate.training.parts import hold_statistics

WEIGHT = 1e9  # maximum weight of a loss


class Objective(nn.Module):
    """Base class of every training method, which has a loss and a source of batches.

    An objective contains the module that it trains and, if needed, a teacher or a buffer.
    State other than tensors, such as counters, is saved and restored with the weights if
    ``get_extra_state`` returns it and ``set_extra_state`` sets it. This extra state must be a
    JSON-compatible dict. The optimizer never receives parameters whose ``requires_grad`` is False.

    Attributes:
        sources: maps a constructor parameter to the function that builds a source of batches for
            it. An example is ``{"rollouts": Rollouts}``.
        here: whether jobs run only in the training process, and never in a worker.
        ahead: whether workers may run jobs in advance, because jobs read no weights.
        needs: names of the agent's attributes that the objective uses.
        otherwise: advice for the error message if the agent lacks one of these attributes.
        workers: number of worker processes for jobs. With None, there is one worker per core.
    """

    sources: ClassVar[Mapping[str, Callable[..., Any]]] = {}
    here = False
    ahead = False
    needs: ClassVar[tuple[str, ...]] = ()
    otherwise: ClassVar[str] = ""
    workers: int | None = None

    @classmethod
    def misfit(cls, agent: Any) -> str:
        """Return an error message with advice if this objective cannot train ``agent``, else "".

        The method is called before the first stage, when a run is planned.
        """
        absent = missing_members(agent, cls.needs)
        return f"it does not define {', '.join(absent)}. {cls.otherwise}" if absent else ""

    def train(self, mode: bool = True) -> Any:
        """Set the mode, but keep the statistics of frozen normalisation layers constant
        (``hold_statistics``), and keep the submodule ``teacher`` in eval mode.
        """
        super().train(mode)
        hold_statistics(self)
        teacher = self._modules.get("teacher")
        if teacher is not None:
            teacher.eval()
        return self

    def start(self) -> None:
        """Prepare for the first batch, for example by computing a cache of features.

        This is called once, in the trainer's precision.
        """

    def batch(self, step: int) -> dict[str, Any]:
        """Return the batch of ``step``, where the first step is 0.

        The batch must be a pure function of the seed, the step and the weights. The trainer moves
        the tensors of the batch to the training device. If the batch has an entry ``episode_ids``
        (list of str), the error message for a loss that is not finite contains these ids.

        State that grows over steps, such as a buffer, must be rebuilt from the seed and the
        weights, or saved as extra state. If the state is not restored, a resumed run gives
        different results.

        An objective must define either this method or the three methods :meth:`jobs`, :meth:`work`
        and :meth:`collate`. By default, this method calls those three, without worker processes.
        """
        jobs = self.jobs(step)
        if not jobs:
            raise NotImplementedError(f"{type(self).__name__} defines no batch(step)")
        return self.collate(step, [do(self, job) for job in jobs])

    def jobs(self, step: int) -> list[Any]:
        """Return the jobs for the batch of ``step``, which worker processes can run.

        The list is empty if :meth:`batch` is overridden. The number of jobs must not depend on the
        number of workers. A job contains what :meth:`work` needs to know besides the settings, the
        seed and the weights. For example, it contains the step, the index of the job and the state
        of the schedule. Jobs and objectives are pickled.
        """
        return []

    def pieces(self) -> int | None:
        """Return the number of jobs per step. The jobs are divided among the ranks.

        This is called before the first stage. If the number is 1, training must run in a single
        process. If the number is known only at the first step, the result is None.
        """
        return None

    def work(self, job: Any) -> Any:
        """Run ``job`` and return its result, which must be picklable.

        The result must be a pure function of the job, the seed and the weights. This is called in
        eval mode and without gradients, on a copy of the objective in a worker process.
        """
        raise NotImplementedError(f"{type(self).__name__} has jobs, but defines no work(job)")

    def collate(self, step: int, pieces: list[Any]) -> dict[str, Any]:
        """Return the batch of ``step`` from the results of its jobs, in order."""
        raise NotImplementedError(f"{type(self).__name__} has jobs, but defines no collate")

    def micro_batches(self, batch: dict[str, Any]) -> list[dict[str, Any]]:
        """Split ``batch`` into parts that are processed one after the other.

        With several parts, the forward and backward passes of a step need memory for only one part
        at a time. The gradients and values of the parts are summed. By default, the whole batch is
        one part.
        """
        return [batch]

    def weight(self, batch: dict[str, Any]) -> float:
        """Return the weight of a rank's batch when values are averaged over ranks.

        A loss is a weighted mean over the items of a batch, and the weight of the batch is the sum
        of the items' weights. By default, the items are decisions. Without decisions, the weight of
        the batch is 1.
        """
        decisions = batch.get("decisions")
        return 1.0 if decisions is None else float(decisions.weight.sum())

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        """Return a dict of scalars: the differentiable ``loss``, and values to log."""
        raise NotImplementedError(f"{type(self).__name__} defines no forward(batch)")

    def parameter_groups(self) -> list[dict[str, Any]]:
        """Return the parameter groups for AdamW.

        ``lr`` and ``weight_decay`` in a group override the trainer's settings. By default, weight
        decay applies to matrices and convolution kernels, and not to biases, normalisation weights
        and other vectors.
        """
        trained = [p for p in self.parameters() if p.requires_grad]
        return [
            {"params": [p for p in trained if p.ndim >= 2]},
            {"params": [p for p in trained if p.ndim < 2], "weight_decay": 0.0},
        ]

    def identity(self) -> dict[str, str]:
        """Return the data that identifies the objective, apart from its settings.

        An example is the sha256 of a teacher. Checkpoints record this data. A run is not resumed if
        the data differs.
        """
        return {}

    def finish(self) -> None:
        """Set values that depend on the trained weights, such as the threshold of a gate.

        This is called after the last update, in eval mode without gradients. If the run is
        interrupted, it is called again with the same weights.
        """

    def evaluate(self, step: int) -> dict[str, float]:
        """Measure and return scalars after ``step`` updates.

        This is called every ``eval_every`` steps.
        """
        return {}

    def figures(self, step: int) -> dict[str, np.ndarray]:
        """Return pictures to log, each uint8 ``[H, W, 3]``."""
        return {}


class OnSource(Objective):
    """Base class of objectives whose jobs come from a source with a schedule of corruptions."""

    @property
    def _source(self) -> Any:
        """The source of batches, an attribute with the name of the constructor's parameter."""
        return getattr(self, next(iter(self.sources)))

    def identity(self) -> dict[str, str]:
        return dict(self._source.identity())

    def jobs(self, step: int) -> list[tuple]:
        return list(self._source.jobs(step, self.workers))

    def pieces(self) -> int:
        return int(self._source.pieces)

    def work(self, job: tuple) -> Any:
        return self._source.work(job)

    def figures(self, step: int) -> dict[str, np.ndarray]:
        return dict(self._source.figures())

    def get_extra_state(self) -> dict[str, Any]:
        return {"schedule": self._source.schedule.state_dict()}

    def set_extra_state(self, state: dict[str, Any]) -> None:
        self._source.schedule.load_state_dict(state["schedule"])


@torch.no_grad()
def do(objective: Objective, job: Any) -> Any:
    """Run ``objective.work(job)`` in eval mode on one CPU thread."""
    threads = torch.get_num_threads()
    training = objective.training
    try:
        # with one thread, the rounding of sums does not depend on the number of processes
        torch.set_num_threads(1)
        return objective.eval().work(job)
    finally:
        objective.train(training)
        torch.set_num_threads(threads)


def accumulate(
    objective: Objective, batch: dict[str, Any], kind: str, device: torch.device
) -> dict[str, Tensor]:
    """Run the forward pass and the backward pass for each part of ``batch``.

    The forward pass is computed in the precision ``kind``. If the loss of a part is not finite, no
    gradient is computed for that part.

    Returns:
        The values that ``forward`` returned, summed over the parts.
    """
    values: dict[str, Tensor] = {}
    for part in objective.micro_batches(batch):
        with computing(kind, device):
            outputs = _checked(objective, objective(part))
        if torch.isfinite(outputs["loss"]):
            outputs["loss"].backward()
        fresh = {name: torch.as_tensor(value).detach() for name, value in outputs.items()}
        values = {name: values.get(name, 0) + value for name, value in fresh.items()}
    return values


def _checked(objective: Objective, outputs: Any) -> dict[str, Any]:
    """Check that ``outputs`` of ``forward`` are numbers and contain a loss, and return them."""
    wrong = ""
    if not isinstance(outputs, dict) or "loss" not in outputs:
        names = map(repr, outputs) if isinstance(outputs, dict) else [type(outputs).__name__]
        wrong = f'returned no "loss", but {", ".join(names) or "nothing"}'
    else:
        for name, value in outputs.items():
            if not isinstance(value, (Tensor, np.ndarray, Real)):
                wrong = f"returned {name!r} as {type(value).__name__}"
            elif isinstance(value, (Tensor, np.ndarray)) and math.prod(value.shape) != 1:
                wrong = f"returned {name!r} of shape {list(value.shape)}"
    if not wrong and not (isinstance(outputs["loss"], Tensor) and outputs["loss"].requires_grad):
        wrong = 'returned a "loss" that depends on no weight that trains (is it detached?)'
    if wrong:
        raise ValueError(
            f"forward() of {type(objective).__name__} {wrong}. It must return a dict of single "
            'numbers, with a differentiable tensor "loss" (recipes/README.md, "A new objective").'
        )
    return outputs


@dataclass(frozen=True)
class ObjectiveSpec:
    """The objective of a stage, with the arguments of its constructor and of its source."""

    target: str  # the ``_target_`` of the stage's config
    # arguments of the objective's constructor, as plain data
    arguments: dict[str, Any] = field(default_factory=dict)
    # arguments of the source's constructor, or None if the objective makes its own batches
    source: dict[str, Any] | None = None
    parameter: str = ""  # the objective's parameter that receives the source

    @classmethod
    def of(cls, recipe: Mapping[str, Any]) -> ObjectiveSpec:
        """Split the arguments in a stage's ``recipe`` node between the two constructors.

        Raises:
            ValueError: If neither constructor declares an argument, or if the class is not an
                objective or accepts no agent.
        """
        target = str(recipe["_target_"])
        kind = locate(target)
        if isinstance(kind, type):  # :meth:`build` checks the result of a function
            if not is_objective(kind):
                raise ValueError(not_an_objective(target))
            names, is_open = _parameters(kind)
            if "agent" not in names and not is_open:
                raise ValueError(
                    f"{target} takes no agent. Give its constructor a parameter agent."
                )
        arguments = {name: value for name, value in recipe.items() if name != "_target_"}
        parameter = _source_of(kind, arguments)
        objective_arguments, source_arguments = split_arguments(kind, parameter, arguments, target)
        return cls(target, objective_arguments, source_arguments if parameter else None, parameter)

    def build(self, agent: nn.Module) -> Objective:
        """Build the objective for ``agent``.

        The objective chooses which parameters are trained.

        Raises:
            ValueError: If the target does not build an objective, or if its constructor raises
                ValueError.
        """
        for parameter in agent.parameters():
            # integer parameters, such as 8-bit weights, cannot be trained
            parameter.requires_grad_(parameter.is_floating_point())
        kind = locate(self.target)
        modules: dict[str, Any] = {"agent": agent}
        if self.source is not None:
            make_source = kind.sources[self.parameter]
            modules[self.parameter] = make_source(agent=agent, **arguments_of(self.source))
        objective = kind(**arguments_of(self.arguments), **modules)
        if not isinstance(objective, Objective):
            raise ValueError(not_an_objective(self.target))
        return objective


def split_arguments(
    kind: Any, parameter: str, arguments: Mapping[str, Any], target: str
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the arguments of the objective ``kind`` and the arguments of its source.

    An argument that both constructors declare is in both of the returned dicts. Raises ValueError
    for an argument that neither of them declares.
    """
    names, is_open = _parameters(kind)
    source_names, source_open = _parameters(kind.sources[parameter]) if parameter else ((), False)
    allowed = [n for n in (*names, *source_names) if n != parameter]
    for name in arguments:
        if not (name.startswith("_") or name in allowed or is_open or source_open):
            raise ValueError(f"{target}: {unknown('argument', name, [*dict.fromkeys(allowed)])}")
    source_arguments = {
        n: v for n, v in arguments.items() if n in source_names or (source_open and n not in names)
    }
    objective_arguments = {
        n: v for n, v in arguments.items() if n in names or n not in source_arguments
    }
    return objective_arguments, source_arguments


def _parameters(kind: Any) -> tuple[tuple[str, ...], bool]:
    """Return the named parameters of a callable, and whether it also accepts any other keyword."""
    try:
        parameters = signature(kind).parameters.values()
    except (ValueError, TypeError):  # a callable written in C has no signature
        return (), True
    is_open = any(parameter.kind is Parameter.VAR_KEYWORD for parameter in parameters)
    return tuple(p.name for p in parameters if p.kind is not Parameter.VAR_KEYWORD), is_open


def _source_of(kind: Any, arguments: Container[str]) -> str:
    """Return the name of the parameter of ``kind`` that takes the data source.

    Returns "" if there is no such parameter or if ``arguments`` already sets it.
    """
    if not is_objective(kind):
        return ""
    names, _ = _parameters(kind)
    return next((name for name in kind.sources if name in names and name not in arguments), "")


def is_objective(kind: Any) -> bool:
    """Return whether ``kind`` is a subclass of Objective.

    For a function that builds an objective, the result is False.
    """
    return isinstance(kind, type) and issubclass(kind, Objective)


def not_an_objective(target: str) -> str:
    """Return the error message for a ``target`` that is not an objective."""
    return (
        f"{target} is not an objective. Make it a subclass of mitigate.training.objective."
        'Objective (recipes/README.md, "A new objective").'
    )


def check_weights(**weights: float) -> None:
    """Raise ValueError unless each weight of a loss is from 0 (disabled) to ``WEIGHT``."""
    for name, value in weights.items():
        if not in_range(value, 0, WEIGHT):
            raise ValueError(
                f"{name} must be a number from 0 to {WEIGHT:g}, got {number_text(value)}. "
                "It is the weight of a loss; 0 disables the loss."
            )


def check_counts(**counts: int) -> None:
    """Raise ValueError for a count below 1."""
    for name, value in counts.items():
        if type(value) is not int or value < 1:
            raise ValueError(f"{name} must be a whole number >= 1, got {value!r:.80}.")


class Job(NamedTuple):
    """A job that makes some of the items in a step's batch.

    Attributes:
        step: training step.
        number: index of the job.
        jobs: number of jobs in the step.
        items: number of items that the job makes.
    """

    step: int
    number: int
    jobs: int
    items: int


def divide(step: int, items: int, jobs: int) -> list[Job]:
    """Divide the ``items`` of a step evenly among ``jobs`` jobs."""
    parts = np.array_split(np.arange(items), jobs)
    return [Job(step, number, jobs, len(part)) for number, part in enumerate(parts)]


def check_share(name: str, value: float) -> None:
    """Raise ValueError unless ``value`` is a fraction from 0 to 1."""
    if not in_range(value, 0, 1):
        raise ValueError(
            f"{name} must be a fraction from 0 to 1, such as 0.5, got {number_text(value)}."
        )
