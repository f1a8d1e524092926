"""Choose which parts of an agent are trained, and build teachers from agents."""

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
from mitigate.core.contracts import missing_members
from mitigate.core.files import find
from mitigate.core.names import unknown
from mitigate.core.pretrained import LORA

ADAPTERS = "adapters"  # name of the part that contains all adapters of the agent
# value that selects all parts except the encoders; used instead of a list of parts
POLICY = "policy"
# members that an agent needs for training on episodes
TRAINABLE = ("parts", "collect", "join", "decide")
# members that an agent needs for training its encoders on single observations
SEEING = ("parts", "encoders", "labels", "see")
OWN = "Choose an agent that has these (docs/agents.md), or give it these (docs/bring-your-own.md)."
START = "start"  # value of teacher= that selects a copy of the agent at the start of the stage


def policy_parts(agent: Any) -> list[str]:
    """Return the names of an agent's parts that are not encoders."""
    encoders = {name for names in as_agent(agent).encoders.values() for name in names}
    return [name for name in agent.parts() if name not in encoders]


def train_only(agent: nn.Module, parts: Iterable[str] | str | None) -> None:
    """Freeze every parameter of ``agent`` outside ``parts``.

    Adapters are trained only if "adapters" is one of the parts.

    Args:
        agent: the agent.
        parts: names from ``agent.parts()``; "policy" means all parts except the encoders. If it is
            None, all parts are selected.

    Raises:
        ValueError: If a part is unknown, if a parameter belongs to no part, or if the agent is not
            trainable. It is also raised if adapters with gates are to be trained, because gates
            cannot be trained on episodes.
    """
    if not isinstance(agent, Trainable):
        absent = missing_members(agent, TRAINABLE)
        raise ValueError(
            f"{type(agent).__name__} cannot be trained on episodes: it does not define "
            f"{', '.join(absent)} (mitigate/agents/agent.py, docs/bring-your-own.md)."
        )
    modules = agent.parts()
    parts = policy_parts(agent) if parts == POLICY else tuple(modules if parts is None else parts)
    for part in parts:
        if part not in (*modules, ADAPTERS):
            raise ValueError(unknown("part of the agent", part, (*modules, ADAPTERS)))
    known = {id(p) for module in modules.values() for p in module.parameters()}
    missing = [name for name, p in agent.named_parameters() if id(p) not in known]
    if missing:
        raise ValueError(
            f"parts() of {type(agent).__name__} leaves out {', '.join(missing[:4])}: every "
            "parameter must belong to a part, so that it is clear whether it is trained."
        )
    if ADAPTERS in parts:
        refuse_gates(agent)
    for name, module in modules.items():
        for parameter in module.parameters():  # quantised weights cannot have gradients
            parameter.requires_grad_(name in parts and parameter.is_floating_point())
    freeze(agent)
    for parameter in adapter_parameters(agent):
        parameter.requires_grad_(ADAPTERS in parts)


def refuse_gates(module: nn.Module) -> None:
    """Raise ValueError if adapters of ``module`` have a gate.

    Gates can be trained only on pairs of corrupted and clean views (``recipes/adapt.py``).
    """
    if any(isinstance(adapter, FrameGate) for adapter in adapters_of(module)):
        raise ValueError(
            "This recipe cannot train the gates of agent.adapters.gates. Leave them out, or choose "
            "recipe=harden or conv_adapter."
        )


def freeze(agent: nn.Module) -> None:
    """Freeze the modules that an agent lists in ``frozen``, except their adapters and LoRA."""
    for name in as_agent(agent).frozen:
        module = agent.get_submodule(name)
        adapters = {id(p) for p in adapter_parameters(module)}
        adapters |= {id(p) for place, p in module.named_parameters() if LORA in place}
        for parameter in module.parameters():
            if id(parameter) not in adapters:
                parameter.requires_grad_(False)


def hold_statistics(module: nn.Module, around: Sequence[nn.Parameter] = ()) -> None:
    """Set eval mode for the frozen BatchNorm layers in ``module``.

    In training mode, every batch would change their running statistics, although no weight is
    trained. A normalisation layer may have no weights. Such a layer counts as frozen if all weights
    of the nearest enclosing module that has weights are frozen. Adapters are ignored.

    Args:
        module: the module.
        around: weights of the enclosing module, which decide if ``module`` has no weights.
    """
    weights = [p for name, p in module.named_parameters() if checkpoint.ADAPTER not in f".{name}"]
    around = weights or around
    for child in module.children():
        hold_statistics(child, around)
        if isinstance(child, _NormBase):
            relevant = [*child.parameters()] or around
            frozen = bool(relevant) and not any(p.requires_grad for p in relevant)
            child.train(child.training and not frozen)


def load_teacher(agent: nn.Module, weights: str | None) -> nn.Module:
    """Return a frozen copy of ``agent`` without its adapters.

    Args:
        agent: the agent.
        weights: a file or folder with the weights of the teacher, or "start" for the current
            weights.

    Raises:
        ValueError: If the weights contain only adapters, or do not match the agent.
        FileNotFoundError: If the weights do not exist.
    """
    if weights is None:
        raise ValueError(
            f"No teacher is shipped for {type(agent).__name__}. Train one, for example with `make "
            "train RECIPE=da_per_episode`, and set teacher=runs/.../agent. Or set teacher=start to "
            "use the agent at the start of the stage."
        )
    if (find(weights) / ADAPTERS_FILE).is_file():
        raise ValueError(
            f"{weights} holds only adapters, but a teacher needs complete weights. Choose a folder "
            f"with {checkpoint.WEIGHTS}, such as checkpoints/teacher."
        )
    teacher = as_agent(agent).as_teacher()
    if weights != START:
        try:
            checkpoint.load_agent(teacher, find(weights))
        except FileNotFoundError as error:
            raise FileNotFoundError(
                f"There is no teacher at {weights}. Train a teacher with `make train "
                "RECIPE=da_per_episode` and set teacher=runs/.../agent."
            ) from error
    return teacher.requires_grad_(False).eval()
