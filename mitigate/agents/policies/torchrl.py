"""Policies of torchrl and tensordict."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import torch
from torch.distributions import Categorical

from mitigate.agents.policies.answers import Answer, parts
from mitigate.agents.policies.policy import Policy, flat
from mitigate.core.spaces import ActionSpace


class TorchrlPolicy(Policy):
    """A policy of torchrl or tensordict: a module with ``in_keys`` and ``out_keys``.

    A probabilistic module returns a distribution of actions. Other modules return ``logits``,
    ``action_value`` or ``action``.
    """

    def __init__(self, network: Any, native: Any, space: ActionSpace) -> None:
        read_keys = {dotted(key) for key in network.in_keys}
        entries = {name: entry for name, entry in native.entries.items() if entry in read_keys}
        super().__init__(network, replace(native, entries=entries or native.entries), space)
        outputs = {dotted(key) for key in network.out_keys}
        # recurrent modules write their new state to the entry "next"
        self._fed_back = [key for key in network.in_keys if f"next.{dotted(key)}" in outputs]
        self.recurrent = bool(self._fed_back)

    def answer(self, observation: Any, memory: Any = None) -> tuple[Answer, Any]:
        from tensordict import TensorDict

        network: Any = self.network
        arrays = flat(observation)
        keys = [key for key in network.in_keys if key not in self._fed_back]
        if list(arrays) == [""]:
            arrays = {dotted(keys[0]): arrays[""]}
        count = len(next(iter(arrays.values())))
        inputs = TensorDict({}, batch_size=[count], device=self.device)
        for key in keys:
            if dotted(key) in arrays:
                inputs[key] = torch.from_numpy(np.array(arrays[dotted(key)])).to(self.device)
        for key, value in (memory or {}).items():
            inputs[key] = value
        if self.recurrent:
            inputs["is_init"] = torch.full((count, 1), memory is None, device=self.device)
        if hasattr(network, "get_dist"):
            return parts(network.get_dist(inputs)), self._next(inputs)
        outputs = network(inputs)
        for key in ("logits", "action_value", "action"):
            if key in outputs:
                values = outputs[key]
                answer = [Categorical(logits=values)] if key == "logits" else values
                return answer, self._next(outputs)
        raise ValueError(
            f"The policy's outputs must contain logits, action_value or action, got "
            f"{', '.join(map(str, outputs.keys()))}. Rename them (out_keys=)."
        )

    def _next(self, outputs: Any) -> Any:
        return {key: outputs["next", key] for key in self._fed_back} or None


def dotted(key: Any) -> str:
    """Return a key of a TensorDict as text, such as ``next.state``."""
    return key if isinstance(key, str) else ".".join(key)
