"""Choose where worker processes run: ``launcher=local | ray | slurm``."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from mitigate.cluster import ray_actors, slurm_jobs
from mitigate.cluster.config import LauncherConfig, RayConfig, SlurmConfig
from mitigate.core import workers
from mitigate.core.progress import Progress
from mitigate.core.workers import Task


def chosen(launcher: LauncherConfig) -> LauncherConfig:
    """Check ``launcher`` before any work is done, and return it.

    Raises:
        ValueError: If a number is out of range, a package is missing, or the cluster is unknown or
            cannot be reached.
    """
    for name in ("cpus", "memory", "attempts", "processes", "minutes"):
        value = vars(launcher).get(name)
        if value is not None and not 0 < value < math.inf:
            raise ValueError(f"launcher.{name} must be > 0 and finite, got {value:g}.")
    if isinstance(launcher, RayConfig):
        ray_actors.check(launcher)
    if isinstance(launcher, SlurmConfig):
        slurm_jobs.check(launcher)
    return launcher


def count(launcher: LauncherConfig, requested: int | None, jobs: int, worth: int) -> int:
    """Return the number of workers to start (for SLURM, the number of SLURM jobs).

    Args:
        launcher: place where the workers run.
        requested: the requested number. None means as many workers as are worth starting, or as
            many as fit into the Ray cluster.
        jobs: number of jobs.
        worth: minimum number of jobs per process; with fewer jobs, starting a process costs more
            time than it saves.

    Raises:
        ValueError: If ``requested`` is less than 1.
    """
    if launcher.name == "local":
        return workers.count(requested, jobs, worth)
    if requested is not None and requested < 1:
        raise ValueError(f"workers must be >= 1 or null, got {requested}.")
    if requested is not None:
        return requested
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
    """Run jobs in ``started`` workers of the launcher, and yield (job number, result) pairs.

    As with ``core.workers.results``, each result is yielded exactly once, even if workers die.

    Raises:
        WorkersDied: If the worker of a group of jobs died too often.
        Exception: The error that a job raised.
    """
    if isinstance(launcher, RayConfig):
        return ray_actors.results(task, groups, started, progress, launcher)
    if isinstance(launcher, SlurmConfig):
        return slurm_jobs.results(task, groups, started, progress, launcher)
    return workers.results(task, groups, started, progress)
