"""Corrupt the inputs of navigation agents, measure the effect, and train and ship hardened
agents.
"""

from __future__ import annotations

import os
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mitigate.agents.loading import load, load_hardened
    from mitigate.agents.policies.wrapping import as_policy, load_policy
    from mitigate.evaluation.benchmark import benchmark
    from mitigate.evaluation.leaderboard.entry import LeaderboardEntry
    from mitigate.replay.replay import replay_recordings
    from mitigate.shipping.harden import harden

# OpenMP reads this variable when torch is imported.
# By default, a waiting OpenMP thread spins and occupies a core that other processes need.
# A training step was timed on 2 cores while another process used one of the cores.
# The step took 2000 ms with the default and 450 ms with this setting.
# Without the other process, the step took 200 ms with either setting.
os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")

# ``commands/`` holds modules such as ``mitigate.train``, which torchrun starts with ``python -m``.
__path__.append(os.path.join(os.path.dirname(__file__), "commands"))

__all__ = [
    "LeaderboardEntry",
    "as_policy",
    "benchmark",
    "harden",
    "load",
    "load_hardened",
    "load_policy",
    "replay_recordings",
]
_MODULES = {
    "LeaderboardEntry": "mitigate.evaluation.leaderboard.entry",
    "as_policy": "mitigate.agents.policies.wrapping",
    "benchmark": "mitigate.evaluation.benchmark",
    "harden": "mitigate.shipping.harden",
    "load": "mitigate.agents.loading",
    "load_hardened": "mitigate.agents.loading",
    "load_policy": "mitigate.agents.policies.wrapping",
    "replay_recordings": "mitigate.replay.replay",
}


def __getattr__(name: str) -> Any:
    """Import a name of ``__all__`` on first use, because its module may import torch."""
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
