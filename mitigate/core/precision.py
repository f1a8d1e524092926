"""In which number format networks compute: decided here, once a run, and obeyed everywhere.

The choice depends on the device alone and is not timed: on a busy machine the same command would
choose now one format, now the other, and train other weights.

The trainer chooses, keeps the answer in the checkpoint, and puts :func:`computing` around all that
it runs: forward, rollouts, teachers, feature caches. Weights stay float32 and evaluations compute
in float32, so that rows of two machines can be compared.
"""

from __future__ import annotations

import os
import re
import time
from contextlib import AbstractContextManager
from functools import lru_cache
from typing import Any

import torch
import torch.nn.functional as F

CHOICES = ("auto", "fp32", "bf16")
CAP = "ONEDNN_MAX_CPU_ISA"  # oneDNN's cap on the instructions that it uses
_NATIVE = re.compile("BF16|FP16|AMX|AVX10|DEFAULT|ALL")  # caps that leave bf16 its instructions
# Milliseconds of the probe on the machine that the stages' costs were measured on (2 cores
# of an AMD EPYC, capped to AVX2).
REFERENCE = 12.0


def check(precision: str) -> None:
    """Raise ValueError unless ``precision`` is one of ``CHOICES``."""
    if precision not in CHOICES:
        raise ValueError(
            f"trainer.precision={precision} is unknown; choose one of {', '.join(CHOICES)}."
        )


def choose(precision: str, device: torch.device) -> str:
    """Return "fp32" or "bf16" for ``precision``, one of ``CHOICES``.

    "auto" is bf16 only where the device computes it natively; elsewhere bf16 is emulated, 3 to 10
    times slower than fp32 (measured with AVX2). Raises ValueError for another name.
    """
    check(precision)
    if precision != "auto":
        return precision
    if device.type == "cuda":
        return "bf16" if torch.cuda.is_bf16_supported(including_emulation=False) else "fp32"
    return "bf16" if device.type == "cpu" and native() else "fp32"


def device_of(name: str) -> torch.device:
    """Return the device of a ``name`` such as "cpu" or "cuda:1"; "auto" is CUDA if it is there.

    Raises ValueError for one that is not there.
    """
    if name == "auto":
        return torch.device("cuda" if torch.cuda.is_available() else "cpu")
    gpus = torch.cuda.device_count()
    there = ["auto", "cpu", *(f"cuda:{n}" for n in range(gpus))]
    try:
        device = torch.device(name)
        if device.type == "cuda":  # CUDA itself is not begun before the workers are forked
            cause = "it is not there"
            good = torch.cuda.is_available() and (device.index or 0) < gpus
        else:
            good, cause = device.type != "meta", "it holds no numbers"
            torch.empty(0, device=device)
        if good:
            return device
    except (RuntimeError, AssertionError, NotImplementedError) as error:
        cause = str(error).partition("\n")[0].partition(" device type at start")[0][:200]
    raise ValueError(
        f"trainer.device={name} cannot be used here ({cause}). Choose one of: {', '.join(there)}; "
        "`make doctor` says what this machine has."
    )


def to_device(value: Any, device: torch.device) -> Any:
    """Move what has ``to`` (tensors, batches of them) in nested dicts, lists and tuples to
    ``device``; leave the rest."""
    if hasattr(value, "to"):  # batches of decisions are of users' classes
        return value.to(device)
    if isinstance(value, dict):
        return {name: to_device(item, device) for name, item in value.items()}
    if type(value) in (list, tuple):  # not a named one, which objectives move themselves
        return type(value)(to_device(item, device) for item in value)
    return value


def computing(precision: str, device: torch.device) -> AbstractContextManager[None]:
    """Return the context in which networks on ``device`` compute in ``precision``."""
    return torch.autocast(device.type, torch.bfloat16, enabled=precision == "bf16")


def current(device: torch.device) -> str:
    """Return the precision of the context that this is called in: "fp32" or "bf16"."""
    return "bf16" if torch.is_autocast_enabled(device.type) else "fp32"


def native(capabilities: dict | None = None, cap: str | None = None) -> bool:
    """Whether the CPU has instructions for bf16, and oneDNN may use them.

    Args: capabilities: as ``torch.cpu.get_capabilities`` gives them; None: those of this machine.
    cap: in place of the environment's ``ONEDNN_MAX_CPU_ISA``.
    """
    has = torch.cpu.get_capabilities() if capabilities is None else capabilities
    cap = os.environ.get(CAP, "") if cap is None else cap
    allowed = not cap or _NATIVE.search(cap.upper()) is not None
    return allowed and any(has.get(name) for name in ("avx512_bf16", "amx_bf16", "bf16"))


@lru_cache(maxsize=1)
def probe(rounds: int = 7) -> float:
    """Return the least milliseconds of a small fp32 training step of convolutions and a product:
    how fast this machine is. Takes a tenth of a second, once per process."""
    with torch.random.fork_rng(devices=[]):
        x = torch.randn(48, 32, 32, 32)
        kernel = torch.randn(48, 32, 3, 3, requires_grad=True)
        matrix = torch.randn(512, 512, requires_grad=True)
    spent = []
    for _ in range(rounds):
        began = time.perf_counter()
        y = F.conv2d(x, kernel, stride=2, padding=1).relu()
        z = y.flatten(2).mean(2).repeat(8, 11)[:, :512] @ matrix
        (y.mean() + z.mean()).backward()
        kernel.grad = matrix.grad = None
        spent.append(1e3 * (time.perf_counter() - began))
    return min(spent)
