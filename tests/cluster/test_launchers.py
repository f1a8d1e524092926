"""Tests of workers on Ray and as SLURM jobs: no matter which process dies, each result occurs
once."""

from __future__ import annotations

import json
import math
import os
import signal
import time
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import ClassVar

import pytest

from mitigate.cluster import ray_actors, slurm_jobs
from mitigate.cluster.launcher import LauncherConfig, RayConfig, SlurmConfig, chosen, count, results
from mitigate.core.progress import Progress
from mitigate.core.workers import WorkersDied

GROUPS = [[(g, i) for i in range(3)] for g in range(6)]


class Squares:
    """A task whose job (g, i) returns 10 * g + i after some time. A job in ``deadly`` kills its
    process the first time, and leaves a file in ``folder``. A job in ``always`` kills its process
    every time."""

    preload: ClassVar[str] = "mitigate.core.workers"

    def __init__(self, folder: Path, deadly=(), always=(), wrong=(), seconds: float = 0.0) -> None:
        self.folder, self.deadly, self.always = folder, set(deadly), set(always)
        self.wrong, self.seconds = set(wrong), seconds

    def ready(self) -> AbstractContextManager[None]:
        return nullcontext()

    def work(self, jobs: Sequence[tuple[int, int]]) -> Iterator[list[int]]:
        for job in jobs:
            time.sleep(self.seconds)
            note = self.folder / f"died-{job[0]}-{job[1]}"
            if job in self.always or (job in self.deadly and not note.exists()):
                note.write_text("")
                os.kill(os.getpid(), signal.SIGKILL)
            if job in self.wrong:
                raise ValueError(f"job {job} makes no sense")
            yield [10 * job[0] + job[1], os.getpid()]

    def name(self, job) -> str:
        return f"job {job}"


pytestmark = pytest.mark.xdist_group("launchers")  # one cluster is enough


def run(launcher, task, workers=2):
    """Return the results by job number, and the process ids of the workers."""
    output = {}
    with Progress("jobs", 18, unit="job") as progress:
        for item in results(launcher, task, GROUPS, workers, progress):
            if item is not None:
                assert item[0] not in output
                output[item[0]] = item[1]
    values = {number: value for number, (value, _) in output.items()}
    return values, {process for _, process in output.values()}


EXPECTED = {3 * g + i: 10 * g + i for g in range(6) for i in range(3)}


def test_ray_yields_every_result_once(ray_launcher, tmp_path):
    values, processes = run(ray_launcher, Squares(tmp_path, seconds=0.05))
    assert values == EXPECTED
    assert 1 <= len(processes) <= 2 and os.getpid() not in processes


def test_ray_reruns_the_jobs_of_a_killed_worker(ray_launcher, tmp_path):
    values, _ = run(ray_launcher, Squares(tmp_path, deadly=[(1, 1), (4, 0)]))
    assert values == EXPECTED
    assert sorted(p.name for p in tmp_path.glob("died-*")) == ["died-1-1", "died-4-0"]


def test_ray_names_a_job_that_kills_workers(ray_launcher, tmp_path):
    with pytest.raises(WorkersDied, match=r"job \(2, 2\).*3 times"):
        run(ray_launcher, Squares(tmp_path, always=[(2, 2)]))


def test_results_raise_errors_of_jobs(ray_launcher, tmp_path):
    with pytest.raises(ValueError, match="makes no sense"):
        run(ray_launcher, Squares(tmp_path, wrong=[(3, 1)]))


def test_ray_survives_a_lost_node(cluster, ray_launcher, tmp_path):
    task, output = Squares(tmp_path, seconds=0.15), {}
    with Progress("jobs", 18, unit="job") as progress:
        for item in results(ray_launcher, task, GROUPS, 3, progress):
            if item is None:
                continue
            assert item[0] not in output
            output[item[0]] = item[1][0]
            if len(output) == 4:
                cluster.remove_node(cluster.nodes.pop(), allow_graceful=False)
    assert output == EXPECTED


def test_ray_count_depends_on_the_cluster(ray_launcher):
    assert 1 <= count(ray_launcher, None, 1000, 40) <= 3
    assert count(ray_launcher, 5, 1000, 40) == 5


def test_slurm_yields_every_result_once(slurm_launcher, tmp_path):
    values, processes = run(slurm_launcher(), Squares(tmp_path))
    assert values == EXPECTED
    assert len(processes) == 2
    assert not list((tmp_path / "slurm").iterdir())  # no files are left behind


@pytest.mark.slow
def test_slurm_resubmits_after_a_killed_job(slurm_launcher, tmp_path):
    values, _ = run(slurm_launcher(), Squares(tmp_path, deadly=[(2, 1)]))
    assert values == EXPECTED


