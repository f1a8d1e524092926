"""Run jobs in worker processes; if a worker dies, a new process runs its jobs.

Each worker has its own pipe and receives one group of jobs at a time. It sends each result as soon
as the job is finished. When a worker dies, its pipe closes, so no process waits for the worker. The
parent process ends the workers; if the parent was killed, each worker ends after its current job.
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

from mitigate.core.errors import error_message
from mitigate.core.progress import Progress, duration
from mitigate.core.signals import delay_signals, leave_to_parent, start_worker

# seconds to wait for messages from workers before checking for stuck workers and for Ctrl-C
SECOND = 1.0
STUCK = 60.0  # seconds after which a worker that is still busy with one job is reported
DEATHS = 1  # maximum number of workers that are replaced
ALONE = "set workers=1, or define its classes at the top level of a module"


class Task(Protocol):
    """A task that worker processes run; each worker receives a pickled copy."""

    preload: ClassVar[str]  # module that all workers need; it is imported once

    def ready(self) -> AbstractContextManager[None]:
        """Return a context manager for setup and cleanup, in which a process runs all its jobs."""
        ...

    def work(self, jobs: Sequence[Any]) -> Iterator[Any]:
        """Yield the results of a group's jobs, in order."""
        ...

    def name(self, job: Any) -> str:
        """Return a short name of the job, for messages."""
        ...


class WorkersDied(ValueError):
    """Too many workers died; all finished results were yielded before this error."""


def lost(what: str, attempts: int, done: int, total: int) -> WorkersDied:
    """Return the error for a group of jobs whose workers all died."""
    return WorkersDied(
        f"{what} was lost with its worker {attempts} times. {done} of {total} jobs are finished. "
        "Check the logs of the nodes; if memory ran out, reserve more (launcher.memory=4)."
    )


def cores() -> int:
    """Return the number of processor cores that this process may use.

    The environment variable PYTHON_CPU_COUNT overrides this number, as in Python 3.13 and later.
    """
    override = os.environ.get("PYTHON_CPU_COUNT", "")
    if override.isdigit() and int(override) > 0:
        return int(override)
    return len(os.sched_getaffinity(0)) if sys.platform == "linux" else os.cpu_count() or 1


