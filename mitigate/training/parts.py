"""Which parts of an agent train, and the teachers made of agents."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from torch import nn
from torch.nn.modules.batchnorm import _NormBase

from mitigate.agents.adapter_layers import FrameGate
from mitigate.agents.adapters import WEIGHTS as ADAPTERS_FILE
from mitigate.agents.adapters import adapter_parameters, adapters_of
from mitigate.agents.agent import Trainable, as_agent
from mitigate.core import checkpoint
from mitigate.core.contracts import lacking
from mitigate.core.files import find
from mitigate.core.names import unknown

ADAPTERS = "adapters"  # in a list of parts: all of them, wherever they are
POLICY = "policy"  # in place of a list of parts: all but the encoders
TRAINABLE = ("parts", "collect", "join", "decide")  # what an agent has that learns on episodes
SEEING = ("parts", "encoders", "labels", "see")  # ... whose encoders learn on single observations
OWN = "Choose an agent that has these (docs/agents.md), or give it these (docs/bring-your-own.md)."
START = "start"  # as a teacher: the agent as it is when the stage begins


def policy_parts(agent: Any) -> list[str]:
    """The names of an agent's parts that are not its encoders (``agents/agent.py``: Seeing)."""
    encoders = {name for names in as_agent(agent).encoders.values() for name in names}
    return [name for name in agent.parts() if name not in encoders]


def train_only(agent: nn.Module, parts: Iterable[str] | str | None) -> None:
    """Freeze all of ``agent`` but ``parts``, names of its ``parts()``; "policy": all but the
    encoders; None: all train.

    Adapters train only if "adapters" is named, wherever they are. Raises ValueError for an unknown
    part, for parameters that are in no part, for adapters with gates, which no episode teaches, and
    for an agent that is not trainable.
    """
    if not isinstance(agent, Trainable):
        absent = lacking(agent, TRAINABLE)
        raise ValueError(
            f"{type(agent).__name__} cannot be trained on episodes: it has no "
            f"{', '.join(absent)} (mitigate/agents/agent.py, docs/bring-your-own.md)."
        )
    own = agent.parts()
    parts = policy_parts(agent) if parts == POLICY else tuple(own if parts is None else parts)
    for part in parts:
        if part not in (*own, ADAPTERS):
            raise ValueError(unknown("part of the agent", part, (*own, ADAPTERS)))
    held = {id(p) for module in own.values() for p in module.parameters()}
    stray = [name for name, p in agent.named_parameters() if id(p) not in held]
    if stray:
        raise ValueError(
            f"parts() of {type(agent).__name__} leaves out {', '.join(stray[:4])}: every parameter "
            "belongs to a part, or nobody could say whether it trains."
        )
    if ADAPTERS in parts:
        refuse_gates(agent)
    for name, module in own.items():
        module.requires_grad_(name in parts)
    freeze(agent)
    for parameter in adapter_parameters(agent):
        parameter.requires_grad_(ADAPTERS in parts)


def refuse_gates(module: nn.Module) -> None:
    """Raise ValueError if adapters of ``module`` have a gate: only random views with their clean
    ones beside them (``recipes/adapt.py``) teach it when to open."""
    if any(isinstance(adapter, FrameGate) for adapter in adapters_of(module)):
        raise ValueError(
            "Nothing in this recipe teaches the gates of agent.adapters.gates when to open: leave "
            "them out, or choose recipe=harden or conv_adapter."
        )


def freeze(agent: nn.Module) -> None:
    """Freeze what an agent calls ``frozen``, but for adapters."""
    for name in as_agent(agent).frozen:
        module = agent.get_submodule(name)
        adapters = {id(p) for p in adapter_parameters(module)}
        for parameter in module.parameters():
            if id(parameter) not in adapters:
                parameter.requires_grad_(False)


def hold_statistics(module: nn.Module, around: Sequence[nn.Parameter] = ()) -> None:
    """Put the frozen normalisations with running statistics (BatchNorm) below ``module`` in eval
    mode: in training mode every batch moves these, though no weight trains. One without weights of
    its own is frozen if all are of the nearest module around it that has some, but for adapters
    (``around``: those of a module above)."""
    own = [p for name, p in module.named_parameters() if checkpoint.ADAPTER not in f".{name}"]
    around = own or around
    for child in module.children():
        hold_statistics(child, around)
        if isinstance(child, _NormBase):
            judged = [*child.parameters()] or around
            frozen = bool(judged) and not any(p.requires_grad for p in judged)
            child.train(child.training and not frozen)


def load_teacher(agent: nn.Module, weights: str | None) -> nn.Module:
    """A frozen copy of ``agent`` without its adapters, with ``weights``: a file or folder, or
    "start" for those that ``agent`` has now.

    Raises ValueError for weights that are adapters alone or do not fit, FileNotFoundError for
    weights that are not there.
    """
    if weights is None:
        raise ValueError(
            f"No teacher is shipped for {type(agent).__name__}: train one, such as by `make train "
            "RECIPE=da_per_episode`, and name its folder (teacher=runs/.../agent), or "
            "name the agent as it is now: start."
        )
    if (find(weights) / ADAPTERS_FILE).is_file():
        raise ValueError(
            f"{weights} holds adapters alone, and a teacher needs whole weights: name a folder "
            f"with {checkpoint.WEIGHTS}, such as checkpoints/teacher."
        )
    teacher = as_agent(agent).as_teacher()
    if weights != START:
        try:
            checkpoint.load_weights(teacher, find(weights))
        except FileNotFoundError as error:
            raise FileNotFoundError(
                f"There is no teacher at {weights}. Train one with `make train "
                "RECIPE=da_per_episode` and name its folder (teacher=runs/.../agent)."
            ) from error
    return teacher.requires_grad_(False).eval()
