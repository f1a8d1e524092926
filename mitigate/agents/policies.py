"""Use trained policies of other libraries as agents: stable-baselines3, torchrl, plain torch.

:func:`as_policy` recognises a policy by its methods; no other library is imported. The agent reads
the frames of a world, converts them back to the environment's own observation format
(``World.native``), and calls the policy. :meth:`Policy.answer` gives the action distributions for
batches of frames, with gradients, which ``mitigate.harden`` trains.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor, nn
from torch.distributions import (
    Categorical,
    Distribution,
    Independent,
    OneHotCategorical,
    TransformedDistribution,
    kl_divergence,
)

from mitigate.agents import adapters
from mitigate.agents.agent import Agent, check_logits
from mitigate.agents.sites import first
from mitigate.core import checkpoint
from mitigate.core.contracts import missing_members, read
from mitigate.core.observation import DEPTH, RGB
from mitigate.core.spaces import ActionSpace, Box, Composite, Discrete, MultiDiscrete
from mitigate.worlds.seeded import WHOLE

# Either one distribution per part of the action, or actions or action values [B, ...]
Answer = Sequence[Distribution] | Tensor
Forward = Callable[..., Any]


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
        """Return the policy's answers to a batch, and its memory after it.

        Args:
            observation: the environment's own observation, arrays with a first axis B.
            memory: the policy's memory before this observation; None at the start of an episode.
        """
        raise NotImplementedError(f"{type(self).__name__} defines no answer(observation, memory)")

    def action(self, answer: Answer) -> Any:
        """Return the most probable action for the first item of a batch.

        If the answer is a tensor, it holds the value of each action for discrete actions, and
        otherwise the action itself.
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
        """Return an action of the network, such as a sample of its distribution, for the world."""
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
        """Class name and hash of the weights, which name this policy in result rows."""
        return f"{self.name}-{checkpoint.weights_sha(self.network)}"

    @property
    def sensors(self) -> tuple[str, ...]:  # type: ignore[override]
        """The entries of observations that it reads."""
        return tuple(self.native.entries)

    @property
    def device(self) -> torch.device:
        """Device of the weights."""
        return next(self.network.parameters()).device

    def settings(self) -> dict[str, Any]:
        """Return the settings that determine the policy's actions, besides its weights."""
        return {"policy": self.name, "architecture": str(self.network), "native": repr(self.native)}

    def train(self, mode: bool = True) -> Any:
        """Keep the network in eval mode, so that dropout is off and normalisation statistics do not
        change.
        """
        return super().train(False)

    def reset(self, instruction: str) -> None:
        """Start an episode."""
        self._memory = None

    @torch.no_grad()
    def act(self, observation: Mapping[str, Any]) -> Any:
        """Return the likeliest action."""
        frames = {name: np.asarray(observation[name])[None] for name in self.sensors}
        self._before = self._memory
        answer, self._memory = self.answer(self.native(frames), self._memory)
        return self.action(answer)

    def entropy(self, observation: Mapping[str, Any]) -> Tensor:
        """Return the entropy of the last action's distribution (``agents/agent.py``).

        Raises:
            ValueError: The policy gives no distribution.
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
        """Return the answers to windows of consecutive frames, as a list with one batch per
        position in the window.

        Args:
            frames: frames by sensor, [B * length, ...]; the frames of a window are consecutive.
            length: frames per window. A recurrent policy starts each window with an empty memory.
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

    def forget(self) -> None:
        """Remove data that the network stores from its last call, so that it can be copied."""

    @contextmanager
    def recording(self, module: str) -> Iterator[list[Tensor]]:
        """Yield a list in which the outputs of a module of the network are recorded."""
        outputs: list[Tensor] = []
        target = self.network.get_submodule(module)
        handle = target.register_forward_hook(lambda *call: outputs.append(first(call[2])))
        try:
            yield outputs
        finally:
            handle.remove()


