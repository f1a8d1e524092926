"""Policies of stable-baselines3 and sb3-contrib."""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor
from torch.distributions import TransformedDistribution

from mitigate.agents.policies.answers import Answer, parts
from mitigate.agents.policies.policy import Policy
from mitigate.core.spaces import ActionSpace, Box


class StableBaselinesPolicy(Policy):
    """A policy of stable-baselines3 or sb3-contrib.

    PPO, A2C, RecurrentPPO, SAC and TQC return a distribution of actions. DDPG and TD3 return an
    action. DQN returns the values of all actions.
    """

    def __init__(self, network: Any, native: Any, space: ActionSpace) -> None:
        super().__init__(network, native, space)
        self.recurrent = hasattr(network, "lstm_actor")

    def answer(self, observation: Any, memory: Any = None) -> tuple[Answer, Any]:
        policy: Any = self.network
        inputs, _ = policy.obs_to_tensor(observation)
        if self.recurrent:
            return self._recurrent(inputs, memory)
        if hasattr(policy, "get_distribution"):
            return parts(policy.get_distribution(inputs).distribution), None
        if hasattr(policy, "q_net"):
            return policy.q_net(inputs), None
        if hasattr(policy.actor, "get_action_dist_params"):
            mean, log_std, _ = policy.actor.get_action_dist_params(inputs)
            tanh = torch.distributions.TanhTransform(cache_size=1)
            normal = torch.distributions.Normal(mean, log_std.exp())
            return [TransformedDistribution(normal, tanh)], None
        return policy.actor(inputs), None

    def _recurrent(self, inputs: Any, memory: Any) -> tuple[Answer, Any]:
        policy: Any = self.network
        count = len(next(iter(inputs.values())) if isinstance(inputs, dict) else inputs)
        layers, _, size = policy.lstm_hidden_state_shape
        starts = torch.zeros(count, device=policy.device)
        if memory is None:
            memory = (torch.zeros(layers, count, size, device=policy.device),) * 2
        distribution, memory = policy.get_distribution(inputs, memory, starts)
        return parts(distribution.distribution), memory

    def executable(self, chosen: Tensor) -> Any:
        policy: Any = self.network
        if policy.squash_output and isinstance(self.space, Box):
            return policy.unscale_action(chosen.cpu().numpy()).astype(self.space.low.dtype)
        return super().executable(chosen)
