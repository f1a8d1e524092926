"""In which number format networks compute: decided here, once a run, and obeyed everywhere.

The trainer chooses, keeps the answer in the checkpoint, and puts :func:`computing` around all that
it runs: forward, rollouts, teachers, feature caches. Weights stay float32 and evaluations compute
in float32, so that rows of two machines can be compared.
"""

from __future__ import annotations

import os
import time
from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import torch
import torch.nn.functional as F

CHOICES = ("auto", "fp32", "bf16")
CAP = "ONEDNN_MAX_CPU_ISA"  # oneDNN's cap on the instructions that it uses
_NATIVE = (
    "BF16",
    "FP16",
    "AMX",
    "AVX10",
    "DEFAULT",
    "ALL",
)  # caps that leave bf16 its instructions
# Milliseconds of the probe in fp32 on the machine that the stages' costs were measured on (2 cores
# of an AMD EPYC, capped to AVX2).
REFERENCE = 12.0


@dataclass(frozen=True)
class Probe:
    """Least milliseconds of one small training step, forward and backward; ``bf16`` is None where
    it was not timed because the CPU does not compute it natively."""

    fp32: float
    bf16: float | None


def check(precision: str) -> None:
    """Raise ValueError unless ``precision`` is one of ``CHOICES``."""
    if precision not in CHOICES:
        raise ValueError(
            f"trainer.precision={precision} is unknown; choose one of {', '.join(CHOICES)}."
        )


def choose(precision: str, device: torch.device) -> str:
    """Return "fp32" or "bf16" for ``precision``, one of ``CHOICES``.

    "auto" is bf16 only where the device computes it natively and, on a CPU, :func:`probe` finds it
    no slower; elsewhere bf16 is emulated, 3 to 10 times slower than fp32 (measured with AVX2).
    Raises ValueError for another name.
    """
    check(precision)
    if precision != "auto":
        return precision
    if device.type == "cuda":
        return "bf16" if torch.cuda.is_bf16_supported(including_emulation=False) else "fp32"
    if device.type != "cpu":
        return "fp32"
    found = probe()
    return "bf16" if found.bf16 is not None and found.bf16 <= found.fp32 else "fp32"


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
    if hasattr(value, "to"):
        return value.to(device)
    if isinstance(value, dict):
        return {name: to_device(item, device) for name, item in value.items()}
    if isinstance(value, (list, tuple)) and not hasattr(value, "_fields"):
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
    allowed = not cap or any(name in cap.upper() for name in _NATIVE)
    return allowed and any(has.get(name) for name in ("avx512_bf16", "amx_bf16", "bf16"))


@lru_cache(maxsize=1)
def probe(rounds: int = 7) -> Probe:
    """Time a small step of convolutions and a product in fp32 and, where it is native, in bf16,
    in turns: a tenth of a second or two, once a process."""
    kinds = ("fp32", "bf16") if native() else ("fp32",)
    spent: dict[str, list[float]] = {kind: [] for kind in kinds}
    with torch.random.fork_rng(devices=[]):
        step = _step()
    for _ in range(rounds):
        for kind in kinds:
            began = time.perf_counter()
            step(kind)
            spent[kind].append(1e3 * (time.perf_counter() - began))
    least = {kind: min(times) for kind, times in spent.items()}
    return Probe(least["fp32"], least.get("bf16"))


def _step():
    x = torch.randn(48, 32, 32, 32)
    kernel = torch.randn(48, 32, 3, 3, requires_grad=True)
    matrix = torch.randn(512, 512, requires_grad=True)

    def step(kind: str) -> None:
        with computing(kind, x.device):
            y = F.conv2d(x, kernel, stride=2, padding=1).relu()
            z = y.flatten(2).mean(2).repeat(8, 11)[:, :512] @ matrix
        (y.float().mean() + z.float().mean()).backward()
        kernel.grad = matrix.grad = None

    return step
