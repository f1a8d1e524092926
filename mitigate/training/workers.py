"""Worker processes that make the pieces of an objective's batches.

An objective names the jobs of a step (``objective.py``); each is a pure function of itself, the
seed and the weights, and is done on one thread. Unlike those of ``core/workers.py``, which end with
their one task, these live through all stages of a training, and receive new weights.
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
from mitigate.core.memory import give_back
from mitigate.core.progress import duration, say
from mitigate.core.signals import leave_to_parent, start_worker
from mitigate.core.workers import WorkersDied, context, packed, portable
from mitigate.training.objective import Objective, do

MOST = 8  # workers worth starting: the recipes make 2 to 4 pieces of a step, some steps ahead
PRELOAD = "mitigate.evaluation.evaluator"  # has what takes long to import
STUCK = 60.0  # seconds without a word after which an awaited worker is reported (ours)
TRIM_EVERY = 8  # jobs of a worker; after each it costs 7 % of their time, after 8 less than 1 %
ALONE = "make it of plain data, or train with workers=0"
DEATHS = 1  # times that a worker is started anew before the training stops


class Workers:
    """``count`` processes; job i of a step is done by worker ``i % count``, or, where there are
    workers for several steps at once, by that of the step's turn. Either way a worker meets one
    number i only, modulo the jobs of a step, so it opens the scenes of that piece alone.

    They live through all stages of a training, so apartments and scenes that one stage has built
    serve the next. Use it as a context manager.
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
        """Give every worker its own copy of ``objective``, to compute in the precision ``kind``.

        Raises ValueError if the objective cannot be pickled.
        """
        packed = _packed(objective)
        for worker in self._all:
            worker.take(packed, kind)

    def send_weights(self, objective: Objective) -> None:
        """Bring the copies of the trained weights and of all buffers up to date.

        They are sent as they are now: tensors would be shared, and change while a worker reads.
        """
        trained = {
            name: p.detach().cpu() for name, p in objective.named_parameters() if p.requires_grad
        }
        buffers = {name: buffer.detach().cpu() for name, buffer in objective.named_buffers()}
        weights = pickle.dumps({**trained, **buffers})
        for worker in self._all:
            worker.renew(weights)

    def order(self, jobs: list[Any], turn: int = 0) -> None:
        """Have ``jobs`` done; :meth:`receive` returns what they give. What is ordered at once goes
        to as many workers as there are if its ``turn`` goes up by one from order to order."""
        for worker, job in zip(self._of(len(jobs), turn), jobs, strict=True):
            worker.order(job)

    def receive(self, count: int, turn: int = 0) -> list[Any]:
        """Return what the next ``count`` jobs gave, in the order of one :meth:`order`.

        Raises what a job raised, and WorkersDied.
        """
        return [worker.receive() for worker in self._of(count, turn)]

    def _of(self, jobs: int, turn: int) -> list[_Worker]:
        """Who does each of ``jobs``."""
        first = jobs * (turn % max(1, len(self) // max(1, jobs)))
        return [self._all[(first + index) % len(self)] for index in range(jobs)]


class _Worker:
    """One process and what it was given to do, each job with the weights that it is done with."""

    def __init__(self, number: int) -> None:
        self.number, self.deaths = number, 0
        self.objective: tuple[bytes, str] | None = None
        self.weights: bytes | None = None  # None: those of the objective
        self.pending: deque[tuple[bytes | None, bytes]] = deque()
        self._start()

    def take(self, packed: bytes, kind: str) -> None:
        if self.pending:  # of an objective that was given up: nobody will ask for them
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
        with suppress(BrokenPipeError, ConnectionResetError):  # receive() notices
            self.connection.send(message)

    def receive(self) -> Any:
        try:
            waited = time.monotonic()
            while not self.connection.poll(STUCK):
                for_long = duration(time.monotonic() - waited)
                say(f"worker {self.number} ({self.process.pid}) says nothing for {for_long}")
            kind, value = self.connection.recv()
        except (EOFError, OSError):  # also "got end of file during message": it died in a word
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
        made = context(PRELOAD)
        self.connection, other = made.Pipe()
        self.process = made.Process(target=_serve, args=(other,), daemon=True)
        start_worker(self.process)
        other.close()  # so that the worker's death ends the connection

    def _replace(self) -> None:
        self.process.join(timeout=1)
        code = self.process.exitcode
        what = f"worker {self.number} ended with code {code}"
        if self.deaths >= DEATHS or self.objective is None:
            killed = code is not None and code < 0
            cause = (
                "it was killed, most likely because the memory ran out"
                if killed
                else "what it printed says why"
            )
            raise WorkersDied(
                f"The {what}, and not for the first time: {cause}. Checkpoints are kept. Run the "
                "same command again, with fewer processes: workers=1, or 0 for none."
            )
        self.deaths += 1
        say(f"{what}; a new one does its work again")
        self._restart()
        self.send(("objective", *self.objective))
        given: bytes | None = None
        for weights, job in self.pending:
            if weights is not None and weights is not given:
                self.send(("weights", weights))
            given = weights
            self.send(("job", job))
        if self.weights is not None and self.weights is not given:
            self.send(("weights", self.weights))

    def _restart(self) -> None:
        self.connection.close()
        self.process.kill()
        self._start()


def _packed(objective: Objective) -> bytes:
    own = "keep what cannot be pickled out of its attributes, or train with workers=0"
    device = next((p.device for p in objective.parameters()), torch.device("cpu"))
    if device.type == "cpu":  # it stays as it is
        return packed(objective, type(objective).__name__, own)
    try:
        return packed(objective.cpu(), type(objective).__name__, own)
    finally:
        objective.to(device)


def _serve(connection: Connection) -> None:
    """The life of a worker: messages in, the results of jobs out, until the connection ends."""
    leave_to_parent()
    told: SimpleQueue[bytes | None] = SimpleQueue()
    Thread(target=_listen, args=(connection, told), daemon=True).start()
    try:
        _work(connection, told)
    except (BrokenPipeError, ConnectionResetError):
        pass  # the parent is gone
    except Exception as error:  # of the program: an objective that cannot be unpacked here, say
        with suppress(OSError):
            connection.send(("error", portable(error)))


def _work(connection: Connection, told: SimpleQueue) -> None:
    objective, kind, weights, done = Objective(), "fp32", {}, 0
    while (message := told.get()) is not None:
        name, *given = pickle.loads(message)
        if name == "objective":
            objective, kind = pickle.loads(given[0]), given[1]
            weights = {**dict(objective.named_parameters()), **dict(objective.named_buffers())}
        elif name == "weights":
            with torch.no_grad():
                for entry, value in pickle.loads(given[0]).items():
                    weights[entry].copy_(value)
        else:
            connection.send_bytes(_answer(objective, given[0], kind))
            done += 1
            if done % TRIM_EVERY == 0:
                give_back()


def _listen(connection: Connection, told: SimpleQueue) -> None:
    """Hear the parent while a piece is made or given back: it may have weights to send meanwhile,
    and neither would go on if both waited to be heard. None at the end."""
    try:
        while True:
            told.put(connection.recv_bytes())
    except (EOFError, OSError):
        told.put(None)


def _answer(objective: Objective, job: bytes, kind: str) -> bytes:
    """What a packed job gives, or the error that it raises, packed."""
    device = next((p.device for p in objective.parameters()), torch.device("cpu"))
    try:
        with precision.computing(kind, device):
            made = do(objective, pickle.loads(job))
        return packed(("done", made), "A piece of a batch", ALONE, shared=True)
    except Exception as error:
        return pickle.dumps(("error", portable(error)))
