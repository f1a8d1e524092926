"""Corrupt, mitigate, measure and ship hardened navigation agents."""

from __future__ import annotations

import os
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mitigate.agents.loading import load, load_hardened
    from mitigate.evaluation.benchmark import benchmark
    from mitigate.evaluation.leaderboard.entry import LeaderboardEntry

# OpenMP reads this when torch is imported. By default a thread that waits for another one spins: as
# soon as anything else runs beside torch, such as workers that make the next batch, it spins on the
# core that the other one needs (measured on 2 cores beside one busy process: a training step of
# 200 ms took 2000 ms; with this 450 ms, and alone no longer than before).
os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")

# ``python -m mitigate.train``, which torchrun needs, and its like are files of ``commands/``.
__path__.append(os.path.join(os.path.dirname(__file__), "commands"))

__all__ = ["LeaderboardEntry", "benchmark", "load", "load_hardened"]
_HOMES = {
    "LeaderboardEntry": "mitigate.evaluation.leaderboard.entry",
    "benchmark": "mitigate.evaluation.benchmark",
    "load": "mitigate.agents.loading",
    "load_hardened": "mitigate.agents.loading",
}


def __getattr__(name: str) -> Any:
    """Import what is in ``__all__``, and torch with it, when it is first asked for."""
    if name in _HOMES:
        try:
            return vars(import_module(_HOMES[name]))[name]
        except ModuleNotFoundError as error:
            from mitigate.core.errors import lacking

            told = lacking(f"mitigate.{name}", error)
            if not told:
                raise
            raise ImportError(told) from error
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
