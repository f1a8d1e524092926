"""From a config to objects: the only place that instantiates ``_target_`` nodes.

Only configs of this checkout are ever built; a config that came with downloaded weights is read
as data, because a ``_target_`` in it could run anything.
"""

from __future__ import annotations

from typing import Any

from hydra.errors import InstantiationException
from hydra.utils import instantiate
from omegaconf import DictConfig
from torch import nn

from mitigate import checkpoint, seeding


def build(node: DictConfig, **given: Any) -> Any:
    """Return the object that ``node`` describes; ``given`` are further keyword arguments.

    Lists and mappings inside arrive as plain lists and dicts. The ValueError or FileNotFoundError
    of a constructor reaches the user as it was raised.
    """
    try:
        make = instantiate(node, _partial_=True, _convert_="all")
        return make(**given)  # not through instantiate, which would copy what is given
    except InstantiationException as error:
        cause = error.__cause__
        while isinstance(cause, InstantiationException):
            cause = cause.__cause__
        if isinstance(cause, (ValueError, FileNotFoundError)):
            raise cause from error
        raise


def build_agent(node: DictConfig, *, weights: str | None, seed: int) -> nn.Module:
    """Return the agent of ``node``, its first weights drawn from ``seed`` or read from a file."""
    seeding.seed_everything(seed, "agent")
    agent = build(node)
    if weights is not None:
        checkpoint.load_agent(agent, weights)
    return agent
