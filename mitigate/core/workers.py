"""Worker processes that cannot hang: a dead one is noticed at once, and its jobs are done again.

Each worker has a pipe of its own and is given one group of jobs at a time; results come back one
by one. When a worker dies its pipe closes, so nothing waits for it. Workers are ended by the
process that started them; if that was killed, each ends after the job at hand.
"""

from __future__ import annotations

import itertools
import multiprocessing
import os
import pickle
import signal
import sys
import time
import traceback
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, suppress
from multiprocessing.connection import Connection, wait
from multiprocessing.reduction import ForkingPickler
from typing import Any, ClassVar, Protocol

from mitigate.core.errors import said
from mitigate.core.progress import Progress, duration
from mitigate.core.signals import held, leave_to_parent, start_worker

SECOND = 1.0  # between two looks at workers that say nothing
STUCK = 60.0  # seconds with one job after which a worker is reported, and again after as many
DEATHS = 1  # workers that are replaced
ALONE = "give workers=1, or define what it holds at the head of a module"


class Task(Protocol):
    """What workers do. Each gets a copy of it (by pickle), made in the process that asks."""

    preload: ClassVar[str]  # module that all workers need, imported once for all of them

    def ready(self) -> AbstractContextManager[None]:
        """Around all jobs of a process: what it sets up once, and puts back."""
        ...

    def work(self, jobs: Sequence[Any]) -> Iterator[Any]:
        """The result of each job of a group, in order."""
        ...

    def name(self, job: Any) -> str:
        """The job in a few words, for a line about a worker that is stuck with it."""
        ...


class WorkersDied(ValueError):
    """Workers died more often than they are replaced; the results so far were handed out."""


def lost(what: str, attempts: int, done: int, total: int) -> WorkersDied:
    """The error for a group of jobs that no worker finished."""
    return WorkersDied(
        f"{what} was lost with its worker {attempts} times. {done} of {total} jobs are finished. "
        "Look at the nodes' logs; if memory ran out, reserve more (launcher.memory=4)."
    )


def cores() -> int:
    """Processor cores that this process may use; the environment variable PYTHON_CPU_COUNT, which
    Python itself reads from 3.13 on, says another number."""
    told = os.environ.get("PYTHON_CPU_COUNT", "")
    if told.isdigit() and int(told) > 0:
        return int(told)
    return len(os.sched_getaffinity(0)) if sys.platform == "linux" else os.cpu_count() or 1


