"""Policies from other libraries as actor-critics, for reinforcement learning.

:class:`ActorCritic` adds a critic to a :class:`~mitigate.agents.policies.policy.Policy`: an
estimate of the return from the current frame to the end of the episode.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn
from torch.distributions import Categorical, Distribution

from mitigate.agents.policies.answers import DISCRETE
from mitigate.agents.policies.policy import Policy, copied
from mitigate.agents.policies.stable_baselines import StableBaselinesPolicy

HIDDEN = 64  # width of a new critic, the default of stable-baselines3


class Joint(Distribution):
    """The distribution of whole actions, made from the distributions of their parts.

    A sample of discrete actions has the shape [B] or [B, n] and holds indices, even for one-hot
    parts. A sample of continuous actions has the shape [B, ...].
    """

    def __init__(self, parts: Sequence[Distribution]) -> None:
        self.parts = [
            Categorical(logits=part.logits) if isinstance(part, DISCRETE) else part
            for part in parts
        ]
        super().__init__(self.parts[0].batch_shape[:1], validate_args=False)

    def sample(self, sample_shape: Any = ()) -> Tensor:
        samples = [part.sample(sample_shape) for part in self.parts]
        return samples[0] if len(samples) == 1 else torch.stack(samples, -1)

    def log_prob(self, value: Tensor) -> Tensor:
        """Return the logarithm of the probability (density) of each action, [B]."""
        values = [value] if len(self.parts) == 1 else value.unbind(-1)
        return sum(
            _per_action(part.log_prob(one)) for part, one in zip(self.parts, values, strict=True)
        )  # type: ignore[return-value]

    def entropy(self) -> Tensor:
        """Return the entropy of each action's distribution, [B].

        Raises:
            ValueError: If the distribution of a part has no known entropy.
        """
        try:
            return sum(_per_action(part.entropy()) for part in self.parts)  # type: ignore[return-value]
        except NotImplementedError:
            names = ", ".join(type(part).__name__ for part in self.parts)
            raise ValueError(
                f"The entropy of the policy's distribution ({names}) is unknown. Disable "
                "the entropy bonus: w_entropy=0."
            ) from None


class ActorCritic(nn.Module):
    """A policy with a critic.

    For a policy of stable-baselines3, the new critic starts as a copy of the critic in the policy.
    Other policies get a new critic, a small network that reads the output of one of the policy's
    modules. Training the critic does not train modules of the policy, so that wrong values cannot
    change the actions directly.

    Args:
        policy: the policy. It is not copied.
        frames: an example frame [1, ...] for each sensor; the frames determine the input size of a
            new critic.
        module: name of the module of the network whose output a new critic reads.

    Raises:
        ValueError: If the policy has a memory, or returns no distribution of its actions.
    """

    def __init__(self, policy: Policy, frames: Mapping[str, np.ndarray], module: str) -> None:
        super().__init__()
        if policy.recurrent:
            raise ValueError(
                f"{policy.name} has a memory, and method='ppo' trains only policies without one. "
                "Use method='self_distil'."
            )
        self.policy = policy
        self.module = module
        network: Any = policy.network
        if isinstance(policy, StableBaselinesPolicy) and not hasattr(network, "predict_values"):
            raise ValueError(
                f"{policy.name} has no state-value critic, which method='ppo' needs. Policies of "
                "PPO and A2C have one. For this policy, use method='self_distil'."
            )
        with torch.no_grad():
            self.actions(frames)
            self.critic: nn.Module = (
                _StableBaselinesCritic(network)
                if isinstance(policy, StableBaselinesPolicy)
                else _new_critic(self._features(frames).shape[1])
            )
        self.critic.to(policy.device)

    def actions(self, frames: Mapping[str, np.ndarray]) -> Joint:
        """Return the action distribution; ``frames`` maps each sensor to an array [B, ...]."""
        answer = self.policy.answers(frames)[0]
        if isinstance(answer, Tensor):
            raise ValueError(
                f"{self.policy.name} returns actions or their values, but method='ppo' needs a "
                "distribution of actions, such as a torch.distributions.Normal. Give forward= a "
                "function that returns one, or use method='self_distil'."
            )
        return Joint(answer)

    def values(self, frames: Mapping[str, np.ndarray]) -> Tensor:
        """Return the critic's values [B, 1]; ``frames`` maps each sensor to an array [B, ...]."""
        return self.critic(self._features(frames))

    @torch.no_grad()
    def _features(self, frames: Mapping[str, np.ndarray]) -> Any:
        """Return the input of the critic, without gradients."""
        if isinstance(self.policy, StableBaselinesPolicy):
            network: Any = self.policy.network
            arrays = {name: frames[name] for name in self.policy.sensors}
            inputs, _ = network.obs_to_tensor(self.policy.native(arrays))
            return network.extract_features(inputs, network.vf_features_extractor)
        with self.policy.recording(self.module) as outputs:
            self.policy.answers(frames)
        return outputs[-1].float().flatten(1)

    def copied(self) -> ActorCritic:
        """Return a frozen copy with its own weights."""
        twin = copy.copy(self)
        twin._modules = {"policy": copied(self.policy), "critic": copy.deepcopy(self.critic)}
        return twin.requires_grad_(False)


class _StableBaselinesCritic(nn.Module):
    """A copy of the critic of a stable-baselines3 policy; the input is the extracted features."""

    def __init__(self, network: Any) -> None:
        super().__init__()
        self.layers = copy.deepcopy(network.mlp_extractor)
        self.head = copy.deepcopy(network.value_net)
        self.requires_grad_(True)

    def forward(self, features: Tensor) -> Tensor:
        return self.head(self.layers.forward_critic(features))


def _new_critic(size: int) -> nn.Module:
    return nn.Sequential(nn.Linear(size, HIDDEN), nn.Tanh(), nn.Linear(HIDDEN, 1))


def _per_action(values: Tensor) -> Tensor:
    """Return the sum [B] of ``values`` [B, ...] over the components of each action."""
    return values.flatten(1).sum(1) if values.dim() > 1 else values
