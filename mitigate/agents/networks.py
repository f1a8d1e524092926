"""Find the networks of an agent, which may be any Python object, and set their mode."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from torch import nn

from mitigate.agents.state import read_state


def networks(agent: Any) -> list[nn.Module]:
    """Return the networks that ``agent`` contains, or ``agent`` itself if it is a network."""
    return [net for _, net in read_state(agent, attributes=False).networks]


@contextmanager
def in_eval_mode(agent: Any) -> Iterator[None]:
    """Put every network of ``agent`` into eval mode, and restore the previous modes of all modules
    at the end.

    Each network's ``eval()`` is called, because a class may override it.
    """
    roots = [net for net in networks(agent) if _has_mode(net)]
    modules = [module for net in roots for module in net.modules() if _has_mode(module)]
    modes = {module: module.training for module in modules}
    for net in roots:
        net.eval()
    try:
        yield
    finally:
        for net in roots:
            net.train(modes[net])
        for module, training in modes.items():
            module.training = training


def _has_mode(module: nn.Module) -> bool:
    return hasattr(module, "training")  # an exported program has no such method