class StableBaselinesPolicy(Policy):
    """A policy of stable-baselines3 or sb3-contrib.

    PPO, A2C, RecurrentPPO, SAC and TQC give a distribution of actions, DDPG and TD3 an action, and
    DQN the values of all actions.
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
            return _parts(policy.get_distribution(inputs).distribution), None
        if hasattr(policy, "q_net"):
            return policy.q_net(inputs), None
        if hasattr(policy.actor, "get_action_dist_params"):
            mean, log_std, _ = policy.actor.get_action_dist_params(inputs)
            tanh = torch.distributions.TanhTransform(cache_size=1)
            return [
                TransformedDistribution(torch.distributions.Normal(mean, log_std.exp()), tanh)
            ], None
        return policy.actor(inputs), None

    def _recurrent(self, inputs: Any, memory: Any) -> tuple[Answer, Any]:
        policy: Any = self.network
        count = len(next(iter(inputs.values())) if isinstance(inputs, dict) else inputs)
        layers, _, size = policy.lstm_hidden_state_shape
        starts = torch.zeros(count, device=policy.device)
        if memory is None:
            memory = (torch.zeros(layers, count, size, device=policy.device),) * 2
        distribution, memory = policy.get_distribution(inputs, memory, starts)
        return _parts(distribution.distribution), memory

    def forget(self) -> None:
        for module in self.network.modules():
            last_call = read(module, "action_dist")
            for name, value in vars(last_call).items() if last_call else ():
                if isinstance(value, (Tensor, Distribution, list)):
                    # distributions and actions, with their autograd graph
                    setattr(last_call, name, None)

    def executable(self, chosen: Tensor) -> Any:
        policy: Any = self.network
        if policy.squash_output and isinstance(self.space, Box):
            return policy.unscale_action(chosen.cpu().numpy()).astype(self.space.low.dtype)
        return super().executable(chosen)


class TorchrlPolicy(Policy):
    """A policy of torchrl or tensordict: a module with ``in_keys`` and ``out_keys``.

    A probabilistic module gives a distribution of actions. Other modules give ``logits``,
    ``action_value`` or ``action``.
    """

    def __init__(self, network: Any, native: Any, space: ActionSpace) -> None:
        read_keys = {_dotted(key) for key in network.in_keys}
        entries = {name: entry for name, entry in native.entries.items() if entry in read_keys}
        super().__init__(network, replace(native, entries=entries or native.entries), space)
        outputs = {_dotted(key) for key in network.out_keys}
        self._fed_back = [
            key for key in network.in_keys if f"next.{_dotted(key)}" in outputs
        ]  # recurrent modules return their new state in the entry "next"
        self.recurrent = bool(self._fed_back)

    def answer(self, observation: Any, memory: Any = None) -> tuple[Answer, Any]:
        from tensordict import TensorDict

        network: Any = self.network
        arrays = _flat(observation)
        keys = [key for key in network.in_keys if key not in self._fed_back]
        if list(arrays) == [""]:
            arrays = {_dotted(keys[0]): arrays[""]}
        count = len(next(iter(arrays.values())))
        inputs = TensorDict({}, batch_size=[count], device=self.device)
        for key in keys:
            if _dotted(key) in arrays:
                inputs[key] = torch.from_numpy(np.array(arrays[_dotted(key)])).to(self.device)
        for key, value in (memory or {}).items():
            inputs[key] = value
        if self.recurrent:
            inputs["is_init"] = torch.full((count, 1), memory is None, device=self.device)
        if hasattr(network, "get_dist"):
            return _parts(network.get_dist(inputs)), self._next(inputs)
        outputs = network(inputs)
        for key in ("logits", "action_value", "action"):
            if key in outputs:
                values = outputs[key]
                return ([Categorical(logits=values)] if key == "logits" else values), self._next(
                    outputs
                )
        raise ValueError(
            f"The policy's outputs must contain logits, action_value or action, got "
            f"{', '.join(map(str, outputs.keys()))}. Rename them (out_keys=)."
        )

    def _next(self, outputs: Any) -> Any:
        return {key: outputs["next", key] for key in self._fed_back} or None


class ModulePolicy(Policy):
    """A plain ``nn.Module``.

    ``forward(network, observation)``, or with ``recurrent`` ``forward(network, observation,
    memory)``, returns logits of the actions [B, n] (discrete actions), actions [B, ...]
    (continuous ones), a ``torch.distributions`` object, or a list of these; with ``recurrent``
    also the new memory. By default, the network itself is called. ``observation`` holds tensors on
    the network's device.
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
        try:
            output = (
                self.network(*arguments)
                if self._forward is None
                else self._forward(self.network, *arguments)
            )
        except KeyError as error:
            raise ValueError(
                f"{self.name} reads the entry {error}, but the world passes only "
                f"{', '.join(_flat(inputs))}. Name every entry that the policy reads: "
                "GymWorld(entries={...})."
            ) from error
        if self.recurrent:
            output, memory = output
        if isinstance(output, Tensor):
            return self._of_tensor(output), memory
        return _parts(output), memory

    def _of_tensor(self, output: Tensor) -> Answer:
        if isinstance(self.space, Discrete):
            return [Categorical(logits=check_logits(output, self))]
        if isinstance(self.space, MultiDiscrete):
            counts = self.space.counts.ravel().tolist()
            return [Categorical(logits=part) for part in output.split(counts, -1)]
        return output


