"""Where the worker processes of an evaluation run: ``launcher=local | ray | slurm``."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from typing import Any

from hydra.core.config_store import ConfigStore
from omegaconf import DictConfig, OmegaConf

from mitigate.core import workers
from mitigate.core.progress import Progress
from mitigate.core.workers import Task

HOMES = {"ray": "ray_actors", "slurm": "slurm_jobs"}  # by the launcher's name


@dataclass
class LauncherConfig:
    """Worker processes of this machine. The entries are explained in ``conf/launcher``."""

    name: str = "local"


@dataclass
class RayConfig(LauncherConfig):
    """Actors on a Ray cluster."""

    name: str = "ray"
    address: str | None = None
    cpus: float = 1.0
    memory: float | None = None
    attempts: int = 3


@dataclass
class SlurmConfig(LauncherConfig):
    """Jobs of a SLURM cluster, by submitit."""

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


def chosen(node: LauncherConfig | DictConfig) -> LauncherConfig:
    """The launcher that a config names. Raises ValueError for a number that is too small, and for
    what can be seen from here to be missing or misnamed, before any work is done."""
    launcher = OmegaConf.to_object(node) if isinstance(node, DictConfig) else node
    assert isinstance(launcher, LauncherConfig)
    for name in ("cpus", "memory", "attempts", "processes", "minutes"):
        value = vars(launcher).get(name)
        if value is not None and not 0 < value < math.inf:
            raise ValueError(f"launcher.{name}={value:g} must be above 0, and no infinity.")
    if launcher.name != "local":
        _home(launcher).check(launcher)
    return launcher


def _home(launcher: LauncherConfig) -> Any:
    """The module of a launcher of other machines."""
    return import_module(f"mitigate.cluster.{HOMES[launcher.name]}")


def count(launcher: LauncherConfig, wanted: int | None, jobs: int, worth: int) -> int:
    """How many workers to start (of SLURM: jobs); ``wanted`` None: as many as pay, which Ray is
    asked for itself. Raises ValueError for fewer than 1."""
    if launcher.name == "local":
        return workers.count(wanted, jobs, worth)
    if wanted is not None and wanted < 1:
        raise ValueError(f"workers={wanted}: give 1 or more, or null.")
    if wanted is not None:
        return wanted
    if launcher.name == "ray":
        return _home(launcher).room(launcher)
    return max(1, jobs // (worth * launcher.processes))  # type: ignore[attr-defined]


def results(
    launcher: LauncherConfig,
    task: Task,
    groups: Sequence[Sequence[Any]],
    started: int,
    progress: Progress,
) -> Iterator[tuple[int, Any] | None]:
    """As ``core.workers.results``, on ``started`` workers of the launcher: (number of the job, its
    result) as they come, each once, whatever dies. Raises WorkersDied when a group of jobs was lost
    too often, and what a job raises."""
    if launcher.name == "local":
        return workers.results(task, groups, started, progress)
    return _home(launcher).results(task, groups, started, progress, launcher)


def lost(what: str, attempts: int, done: int, total: int) -> workers.WorkersDied:
    """The error for a group of jobs that no worker finished."""
    return workers.WorkersDied(
        f"{what} was lost with its worker {attempts} times. {done} of {total} jobs are finished. "
        "Look at the nodes' logs; if memory ran out, reserve more (launcher.memory=4)."
    )
