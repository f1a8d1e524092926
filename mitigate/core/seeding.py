"""Generate keyed random numbers, which depend only on a key and never on earlier random numbers.

A key is a tuple of integers and strings, such as ``(seed, "rollout", step)``. The same key gives
the same numbers in any process and in any order; Python's ``hash()``, which is salted per process,
is never used.
"""

from __future__ import annotations

import hashlib
import random
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, TypeVar

import numpy as np

# torch is imported only where needed, because its import is slow and most callers use only numpy
if TYPE_CHECKING:
    import torch

Key = int | str
Item = TypeVar("Item")


def digest(*key: Key) -> int:
    """Return a 128-bit integer that depends on the value and type of every part of ``key``."""
    text = "\x1f".join(f"{type(part).__name__}:{part}" for part in key)
    return int.from_bytes(hashlib.blake2b(text.encode(), digest_size=16).digest(), "little")


def generator(*key: Key) -> np.random.Generator:
    """Return a new numpy generator (Philox, counter-based) for ``key``."""
    return np.random.Generator(np.random.Philox(key=digest(*key)))


def pick(options: Sequence[Item], rng: np.random.Generator) -> Item:
    """Return one of ``options``, each with the same probability."""
    return options[int(rng.integers(len(options)))]


def torch_generator(*key: Key) -> torch.Generator:
    """Return a new CPU torch generator for ``key``."""
    import torch

    rng = torch.Generator()
    rng.manual_seed(digest(*key) & (2**63 - 1))
    return rng


def check(seed: int) -> None:
    """Raise ValueError for a seed that cannot be stored in a result row."""
    if not -(2**63) < seed < 2**63:
        raise ValueError(
            f"seed must be a whole number between -2^63 and 2^63, got {seed}. Set e.g. seed=1."
        )


def seed_everything(*key: Key) -> None:
    """Set the global generators of Python, numpy and torch (all devices) from ``key``."""
    import torch

    number = digest(*key)
    random.seed(number)
    np.random.seed(number & (2**32 - 1))
    torch.manual_seed(number & (2**63 - 1))


@contextmanager
def seeded(*key: Key) -> Iterator[None]:
    """Set the global generators of Python, numpy and torch from ``key`` inside the context."""
    before = global_state()
    seed_everything(*key)
    try:
        yield
    finally:
        set_global_state(before)


def global_state() -> dict:
    """Return the state of the three global generators as tensors, tuples and numbers."""
    import torch

    name, words, position, has_gauss, gauss = np.random.get_state(legacy=True)
    return {
        "python": random.getstate(),
        "numpy": (name, torch.from_numpy(np.asarray(words, np.int64)), position, has_gauss, gauss),
        "torch": torch.get_rng_state(),
    }


def set_global_state(state: dict) -> None:
    """Restore the state that :func:`global_state` returned."""
    import torch

    name, words, position, has_gauss, gauss = state["numpy"]
    random.setstate(state["python"])
    np.random.set_state((name, words.numpy().astype(np.uint32), position, has_gauss, gauss))
    torch.set_rng_state(state["torch"].cpu())
