"""Workers as jobs of a SLURM cluster, submitted by submitit; or as processes of this machine, to
try it (``launcher.cluster=local``).

Each job takes a share of the groups, runs them in its own worker processes and appends a line for
each result to a file in a folder that all nodes see. Whoever submitted them reads the lines as
they come; when a job ends without having done its share, the rest is submitted again.
"""

from __future__ import annotations

import json
import os
import pickle
import re
import shutil
import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from mitigate.cluster.config import SlurmConfig
from mitigate.core.files import write_bytes
from mitigate.core.names import short, unknown
from mitigate.core.output import open_output
from mitigate.core.progress import Progress
from mitigate.core.workers import SECOND, Task, lost, numbered
from mitigate.core.workers import results as run_here

CLUSTERS = ("slurm", "local")
LATE = 30.0  # seconds that jobs without work may take to end (ours)
TASK = "task.pickle"  # by whoever submits, for the jobs: no file from outside is unpickled


@dataclass
class _Share:
    """A job and the part of the work that it has: ``left`` by the jobs' numbers; ``read``: bytes of
    ``lines`` that were read."""

    job: Any
    groups: Sequence[Sequence[tuple[int, Any]]]
    lines: Path
    left: dict[int, Any]
    attempt: int
    read: int = 0


def results(
    task: Task,
    groups: Sequence[Sequence[Any]],
    workers: int,
    progress: Progress,
    launcher: SlurmConfig,
) -> Iterator[tuple[int, Any] | None]:
    """As ``launcher.results``; ``workers`` is the number of jobs. Their folder is removed when all
    is done; otherwise their logs stay in it, but never the task, with the agent's weights."""
    check(launcher)
    folder = Path(launcher.folder).resolve() / f"{int(time.time())}-{os.getpid()}"
    executor = _executor(launcher, folder)
    given = numbered(groups)
    total, done = sum(map(len, given)), 0
    shares = [given[at::workers] for at in range(min(workers, len(given)))]
    running: list[_Share] = []
    try:
        write_bytes(folder / TASK, pickle.dumps(task))
        for number, share in enumerate(shares):
            running.append(_submit(executor, folder, launcher, share, 1, number))
        progress.say(f"{len(running)} jobs submitted; their logs are in {folder}")
        submitted = len(running)
        while done < total:
            for held in list(running):
                over = held.job.done()  # before its lines are read: nothing comes after
                for number, result in _fresh(held):
                    done += 1
                    yield number, result
                if not over:
                    continue
                running.remove(held)
                if held.left:
                    again = _again(held, task, launcher, progress, done, total)
                    groups_left = [[j for j in group if j[0] in held.left] for group in held.groups]
                    groups_left = [group for group in groups_left if group]
                    running.append(
                        _submit(executor, folder, launcher, groups_left, again, submitted)
                    )
                    submitted += 1
            yield None
            time.sleep(SECOND / 4)
        _end(running, folder)
    finally:
        for held in running:
            held.job.cancel()
        (folder / TASK).unlink(missing_ok=True)
        with suppress(OSError):  # it has the logs of jobs
            folder.rmdir()


def _end(running: list[_Share], folder: Path) -> None:
    """Let the jobs, whose results are all here, end by themselves, and remove their folder."""
    waited = time.monotonic()
    while running and time.monotonic() - waited < LATE:
        running[:] = [share for share in running if not share.job.done()]
        time.sleep(SECOND / 4)
    if not running:
        shutil.rmtree(folder, ignore_errors=True)


def check(launcher: SlurmConfig) -> None:
    """Raise ValueError if submitit is not installed, and for a cluster that cannot be reached."""
    if find_spec("submitit") is None:
        raise ValueError("launcher=slurm needs submitit: pip install -e '.[cluster]'.")
    if launcher.cluster not in CLUSTERS:
        raise ValueError(unknown("launcher.cluster", launcher.cluster, CLUSTERS))
    if launcher.cluster == "slurm" and shutil.which("sbatch") is None:
        raise ValueError(
            "There is no SLURM here (no sbatch). Start this on a login node, or try it with "
            "launcher.cluster=local."
        )


