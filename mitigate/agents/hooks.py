"""Find what changes a network's behaviour beside its state dict: hooks and replaced methods."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from torch import Tensor, nn
from torch.nn.modules import module as torch_module

_HOOKS = ("_forward_pre_hooks", "_forward_hooks")
_GLOBAL_HOOKS = ("_global_forward_pre_hooks", "_global_forward_hooks")
_OWN_HOOKS = "mitigate.agents.attachment"  # its adapters are modules: in state_dict()


@dataclass
class Hidden:
    """By dotted place in the network.

    Attributes:
        readable: hooks that describe themselves, as text.
        values: objects to read like any other: replaced methods, hooks of torch, packed weights.
        unreadable: reasons why the rest cannot be read.
    """

    readable: dict[str, str] = field(default_factory=dict)
    values: dict[str, Any] = field(default_factory=dict)
    unreadable: dict[str, str] = field(default_factory=dict)


def hidden_behaviour(net: nn.Module) -> Hidden:
    """Return what changes the behaviour of ``net`` beside its class and its state dict.

    A hook is read if it is one of this project's adapters, an object with a ``fingerprint()``
    method that returns plain data, or an object of torch such as a weight norm.
    """
    hidden = Hidden()
    for name in _GLOBAL_HOOKS:
        if getattr(torch_module, name, None):
            hidden.unreadable["global hooks"] = "a forward hook that is registered for all modules"
    for place, one in net.named_modules():
        prefix = f"{place}." if place else ""
        for hook in _hooks(one):
            _add_hook(hidden, f"{prefix}forward hook", hook)
        for name, replaced in _replaced_methods(one):
            hidden.values[f"{prefix}{name}"] = replaced
        if type(one).__module__.startswith("torch.jit"):
            hidden.unreadable[place] = "a TorchScript module, whose program cannot be read"
    for name, value in net.state_dict().items():
        if not isinstance(value, Tensor):  # such as the packed weights of a quantised layer
            hidden.values[f"state {name}"] = value
    return hidden


def _hooks(module: nn.Module) -> Iterator[Any]:
    for kind in _HOOKS:
        yield from (getattr(module, kind, None) or {}).values()


def _add_hook(hidden: Hidden, place: str, hook: Any) -> None:
    module = str(getattr(hook, "__module__", type(hook).__module__))
    if module == _OWN_HOOKS:
        return
    number = sum(name.startswith(place) for name in (*hidden.readable, *hidden.values))
    name = f"{place} {number}" if number else place
    describe = getattr(hook, "fingerprint", None)
    if callable(describe):
        hidden.readable[name] = f"{type(hook).__qualname__} {describe()!r}"
    elif module.startswith("torch.") and hasattr(hook, "__dict__") and vars(hook):
        hidden.values[name] = hook
    else:
        kind = getattr(hook, "__qualname__", type(hook).__qualname__)
        hidden.unreadable[name] = f"a forward hook, {kind}"


def _replaced_methods(module: nn.Module) -> Iterator[tuple[str, Any]]:
    """Attributes of an instance that stand in for methods of its class, such as ``forward``."""
    for name, value in vars(module).items():
        if callable(value) and callable(getattr(type(module), name, None)):
            yield name, value
