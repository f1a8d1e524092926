"""Run worker processes that compute parts of an objective's batches.

An objective divides each training step into jobs (``objective.py``). A job is a pure function of
its content, the seed and the weights, and runs on one thread. The workers of ``core/workers.py``
exit when their task is done. In contrast, the workers of this module run during all stages of
training and receive new weights.
"""

from __future__ import annotations

import pickle
import time
from collections import deque
from contextlib import suppress
from multiprocessing.connection import Connection
from queue import SimpleQueue
from threading import Thread
from typing import Any

import torch

from mitigate.core import precision
from mitigate.core.memory import release_memory
from mitigate.core.progress import duration, say
from mitigate.core.signals import leave_to_parent, start_worker
from mitigate.core.workers import DEATHS, STUCK, WorkersDied, context, packed, portable
from mitigate.training.objective import Objective, do

# More workers do not help: a step has only 2 to 4 jobs, and few steps are computed in advance.
MOST = 8
PRELOAD = "mitigate.evaluation.evaluator"  # preloaded module, which imports the slow modules
# This is the number of jobs between two releases of memory.
# Releasing memory after every job costs 7 % of the time; releasing it after 8 jobs costs 1 %.
TRIM_EVERY = 8
ALONE = "use plain data, or train with workers=0"


class Workers:
    """Context manager for ``count`` worker processes of a training run.

    Job i of a step runs on worker ``i % count``. If there are enough workers for several steps at
    once, successive steps use different workers. A worker always computes the same part of the
    batch, so it opens only the scenes of that part.

    Workers run during all stages, so a stage reuses scenes that were built in an earlier stage.
    """

    def __init__(self, count: int) -> None:
        self._all = [_Worker(number) for number in range(count)]

    def __len__(self) -> int:
        return len(self._all)

    def __enter__(self) -> Workers:
        return self

    def __exit__(self, *_: object) -> None:
        for worker in self._all:
            worker.close()

    def take(self, objective: Objective, kind: str) -> None:
        """Send a copy of ``objective`` to every worker.

        The workers compute in the precision ``kind``. Raises ValueError if the objective cannot be
        pickled.
        """
        packed = _packed(objective)
        for worker in self._all:
            worker.take(packed, kind)

    def send_weights(self, objective: Objective) -> None:
        """Send the current trained weights and all buffers to the workers.

        Weights are sent by value, because shared tensors would change while a worker reads them.
        """
        trained = {
            name: p.detach().cpu() for name, p in objective.named_parameters() if p.requires_grad
        }
        buffers = {name: buffer.detach().cpu() for name, buffer in objective.named_buffers()}
        weights = pickle.dumps({**trained, **buffers})
        for worker in self._all:
            worker.renew(weights)

    def order(self, jobs: list[Any], turn: int = 0) -> None:
        """Send ``jobs`` to the workers. Their results are returned by :meth:`receive`.

        If ``turn`` increases by one per call, consecutive calls use different workers.
        """
        for worker, job in zip(self._of(len(jobs), turn), jobs, strict=True):
            worker.order(job)

    def receive(self, count: int, turn: int = 0) -> list[Any]:
        """Return the results of the next ``count`` jobs, in the order in which they were sent.

        Raises WorkersDied, or the error of a job.
        """
        return [worker.receive() for worker in self._of(count, turn)]

    def _of(self, jobs: int, turn: int) -> list[_Worker]:
        """Return the worker for each of ``jobs`` jobs."""
        first = jobs * (turn % max(1, len(self) // max(1, jobs)))
        return [self._all[(first + index) % len(self)] for index in range(jobs)]


class _Worker:
    """One worker process and its pending jobs.

    Each pending job is stored with the weights that it needs.
    """

    def __init__(self, number: int) -> None:
        self.number = number
        self.deaths = 0
        self.objective: tuple[bytes, str] | None = None
        # if None, the worker uses the weights of the pickled objective
        self.weights: bytes | None = None
        self.pending: deque[tuple[bytes | None, bytes]] = deque()
        self._start()

    def take(self, packed: bytes, kind: str) -> None:
        if self.pending:  # the pending jobs belong to an objective that was abandoned
            self._restart()
            self.pending.clear()
        self.objective, self.weights = (packed, kind), None
        self.send(("objective", packed, kind))

    def renew(self, weights: bytes) -> None:
        self.weights = weights
        self.send(("weights", weights))

    def order(self, job: Any) -> None:
        message = packed(job, "A job of this objective", ALONE)
        self.pending.append((self.weights, message))
        self.send(("job", message))

    def send(self, message: tuple) -> None:
        with suppress(BrokenPipeError, ConnectionResetError):  # receive() notices a dead worker
            self.connection.send(message)

    def receive(self) -> Any:
        try:
            waited = time.monotonic()
            while not self.connection.poll(STUCK):
                for_long = duration(time.monotonic() - waited)
                say(f"worker {self.number} ({self.process.pid}) has been silent for {for_long}")
            kind, value = self.connection.recv()
        # this also catches a worker that died in the middle of a message
        except (EOFError, OSError):
            self._replace()
            return self.receive()
        self.pending.popleft()
        if kind == "error":
            error, cause = value
            raise error from cause
        return value

    def close(self) -> None:
        self.connection.close()
        self.process.join(timeout=1)
        if self.process.is_alive():
            self.process.kill()

    def _start(self) -> None:
        processes = context(PRELOAD)
        self.connection, other = processes.Pipe()
        self.process = processes.Process(target=_serve, args=(other,), daemon=True)
        start_worker(self.process)
        other.close()  # closed here, so that the connection closes when the worker dies

    def _replace(self) -> None:
        self.process.join(timeout=1)
        code = self.process.exitcode
        what = f"worker {self.number} ended with code {code}"
        if self.deaths >= DEATHS or self.objective is None:
            raise WorkersDied(
                f"The {what}, for the second time. A negative code means that the process was "
                "killed, most likely because memory ran out. The checkpoints are complete. Run the "
                "same command again with fewer processes: workers=1, or workers=0 for none."
            )
        self.deaths += 1
        say(f"{what}; a new one repeats its work")
        self._restart()
        self.send(("objective", *self.objective))
        sent: bytes | None = None
        for weights, job in self.pending:
            if weights is not None and weights is not sent:
                self.send(("weights", weights))
            sent = weights
            self.send(("job", job))
        if self.weights is not None and self.weights is not sent:
            self.send(("weights", self.weights))

    def _restart(self) -> None:
        self.connection.close()
        self.process.kill()
        self._start()


def _packed(objective: Objective) -> bytes:
    hint = "remove attributes that cannot be pickled, or train with workers=0"
    device = next((p.device for p in objective.parameters()), torch.device("cpu"))
    if device.type == "cpu":
        return packed(objective, type(objective).__name__, hint)
    try:
        return packed(objective.cpu(), type(objective).__name__, hint)
    finally:
        objective.to(device)


def _serve(connection: Connection) -> None:
    """Run a worker: receive messages and send results of jobs until the connection ends."""
    leave_to_parent()
    messages: SimpleQueue[bytes | None] = SimpleQueue()
    Thread(target=_listen, args=(connection, messages), daemon=True).start()
    try:
        _work(connection, messages)
    except (BrokenPipeError, ConnectionResetError):
        pass  # the parent process has ended
    except Exception as error:  # for example, the objective cannot be unpickled in this process
        with suppress(OSError):
            connection.send(("error", portable(error)))


def _work(connection: Connection, messages: SimpleQueue) -> None:
    objective, kind, weights, done = Objective(), "fp32", {}, 0
    while (message := messages.get()) is not None:
        name, *content = pickle.loads(message)
        if name == "objective":
            objective, kind = pickle.loads(content[0]), content[1]
            weights = {**dict(objective.named_parameters()), **dict(objective.named_buffers())}
        elif name == "weights":
            with torch.no_grad():
                for entry, value in pickle.loads(content[0]).items():
                    weights[entry].copy_(value)
        else:
            connection.send_bytes(_answer(objective, content[0], kind))
            done += 1
            if done % TRIM_EVERY == 0:
                release_memory()


def _listen(connection: Connection, messages: SimpleQueue) -> None:
    """Receive messages from the parent in a thread, and put them into the queue.

    When the connection ends, None is put into the queue. The thread prevents a deadlock: the parent
    may send weights while the worker sends a result.
    """
    try:
        while True:
            messages.put(connection.recv_bytes())
    except (EOFError, OSError):
        messages.put(None)


def _answer(objective: Objective, job: bytes, kind: str) -> bytes:
    """Run a pickled job, and return its pickled result or error."""
    device = next((p.device for p in objective.parameters()), torch.device("cpu"))
    try:
        with precision.computing(kind, device):
            piece = do(objective, pickle.loads(job))
        return packed(("done", piece), "A piece of a batch", ALONE, shared=True)
    except Exception as error:
        return pickle.dumps(("error", portable(error)))
