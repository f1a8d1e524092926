"""Corrupt, mitigate, measure and ship hardened navigation agents."""

from __future__ import annotations

import os
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mitigate.agents.loading import load, load_hardened
    from mitigate.agents.policies import as_policy, load_policy
    from mitigate.evaluation.benchmark import benchmark
    from mitigate.evaluation.leaderboard.entry import LeaderboardEntry
    from mitigate.shipping.harden import harden

# OpenMP reads this when torch is imported. By default a waiting thread spins. If another process
# runs at the same time, such as a worker that makes the next batch, the spinning thread occupies
# the core that the process needs. Measured on 2 cores with one other busy process: a training
# step of 200 ms took 2000 ms with the default and 450 ms with this setting; without that process
# both are equal.
os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")

# Modules such as ``python -m mitigate.train``, which torchrun needs, are in ``commands/``.
__path__.append(os.path.join(os.path.dirname(__file__), "commands"))

__all__ = [
    "LeaderboardEntry",
    "as_policy",
    "benchmark",
    "harden",
    "load",
    "load_hardened",
    "load_policy",
]
_MODULES = {
    "LeaderboardEntry": "mitigate.evaluation.leaderboard.entry",
    "as_policy": "mitigate.agents.policies",
    "benchmark": "mitigate.evaluation.benchmark",
    "harden": "mitigate.shipping.harden",
    "load": "mitigate.agents.loading",
    "load_hardened": "mitigate.agents.loading",
    "load_policy": "mitigate.agents.policies",
}


def __getattr__(name: str) -> Any:
    """Import the names of ``__all__``, and torch with them, on first use."""
    if name in _MODULES:
        try:
            return vars(import_module(_MODULES[name]))[name]
        except ModuleNotFoundError as error:
            from mitigate.core.errors import missing_package_message

            message = missing_package_message(f"mitigate.{name}", error)
            if not message:
                raise
            raise ImportError(message) from error
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
