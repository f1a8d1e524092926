"""How adapters and gates stand in a model: each a child of its module, reached by a hook.

The model's own weights keep their names and values, and its ``forward`` is not touched.
"""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor, nn

from mitigate.agents.conv import ConvAdapter
from mitigate.agents.gate import FrameGate
from mitigate.agents.ring import RingAdapter
from mitigate.agents.sites import first
from mitigate.agents.tokens import TokenAdapter
from mitigate.core import checkpoint

NAME = checkpoint.ADAPTER.strip(".")  # of the submodule that a target module gets
ADAPTERS = (ConvAdapter, RingAdapter, TokenAdapter, FrameGate)
_HOOK = "_adapter_hook"
_STATISTICS = "_statistics_before_adapters"


def adapted(model: nn.Module) -> list[str]:
    """Names of the modules of ``model`` that have an adapter."""
    return [n for n, m in model.named_modules() if isinstance(getattr(m, NAME, None), ADAPTERS)]


def adapters_of(model: nn.Module) -> list[nn.Module]:
    """The adapters and gates themselves, in the model's order."""
    return [getattr(model.get_submodule(name), NAME) for name in adapted(model)]


def refuse_adapted(model: nn.Module) -> None:
    if adapted(model):
        raise ValueError("This model has adapters already; remove_adapters(model) takes them out.")


def attach_all(model: nn.Module, made: dict[str, nn.Module]) -> None:
    """Freeze ``model`` and attach ``made``, all or none."""
    taken = [name for name in made if hasattr(model.get_submodule(name), NAME)]
    if taken:
        raise ValueError(
            f"{', '.join(taken)} has something called {NAME!r} of its own, the name that an "
            "adapter takes. Choose other target modules."
        )
    model.requires_grad_(False)
    like = next(model.parameters(), torch.zeros(()))
    for name, adapter in made.items():
        _attach(model.get_submodule(name), adapter, like)
    _follow(made)
    setattr(model, _STATISTICS, _statistics(model))


def detach_all(model: nn.Module) -> None:
    """Take all adapters out, and their hooks."""
    for name in adapted(model):
        module = model.get_submodule(name)
        if hasattr(module, _HOOK):
            getattr(module, _HOOK).remove()
            delattr(module, _HOOK)
        delattr(module, NAME)


def moved_statistics(model: nn.Module) -> bool:
    """Whether the backbone's running statistics are other ones than when adapters came in."""
    held = getattr(model, _STATISTICS, {})
    return any(not v.equal(held.get(name, v)) for name, v in _statistics(model).items())


def _attach(module: nn.Module, adapter: nn.Module, usual: Tensor) -> None:
    """``usual``: whose device and dtype it gets where ``module`` has no weights."""
    like = next(module.parameters(), usual)
    module.add_module(NAME, adapter.to(like.device, like.dtype))
    if isinstance(adapter, FrameGate):
        setattr(module, _HOOK, module.register_forward_pre_hook(_look))
    elif type(module).forward is not nn.Sequential.forward:  # that runs its new child by itself
        setattr(module, _HOOK, module.register_forward_hook(_adapt))


def _adapt(module: nn.Module, inputs: Any, output: Any) -> Any:
    """Forward hook: the adapter of ``module`` on its output, or on the first item of it."""
    adapter = getattr(module, NAME)
    if isinstance(output, (tuple, list)):
        rest = (adapter(first(output)), *output[1:])
        return output._make(rest) if hasattr(output, "_make") else type(output)(rest)
    return adapter(output)


def _look(module: nn.Module, inputs: Any) -> None:
    """Forward pre-hook: the gate of ``module`` on what goes into it."""
    getattr(module, NAME).look(inputs[0])


def _follow(made: dict[str, nn.Module]) -> None:
    """Tell each adapter of the gate in front of it."""
    for name, gate in _gates_of(made).items():
        made[name].gates = [made[gate]]  # type: ignore[assignment]


def check_gates(made: dict[str, nn.Module]) -> None:
    """Raise ValueError for a gate that would open and close for nothing."""
    used = set(_gates_of(made).values())
    idle = [name for name, m in made.items() if isinstance(m, FrameGate) and name not in used]
    if idle:
        raise ValueError(
            f"The gate at {idle[0]} has no adapter of maps behind it to open for (those of tokens "
            "take none). Leave it out of gates, or choose other target modules."
        )


def _gates_of(made: dict[str, nn.Module]) -> dict[str, str]:
    """By adapter, the gate in front of it: the one in the same encoder."""
    corrects = [n for n, m in made.items() if isinstance(m, (ConvAdapter, RingAdapter))]
    held: dict[str, tuple[str, str]] = {}  # by adapter: the module around both, and the gate
    for name, gate in made.items():
        if not isinstance(gate, FrameGate):
            continue
        around, behind = name, list[str]()
        while around and not behind:
            around = around.rpartition(".")[0]
            behind = [n for n in corrects if not around or n.startswith(f"{around}.")]
        for n in behind:
            if n not in held or len(around) > len(held[n][0]):
                held[n] = (around, name)
    return {name: gate for name, (_, gate) in held.items()}


def _statistics(model: nn.Module) -> dict[str, Tensor]:
    """Copies of the running means and variances of the backbone's normalisations."""
    found = {n: b for n, b in model.named_buffers() if n.rpartition(".")[2].startswith("running_")}
    return {name: torch.clone(buffer).float().cpu() for name, buffer in found.items()}
