"""Define an agent that wraps a trained policy; all supported libraries share this base class.

The agent reads the frames of a world, converts them back to the environment's own observation
format (``World.native``), and calls the policy. :meth:`Policy.answer` returns the action
distributions for batches of frames. They have gradients, so ``mitigate.harden`` can train the
policy.
"""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn
from torch.distributions import Distribution

from mitigate.agents.agent import Agent, check_logits
from mitigate.agents.policies.answers import Answer, mode
from mitigate.agents.sites import first
from mitigate.core import checkpoint
from mitigate.core.contracts import read
from mitigate.core.spaces import ActionSpace, Box, Discrete, MultiDiscrete


class Policy(Agent, nn.Module):
    """Agent that wraps a trained network with actions of any kind.

    Each supported library has a subclass, which defines ``answer``.

    Args:
        network: all weights of the policy.
        native: converts frames to the environment's own observation (``World.native``).
        space: actions of the world.

    Attributes:
        recurrent: whether the answer depends on earlier observations of the episode.
    """

    recurrent = False
    run_state = ("_memory", "_before")

    def __init__(self, network: nn.Module, native: Any, space: ActionSpace) -> None:
        super().__init__()
        self.network = network
        self.native = native
        self.space = space
        self._memory: Any = None
        self._before: Any = None  # memory before the last action

    def answer(self, observation: Any, memory: Any = None) -> tuple[Answer, Any]:
        """Return the policy's answers for a batch of observations, and its memory after the batch.

        Args:
            observation: the environment's own observation, arrays with a first axis B.
            memory: the policy's memory before this observation; None at the start of an episode.
        """
        raise NotImplementedError(f"{type(self).__name__} defines no answer(observation, memory)")

    def action(self, answer: Answer) -> Any:
        """Return the most probable action for the first item of a batch.

        If the answer is a tensor, it holds the value of each action (discrete actions) or the
        action itself (continuous actions).
        """
        if isinstance(self.space, MultiDiscrete):
            return self.executable(torch.stack([mode(part)[0] for part in answer]))
        first_answer = answer[0] if isinstance(answer, Tensor) else mode(answer[0])[0]
        if isinstance(self.space, Discrete):
            values = answer if isinstance(answer, Tensor) else getattr(answer[0], "logits", None)
            if values is not None and values.shape[-1] != self.space.n:
                raise ValueError(
                    f"{self.name} gives {values.shape[-1]} values for the {self.space.n} actions "
                    "of the environment. Give one per action."
                )
            if isinstance(answer, Tensor):
                first_answer = check_logits(first_answer, self).argmax()
        return self.executable(first_answer)

    def executable(self, chosen: Tensor) -> Any:
        """Convert an action of the network to an action of the world.

        ``chosen`` is, for example, a sample of the network's distribution.
        """
        if isinstance(self.space, MultiDiscrete):
            return chosen.long().cpu().numpy().reshape(self.space.counts.shape)
        if isinstance(self.space, Discrete):
            return int(chosen) + self.space.start
        values = chosen.double().cpu().numpy()
        if not np.isfinite(values).all():
            raise ValueError(f"The action of {self.name} must be finite, got {values.tolist()}.")
        assert isinstance(self.space, Box), "as_policy rejects other spaces"
        values = np.clip(values.reshape(self.space.low.shape), self.space.low, self.space.high)
        return values.astype(self.space.low.dtype)

    @property
    def name(self) -> str:
        """Class name of the policy, for messages and tables."""
        return type(self.network).__name__

    @property
    def version(self) -> str:
        """Version for fingerprints: the class name of the policy and the hash of its weights."""
        return f"{self.name}-{checkpoint.weights_sha(self.network)}"

    @property
    def sensors(self) -> tuple[str, ...]:  # type: ignore[override]
        """The entries of observations that the policy reads."""
        return tuple(self.native.entries)

    @property
    def device(self) -> torch.device:
        """Device of the weights."""
        return next(self.network.parameters()).device

    def settings(self) -> dict[str, Any]:
        """Return the settings that, together with the weights, determine the policy's actions."""
        return {"policy": self.name, "architecture": str(self.network), "native": repr(self.native)}

    def train(self, mode: bool = True) -> Any:
        """Keep the network in eval mode: no dropout, and fixed normalisation statistics."""
        return super().train(False)

    def reset(self, instruction: str) -> None:
        """Start an episode."""
        self._memory = None

    @torch.no_grad()
    def act(self, observation: Mapping[str, Any]) -> Any:
        """Return the most likely action."""
        frames = {name: np.asarray(observation[name])[None] for name in self.sensors}
        self._before = self._memory
        answer, self._memory = self.answer(self.native(frames), self._memory)
        return self.action(answer)

    def entropy(self, observation: Mapping[str, Any]) -> Tensor:
        """Return the entropy of the last action's distribution (``agents/agent.py``).

        Raises:
            ValueError: If the policy returns no distribution of actions.
        """
        frames = {name: np.asarray(observation[name])[None] for name in self.sensors}
        answer = self.answer(self.native(frames), self._before)[0]
        if isinstance(answer, Tensor):
            raise ValueError(
                f"adapt=tent lowers the entropy of actions, but {self.name} returns values "
                "without a distribution. Choose adapt=norm or adapt=recentre."
            )
        return torch.stack([part.entropy().sum() for part in answer]).sum()

    def answers(self, frames: Mapping[str, np.ndarray], length: int = 1) -> list[Answer]:
        """Return the policy's answers for windows of consecutive frames.

        Args:
            frames: maps each sensor to an array [B * length, ...]; the frames of a window are
                consecutive.
            length: frames per window. A recurrent policy starts each window with an empty memory.

        Returns:
            For a recurrent policy, one batch of B answers per position in the window. Otherwise,
            a single batch with the answers for all frames.
        """
        arrays = {name: frames[name] for name in self.sensors}
        if not self.recurrent:
            return [self.answer(self.native(arrays))[0]]
        memory, answers = None, []
        for place in range(length):
            step = {name: array[place::length] for name, array in arrays.items()}
            answer, memory = self.answer(self.native(step), memory)
            answers.append(answer)
        return answers

    @contextmanager
    def recording(self, module: str) -> Iterator[list[Tensor]]:
        """Record the outputs of a module of the network in the list that is yielded."""
        outputs: list[Tensor] = []
        target = self.network.get_submodule(module)
        with target.register_forward_hook(lambda *call: outputs.append(first(call[2]))):
            yield outputs