def test_slurm_raises_a_value_error_at_once(slurm_launcher, tmp_path):
    with pytest.raises(ValueError, match="makes no sense"):
        run(slurm_launcher(attempts=2), Squares(tmp_path, wrong=[(0, 1)]), workers=1)
    left = [path.name for path in (tmp_path / "slurm").rglob("*")]
    # logs are kept, so that a user can see what went wrong
    assert slurm_jobs.TASK not in left and "logs" in left


def test_slurm_resubmits_the_rest_of_a_share(tmp_path, monkeypatch):
    """A process takes one group of jobs at a time, so unfinished groups must not be merged."""
    options, cancelled = [], []

    class Job:
        job_id = 1

        def __init__(self, groups, lines):
            self.lines, self.groups = lines, groups

        def done(self):
            if len(options) == 1:  # the first SLURM job ends early, with only one result
                self.lines.write_text('{"job": 0, "result": [0, 0]}\n')
            else:
                output = [n for group in self.groups for n, _ in group]
                built = [json.dumps({"job": n, "result": [n, 0]}) for n in output]
                self.lines.write_text("\n".join(built) + "\n")
            return True

        def exception(self):
            return RuntimeError("Error: time ran out")

        def cancel(self):
            cancelled.append(self)

    class Executor:
        most = 9

        def submit(self, serve, task, groups, processes, lines):
            if len(options) == self.most:
                raise OSError("submit limit")
            options.append([[number for number, _ in group] for group in groups])
            return Job(groups, lines)

    monkeypatch.setattr(slurm_jobs, "check", lambda launcher: None)
    monkeypatch.setattr(slurm_jobs, "_executor", lambda launcher, folder: Executor())
    launcher = SlurmConfig(folder=str(tmp_path / "slurm"))
    run(launcher, Squares(tmp_path), workers=1)
    assert options[0][0] == [0, *options[1][0]] and options[1][1:] == options[0][1:] != []
    options.clear()
    monkeypatch.setattr(Executor, "most", 1)
    with pytest.raises(OSError, match="submit limit"):
        run(launcher, Squares(tmp_path), workers=2)
    assert len(cancelled) == 1
    # the file of the task, which contains the agent's weights, is also removed
    assert not [*(tmp_path / "slurm").iterdir()]


@pytest.mark.parametrize(
    "number",
    [{"processes": 0}, {"attempts": 0}, {"memory": -1.0}, {"memory": math.inf}, {"cpus": math.inf}],
    ids=str,
)
def test_launcher_rejects_invalid_numbers(number):
    kind = RayConfig if "cpus" in number else SlurmConfig
    with pytest.raises(ValueError, match=f"launcher.{next(iter(number))} must be > 0"):
        chosen(kind(**number))


def test_slurm_explains_a_missing_sbatch(tmp_path, monkeypatch):
    pytest.importorskip("submitit")
    monkeypatch.setenv("PATH", "")
    launcher = SlurmConfig(folder=str(tmp_path))
    for read in (lambda: run(launcher, Squares(tmp_path)), lambda: chosen(launcher)):
        with pytest.raises(ValueError, match="login node"):
            read()
    assert not [*tmp_path.iterdir()]


@pytest.mark.parametrize(
    ("launcher", "package", "says"),
    [
        (SlurmConfig(cluster="foo"), "submitit", "no launcher.cluster 'foo'"),
        (RayConfig(address="not an address"), "ray", "must be auto, ray://"),
        (RayConfig(address="host"), "ray", "must be auto, ray://"),
    ],
    ids=lambda value: str(value)[:40],
)
def test_launcher_rejects_an_unknown_name(launcher, package, says):
    pytest.importorskip(package)
    with pytest.raises(ValueError, match=says):
        chosen(launcher)


@pytest.mark.parametrize("address", [None, "auto", "10.0.0.1:6379", "ray://head:10001"])
def test_ray_rejects_an_invalid_address(address):
    pytest.importorskip("ray")
    assert chosen(RayConfig(address=address)).address == address


def test_launcher_names_a_missing_package(monkeypatch):
    for module, launcher in ((slurm_jobs, SlurmConfig()), (ray_actors, RayConfig())):
        monkeypatch.setattr(module, "find_spec", lambda name: None)
        with pytest.raises(ValueError, match=r"pip install -e '.\[cluster\]'"):
            chosen(launcher)


def test_local_launcher_runs_here(tmp_path):
    values, _ = run(LauncherConfig(), Squares(tmp_path))
    assert values == EXPECTED


@pytest.mark.parametrize("workers", [0, -1])
def test_count_rejects_less_than_one_worker(workers, tmp_path):
    with pytest.raises(ValueError, match="workers must be"):
        count(SlurmConfig(), workers, 100, 40)
