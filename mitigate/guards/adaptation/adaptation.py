"""Base class of guards that adapt an agent to the frames of the current episode."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from typing import Any

import torch
from torch import Tensor, nn

from mitigate.agents.fingerprint import hash_of
from mitigate.agents.networks import networks
from mitigate.guards.adaptation.choices import EPISODE, NEVER, check_reset
from mitigate.guards.guard import Guard

NO_LAYER = (
    "Choose adapt=recentre, which needs none and shifts features back to their mean on clean frames"
)


class Adaptation(Guard):
    """A guard that changes tensors of an agent while an episode runs, and then restores them.

    A subclass defines :meth:`tensors`, :meth:`adapting`, :meth:`settings` and :meth:`check_agent`.

    Args:
        reset: with "episode", each episode starts from the agent's original weights. With "never",
            an episode starts from the adapted tensors of the previous episode; only the first
            episode of each condition starts from the original weights.

    Attributes:
        kind: name of the method in fingerprints and columns.
        code: version of the method, which is increased whenever its results change.
    """

    frames: Sequence[str] = ()
    kind = ""
    code = 1

    def __init__(self, reset: str = EPISODE) -> None:
        self.reset = check_reset(reset)
        self.label = self.kind if reset == EPISODE else f"{self.kind}-{reset}"
        self._adapted: list[Tensor] | None = None

    @property
    def continual(self) -> bool:  # type: ignore[override]
        return self.reset == NEVER

    def restart(self) -> None:
        self._adapted = None

    def settings(self) -> dict[str, Any]:
        """Return the settings that determine the adaptation."""
        return {"reset": self.reset}

    def fingerprint(self) -> str:
        parts = {"settings": self.settings(), "code": self.code, "version": self.version}
        return f"{self.kind}-{hash_of(parts, {})}"

    def tensors(self, agent: Any) -> list[Tensor]:
        """Return the tensors that the adaptation changes during an episode, in a fixed order."""
        raise NotImplementedError(f"{type(self).__name__} defines no tensors(agent)")

    def adapting(self, agent: Any) -> AbstractContextManager[None]:
        """Return a context in which the agent adapts."""
        raise NotImplementedError(f"{type(self).__name__} defines no adapting(agent)")

    @contextmanager
    def attach(self, agent: Any) -> Iterator[None]:
        tensors = self.tensors(agent)
        before = [tensor.detach().clone() for tensor in tensors]
        try:
            if self._adapted is not None:
                _fill(tensors, self._adapted)
            with self.adapting(agent):
                yield
            if self.continual:
                self._adapted = [tensor.detach().clone() for tensor in tensors]
        finally:
            _fill(tensors, before)


@torch.no_grad()
def _fill(tensors: Sequence[Tensor], values: Sequence[Tensor]) -> None:
    for tensor, value in zip(tensors, values, strict=True):
        tensor.copy_(value)


def modules_of(agent: Any) -> list[nn.Module]:
    """Return all modules of an agent's networks, in order and without repeats."""
    roots = [agent] if isinstance(agent, nn.Module) else networks(agent).values()
    return [*dict.fromkeys(module for root in roots for module in root.modules())]
