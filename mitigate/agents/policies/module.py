"""Policies that are plain torch modules."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn
from torch.distributions import Categorical, Distribution

from mitigate.agents.agent import check_logits
from mitigate.agents.policies.answers import Answer, parts
from mitigate.agents.policies.policy import Policy, flat
from mitigate.core.errors import own_place
from mitigate.core.spaces import ActionSpace, Box, Discrete, MultiDiscrete

Forward = Callable[..., Any]
EXAMPLE = "forward=lambda net, x: net.actor(net.network(x.permute(0, 3, 1, 2) / 255.0))"


class ModulePolicy(Policy):
    """A plain ``nn.Module``.

    The policy calls ``forward(network, observation)``, or ``forward(network, observation, memory)``
    if ``recurrent`` is set. For discrete actions, ``forward`` returns logits [B, n]; for continuous
    actions, it returns actions [B, ...]. It may also return a ``torch.distributions`` object or a
    list of these. If ``recurrent`` is set, it also returns the new memory. By default, the network
    itself is called.

    ``observation`` holds batched tensors on the network's device, in the environment's own format.
    A single RGB frame is one tensor, uint8 [B, H, W, 3]. A ``Dict`` is a dict of such tensors.

    Raises:
        ValueError: If the network has no method ``forward`` and the argument ``forward`` is None.
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
        if forward is None and getattr(network.forward, "__func__", None) is nn.Module.forward:
            raise ValueError(
                f"{self.name} must have a method forward that returns {self._expected}. Define it, "
                f"or pass a function that calls the network, such as {EXAMPLE}."
            )
        self._forward = forward
        self.recurrent = recurrent

    def answer(self, observation: Any, memory: Any = None) -> tuple[Answer, Any]:
        inputs = _tensors(observation, self.device)
        arguments = (inputs, memory) if self.recurrent else (inputs,)
        call = self.network if self._forward is None else partial(self._forward, self.network)
        try:
            output = call(*arguments)
        except KeyError as error:
            names = ", ".join(flat(inputs)) if isinstance(inputs, Mapping) else "the frame"
            raise ValueError(
                f"{self.name} reads the entry {error}, but the world passes only "
                f"{names}. Name all entries: GymWorld(entries={{...}})."
            ) from error
        except (MemoryError, torch.OutOfMemoryError):
            raise
        except Exception as error:  # the user's code may raise any error
            place = own_place(error)
            cause = " ".join(str(error).split())[:300]
            raise ValueError(
                f"{self.name} raised {type(error).__name__}: {cause}"
                f"{f' (raised in {place})' if place else ''}. It received {_described(inputs)}. "
                "Frames are uint8 from 0 to 255, with channels last. If the network needs another "
                f"format, convert them in forward=, such as {EXAMPLE}."
            ) from error
        if self.recurrent:
            if not (isinstance(output, (tuple, list)) and len(output) == 2):
                raise ValueError(
                    f"{self.name} must return a pair (output, new memory), because recurrent=True, "
                    f"got {_described(output)}."
                )
            output, memory = output
        if not isinstance(output, Tensor):
            answer = parts(output)
            if not answer or not all(isinstance(part, Distribution) for part in answer):
                raise self._unsupported(output)
            return answer, memory
        if isinstance(self.space, Discrete):
            if output.ndim < 2:
                raise self._unsupported(output)
            return [Categorical(logits=check_logits(output, self))], memory
        if isinstance(self.space, MultiDiscrete):
            counts = self.space.counts.ravel().tolist()
            if output.ndim < 2 or output.shape[-1] != sum(counts):
                raise self._unsupported(output)
            return [Categorical(logits=part) for part in output.split(counts, -1)], memory
        return output, memory

    @property
    def _expected(self) -> str:
        if isinstance(self.space, Discrete):
            values = f"logits [N, {self.space.n}]"
        elif isinstance(self.space, MultiDiscrete):
            values = f"logits [N, {self.space.counts.sum()}]"
        else:
            assert isinstance(self.space, Box), "as_policy rejects other spaces"
            values = f"actions {['N', *self.space.low.shape]}".replace("'", "")
        return f"{values} or a torch.distributions object"

    def _unsupported(self, output: Any) -> ValueError:
        message = f"{self.name} must return {self._expected}, got {_described(output)}. "
        if isinstance(output, (tuple, list)) and not self.recurrent:
            message += "If it also returns a memory, set recurrent=True. "
        return ValueError(
            f"{message}Return only this output (no sampled action) from forward=, such as "
            f"{EXAMPLE}."
        )


def _described(value: Any) -> str:
    """Return the types and shapes of ``value``, as text of limited length."""
    if isinstance(value, Tensor):
        return f"{str(value.dtype).removeprefix('torch.')} {list(value.shape)}"
    if isinstance(value, Mapping):
        entries = [f"{name}: {_described(part)}" for name, part in flat(value).items()]
        return f"a dict ({', '.join(entries)})"[:300]
    if isinstance(value, (tuple, list)):
        return f"a {type(value).__name__} ({', '.join(map(_described, value))})"[:300]
    return f"type {type(value).__name__}"


def _tensors(observation: Any, device: torch.device) -> Any:
    if isinstance(observation, Mapping):
        return {name: _tensors(value, device) for name, value in observation.items()}
    return torch.from_numpy(np.array(observation)).to(device)
