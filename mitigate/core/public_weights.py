"""Public weights inside a module of ours: never copied into its checkpoints, only named there.

A checkpoint of such a module holds what differs from them, such as adapters, and the sha256 of the
file that they came from.
"""

from __future__ import annotations

from typing import Any

import torch
from torch import nn


def borrow(module: nn.Module, prefixes: tuple[str, ...], source: str, name: str) -> None:
    """Leave the tensors of ``module`` whose names begin so out of its state dicts, while they are
    as they are now, bit for bit; a state dict without them takes them from here.

    ``source``: sha256 of the file that they came from, in hex; ``name``: what to call them in an
    error. Loading a state dict that was made with others raises ValueError.
    """
    module.public_tensors = {  # type: ignore[assignment]
        key: value.clone() for key, value in module.state_dict().items() if key.startswith(prefixes)
    }
    module.public_name = name  # type: ignore[assignment]
    module.register_buffer("public", torch.tensor(list(bytes.fromhex(source)), dtype=torch.uint8))
    module.register_state_dict_post_hook(_leave_out)
    module.register_load_state_dict_pre_hook(_fill_in)


def _leave_out(module: Any, state: dict[str, Any], prefix: str, _: Any) -> None:
    for name, value in module.public_tensors.items():
        held = state.get(prefix + name)
        if held is not None and torch.equal(held.cpu(), value):
            del state[prefix + name]


def _fill_in(module: Any, state: dict[str, Any], prefix: str, *_: Any) -> None:
    made_with = state.get(f"{prefix}public")
    if made_with is not None and not torch.equal(made_with.cpu(), module.public.cpu()):
        raise ValueError(
            f"These weights belong to {module.public_name} with sha256 "
            f"{bytes(made_with.tolist()).hex()[:12]}, but the installed one has "
            f"{bytes(module.public.tolist()).hex()[:12]}: install the version that they were made "
            "with."
        )
    for name, value in module.public_tensors.items():
        state.setdefault(prefix + name, value)
