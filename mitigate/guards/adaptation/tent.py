"""``adapt=tent``: adapt normalisation layers so that decisions become more certain.

After each decision, a gradient step lowers the entropy of the distribution of actions. Only the
scales and shifts of normalisation layers change (TENT, Wang et al. 2021). The published method also
uses the statistics of the test frames; ``adapt=norm+tent`` does the same.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import torch
from torch import Tensor, nn
from torch.nn.modules.batchnorm import _NormBase

from mitigate.agents.agent import KnowsEntropy
from mitigate.agents.policies.policy import Policy
from mitigate.core.spaces import Box
from mitigate.guards.adaptation.adaptation import NO_LAYER, Adaptation, modules_of
from mitigate.guards.adaptation.choices import EPISODE

LAYERS = (_NormBase, nn.GroupNorm, nn.LayerNorm)


class Tent(Adaptation):
    """Lower the entropy of the agent's decisions by gradient descent.

    The agent must have a method ``entropy(observation)`` (``KnowsEntropy`` in ``agents/agent.py``).

    Args:
        lr: learning rate. With 0, the weights do not change.
        reset: see :class:`Adaptation`.

    Raises:
        ValueError: If ``lr`` or ``reset`` is invalid.
    """

    kind = "tent"

    def __init__(self, lr: float = 1e-3, reset: str = EPISODE) -> None:
        super().__init__(reset)
        if not 0 <= lr < math.inf:
            raise ValueError(f"lr must be >= 0, got {lr!r:.80}.")
        self.lr = lr

    def settings(self) -> dict[str, Any]:
        return {**super().settings(), "lr": self.lr}

    def check_agent(self, agent: Any) -> None:
        if not isinstance(agent, KnowsEntropy):
            raise ValueError(
                f"adapt=tent needs the entropy of decisions, and {type(agent).__name__} has no "
                "entropy(observation) (mitigate/agents/agent.py). Choose adapt=recentre."
            )
        if isinstance(agent, Policy) and isinstance(agent.space, Box):
            raise ValueError(
                f"adapt=tent lowers the entropy of discrete actions, but the actions of "
                f"{agent.name} are continuous. Choose adapt=norm or adapt=recentre."
            )
        if not self.tensors(agent):
            raise ValueError(
                f"adapt=tent trains the scales and shifts of normalisation layers, and "
                f"{type(agent).__name__} has none. {NO_LAYER}."
            )

    def tensors(self, agent: Any) -> list[Tensor]:
        layers = [module for module in modules_of(agent) if isinstance(module, LAYERS)]
        return [parameter for layer in layers for parameter in layer.parameters(recurse=False)]

    @contextmanager
    def adapting(self, agent: Any) -> Iterator[None]:
        adapted = self.tensors(agent)
        # All weights require gradients: otherwise GroupNorm's backward pass may crash the process.
        # This happens for channels_last input that requires no gradient (torch 2.13, CPU).
        weights = dict.fromkeys(
            parameter
            for module in modules_of(agent)
            for parameter in module.parameters(recurse=False)
            if parameter.is_floating_point()
        )
        states = [(weight, weight.requires_grad, weight.grad) for weight in weights]
        act = agent.act

        def act_and_adapt(observation: Any) -> Any:
            action = act(observation)
            for weight in weights:
                weight.grad = None
            with torch.enable_grad():
                entropy = agent.entropy(observation)
                if entropy is not None:
                    entropy.backward()
            self._step(adapted)
            return action

        agent.act = act_and_adapt
        for weight in weights:
            weight.requires_grad_(True)
        try:
            yield
        finally:
            del agent.act
            for weight, trains, gradient in states:
                weight.requires_grad_(trains)
                weight.grad = gradient

    @torch.no_grad()
    def _step(self, adapted: list[Tensor]) -> None:
        """Take a gradient descent step, unless a gradient is not finite."""
        pairs = [(weight, weight.grad) for weight in adapted if weight.grad is not None]
        if all(torch.isfinite(gradient).all() for _, gradient in pairs):
            for weight, gradient in pairs:
                weight.sub_(gradient, alpha=self.lr)