def _forget(network: nn.Module) -> None:
    """Detach what a network stores from its last call, because graphs cannot be copied."""
    for module in network.modules():
        for name, value in vars(module).items():
            if isinstance(value, Tensor) and value.grad_fn is not None:
                setattr(module, name, value.detach())
        last_call = read(module, "action_dist")  # of stable-baselines3
        for name, value in vars(last_call).items() if last_call else ():
            if isinstance(value, (Tensor, Distribution, list)):
                setattr(last_call, name, None)


def copied(policy: Policy) -> Policy:
    """Return a copy of a policy that shares no weights with the original.

    Raises:
        ValueError: If the network cannot be copied.
    """
    _forget(policy.network)
    try:
        twin = copy.copy(policy)
        twin._modules = {"network": copy.deepcopy(policy.network)}
    except Exception as error:  # the user's code may raise any error
        raise ValueError(
            f"{policy.name} cannot be copied ({type(error).__name__}: {str(error)[:200]}), but "
            "the clean teacher must be a copy. Pass a policy without open files or environments."
        ) from error
    return twin


def last_convolution(policy: Policy) -> str:
    """Return the name of the last convolution, or of the first linear layer if there is none.

    Raises:
        ValueError: If the network has neither a convolution nor a linear layer.
    """
    modules = policy.network.named_modules()
    layers = {n: module for n, module in modules if checkpoint.ADAPTER not in f".{n}."}
    kinds = (nn.Conv1d, nn.Conv2d, nn.Conv3d)
    if convolutions := [n for n, module in layers.items() if isinstance(module, kinds)]:
        return convolutions[-1]
    linear = [n for n, module in layers.items() if isinstance(module, nn.Linear)]
    if not linear:
        raise ValueError(
            f"{policy.name} has no convolution and no linear layer. Name the module whose output "
            "is to be compared: module=..."
        )
    return linear[0]


def flat(observation: Any, prefix: str = "") -> dict[str, Any]:
    """Return a flat dict of the arrays of an observation, by dotted name."""
    if not isinstance(observation, Mapping):
        return {prefix: observation}
    parts: dict[str, Any] = {}
    for name, value in observation.items():
        parts |= flat(value, f"{prefix}.{name}".lstrip("."))
    return parts
