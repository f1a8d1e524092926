"""Which parts of an agent train, and the teachers made of agents."""

from __future__ import annotations

import copy
from collections.abc import Iterable
from typing import Any

from torch import nn

from mitigate.agents.adapters import WEIGHTS as ADAPTERS_FILE
from mitigate.agents.adapters import adapter_parameters, remove_adapters
from mitigate.core import checkpoint
from mitigate.core.files import find
from mitigate.core.names import unknown

ADAPTERS = "adapters"  # in a list of parts: those in frozen modules
START = "start"  # as a teacher: the agent as it is when the stage begins


def train_only(agent: Any, parts: Iterable[str]) -> None:
    """Freeze all of ``agent`` but ``parts``, names of its ``parts()``.

    A module's adapters train with it; "adapters" trains those in frozen modules as well. Raises
    ValueError for an unknown part.
    """
    own, parts = agent.parts(), tuple(parts)
    for part in parts:
        if part not in (*own, ADAPTERS):
            raise ValueError(unknown("part of the agent", part, (*own, ADAPTERS)))
    for name, module in own.items():
        module.requires_grad_(name in parts)
    for parameter in adapter_parameters(agent) if ADAPTERS in parts else ():
        parameter.requires_grad_(True)


def load_teacher(agent: nn.Module, weights: str) -> nn.Module:
    """A frozen copy of ``agent`` without its adapters, with ``weights``: a file or folder, or
    "start" for those that ``agent`` has now.

    Raises ValueError for weights that are adapters alone or do not fit, FileNotFoundError for
    weights that are not there.
    """
    if (find(weights) / ADAPTERS_FILE).is_file():
        raise ValueError(
            f"{weights} holds adapters alone, and a teacher needs whole weights: name a folder "
            f"with {checkpoint.WEIGHTS}, such as checkpoints/teacher."
        )
    teacher = without_adapters(agent)
    if weights != START:
        try:
            checkpoint.load_weights(teacher, find(weights))
        except FileNotFoundError as error:
            raise FileNotFoundError(
                f"There is no teacher at {weights}. Train one with `make train "
                "RECIPE=da_per_episode` and name its folder "
                "(stages.views_rgb.recipe.teacher=runs/.../agent: the other stages follow)."
            ) from error
    return teacher.requires_grad_(False).eval()


def without_adapters(agent: nn.Module) -> nn.Module:
    """A copy of ``agent`` without what was added to make it robust: ``agent.as_teacher()``, if it
    has that."""
    if hasattr(agent, "as_teacher"):
        return agent.as_teacher()
    copied = copy.deepcopy(agent)
    remove_adapters(copied)
    return copied
