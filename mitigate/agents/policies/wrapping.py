"""Wrap a trained policy as an agent, and load hardened weights into it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from torch import nn

from mitigate.agents import adapters
from mitigate.agents.policies.module import Forward, ModulePolicy
from mitigate.agents.policies.policy import Policy
from mitigate.agents.policies.stable_baselines import StableBaselinesPolicy
from mitigate.agents.policies.torchrl import TorchrlPolicy, dotted
from mitigate.core import checkpoint
from mitigate.core.contracts import missing_members, read
from mitigate.core.observation import DEPTH, RGB
from mitigate.core.spaces import Composite
from mitigate.worlds.seeded import WHOLE


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
        world: the world of an environment (``GymWorld``, ``EnvWorld``), or a function that creates
            it.
        forward: how to call an ``nn.Module`` (:class:`ModulePolicy`).
        recurrent: whether ``forward`` takes and returns a memory.

    Raises:
        TypeError: If the policy is of an unsupported type.
        ValueError: If the world lacks ``action_space`` or ``native``, or the policy reads entries
            that are missing in the world's ``entries``.
    """
    if isinstance(policy, Policy):
        return policy
    if callable(world):
        world = world()
    if isinstance(read(world, "action_space"), Composite):
        raise ValueError(
            "A policy with a dictionary of actions must be wrapped in an agent: a class with "
            "reset and act (docs/bring-your-own.md)."
        )
    if missing_members(world, ("action_space", "native")):
        raise ValueError(
            f"{type(world).__name__} must have action_space and native (the conversion of frames "
            "to the policy's observation), as GymWorld and EnvWorld have."
        )
    if missing_members(world.native, ("entries",)):
        raise ValueError(
            f"native of {type(world).__name__} must have the attribute entries, which maps rgb and "
            "depth to names in the environment's observation. Wrap the environment in GymWorld or "
            "EnvWorld, or the policy in an agent with reset and act (docs/bring-your-own.md)."
        )
    for name in (name for name in (RGB, DEPTH) if name in world.sensors):
        if len(world.sensors[name].shape) == 4:
            raise ValueError(
                f"The {name} frames must have the shape [H, W, channels], got "
                f"{list(world.sensors[name].shape)}. Pass the environment without the "
                "wrapper that stacks frames, and stack them in forward= (docs/harden.md)."
            )
    network = policy if isinstance(policy, nn.Module) else read(policy, "policy")
    if not isinstance(network, nn.Module):
        raise TypeError(
            "policy must be a model of stable-baselines3, a module of torchrl, or a "
            f"torch.nn.Module, got a {type(policy).__name__}."
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
            states = {dotted(key)[5:] for key in module.out_keys if dotted(key)[:5] == "next."}
            keys = {dotted(key) for key in module.in_keys} - states - {"is_init"}
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
            f"The policy reads {', '.join(missing)}, but the world's entries do not contain "
            f"this. Add: entries={{..., {listed}}}."
        )


def load_policy(policy: Any, folder: str | Path) -> Any:
    """Load hardened weights (from ``mitigate.harden``) into ``policy``, in place, and return it.

    Args:
        policy: a policy with the architecture of the hardened policy. If the folder holds adapters,
            ``policy`` must have the original weights, because the adapters fit only these.
        folder: the folder ``agent`` of the run.

    Raises:
        FileNotFoundError, ValueError: If the weights are missing, damaged, or do not fit.
    """
    network = policy if isinstance(policy, nn.Module) else policy.policy
    if (Path(folder) / adapters.SETTINGS).is_file():
        adapters.load_adapters(network, folder)
    else:
        checkpoint.load_weights(network, folder)
    return policy