def is_policy(thing: Any) -> bool:
    """Return whether ``thing`` is a policy of a supported library rather than an agent."""
    network = thing if isinstance(thing, nn.Module) else read(thing, "policy")
    return isinstance(network, nn.Module) and bool(missing_members(thing, ("act",)))


def as_policy(
    policy: Any, world: Any, *, forward: Forward | None = None, recurrent: bool = False
) -> Policy:
    """Wrap a trained policy as an agent for ``world``.

    Args:
        policy: a model or policy of stable-baselines3, a module of torchrl or tensordict, or any
            ``nn.Module``. The policy is not copied.
        world: the world of an environment (``GymWorld``, ``EnvWorld``).
        forward: how to call an ``nn.Module`` (:class:`ModulePolicy`).
        recurrent: whether ``forward`` takes and returns a memory.

    Raises:
        TypeError: The policy is of an unsupported type.
        ValueError: The world lacks ``action_space`` or ``native``, or the policy reads entries that
            are missing in the world's ``entries``.
    """
    if isinstance(policy, Policy):
        return policy
    if isinstance(world.action_space, Composite):
        raise ValueError(
            "A policy with a dictionary of actions must be wrapped in an agent: a class with "
            "reset and act (docs/bring-your-own.md)."
        )
    if world.action_space is None or world.native is None:
        raise ValueError(
            f"{type(world).__name__} must have action_space (mitigate.core.spaces) and native, the "
            "conversion of frames to the observation that the policy was trained on. GymWorld and "
            "EnvWorld have both."
        )
    for name in (name for name in (RGB, DEPTH) if name in world.sensors):
        if len(world.sensors[name].shape) == 4:
            raise ValueError(
                f"The {name} frames must have the shape [H, W, channels], got "
                f"{list(world.sensors[name].shape)}. Stacked frames are not supported: the first "
                "of four axes counts cameras here. Use a policy with memory, or stack frames "
                "inside it."
            )
    network = policy if isinstance(policy, nn.Module) else read(policy, "policy")
    if not isinstance(network, nn.Module):
        raise TypeError(
            "policy must be a model of stable-baselines3, a module of torchrl, or a "
            f"torch.nn.Module, got a {type(policy).__name__}. For a policy without weights only "
            "mitigate.benchmark applies."
        )
    if any(parameter.is_meta for parameter in network.parameters()):
        raise ValueError(
            f"The weights of {type(network).__name__} are on the device meta, which holds no "
            "values. Load them first."
        )
    if forward is None and hasattr(network, "obs_to_tensor"):
        _check_read(getattr(network.observation_space, "spaces", {}), world)
        return StableBaselinesPolicy(network, world.native, world.action_space)
    if forward is None and hasattr(network, "in_keys") and hasattr(network, "out_keys"):
        if list(world.entries.values()) != [WHOLE]:
            module: Any = network
            states = {_dotted(key)[5:] for key in module.out_keys if _dotted(key)[:5] == "next."}
            keys = {_dotted(key) for key in module.in_keys} - states - {"is_init"}
            _check_read([key.split(".")[0] for key in keys], world)
        return TorchrlPolicy(network, world.native, world.action_space)
    return ModulePolicy(network, world.native, world.action_space, forward, recurrent)


def _check_read(names: Any, world: Any) -> None:
    """Raise ValueError if the policy reads entries that the world does not provide."""
    known = {entry.split(".")[0] for entry in world.entries.values()}
    missing = [name for name in names if name not in known]
    if missing:
        listed = ", ".join(f"{name!r}: {name!r}" for name in missing)
        raise ValueError(
            f"The policy reads {', '.join(missing)}, which the world's entries leave out. Add "
            f"them: entries={{..., {listed}}}."
        )


def load_policy(policy: Any, folder: str | Path) -> Any:
    """Load hardened weights (from ``mitigate.harden``) into ``policy``, in place, and return it.

    Args:
        policy: a policy with the architecture of the hardened one; for adapters it must be the
            original policy, because they fit only its weights.
        folder: the folder ``agent`` of the run.

    Raises:
        FileNotFoundError, ValueError: The weights are missing or damaged, or they do not fit.
    """
    network = policy if isinstance(policy, nn.Module) else policy.policy
    if (Path(folder) / adapters.SETTINGS).is_file():
        adapters.load_adapters(network, folder)
    else:
        checkpoint.load_weights(network, folder)
    return policy


