"""Run workers as jobs of a SLURM cluster, submitted by submitit.

For tests, ``launcher.cluster=local`` runs SLURM jobs as processes on this machine.

Each SLURM job receives some of the groups of jobs and runs them in its own worker processes. The
job appends one line per result to a file in a folder that all nodes can access. The submitting
process reads the lines as they arrive. When a SLURM job ends before all its groups are done, the
remaining groups are submitted again.
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
LATE = 30.0  # maximum seconds that SLURM jobs may take to end after their last result (heuristic)
TASK = "task.pickle"  # only this file, which the submitting process wrote, is unpickled


@dataclass
class _Share:
    """A submitted SLURM job and its part of the work."""

    job: Any  # the job object of submitit
    groups: Sequence[Sequence[tuple[int, Any]]]  # groups of (number, job)
    lines: Path  # file to which the SLURM job writes results
    left: dict[int, Any]  # jobs that have no result yet, by number
    attempt: int
    read: int = 0  # number of bytes of ``lines`` that were read


def results(
    task: Task,
    groups: Sequence[Sequence[Any]],
    workers: int,
    progress: Progress,
    launcher: SlurmConfig,
) -> Iterator[tuple[int, Any] | None]:
    """Yield results in the same form as ``launcher.results``, from ``workers`` SLURM jobs.

    The folder of the jobs is deleted when all jobs are done. After a failure, the folder keeps the
    logs. The task, which contains the agent's weights, is deleted.
    """
    check(launcher)
    folder = Path(launcher.folder).resolve() / f"{int(time.time())}-{os.getpid()}"
    executor = _executor(launcher, folder)
    work = numbered(groups)
    total, done = sum(map(len, work)), 0
    shares = [work[at::workers] for at in range(min(workers, len(work)))]
    running: list[_Share] = []
    try:
        write_bytes(folder / TASK, pickle.dumps(task))
        for number, share in enumerate(shares):
            running.append(_submit(executor, folder, launcher, share, 1, number))
        progress.say(f"{len(running)} jobs submitted; their logs are in {folder}")
        submitted = len(running)
        while done < total:
            for current in list(running):
                # ask for the state before reading lines, so that no line is missed
                over = current.job.done()
                for number, result in _fresh(current):
                    done += 1
                    yield number, result
                if not over:
                    continue
                running.remove(current)
                if current.left:
                    again = _again(current, task, launcher, progress, done, total)
                    left = [[j for j in group if j[0] in current.left] for group in current.groups]
                    rest = [group for group in left if group]
                    running.append(_submit(executor, folder, launcher, rest, again, submitted))
                    submitted += 1
            progress.advance(0)
            yield None
            time.sleep(SECOND / 4)
        _end(running, folder)
    finally:
        for current in running:
            current.job.cancel()
        (folder / TASK).unlink(missing_ok=True)
        with suppress(OSError):  # the folder still contains logs
            folder.rmdir()


def _end(running: list[_Share], folder: Path) -> None:
    """Wait until the SLURM jobs have ended after their last result, and then remove their folder.

    If a job has not ended after ``LATE`` seconds, the folder is kept.
    """
    waited = time.monotonic()
    while running and time.monotonic() - waited < LATE:
        running[:] = [share for share in running if not share.job.done()]
        time.sleep(SECOND / 4)
    if not running:
        shutil.rmtree(folder, ignore_errors=True)


def check(launcher: SlurmConfig) -> None:
    """Raise ValueError if submitit is not installed or the cluster cannot be reached."""
    if find_spec("submitit") is None:
        raise ValueError("launcher=slurm needs submitit: pip install -e '.[cluster]'.")
    if launcher.cluster not in CLUSTERS:
        raise ValueError(unknown("launcher.cluster", launcher.cluster, CLUSTERS))
    if launcher.cluster == "slurm" and shutil.which("sbatch") is None:
        raise ValueError(
            "SLURM is not available here (no sbatch). Run this on a login node, or test it with "
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
    """Submit a SLURM job for ``groups`` and return its ``Share``."""
    lines = folder / f"results-{number}.jsonl"
    job = executor.submit(serve, folder / TASK, list(groups), launcher.processes, lines)
    return _Share(job, groups, lines, {n: j for group in groups for n, j in group}, attempt)


def serve(
    task: Path, groups: Sequence[Sequence[tuple[int, Any]]], processes: int, lines: Path
) -> None:
    """Run ``groups`` in a SLURM job and write one JSON line per result.

    A line is ``{"job": number, "result": ...}``. For a ValueError, which would occur again on any
    node, the line is ``{"error": text}``.
    """
    with open(task, "rb") as file:
        loaded: Task = pickle.load(file)
    numbers = [number for group in groups for number, _ in group]
    jobs = [[job for _, job in group] for group in groups]
    stream = open_output(lines, "a", encoding="utf-8")
    with stream as out, Progress("jobs", len(numbers)) as progress:
        try:
            for item in run_here(loaded, jobs, processes, progress):
                if item is not None:
                    out.write(json.dumps({"job": numbers[item[0]], "result": item[1]}) + "\n")
                    out.flush()
                    progress.advance()
        except ValueError as error:
            out.write(json.dumps({"error": str(error)}) + "\n")
            raise


def _fresh(share: _Share) -> Iterator[tuple[int, Any]]:
    """Yield each new result of a SLURM job; an incomplete last line is read later.

    If the job reported an error instead of a result, the function raises a ValueError.
    """
    if not share.lines.is_file():
        return
    with open(share.lines, "rb") as file:
        file.seek(share.read)
        for line in file:
            if not line.endswith(b"\n"):
                break
            share.read += len(line)
            record = _parse(line, share.lines)
            if "error" in record:
                raise ValueError(record["error"])
            if share.left.pop(record["job"], None) is not None:
                yield record["job"], record["result"]


def _parse(line: bytes, file: Path) -> dict[str, Any]:
    """Parse one line; if it is damaged, raise a ValueError that names the file."""
    try:
        record: Any = json.loads(line)
    except (ValueError, RecursionError):
        record = None
    if not isinstance(record, dict) or not (
        "error" in record or {"job", "result"} <= record.keys()
    ):
        raise ValueError(
            f"{file} has a damaged line, {short(line.decode(errors='replace'))}. The results "
            "before it were kept. Run the same command again."
        )
    return record


def _again(
    share: _Share, task: Task, launcher: SlurmConfig, progress: Progress, done: int, total: int
) -> int:
    """Return the number of the next attempt to run the unfinished jobs of ``share``.

    Raises WorkersDied after too many attempts.
    """
    try:
        problem: Any = share.job.exception()
    except Exception as error:  # submitit has its own errors for jobs without a result
        problem = error
    errors = re.findall(r"^\w*(?:Error|Died|Exception): .*$", str(problem), re.MULTILINE)
    cause = errors[-1] if errors else "it was killed, or ran out of time"
    if share.attempt >= launcher.attempts:
        first = next(iter(share.left.values()))
        raise lost(f"{task.name(first)} ({cause})", share.attempt, done, total)
    progress.say(
        f"job {share.job.job_id} ended early ({cause}). Its unfinished work ({len(share.left)}) "
        "is submitted again."
    )
    return share.attempt + 1
