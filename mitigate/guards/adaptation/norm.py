"""``adapt=norm``: update the statistics of BatchNorm layers with the frames of the episode.

A BatchNorm layer normalises its input with the mean and variance of the training data. Under
corruption, the input has a different mean and variance (Schneider et al. 2020). Before each call of
a layer, this guard moves its two statistics towards the statistics of the current input.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import Any

import torch
from torch import Tensor
from torch.nn.modules.batchnorm import _BatchNorm

from mitigate.guards.adaptation.adaptation import NO_LAYER, Adaptation, modules_of
from mitigate.guards.adaptation.choices import EPISODE


class Norm(Adaptation):
    """Move the statistics of BatchNorm layers towards the statistics of the episode.

    Args:
        momentum: weight of the current input, from 0 to 1. With 0, the statistics do not change.
        reset: see :class:`Adaptation`.

    Raises:
        ValueError: If ``momentum`` or ``reset`` is invalid.
    """

    kind = "norm"

    def __init__(self, momentum: float = 0.1, reset: str = EPISODE) -> None:
        super().__init__(reset)
        if not 0 <= momentum <= 1:
            raise ValueError(f"momentum must be from 0 to 1, got {momentum!r:.80}.")
        self.momentum = momentum

    def settings(self) -> dict[str, Any]:
        return {**super().settings(), "momentum": self.momentum}

    def check_agent(self, agent: Any) -> None:
        if not _layers(agent):
            raise ValueError(
                f"adapt=norm estimates the statistics of BatchNorm layers, and "
                f"{type(agent).__name__} has none with running statistics. {NO_LAYER}."
            )

    def tensors(self, agent: Any) -> list[Tensor]:
        return [t for layer in _layers(agent) for t in (layer.running_mean, layer.running_var)]

    @contextmanager
    def adapting(self, agent: Any) -> Iterator[None]:
        with ExitStack() as hooks:
            for layer in _layers(agent):
                hooks.enter_context(layer.register_forward_pre_hook(self._update))
            yield

    def _update(self, layer: Any, inputs: tuple[Tensor, ...]) -> None:
        # Tent runs the network a second time with gradients; do not count the same input twice
        if torch.is_grad_enabled():
            return
        values = inputs[0].detach().float().movedim(1, 0).flatten(1)
        layer.running_mean.lerp_(values.mean(1), self.momentum)
        if values.shape[1] > 1:
            layer.running_var.lerp_(values.var(1), self.momentum)


def _layers(agent: Any) -> list[Any]:
    return [
        module
        for module in modules_of(agent)
        if isinstance(module, _BatchNorm) and module.running_mean is not None
    ]
