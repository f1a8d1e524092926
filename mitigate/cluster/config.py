"""Define the options of launchers, which decide where a command's worker processes run."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from hydra.core.config_store import ConfigStore


@dataclass
class LauncherConfig:
    """Options for worker processes on this machine. ``conf/launcher`` explains the entries."""

    name: str = "local"


@dataclass
class RayConfig(LauncherConfig):
    """Options for actors on a Ray cluster."""

    name: str = "ray"
    address: str | None = None
    cpus: float = 1.0
    memory: float | None = None
    attempts: int = 3


@dataclass
class SlurmConfig(LauncherConfig):
    """Options for jobs of a SLURM cluster, which are submitted by submitit."""

    name: str = "slurm"
    cluster: str = "slurm"
    folder: str = "runs/slurm"
    processes: int = 4
    minutes: int = 240
    memory: float = 2.0
    attempts: int = 3
    options: dict[str, Any] = field(default_factory=dict)


for _kind in (LauncherConfig, RayConfig, SlurmConfig):
    ConfigStore.instance().store(group="launcher", name=f"{_kind.name}_schema", node=_kind)
