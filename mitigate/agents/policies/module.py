"""Policies that are plain torch modules."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn
from torch.distributions import Categorical

from mitigate.agents.agent import check_logits
from mitigate.agents.policies.answers import Answer, parts
from mitigate.agents.policies.policy import Policy, flat
from mitigate.core.spaces import ActionSpace, Discrete, MultiDiscrete

Forward = Callable[..., Any]


class ModulePolicy(Policy):
    """A plain ``nn.Module``.

    The policy calls ``forward(network, observation)``, or ``forward(network, observation, memory)``
    if ``recurrent`` is set. For discrete actions, ``forward`` returns logits [B, n]; for continuous
    actions, it returns actions [B, ...]. It may also return a ``torch.distributions`` object or a
    list of these. If ``recurrent`` is set, it also returns the new memory. By default, the network
    itself is called. ``observation`` holds tensors on the network's device.
    """

    def __init__(
        self,
        network: nn.Module,
        native: Any,
        space: ActionSpace,
        forward: Forward | None = None,
        recurrent: bool = False,
    ) -> None:
        super().__init__(network, native, space)
        self._forward = forward
        self.recurrent = recurrent

    def answer(self, observation: Any, memory: Any = None) -> tuple[Answer, Any]:
        inputs = _tensors(observation, self.device)
        arguments = (inputs, memory) if self.recurrent else (inputs,)
        call = self.network if self._forward is None else partial(self._forward, self.network)
        try:
            output = call(*arguments)
        except KeyError as error:
            raise ValueError(
                f"{self.name} reads the entry {error}, but the world passes only "
                f"{', '.join(flat(inputs))}. Name all entries: GymWorld(entries={{...}})."
            ) from error
        if self.recurrent:
            output, memory = output
        if not isinstance(output, Tensor):
            return parts(output), memory
        if isinstance(self.space, Discrete):
            return [Categorical(logits=check_logits(output, self))], memory
        if isinstance(self.space, MultiDiscrete):
            counts = self.space.counts.ravel().tolist()
            return [Categorical(logits=part) for part in output.split(counts, -1)], memory
        return output, memory


def _tensors(observation: Any, device: torch.device) -> Any:
    if isinstance(observation, Mapping):
        return {name: _tensors(value, device) for name, value in observation.items()}
    return torch.from_numpy(np.array(observation)).to(device)
