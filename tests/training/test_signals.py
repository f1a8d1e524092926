"""Tests that a signal makes training save and stop, and that resuming gives the same result."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import torch

from mitigate.core.signals import Ended, delay_signals, uninterrupted
from mitigate.training.objective import Objective
from mitigate.training.ranks import Ranks
from mitigate.training.trainer import Trainer

ROOT = Path(__file__).parents[2]
SCRIPT = """
import sys
from pathlib import Path
import hydra
from mitigate.core import conf
from tests.training.test_signals import train

@hydra.main(version_base="1.3", config_path=None)
def program(cfg):
    train(Path({folder!r}), {number})

conf.main(program, "train")
"""


class Slow(Objective):
    """An objective that fits a line. At step 3 it sends a signal to its process, but only once."""

    def __init__(self, folder: Path, number: int) -> None:
        super().__init__()
        self.note, self.number, self.line = folder / "sent", number, torch.nn.Linear(2, 1)
        torch.nn.init.ones_(self.line.weight)
        torch.nn.init.zeros_(self.line.bias)

    def batch(self, step):
        return {"inputs": torch.full((4, 2), 0.1 * step), "step": step}

    def forward(self, batch):
        if batch["step"] == 3 and self.number and not self.note.exists():
            self.note.touch()
            os.kill(os.getpid(), self.number)
            time.sleep(0.05)  # the step continues
        return {"loss": (self.line(batch["inputs"]) - 1).square().mean()}


class Calibrated(Slow):
    """An objective whose ``finish`` first calls ``before`` and then sets a threshold from the
    weights."""

    def __init__(self, folder: Path, before=lambda: None) -> None:
        super().__init__(folder, 0)
        self.before, self.steps = before, []
        self.register_buffer("threshold", torch.zeros(()))

    def batch(self, step):
        self.steps.append(step)
        return super().batch(step)

    def finish(self):
        self.before()
        self.threshold.copy_(self.line.weight.sum())


def end_within_another_block():
    """Simulate a signal that arrives during training while worker processes run an evaluation."""
    with delay_signals():
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(0.01)
    raise Ended(signal.SIGTERM)


def train(folder: Path, number: int) -> torch.Tensor:
    torch.manual_seed(0)
    folder.mkdir(parents=True, exist_ok=True)
    output = Slow(folder, number)
    Trainer(output, steps=6, folder=folder / "run", lr=0.1, save_every=5, precision="fp32").fit()
    return output.line.weight.detach()


def run(folder: Path, number: int) -> subprocess.CompletedProcess:
    script = folder / "program.py"
    script.write_text(SCRIPT.format(folder=str(folder), number=number))
    return subprocess.run(
        [sys.executable, str(script)],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "status"),
    [(signal.SIGTERM, 143), (signal.SIGINT, 130)],
)
def test_interrupted_training_saves_and_resumes_to_the_same_result(tmp_path, number, status):
    ended = run(tmp_path, int(number))
    assert ended.returncode == status, ended.stderr
    assert "saved at step 4" in ended.stdout
    assert "To resume:" in ended.stderr and "program.py" in ended.stderr
    assert "Traceback" not in ended.stderr
    assert [path.name for path in (tmp_path / "run").glob("step-*.pt")] == ["step-00000004.pt"]
    matches = train(tmp_path, 0)
    assert torch.equal(matches, train(tmp_path / "unbroken", 0))


def test_signal_during_evaluation_loses_no_step(tmp_path):
    class Evaluated(Slow):
        def evaluate(self, step):
            os.kill(os.getpid(), signal.SIGTERM)
            time.sleep(0.01)
            return {}

    folder = tmp_path / "run"
    settings = {"steps": 6, "lr": 0.1, "save_every": 5, "precision": "fp32"}
    with pytest.raises(Ended):
        Trainer(Evaluated(tmp_path, 0), folder=folder, eval_every=2, **settings).fit()
    assert [path.name for path in folder.glob("step-*.pt")] == ["step-00000002.pt"]


@pytest.mark.parametrize("when", ["batch", "finish"])
def test_signal_at_the_end_does_not_skip_finish(tmp_path, when):
    def before():
        if when == "finish":
            end_within_another_block()

    class Ending(Calibrated):
        def batch(self, step):
            if step == 2 and when == "batch":
                os.kill(os.getpid(), signal.SIGTERM)
                time.sleep(0.01)
            return super().batch(step)

    settings = {"steps": 3, "lr": 0.1, "precision": "fp32", "folder": tmp_path / "run"}
    with pytest.raises(Ended):
        Trainer(Ending(tmp_path, before), **settings).fit()
    resumed = Trainer(Calibrated(tmp_path), **settings).fit()
    assert resumed.steps == [] and resumed.threshold == resumed.line.weight.sum() != 0


def test_kill_while_finishing_loses_no_step(tmp_path, capsys):
    class Killed(BaseException):
        pass

    def before():
        raise Killed

    settings = {"steps": 6, "lr": 0.1, "precision": "fp32", "save_every": 0}
    with pytest.raises(Killed):
        Trainer(Calibrated(tmp_path, before), folder=tmp_path / "run", **settings).fit()
    resumed = Trainer(Calibrated(tmp_path), folder=tmp_path / "run", **settings).fit()
    whole = Trainer(Calibrated(tmp_path), folder=tmp_path / "whole", **settings).fit()
    assert resumed.steps == [] and torch.equal(resumed.threshold, whole.threshold)
    again = Trainer(Calibrated(tmp_path, before), folder=tmp_path / "run", **settings).fit()
    assert torch.equal(again.threshold, whole.threshold)
    assert "already trained for 6 steps" in capsys.readouterr().out


def test_interrupted_evaluation_loses_no_step(tmp_path):
    class Evaluated(Slow):
        def evaluate(self, step):
            end_within_another_block()

    settings = {"steps": 6, "eval_every": 2, "precision": "fp32", "folder": tmp_path / "run"}
    with pytest.raises(Ended):
        Trainer(Evaluated(tmp_path, 0), **settings).fit()
    assert [path.name for path in (tmp_path / "run").glob("step-*.pt")] == ["step-00000002.pt"]


def test_signal_in_an_inner_block_reaches_the_outer_one(tmp_path):
    with delay_signals() as outer:
        with uninterrupted():
            os.kill(os.getpid(), signal.SIGTERM)
            time.sleep(0.01)
        assert outer.number == signal.SIGTERM and not outer.again  # and the run continues
        with pytest.raises(Ended), delay_signals():
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(1)
        assert outer.again
    with pytest.raises(Ended), uninterrupted():
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(0.01)


def test_second_signal_ends_at_once(tmp_path):
    with pytest.raises(Ended) as ended, delay_signals() as first:
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(0.01)
        assert first.number == signal.SIGTERM
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(1)
    assert ended.value.status == 143
    assert Ranks().first


def test_signal_during_success_measurement_keeps_earlier_steps(tmp_path):
    """A signal arrives in step 3 while workers measure success rates; these workers end at once."""

    class Measured(Slow):
        def batch(self, step):
            if step == 3:
                raise Ended(signal.SIGTERM)
            return super().batch(step)

    settings = {"steps": 6, "lr": 0.1, "precision": "fp32", "folder": tmp_path / "run"}
    torch.manual_seed(0)
    with pytest.raises(Ended):
        Trainer(Measured(tmp_path, 0), **settings).fit()
    assert [path.name for path in (tmp_path / "run").glob("step-*.pt")] == ["step-00000003.pt"]
    done = Trainer(Slow(tmp_path, 0), **settings).fit()
    assert torch.equal(done.line.weight, train(tmp_path / "unbroken", 0))
