"""Run workers as actors of a Ray cluster.

The task, which contains the agent's weights, is in Ray's object store, so each node receives it
only once. Each result is returned when it becomes available. When an actor or its node dies, a new
actor takes over the unfinished jobs.
"""

from __future__ import annotations

import re
import time
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from importlib.util import find_spec
from typing import Any

from mitigate.cluster.config import RayConfig
from mitigate.core.names import short
from mitigate.core.progress import Progress
from mitigate.core.workers import SECOND, STUCK, Task, lost, numbered

GIGABYTE = 1 << 30


class Worker:
    """Ray actor that runs the jobs of a group one after the other."""

    def __init__(self, task: Task) -> None:
        self.task = task
        self.contexts = ExitStack()

    def started(self) -> None:
        """Return once the actor runs and its task is ready. Errors of the setup are raised.

        An actor may have to wait for room in the cluster, so it receives jobs only afterwards.
        """
        self.contexts.enter_context(self.task.ready())

    def work(self, jobs: Sequence[Any]) -> Iterator[Any]:
        """Yield the result of each job, in order."""
        yield from self.task.work(jobs)


def check(launcher: RayConfig) -> None:
    """Raise ValueError if ray is not installed or the address is invalid."""
    if find_spec("ray") is None:
        raise ValueError("launcher=ray needs ray: pip install -e '.[cluster]'.")
    address = launcher.address
    if address is not None and not re.fullmatch(r"auto|local|ray://\S+|\S+:\d+", address):
        raise ValueError(
            "launcher.address must be auto, ray://host:10001, host:6379, or null for a cluster on "
            f"this machine, got {short(address)}."
        )


def connect(launcher: RayConfig) -> Any:
    """Connect Ray to the cluster of ``launcher``, and return the module ray.

    Without an address, a cluster is started on this machine; it stops when this process ends.
    Raises ValueError in the same cases as :func:`check`, and if there is no cluster.
    """
    check(launcher)
    import ray

    if not ray.is_initialized():
        try:
            ray.init(launcher.address, log_to_driver=False, include_dashboard=False)
        except (ConnectionError, ValueError) as error:
            raise ValueError(
                f"There is no Ray cluster at launcher.address={launcher.address} "
                f"({str(error).splitlines()[0]}). Start one (ray start --head), or leave out the "
                "address to use this machine."
            ) from error
    return ray


def room(launcher: RayConfig) -> int:
    """Return how many workers the cluster has room for."""
    resources = connect(launcher).cluster_resources()
    count = int(resources.get("CPU", 1) // launcher.cpus)
    if launcher.memory:
        count = min(count, int(resources.get("memory", 0) // (launcher.memory * GIGABYTE)))
    return max(1, count)


def results(
    task: Task,
    groups: Sequence[Sequence[Any]],
    workers: int,
    progress: Progress,
    launcher: RayConfig,
) -> Iterator[tuple[int, Any] | None]:
    """Yield results in the same form as ``launcher.results``."""
    crew = _Crew(connect(launcher), task, groups, workers, progress, launcher)
    try:
        yield from crew.results()
    finally:
        crew.end()


class _Crew:
    """The actors, their unfinished jobs, and the groups of jobs that no actor has received yet."""

    def __init__(
        self,
        ray: Any,
        task: Task,
        groups: Sequence[Sequence[Any]],
        workers: int,
        progress: Progress,
        launcher: RayConfig,
    ) -> None:
        self.ray = ray
        self.launcher = launcher
        self.progress = progress
        self.waiting = deque((group, 1) for group in numbered(groups))
        self.total = sum(len(group) for group, _ in self.waiting)
        self.done = 0
        self.size = min(workers, len(self.waiting))
        self.task = ray.put(task)
        self.reserved = {"num_cpus": launcher.cpus, "max_restarts": 0}
        if launcher.memory:
            self.reserved["memory"] = int(launcher.memory * GIGABYTE)
        self.failures = 0
        self.make = ray.remote(Worker).options(**self.reserved).remote
        self.name = task.name
        self.idle: list[Any] = []
        self.starting: dict[Any, Any] = {}  # maps a pending result of ``started`` to its actor
        # maps a stream of results to a tuple: actor, remaining jobs, number of the attempt
        self.busy: dict[Any, tuple[Any, deque, int]] = {}

    def results(self) -> Iterator[tuple[int, Any] | None]:
        for _ in range(self.size):
            self._start()
        heard = time.monotonic()
        while self.done < self.total:
            while self.idle and self.waiting:
                self._give(self.idle.pop(), *self.waiting.popleft())
            ready, _ = self.ray.wait([*self.busy, *self.starting], timeout=SECOND)
            for answer in ready:
                heard = time.monotonic()
                if answer in self.starting:
                    self._welcome(answer)
                else:
                    yield from self._hear(answer)
            if not self.busy and time.monotonic() - heard > STUCK:
                heard = time.monotonic()
                self.progress.say(f"No worker runs: the cluster has no room for {self.reserved}.")
            self.progress.advance(0)
            yield None

    def _start(self) -> None:
        actor = self.make(self.task)
        self.starting[actor.started.remote()] = actor

    def _welcome(self, answer: Any) -> None:
        """Handle an actor that has started, or that died before it started."""
        actor = self.starting.pop(answer)
        try:
            self.ray.get(answer)
        except self.ray.exceptions.RayTaskError as error:
            raise error.cause from None
        except self.ray.exceptions.RayError as error:
            self.failures += 1
            if self.failures > self.launcher.attempts * self.size:
                what = f"A worker, before its first job ({error}),"
                raise lost(what, self.failures, self.done, self.total) from None
            self._start()
        else:
            self.idle.append(actor)

    def _give(self, actor: Any, group: Sequence[tuple[int, Any]], attempt: int) -> None:
        """Start a group of jobs on ``actor``."""
        work = actor.work.options(num_returns="streaming")
        stream = work.remote([job for _, job in group])
        self.busy[stream] = (actor, deque(group), attempt)

    def _hear(self, stream: Any) -> Iterator[tuple[int, Any]]:
        """Yield the next result of a stream.

        If the stream has ended, handle the end of the group or the death of the actor.
        """
        actor, left, attempt = self.busy[stream]
        try:
            result = self.ray.get(next(stream))
        except StopIteration:
            del self.busy[stream]
            self.idle.append(actor)
        except self.ray.exceptions.RayTaskError as error:
            raise error.cause from None
        except self.ray.exceptions.RayError as error:
            del self.busy[stream]
            self._replace(left, attempt, error)
        else:
            self.done += 1
            yield left.popleft()[0], result

    def _replace(self, left: deque, attempt: int, error: Exception) -> None:
        """Start a new actor, anywhere in the cluster, to replace an actor that died."""
        self._start()
        if not left:
            return
        if attempt >= self.launcher.attempts:
            raise lost(self.name(left[0][1]), attempt, self.done, self.total) from None
        self.progress.say(
            f"A worker was lost ({type(error).__name__}). Its unfinished jobs ({len(left)}) start "
            "again on another."
        )
        self.waiting.appendleft((list(left), attempt + 1))

    def end(self) -> None:
        """Kill all actors."""
        busy = [actor for actor, _, _ in self.busy.values()]
        for actor in [*self.idle, *self.starting.values(), *busy]:
            self.ray.kill(actor)