def count(requested: int | None, jobs: int, worth: int) -> int:
    """Return the number of processes to start.

    Args:
        requested: number of processes that the user asked for. None means at most one per core.
        jobs: number of jobs.
        worth: minimum number of jobs per process; with fewer jobs, starting a process takes longer
            than it saves.

    Raises:
        ValueError: If ``requested`` is less than 1.
    """
    if requested is not None and requested < 1:
        raise ValueError(f"workers must be >= 1 or null (one per core), got {requested}.")
    return requested or max(1, min(cores(), jobs // worth))


def results(
    task: Task, groups: Sequence[Sequence[Any]], workers: int, progress: Progress
) -> Iterator[tuple[int, Any] | None]:
    """Yield (job number, result) pairs as results arrive.

    The numbers count the jobs of all groups. The jobs of a group run in order in one process: in
    the current process if ``workers`` is 1, otherwise in a worker. While waiting for workers, the
    generator yields None at least every ``SECOND``.

    If a worker dies, a new process runs its unfinished jobs. Only one worker per call is replaced;
    the death of a second worker is an error.

    Raises:
        WorkersDied: If a second worker died.
        Exception: A job raised an error, which is raised again here.
    """
    work = numbered(groups)
    workers = min(workers, len(work))
    if workers > 1:
        yield from _Crew(task, work, workers, progress).results()
    elif work:
        with task.ready():
            for group in work:
                outputs = task.work([job for _, job in group])
                for number, _ in group:
                    with delay_signals() as ending:  # a started job is finished first
                        result = next(outputs)
                    yield number, result
                    ending.check()


def numbered(groups: Sequence[Sequence[Any]]) -> list[list[tuple[int, Any]]]:
    """Return the non-empty groups with jobs as (number, job), numbered across all groups."""
    numbers = itertools.count()
    return [[(next(numbers), job) for job in group] for group in groups if len(group)]


class _Worker:
    """One worker process, its unfinished jobs, and the time of its last message."""

    def __init__(self, context: Any, task: bytes) -> None:
        self.pipe, theirs = context.Pipe()
        self.process = context.Process(target=_serve, args=(theirs, task), daemon=True)
        start_worker(self.process)
        # only the worker keeps this end open, so the pipe closes when the worker dies
        theirs.close()
        self.left: deque[tuple[int, Any]] = deque()
        self.heard = time.monotonic()
        self.reported = self.heard

    def give(self, group: Sequence[tuple[int, Any]]) -> None:
        jobs = packed([job for _, job in group], "A job of a worker", ALONE)
        self.left.extend(group)
        self.heard = time.monotonic()
        self.reported = self.heard
        with suppress(OSError):  # the process is dead; reading its pipe will report this
            self.pipe.send_bytes(jobs)

    def end(self) -> str:
        """End the process if it is still running, and return a description of how it ended."""
        # the exit code may become available only after the pipe is closed
        self.process.join(SECOND)
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
    """The worker processes, and the groups of jobs that no worker has received yet."""

    def __init__(
        self,
        task: Task,
        groups: Sequence[Sequence[tuple[int, Any]]],
        workers: int,
        progress: Progress,
    ) -> None:
        self.task = task
        self.progress = progress
        self.waiting = deque(groups)
        self.total = sum(map(len, groups))
        self.done = 0
        self.deaths = 0
        self.context = context(task.preload)
        # pickled without shared memory, so each worker gets its own copy of the tensors
        self.copy = packed(task, "The agent or its world", ALONE)
        self.crew: list[_Worker] = []
        self.size = workers

    def results(self) -> Iterator[tuple[int, Any] | None]:
        try:
            for _ in range(self.size):
                self.crew.append(_Worker(self.context, self.copy))
            while self.done < self.total:
                # after a signal, results that have already arrived are yielded before the error
                with delay_signals() as ending:
                    for worker in self.crew:
                        if not worker.left and self.waiting:
                            worker.give(self.waiting.popleft())
                    readable = {*wait([worker.pipe for worker in self.crew], SECOND)}
                for worker in [worker for worker in self.crew if worker.pipe in readable]:
                    yield from self._hear(worker)
                self._report_stuck()
                self.progress.advance(0)
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
            except (EOFError, OSError):  # the worker died, possibly in the middle of a message
                self._replace(worker)
                return
            if error is not None:
                raise error[0] from error[1]
            worker.heard = time.monotonic()
            worker.reported = worker.heard
            self.done += 1
            yield worker.left.popleft()[0], result

    def _replace(self, worker: _Worker) -> None:
        """Replace a dead worker with a new process; raise WorkersDied for a second dead worker."""
        cause = worker.end()
        self.crew.remove(worker)
        self.deaths += 1
        if self.deaths > DEATHS:
            raise WorkersDied(
                f"A second worker process was {cause}. {self.done} of {self.total} jobs are "
                f"finished. Use fewer than {self.size} workers (workers=1 takes the least memory). "
                "Scripts need `if __name__ == '__main__':`, since each worker imports them."
            )
        self.progress.say(
            f"A worker process was {cause}. Its unfinished jobs ({len(worker.left)}) start again "
            "in a new one."
        )
        if worker.left:
            self.waiting.appendleft(list(worker.left))
        self.crew.append(_Worker(self.context, self.copy))

    def _report_stuck(self) -> None:
        now = time.monotonic()
        for worker in self.crew:
            if worker.left and now - worker.reported > STUCK:
                worker.reported = now
                self.progress.say(
                    f"worker process {worker.process.pid} has been running "
                    f"{self.task.name(worker.left[0][1])} for {duration(now - worker.heard)}"
                )


def packed(thing: Any, what: str, instead: str, *, shared: bool = False) -> bytes:
    """Pickle ``thing`` for other processes.

    Args:
        thing: the object.
        what: name of the object in the error message.
        instead: what to do if the object cannot be pickled; this is the end of the error message.
        shared: whether to pass tensors in shared memory. Only one process may unpickle such an
            object, and only once.

    Raises:
        ValueError: If ``thing`` cannot be pickled.
    """
    try:
        return bytes(ForkingPickler.dumps(thing)) if shared else pickle.dumps(thing)
    except Exception as error:  # pickling nested objects may raise any error
        cause = " ".join(str(error).split())[:300]
        raise ValueError(
            f"{what} cannot be sent to other processes ({type(error).__name__}: {cause}). To fix "
            f"it, {instead}."
        ) from error


def context(preload: str) -> Any:
    """Return the multiprocessing context that starts workers.

    It uses a fork server that has imported ``preload``, so workers start fast. On systems without
    fork servers, each worker is a new interpreter.
    """
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([preload])
    return context


def _serve(pipe: Connection, copy: bytes) -> None:
    """Run a worker: receive groups of jobs, and send (result, None) per job or (None, error)."""
    leave_to_parent()
    try:
        task: Task = _unpacked(copy)
        with task.ready():
            while True:
                try:
                    message = pipe.recv_bytes()
                except (EOFError, OSError):  # the parent is gone
                    return
                for result in task.work(pickle.loads(message)):
                    what = "The result of a worker"
                    pipe.send_bytes(packed((result, None), what, ALONE, shared=True))
    except Exception as error:
        with suppress(OSError):  # the parent is gone
            pipe.send((None, portable(error)))


def _unpacked(copy: bytes) -> Any:
    """Unpickle a task.

    Raises:
        ValueError: If the class of the task is defined under ``if __name__ == "__main__":``, which
            workers do not run.
    """
    try:
        return pickle.loads(copy)
    except AttributeError as error:
        raise ValueError(
            f"A worker process cannot read its task ({error}). To fix it, {ALONE}."
        ) from error


def portable(error: Exception) -> tuple[Exception, Exception]:
    """Return a version of ``error`` that can be pickled, and a cause with the worker's traceback.

    If the user's code raised a ValueError, the file and line are appended to its message. An error
    that cannot be pickled is replaced with a RuntimeError with the same message.
    """
    cause = RuntimeError(f"in a worker process:\n{traceback.format_exc()}")
    error = ValueError(error_message(error)) if type(error) is ValueError else error
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return RuntimeError(str(error)), cause
    return error, cause