def copied(policy: Policy) -> Policy:
    """Return a copy of a policy that shares no weights with the original.

    Raises:
        ValueError: The network cannot be copied.
    """
    policy.forget()
    try:
        twin = copy.copy(policy)
        twin._modules = {"network": copy.deepcopy(policy.network)}
    except Exception as error:  # the user's code may raise any error
        raise ValueError(
            f"{policy.name} cannot be copied ({type(error).__name__}: {str(error)[:200]}), which "
            "the clean teacher needs. Give a policy without open files or environments."
        ) from error
    return twin


def last_convolution(policy: Policy) -> str:
    """Return the name of the last convolution of a network, or else of its first layer.

    Raises:
        ValueError: The network has neither.
    """
    layers = [
        (name, isinstance(module, (nn.Conv1d, nn.Conv2d, nn.Conv3d)))
        for name, module in policy.network.named_modules()
        if isinstance(module, (nn.Conv1d, nn.Conv2d, nn.Conv3d, nn.Linear))
        and checkpoint.ADAPTER not in f".{name}."
    ]
    if not layers:
        raise ValueError(
            f"{policy.name} has no convolution and no linear layer. Name the module whose output "
            "is to be compared: module=..."
        )
    convolutions = [name for name, is_convolution in layers if is_convolution]
    return convolutions[-1] if convolutions else layers[0][0]


def mode(distribution: Any) -> Tensor:
    """Return the most probable value of a distribution, [B, ...]."""
    if isinstance(distribution, (Categorical, OneHotCategorical)):
        return distribution.logits.argmax(-1)
    if isinstance(distribution, Independent):
        return mode(distribution.base_dist)
    if isinstance(distribution, TransformedDistribution):
        value = mode(distribution.base_dist)
        for transform in distribution.transforms:
            value = transform(value)
        return value
    return distribution.mode


def divergence(teacher: Answer, student: Answer) -> Tensor:
    """Return the mean difference over the batch between the student's and the teacher's answers.

    For distributions it is the KL divergence KL(teacher || student), summed over the parts of an
    action. For plain actions or values it is the squared error divided by the teacher's variance
    over the batch.
    """
    if isinstance(teacher, Tensor) or isinstance(student, Tensor):
        assert isinstance(teacher, Tensor) and isinstance(student, Tensor)
        error = (student.float() - teacher.float()).square().mean()
        return error / teacher.float().var(0).mean().clamp(min=1e-6)
    total = torch.zeros((), device=student[0].sample().device)
    for one, other in zip(teacher, student, strict=True):
        try:
            kl = kl_divergence(_base(one), _base(other))
        except NotImplementedError:  # such as a fixed action given as a distribution
            return divergence(
                torch.cat([mode(t) for t in teacher], -1), torch.cat([mode(s) for s in student], -1)
            )
        total = total + kl.flatten(1).sum(1).mean() if kl.dim() > 1 else total + kl.mean()
    return total


def imitation(teacher: Answer, student: Answer) -> Tensor:
    """Return how badly the student predicts the teacher's likeliest action, mean over the batch.

    Cross-entropy for discrete actions. For continuous actions, and for values without a
    distribution, the squared error divided by the teacher's variance over the batch. Unlike the KL
    divergence, it matters where the teacher is undecided: a policy whose two best actions have
    probabilities of 0.50 and 0.48 acts differently if these change places.
    """
    if isinstance(teacher, Tensor) or isinstance(student, Tensor):
        return divergence(teacher, student)
    losses = []
    for one, other in zip(teacher, student, strict=True):
        action = mode(one)
        if isinstance(other, (Categorical, OneHotCategorical)):
            loss = F.cross_entropy(other.logits.flatten(0, -2), action.flatten())
        else:
            loss = divergence(action, mode(other))
        losses.append(loss)
    return torch.stack(losses).sum()


def _base(distribution: Any) -> Distribution:
    """Remove bijective transforms from a distribution, which do not change the divergence."""
    while isinstance(distribution, (Independent, TransformedDistribution)):
        distribution = distribution.base_dist
    return distribution


def _parts(distributions: Any) -> list[Distribution]:
    return list(distributions) if isinstance(distributions, (list, tuple)) else [distributions]


def _flat(observation: Any, prefix: str = "") -> dict[str, Any]:
    """Return a flat dict of the arrays of an observation, by dotted name."""
    if not isinstance(observation, Mapping):
        return {prefix: observation}
    parts: dict[str, Any] = {}
    for name, value in observation.items():
        parts |= _flat(value, f"{prefix}.{name}".lstrip("."))
    return parts


def _tensors(observation: Any, device: torch.device) -> Any:
    if isinstance(observation, Mapping):
        return {name: _tensors(value, device) for name, value in observation.items()}
    return torch.from_numpy(np.array(observation)).to(device)


def _dotted(key: Any) -> str:
    return key if isinstance(key, str) else ".".join(key)