def _executor(launcher: SlurmConfig, folder: Path) -> Any:
    import submitit

    executor = submitit.AutoExecutor(folder=folder / "logs", cluster=launcher.cluster)
    executor.update_parameters(
        name="mitigate",
        timeout_min=launcher.minutes,
        cpus_per_task=launcher.processes,
        mem_gb=launcher.memory * launcher.processes,
        **{f"slurm_{name}": value for name, value in launcher.options.items()},
    )
    return executor


def _submit(
    executor: Any,
    folder: Path,
    launcher: SlurmConfig,
    groups: Sequence[Sequence[tuple[int, Any]]],
    attempt: int,
    number: int,
) -> _Share:
    """Submit a job for ``groups``."""
    lines = folder / f"results-{number}.jsonl"
    job = executor.submit(serve, folder / TASK, list(groups), launcher.processes, lines)
    return _Share(job, groups, lines, {n: j for group in groups for n, j in group}, attempt)


def serve(
    task: Path, groups: Sequence[Sequence[tuple[int, Any]]], processes: int, lines: Path
) -> None:
    """A job's life: run ``groups``, a line for each result, ``{"job": number, "result": ...}``, or
    ``{"error": text}`` at a ValueError, which would come again on any node."""
    with open(task, "rb") as file:
        held: Task = pickle.load(file)
    numbers = [number for group in groups for number, _ in group]
    jobs = [[job for _, job in group] for group in groups]
    opened = open_output(lines, "a", encoding="utf-8")
    with opened as out, Progress("jobs", len(numbers)) as progress:
        try:
            for found in run_here(held, jobs, processes, progress):
                if found is not None:
                    out.write(json.dumps({"job": numbers[found[0]], "result": found[1]}) + "\n")
                    out.flush()
                    progress.advance()
        except ValueError as error:
            out.write(json.dumps({"error": str(error)}) + "\n")
            raise


def _fresh(share: _Share) -> Iterator[tuple[int, Any]]:
    """Results of a share that were not read before, each once; a line without end comes later.
    Raises the ValueError that its job tells of."""
    if not share.lines.is_file():
        return
    with open(share.lines, "rb") as file:
        file.seek(share.read)
        for line in file:
            if not line.endswith(b"\n"):
                break
            share.read += len(line)
            told = _parse(line, share.lines)
            if "error" in told:
                raise ValueError(told["error"])
            if share.left.pop(told["job"], None) is not None:
                yield told["job"], told["result"]


def _parse(line: bytes, file: Path) -> dict[str, Any]:
    """Return the result in one line. Raises ValueError, naming the file, if it is damaged."""
    try:
        told: Any = json.loads(line)
    except ValueError:
        told = None
    if not isinstance(told, dict) or not ("error" in told or {"job", "result"} <= told.keys()):
        raise ValueError(
            f"{file} has a damaged line, {short(line.decode(errors='replace'))}. The results "
            "before it were kept. Run the same command again."
        )
    return told


def _again(
    share: _Share, task: Task, launcher: SlurmConfig, progress: Progress, done: int, total: int
) -> int:
    """Which attempt the rest of a share is. Raises WorkersDied after too many."""
    try:
        problem: Any = share.job.exception()
    except Exception as error:  # submitit's own, of a job that left no result
        problem = error
    said = re.findall(r"^\w*(?:Error|Died|Exception): .*$", str(problem), re.MULTILINE)
    cause = said[-1] if said else "it was killed, or ran out of time"
    if share.attempt >= launcher.attempts:
        first = next(iter(share.left.values()))
        raise lost(f"{task.name(first)} ({cause})", share.attempt, done, total)
    progress.say(
        f"job {share.job.job_id} ended early ({cause}). What it had not finished "
        f"({len(share.left)}) is submitted again."
    )
    return share.attempt + 1