def count(wanted: int | None, jobs: int, worth: int) -> int:
    """How many processes to start for ``jobs``.

    ``wanted``; None: as many as there are cores, but none for less than ``worth`` jobs, below
    which starting it takes longer than it saves. Raises ValueError for fewer than 1.
    """
    if wanted is not None and wanted < 1:
        raise ValueError(f"workers={wanted}: give 1 or more processes, or null for one a core.")
    return wanted or max(1, min(cores(), jobs // worth))


def results(
    task: Task, groups: Sequence[Sequence[Any]], workers: int, progress: Progress
) -> Iterator[tuple[int, Any] | None]:
    """Yield (number of the job, its result) as they come, jobs numbered through all groups.

    The jobs of a group run one after the other in one process: this one if ``workers`` is 1, else
    one of so many. None is yielded at least every ``SECOND`` while workers are awaited. The first
    worker that dies is replaced, and what it had not finished runs again in a fresh process; at
    the next, WorkersDied is raised. What a job raises is raised here.
    """
    given = numbered(groups)
    workers = min(workers, len(given))
    if workers > 1:
        yield from _Crew(task, given, workers, progress).results()
    elif given:
        with task.ready():
            for group in given:
                found = task.work([job for _, job in group])
                for number, _ in group:
                    with held() as ending:  # a job that was begun is finished
                        result = next(found)
                    yield number, result
                    ending.check()


def numbered(groups: Sequence[Sequence[Any]]) -> list[list[tuple[int, Any]]]:
    """The jobs of each group with their numbers, counted through all groups; no empty group."""
    numbers = itertools.count()
    return [[(next(numbers), job) for job in group] for group in groups if len(group)]


class _Worker:
    """One process, what it still has to do, and when it last said something."""

    def __init__(self, context: Any, task: bytes) -> None:
        self.pipe, theirs = context.Pipe()
        self.process = context.Process(target=_serve, args=(theirs, task), daemon=True)
        start_worker(self.process)
        theirs.close()  # so that its death closes the pipe
        self.left: deque[tuple[int, Any]] = deque()
        self.heard = self.told = time.monotonic()

    def give(self, group: Sequence[tuple[int, Any]]) -> None:
        jobs = packed([job for _, job in group], "What a worker is to do", ALONE)
        self.left.extend(group)
        self.heard = self.told = time.monotonic()
        with suppress(OSError):  # it is dead, as whoever reads the pipe will see
            self.pipe.send_bytes(jobs)

    def end(self) -> str:
        """Make sure that it is dead; say what it died of."""
        self.process.join(SECOND)  # its exit code may come a moment after its pipe closed
        code = self.process.exitcode
        self.process.kill()
        self.process.join()
        self.pipe.close()
        if code == -signal.SIGKILL:
            return "killed (SIGKILL), as the system does when memory runs out"
        if code is not None and code < 0:
            return f"ended by {signal.Signals(-code).name}"
        return f"ended with {code}"


class _Crew:
    """The workers and the groups that none of them has yet."""

    def __init__(
        self,
        task: Task,
        groups: Sequence[Sequence[tuple[int, Any]]],
        workers: int,
        progress: Progress,
    ) -> None:
        self.task, self.progress = task, progress
        self.waiting = deque(groups)
        self.total, self.done, self.deaths = sum(map(len, groups)), 0, 0
        self.context = context(task.preload)
        self.copy = packed(task, "The agent or its world", ALONE)  # tensors do not become shared
        self.crew: list[_Worker] = []
        self.size = workers

    def results(self) -> Iterator[tuple[int, Any] | None]:
        try:
            for _ in range(self.size):
                self.crew.append(_Worker(self.context, self.copy))
            while self.done < self.total:
                with held() as ending:  # what is there to hear is handed out before it ends
                    for worker in self.crew:
                        if not worker.left and self.waiting:
                            worker.give(self.waiting.popleft())
                    readable = {*wait([worker.pipe for worker in self.crew], SECOND)}
                for worker in [worker for worker in self.crew if worker.pipe in readable]:
                    yield from self._hear(worker)
                self._report_stuck()
                yield None
                ending.check()
        finally:
            for worker in self.crew:
                worker.process.kill()
            for worker in self.crew:
                worker.end()

    def _hear(self, worker: _Worker) -> Iterator[tuple[int, Any]]:
        while True:
            try:
                if not worker.pipe.poll():
                    return
                result, error = worker.pipe.recv()
            except (EOFError, OSError):  # it died, maybe in the middle of a message
                self._replace(worker)
                return
            if error is not None:
                raise error[0] from error[1]
            worker.heard = worker.told = time.monotonic()
            self.done += 1
            yield worker.left.popleft()[0], result

    def _replace(self, worker: _Worker) -> None:
        """Put a fresh process in the place of a dead one, if it is the first."""
        cause = worker.end()
        self.crew.remove(worker)
        self.deaths += 1
        if self.deaths > DEATHS:
            own = " A script keeps what it calls under `if __name__ == '__main__':`, since each "
            own += "worker reads it."
            raise WorkersDied(
                f"A second worker process was {cause}. {self.done} of {self.total} jobs are "
                f"finished. There were {self.size} workers: give fewer (workers=1 takes the least "
                f"memory), or free some memory.{own if cause.startswith('ended with') else ''}"
            )
        self.progress.say(
            f"A worker process was {cause}. What it had not finished "
            f"({len(worker.left)} jobs) starts again in a fresh one."
        )
        if worker.left:
            self.waiting.appendleft(list(worker.left))
        self.crew.append(_Worker(self.context, self.copy))

    def _report_stuck(self) -> None:
        now = time.monotonic()
        for worker in self.crew:
            if worker.left and now - worker.told > STUCK:
                worker.told = now
                self.progress.say(
                    f"worker process {worker.process.pid} has been at "
                    f"{self.task.name(worker.left[0][1])} for {duration(now - worker.heard)}"
                )


def packed(thing: Any, what: str, instead: str, *, shared: bool = False) -> bytes:
    """``thing`` for other processes, by value; ``shared``: its tensors by shared memory, for one
    process that reads it once. Raises ValueError, which names ``what`` it is and what to do
    ``instead``, where it cannot be pickled."""
    try:
        return bytes(ForkingPickler.dumps(thing)) if shared else pickle.dumps(thing)
    except Exception as error:  # of any kind: what is in it pickles itself
        cause = " ".join(str(error).split())[:300]
        raise ValueError(
            f"{what} cannot be sent to other processes ({type(error).__name__}: {cause}): "
            f"{instead}."
        ) from error


def context(preload: str) -> Any:
    """Where workers come from: a process that has imported ``preload`` and forks, if there can be
    one (the next crew then starts at once), else fresh interpreters."""
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([preload])
    return context


def _serve(pipe: Connection, copy: bytes) -> None:
    """A worker's life: groups of jobs in, (result, None) or (None, error) out."""
    leave_to_parent()
    try:
        task: Task = _unpacked(copy)
        with task.ready():
            while jobs := _next(pipe):
                for result in task.work(jobs):
                    what = "What a worker found"
                    pipe.send_bytes(packed((result, None), what, ALONE, shared=True))
    except Exception as error:
        with suppress(OSError):  # the parent is gone
            pipe.send((None, portable(error)))


def _unpacked(copy: bytes) -> Any:
    """What :func:`packed` made; ValueError for a class below ``if __name__ == "__main__":``."""
    try:
        return pickle.loads(copy)
    except AttributeError as error:
        raise ValueError(f"A worker process cannot read its task ({error}): {ALONE}.") from error


def _next(pipe: Connection) -> list[Any]:
    try:
        message = pipe.recv_bytes()
    except (EOFError, OSError):
        return []  # the parent is gone
    return pickle.loads(message)


def portable(error: Exception) -> tuple[Exception, Exception]:
    """``error``, a ValueError with the place in a user's code, and a cause that shows the worker's
    traceback; a RuntimeError with its text in place of one that cannot be pickled."""
    cause = RuntimeError(f"in a worker process:\n{traceback.format_exc()}")
    error = ValueError(said(error)) if type(error) is ValueError else error
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return RuntimeError(str(error)), cause
    return error, cause
