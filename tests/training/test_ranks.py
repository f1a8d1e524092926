"""Tests that two ranks, which share the work, take the same training steps as one process."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import torch

from mitigate.core.seeding import generator, seed_everything
from mitigate.training.objective import Objective
from mitigate.training.ranks import Ranks
from mitigate.training.trainer import Trainer

ROOT = Path(__file__).parents[2]
PIECES = 4


class Regression(Objective):
    """An objective with pieces of different lengths.

    The layer ``first`` is applied only to piece 0, which the first rank computes. The layer
    ``unused`` must not decay.
    """

    def __init__(self) -> None:
        super().__init__()
        seed_everything(0, "regression")
        self.line, self.first = torch.nn.Linear(3, 1), torch.nn.Linear(3, 1)
        self.unused = torch.nn.Linear(3, 1)

    def jobs(self, step):
        return [(step, piece) for piece in range(PIECES)]

    def work(self, job):
        return generator("ranks", *job).normal(size=(4 + 3 * job[1], 3)).astype(np.float32)

    def collate(self, step, pieces):
        return {"inputs": torch.from_numpy(np.concatenate(pieces))}

    def weight(self, batch):
        return float(len(batch["inputs"]))

    def forward(self, batch):
        inputs = batch["inputs"]
        guess = self.line(inputs)
        # the first of two ranks has 14 inputs; a single process has 34
        if len(inputs) in (14, 34):
            guess = guess + torch.cat([self.first(inputs[:4]), torch.zeros(len(inputs) - 4, 1)])
        values = {"loss": (guess - inputs.sum(1, keepdim=True)).square().mean()}
        if len(inputs) in (14, 34):
            values["seldom"] = torch.ones(())
        return values


def train(folder: Path, ranks: Ranks, steps: int = 6) -> torch.Tensor:
    output = Regression()
    options = {"lr": 0.05, "weight_decay": 0.5, "save_every": 2, "log_every": 1}
    Trainer(output, steps=steps, folder=folder, ranks=ranks, **options).fit()
    return torch.cat([output.line.weight, output.unused.weight]).detach()


def torchrun(folder: Path, count: int) -> subprocess.CompletedProcess:
    script = folder / "train.py"
    script.write_text(
        "import os, sys, torch\nfrom pathlib import Path\n"
        "from mitigate.training import trainer\n"
        "from mitigate.training.ranks import Ranks\nfrom tests.training.test_ranks import train\n"
        # The two ranks choose different precisions, as they may on different processors.
        # All ranks must use the precision that the first rank chose.
        "trainer.choose = lambda *_: ('fp32', 'bf16')[int(os.environ['RANK'])]\n"
        "folder = Path(sys.argv[1])\n"
        "with Ranks.of_environment() as ranks:\n"
        "    torch.save(train(folder / 'run', ranks), folder / f'rank-{ranks.number}.pt')\n"
    )
    command = ["-m", "torch.distributed.run", "--standalone", f"--nproc-per-node={count}"]
    return subprocess.run(
        [sys.executable, *command, str(script), str(folder)],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
    )


@pytest.mark.slow
def test_two_ranks_train_the_weights_of_one(tmp_path, monkeypatch):
    monkeypatch.setattr("mitigate.training.trainer.choose", lambda *_: "fp32")
    done = torchrun(tmp_path, 2)
    assert done.returncode == 0, done.stderr
    first, second = (torch.load(tmp_path / f"rank-{n}.pt", weights_only=True) for n in (0, 1))
    alone = train(tmp_path / "alone", Ranks())
    assert torch.equal(first, second) and torch.allclose(first, alone, atol=1e-6)
    assert done.stdout.count("step 6/6  loss") == 1
    assert "seldom 1" in done.stdout, "a mean over those that have it"
    assert len(list((tmp_path / "run").glob("step-*.pt"))) == 2


def test_more_ranks_than_pieces_are_rejected():
    with pytest.raises(ValueError, match="4 work items, too few for 5 ranks"):
        Ranks(0, 5).share([1, 2, 3, 4])
    with pytest.raises(ValueError, match=r"policy has 1 work item, .* \(make train NPROC=1\)"):
        Ranks(0, 2).check(1, "the stage policy")
    assert [Ranks(n, 3).share([1, 2, 3, 4]) for n in range(3)] == [[1, 4], [2], [3]]
