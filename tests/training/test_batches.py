"""Tests that workers compute the same batches, are replaced if they die, and report errors."""

from __future__ import annotations

import ctypes
import os
import signal
import threading
from functools import partial

import numpy as np
import pytest
import torch

from mitigate.core import checkpoint, seeding
from mitigate.core.seeding import torch_generator
from mitigate.core.workers import WorkersDied
from mitigate.training import states, workers
from mitigate.training.batches import Batches
from mitigate.training.trainer import Trainer
from mitigate.training.workers import Workers
from tests.deaths import die_in_a_message
from tests.tiny import TinyRecipe


class Shared(TinyRecipe):
    """An objective whose batches have three pieces; each piece depends on the seed and the
    weights."""

    def __init__(self, ahead: bool = False, fatal: str = "") -> None:
        super().__init__()
        self.ahead, self.fatal = ahead, fatal

    def jobs(self, step: int) -> list:
        return [(step, piece) for piece in range(3)]

    def work(self, job: tuple) -> torch.Tensor:
        if job == (2, 1) and self.fatal == "raise":
            raise ValueError("no such pose")
        if job == (2, 1) and os.path.exists(self.fatal):
            os.unlink(self.fatal)  # the next process that runs this job survives
            if self.fatal.endswith("message"):
                die_in_a_message()
            os.kill(os.getpid(), signal.SIGKILL)
        if job == (2, 1) and self.fatal == "always":
            os.kill(os.getpid(), signal.SIGKILL)
        noise = torch.randn(3, 4, generator=torch_generator("piece", *job))
        weight = 0.0 if self.ahead else self.agent.body[0].weight.sum()
        assert torch.get_num_threads() == 1 and not self.training
        return (noise + weight).numpy()

    def collate(self, step: int, pieces: list) -> dict:
        return {"inputs": torch.cat([torch.from_numpy(piece) for piece in pieces])}

    def batch(self, step: int) -> dict:
        return super(TinyRecipe, self).batch(step)


class Bulky(Shared):
    """An objective whose weights and pieces are too large for the buffer of a pipe."""

    def __init__(self) -> None:
        super().__init__()
        self.register_buffer("bulk", torch.zeros(1 << 20))

    def work(self, job: tuple) -> tuple:
        return super().work(job), np.zeros(1 << 20)

    def collate(self, step: int, pieces: list) -> dict:
        return super().collate(step, [piece for piece, _ in pieces])


def trained(folder, workers: Workers | None, lag: int = 0, save_every: int = 2, **settings) -> str:
    seeding.seed_everything(0, "init")
    recipe = Shared(**settings)
    Trainer(recipe, steps=6, folder=folder, workers=workers, save_every=save_every, lag=lag).fit()
    return checkpoint.weights_sha(recipe.agent)


def counted(order, value: dict[int, int], number: int, job) -> None:
    value[number] += 1
    order(job)


@pytest.fixture(scope="module")
def two():
    with Workers(2) as workers:
        yield workers


@pytest.mark.parametrize("ahead", [True, False])
def test_two_workers_train_the_same_weights_as_zero(ahead, two, tmp_path):
    alone = trained(tmp_path / "alone", None, ahead=ahead)
    assert trained(tmp_path / "two", two, ahead=ahead) == alone
    states.checkpoints(tmp_path / "two")[-1].unlink()  # resumes from step 4
    assert trained(tmp_path / "two", two, ahead=ahead) == alone


