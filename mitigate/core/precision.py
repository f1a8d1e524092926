"""Choose the number format in which networks compute, once per run.

The choice depends only on the device. The choice is not based on timing, because on a busy machine
the same command could then choose a different format and train different weights.

The trainer stores its choice in the checkpoint. The trainer runs all computations inside
:func:`computing`: forward passes, rollouts, teachers and feature caches. Weights stay float32, and
evaluations compute in float32, so that rows from different machines can be compared.
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
CAP = "ONEDNN_MAX_CPU_ISA"  # environment variable that limits the instructions that oneDNN uses
# values of ONEDNN_MAX_CPU_ISA with which oneDNN may use bf16 instructions
_NATIVE = re.compile("BF16|FP16|AMX|AVX10|DEFAULT|ALL")
# result of probe() in milliseconds on the machine where stage costs were measured
# That machine has 2 cores of an AMD EPYC, limited to AVX2.
REFERENCE = 12.0


def check(precision: str) -> None:
    """Raise ValueError unless ``precision`` is one of ``CHOICES``."""
    if precision not in CHOICES:
        raise ValueError(f"trainer.precision must be one of {', '.join(CHOICES)}, got {precision}.")


def choose(precision: str, device: torch.device) -> str:
    """Return "fp32" or "bf16" for ``precision``, one of ``CHOICES``.

    "auto" means bf16 only if the device computes bf16 natively, else fp32. Emulated bf16 is 3 to 10
    times slower than fp32 (measured with AVX2).

    Raises:
        ValueError: If ``precision`` is not in ``CHOICES``.
    """
    check(precision)
    if precision != "auto":
        return precision
    if device.type == "cuda":
        return "bf16" if torch.cuda.is_bf16_supported(including_emulation=False) else "fp32"
    return "bf16" if device.type == "cpu" and native() else "fp32"


def device_of(name: str) -> torch.device:
    """Return the device for a ``name`` such as "cpu" or "cuda:1"; "auto" means CUDA if available.

    Raises:
        ValueError: If the device is not available.
    """
    if name == "auto":
        return torch.device("cuda" if torch.cuda.is_available() else "cpu")
    gpus = torch.cuda.device_count()
    devices = ["auto", "cpu", *(f"cuda:{n}" for n in range(gpus))]
    try:
        device = torch.device(name)
        if device.type == "cuda":  # do not initialise CUDA here, because workers are forked later
            cause = "it is not available"
            usable = torch.cuda.is_available() and (device.index or 0) < gpus
        else:
            usable = device.type != "meta"
            cause = "it holds no numbers"
            torch.empty(0, device=device)
        if usable:
            return device
    except (RuntimeError, AssertionError, NotImplementedError) as error:
        cause = str(error).partition("\n")[0].partition(" device type at start")[0][:200]
    raise ValueError(
        f"trainer.device={name} cannot be used here ({cause}). Choose one of: "
        f"{', '.join(devices)}; `make doctor` lists what this machine has."
    )


def to_device(value: Any, device: torch.device) -> Any:
    """Move tensors, and other objects with a method ``to``, to ``device``.

    The contents of dicts, lists and tuples are moved too. Other values are returned unchanged.
    """
    if hasattr(value, "to"):  # users' agents may define their own class of batches
        return value.to(device)
    if isinstance(value, dict):
        return {name: to_device(item, device) for name, item in value.items()}
    if type(value) in (list, tuple):  # objectives move named tuples to the device
        return type(value)(to_device(item, device) for item in value)
    return value


def computing(precision: str, device: torch.device) -> AbstractContextManager[None]:
    """Return a context in which networks on ``device`` compute in ``precision``."""
    return torch.autocast(device.type, torch.bfloat16, enabled=precision == "bf16")


def current(device: torch.device) -> str:
    """Return the precision of the current context: "fp32" or "bf16"."""
    return "bf16" if torch.is_autocast_enabled(device.type) else "fp32"


def native() -> bool:
    """Return whether the CPU has bf16 instructions and oneDNN is allowed to use them."""
    has, cap = torch.cpu.get_capabilities(), os.environ.get(CAP, "")
    allowed = not cap or _NATIVE.search(cap.upper()) is not None
    return allowed and any(has.get(name) for name in ("avx512_bf16", "amx_bf16", "bf16"))


@lru_cache(maxsize=1)
def probe(rounds: int = 7) -> float:
    """Measure the speed of this machine: the milliseconds that a small fp32 training step takes.

    The step has convolutions and a matrix product. The time of the fastest of ``rounds`` runs is
    returned. The measurement takes a tenth of a second and runs once per process.
    """
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
