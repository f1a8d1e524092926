"""Workers on a Ray cluster and as SLURM jobs: each result once, whatever dies."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import ClassVar

import pytest

from mitigate.core.progress import Progress
from mitigate.core.workers import WorkersDied
from mitigate.scale.launcher import LauncherConfig, SlurmConfig, count, results

GROUPS = [[(g, i) for i in range(3)] for g in range(6)]


class Squares:
    """Job (g, i) gives 10 g + i, after a while; ``deadly`` jobs kill their process the first time,
    leaving a note in ``folder``; ``always`` every time."""

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
    """Results by number, each once, and the processes that worked."""
    found = {}
    with Progress("jobs", 18, unit="job") as progress:
        for item in results(launcher, task, GROUPS, workers, progress):
            if item is not None:
                assert item[0] not in found
                found[item[0]] = item[1]
    values = {number: value for number, (value, _) in found.items()}
    return values, {process for _, process in found.values()}


EXPECTED = {3 * g + i: 10 * g + i for g in range(6) for i in range(3)}


def test_ray_gives_every_result_once_from_processes_of_its_own(ray_launcher, tmp_path):
    values, processes = run(ray_launcher, Squares(tmp_path, seconds=0.05))
    assert values == EXPECTED
    assert 1 <= len(processes) <= 2 and os.getpid() not in processes


def test_ray_gives_the_jobs_of_a_killed_worker_to_another(ray_launcher, tmp_path):
    values, _ = run(ray_launcher, Squares(tmp_path, deadly=[(1, 1), (4, 0)]))
    assert values == EXPECTED
    assert sorted(p.name for p in tmp_path.glob("died-*")) == ["died-1-1", "died-4-0"]


def test_ray_says_which_job_no_worker_survives(ray_launcher, tmp_path):
    with pytest.raises(WorkersDied, match=r"job \(2, 2\).*3 times"):
        run(ray_launcher, Squares(tmp_path, always=[(2, 2)]))


def test_what_a_job_raises_is_raised_here(ray_launcher, tmp_path):
    with pytest.raises(ValueError, match="makes no sense"):
        run(ray_launcher, Squares(tmp_path, wrong=[(3, 1)]))


def test_a_node_that_dies_loses_no_result_and_doubles_none(cluster, ray_launcher, tmp_path):
    task, found = Squares(tmp_path, seconds=0.15), {}
    with Progress("jobs", 18, unit="job") as progress:
        for item in results(ray_launcher, task, GROUPS, 3, progress):
            if item is None:
                continue
            assert item[0] not in found
            found[item[0]] = item[1][0]
            if len(found) == 4:
                cluster.remove_node(cluster.nodes.pop(), allow_graceful=False)
    assert found == EXPECTED


def test_ray_is_asked_how_many_workers_it_has_room_for(ray_launcher):
    assert 1 <= count(ray_launcher, None, 1000, 40) <= 3
    assert count(ray_launcher, 5, 1000, 40) == 5


def test_slurm_jobs_give_every_result_once(slurm_launcher, tmp_path):
    values, processes = run(slurm_launcher(), Squares(tmp_path))
    assert values == EXPECTED
    assert len(processes) == 2
    assert not list((tmp_path / "slurm").iterdir())  # nothing is left behind


def test_the_rest_of_a_killed_slurm_job_is_submitted_again(slurm_launcher, tmp_path):
    values, _ = run(slurm_launcher(), Squares(tmp_path, deadly=[(2, 1)]))
    assert values == EXPECTED


def test_a_slurm_job_that_always_fails_is_a_named_error(slurm_launcher, tmp_path):
    launcher = slurm_launcher(attempts=2)
    with pytest.raises(WorkersDied, match="makes no sense"):
        run(launcher, Squares(tmp_path, wrong=[(0, 1)]), workers=1)


def test_without_slurm_it_says_what_to_do(tmp_path, monkeypatch):
    pytest.importorskip("submitit")
    monkeypatch.setenv("PATH", "")
    launcher = SlurmConfig(folder=str(tmp_path))
    with pytest.raises(ValueError, match="login node"):
        run(launcher, Squares(tmp_path))


def test_local_is_what_it_was(tmp_path):
    values, _ = run(LauncherConfig(), Squares(tmp_path))
    assert values == EXPECTED


@pytest.mark.parametrize("workers", [0, -1])
def test_fewer_than_one_worker_is_refused(workers, tmp_path):
    with pytest.raises(ValueError, match="workers="):
        count(SlurmConfig(), workers, 100, 40)