@pytest.mark.slow
@pytest.mark.parametrize("ahead,busy", [(True, 6), (False, 3)])
def test_many_workers_work_on_several_steps_at_once(ahead, busy, tmp_path):
    with Workers(7) as workers:
        options = dict.fromkeys(range(7), 0)
        for worker in workers._all:
            worker.order = partial(counted, worker.order, options, worker.number)
        matches = trained(tmp_path / "seven", workers, ahead=ahead)
    assert matches == trained(tmp_path / "alone", None, ahead=ahead)
    assert [options[n] for n in range(7)] == [18 // busy] * busy + [0] * (7 - busy)


@pytest.mark.slow
def test_batches_with_lag_do_not_depend_on_workers(two, tmp_path):
    alone = trained(tmp_path / "alone", None, lag=2, save_every=3)
    assert alone != trained(tmp_path / "prompt", None, save_every=3)
    assert trained(tmp_path / "two", two, lag=2, save_every=3) == alone
    states.checkpoints(tmp_path / "two")[-1].unlink()  # resumes from step 3
    assert trained(tmp_path / "two", two, lag=2, save_every=3) == alone
    with Workers(7) as workers:
        assert trained(tmp_path / "seven", workers, lag=2, save_every=3) == alone


@pytest.mark.slow
def test_workers_do_not_deadlock_on_full_pipes(tmp_path):
    seeding.seed_everything(0, "init")
    recipe = Bulky()
    with Workers(1) as workers:
        Trainer(recipe, steps=7, folder=tmp_path, workers=workers, lag=3, save_every=0).fit()
    assert states.checkpoints(tmp_path)


def test_lagging_weights_are_so_many_updates_old(tmp_path):
    seeding.seed_everything(0, "init")
    recipe, seen = Shared(), []
    recipe.work = lambda job: (
        seen.append(float(recipe.agent.body[0].weight.sum())) or np.ones((3, 4), np.float32)
    )
    objective = Batches(recipe, None, 6, "fp32", torch.device("cpu"), lag=2, save_every=4)
    for step in range(6):
        objective.batch(step)
        with torch.no_grad():
            recipe.agent.body[0].weight += 1.0
    updates = [
        round((value - seen[0]) / recipe.agent.body[0].weight.numel()) for value in seen[::3]
    ]
    assert updates == [0, 0, 0, 1, 4, 4]


def test_batches_made_of_no_weights_know_no_lag(two, tmp_path):
    prompt = trained(tmp_path / "prompt", None, ahead=True)
    assert trained(tmp_path / "lag", two, ahead=True, lag=2) == prompt


@pytest.mark.parametrize("where", ["job", "message"])
@pytest.mark.parametrize(
    "how",
    [
        pytest.param({"ahead": True}, marks=pytest.mark.slow),
        {},
        pytest.param({"lag": 2, "save_every": 0}, marks=pytest.mark.slow),
    ],
    ids=str,
)
def test_killed_worker_is_replaced_and_nothing_is_lost(how, where, tmp_path, capsys):
    mark = tmp_path / where
    mark.touch()
    with Workers(2) as workers:
        matches = trained(tmp_path / "killed", workers, fatal=str(mark), **how)
    assert matches == trained(tmp_path / "whole", None, **how)
    assert "ended with code -9; a new one repeats its work" in capsys.readouterr().out


def test_second_worker_death_ends_the_training(tmp_path):
    with Workers(1) as workers, pytest.raises(WorkersDied, match=r"memory ran out.* workers=1"):
        trained(tmp_path, workers, fatal="always")
    assert states.checkpoints(tmp_path)


def test_worker_error_is_raised_unchanged(two, tmp_path):
    with pytest.raises(ValueError, match="no such pose"):
        trained(tmp_path / "raised", two, fatal="raise")
    assert trained(tmp_path / "next", two) == trained(tmp_path / "alone", None)  # nothing is left


class Unpackable(Shared):
    """An objective whose pieces or jobs cannot be pickled."""

    def jobs(self, step: int) -> list:
        pointer = ctypes.pointer(ctypes.c_int(step))
        jobs = {"unpickled": BadJob(), "pickled": lambda: step, "pointer": pointer}
        return [jobs[self.fatal]] * 3 if self.fatal in jobs else super().jobs(step)

    def work(self, job):
        return lambda: job


class BadJob:
    def __reduce__(self):
        return _no_job, ()


def _no_job():
    raise OSError("this job cannot be unpickled")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("fatal", "kind", "message"),
    [
        ("piece", ValueError, "A piece of a batch cannot be sent .* workers=0"),
        ("pickled", ValueError, "A job of this objective cannot be sent .* workers=0"),
        ("pointer", ValueError, "A job of this objective cannot be sent .*pointers.* workers=0"),
        ("unpickled", OSError, "this job cannot be unpickled"),
    ],
)
def test_unpicklable_result_is_reported(fatal, kind, message, tmp_path):
    """The error must not suggest a lack of memory, and no process may wait for the job's result."""
    with Workers(1) as workers, pytest.raises(kind, match=message) as raised:
        Trainer(Unpackable(fatal=fatal), steps=2, folder=tmp_path, workers=workers).fit()
    assert not isinstance(raised.value, WorkersDied)


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_workers_reject_torchscript_objectives(two, tmp_path):
    recipe = Shared()
    recipe.script = torch.jit.script(torch.nn.Linear(2, 2))
    with pytest.raises(ValueError, match=r"cannot be sent .*serialize.* workers=0"):
        Trainer(recipe, steps=1, folder=tmp_path, workers=two).fit()


def test_unpicklable_recipe_is_rejected_with_a_way_out(two, tmp_path):
    class Local(Shared):
        """An objective that cannot be pickled, because its class is defined in a function."""

    with pytest.raises(ValueError, match="workers=0"):
        Trainer(Local(), steps=1, folder=tmp_path, workers=two).fit()


def test_stopped_worker_is_reported_until_it_continues(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(workers, "STUCK", 0.2)
    with Workers(1) as pool:
        expected = trained(tmp_path / "whole", pool)
        process = pool._all[0].process.pid
        os.kill(process, signal.SIGSTOP)
        going_on = threading.Timer(0.7, os.kill, (process, signal.SIGCONT))
        going_on.start()
        assert trained(tmp_path / "stopped", pool) == expected
        going_on.join()
    assert f"worker 0 ({process}) has been silent for" in capsys.readouterr().out
