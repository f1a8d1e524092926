"""Where the worker processes of an evaluation run: ``launcher=local | ray | slurm``."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from mitigate.cluster import ray_actors, slurm_jobs
from mitigate.cluster.config import LauncherConfig, RayConfig, SlurmConfig
from mitigate.core import workers
from mitigate.core.progress import Progress
from mitigate.core.workers import Task

__all__ = ["LauncherConfig", "RayConfig", "SlurmConfig", "chosen", "count", "results"]


def chosen(launcher: LauncherConfig) -> LauncherConfig:
    """Return ``launcher``. Raises ValueError for a number that is too small, and for what can be
    seen from here to be missing or misnamed, before any work is done."""
    for name in ("cpus", "memory", "attempts", "processes", "minutes"):
        value = vars(launcher).get(name)
        if value is not None and not 0 < value < math.inf:
            raise ValueError(f"launcher.{name}={value:g} must be above 0, and no infinity.")
    if isinstance(launcher, RayConfig):
        ray_actors.check(launcher)
    if isinstance(launcher, SlurmConfig):
        slurm_jobs.check(launcher)
    return launcher


def count(launcher: LauncherConfig, wanted: int | None, jobs: int, worth: int) -> int:
    """How many workers to start (of SLURM: jobs); ``wanted`` None: as many as pay, which Ray is
    asked for itself. Raises ValueError for fewer than 1."""
    if launcher.name == "local":
        return workers.count(wanted, jobs, worth)
    if wanted is not None and wanted < 1:
        raise ValueError(f"workers={wanted}: give 1 or more, or null.")
    if wanted is not None:
        return wanted
    if isinstance(launcher, SlurmConfig):
        return max(1, jobs // (worth * launcher.processes))
    assert isinstance(launcher, RayConfig)
    return ray_actors.room(launcher)


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
    if isinstance(launcher, RayConfig):
        return ray_actors.results(task, groups, started, progress, launcher)
    if isinstance(launcher, SlurmConfig):
        return slurm_jobs.results(task, groups, started, progress, launcher)
    return workers.results(task, groups, started, progress)
