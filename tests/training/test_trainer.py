"""Tests that the trainer resumes bit for bit, keeps frozen weights, and stops at a NaN loss."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import torch

from mitigate.core import seeding
from mitigate.core.output import FolderLostError, UnsafePathError
from mitigate.core.precision import to_device
from mitigate.training import states
from mitigate.training.journal import Journal
from mitigate.training.states import differences
from mitigate.training.trainer import LossNotFinite, Trainer
from tests.core.test_checksums import FLIPS, flipped
from tests.tiny import TinyRecipe

ROOT = Path(__file__).parents[2]
RUN = """
import sys
import torch
from mitigate.core import seeding
from mitigate.training.trainer import Trainer
from tests.tiny import TinyRecipe
torch.set_num_threads(1)
seeding.seed_everything(0, "init")
settings = {"steps": 60, "save_every": 7, "log_every": 0, "precision": "fp32"}
Trainer(TinyRecipe(pause=0.05), folder=sys.argv[1], **settings).fit()
"""


def recipe(**settings) -> TinyRecipe:
    seeding.seed_everything(0, "init")
    return TinyRecipe(**settings)


def trained(folder: Path, **settings) -> dict[str, torch.Tensor]:
    objective = recipe()
    Trainer(objective, folder=folder, **{"steps": 20, "save_every": 5, **settings}).fit()
    return {name: value.clone() for name, value in objective.agent.state_dict().items()}


def test_trainer_notices_a_lost_folder(tmp_path, monkeypatch):
    save = states.save

    def save_and_lose(folder, state, **options):
        saved = save(folder, state, **options)
        shutil.rmtree(folder)
        return saved

    monkeypatch.setattr(states, "save", save_and_lose)
    with pytest.raises(FolderLostError, match="run was removed or replaced"):
        trained(tmp_path / "run", log_every=1)
    assert not (tmp_path / "run").exists()


def test_journal_keeps_the_first_error_if_its_writer_also_fails(tmp_path, monkeypatch):
    def close(self):
        raise FileNotFoundError("events.out.tfevents")

    with (
        pytest.raises(ValueError, match="the first error"),
        Journal(tmp_path, total=1, start=0, name="run") as journal,
    ):
        monkeypatch.setattr(type(journal._writer), "close", close)
        raise ValueError("the first error")


def test_trainer_rejects_a_link_at_an_event_file(tmp_path):
    (tmp_path / "mine").write_text("mine")
    (tmp_path / "events.out.tfevents.1").symlink_to("mine")
    with pytest.raises(UnsafePathError, match="tfevents.1 must be a regular file"):
        trained(tmp_path)


def same(one: dict[str, torch.Tensor], two: dict[str, torch.Tensor]) -> bool:
    return one.keys() == two.keys() and all(torch.equal(one[name], two[name]) for name in one)


def test_same_seed_trains_the_same_weights(tmp_path):
    assert same(trained(tmp_path / "a"), trained(tmp_path / "b"))


def test_other_seed_trains_other_weights(tmp_path):
    assert not same(trained(tmp_path / "a"), trained(tmp_path / "b", seed=1))


@pytest.mark.parametrize("precision", ["fp32", "bf16"])
def test_resumed_run_equals_an_uninterrupted_one(tmp_path, precision):
    whole = trained(tmp_path / "whole", precision=precision)
    trained(tmp_path / "broken", precision=precision)
    states.checkpoints(tmp_path / "broken")[-1].unlink()  # resumes from step 15
    seeding.seed_everything(9, "what an interrupted process leaves behind")
    assert same(whole, trained(tmp_path / "broken", precision=precision))


def test_resumed_run_logs_what_an_uninterrupted_one_logs(tmp_path):
    from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

    how = {"log_every": 5, "save_every": 5, "eval_every": 5}
    steps = []
    for name in ("whole", "broken"):
        trained(tmp_path / name, **how)
        if name == "broken":
            states.checkpoints(tmp_path / name)[-1].unlink()  # resumes from step 15
            trained(tmp_path / name, **how)
        events = EventAccumulator(str(tmp_path / name))
        events.Reload()
        steps.append(
            {tag: [e.step for e in events.Scalars(tag)] for tag in ("loss", "eval/weight")}
        )
    assert steps[0] == steps[1] and steps[0]["loss"] == [5, 10, 15, 20]


def test_logging_evaluation_and_saving_do_not_change_the_weights(tmp_path):
    quiet = trained(tmp_path / "quiet", log_every=0, save_every=0)
    busy = trained(tmp_path / "busy", log_every=1, save_every=1, eval_every=2, figure_every=3)
    assert same(quiet, busy)


def test_killed_run_resumes_to_the_same_weights(tmp_path):
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"}
    command = [sys.executable, "-c", RUN, str(tmp_path / "killed")]
    killed = subprocess.Popen(command, env=environment, cwd=ROOT)
    while not states.checkpoints(tmp_path / "killed"):
        assert killed.poll() is None, "the run ended before it saved"
        time.sleep(0.01)
    killed.send_signal(signal.SIGKILL)
    killed.wait()
    step = states.load(states.checkpoints(tmp_path / "killed")[-1])["step"]
    assert step < 60
    settings = {"steps": 60, "save_every": 7, "log_every": 0, "precision": "fp32"}
    resumed, whole = (trained(tmp_path / name, **settings) for name in ("killed", "whole"))
    assert same(resumed, whole)


def test_finished_run_returns_at_once(tmp_path, capsys):
    first = trained(tmp_path)
    capsys.readouterr()
    assert same(first, trained(tmp_path))
    assert "already trained for 20 steps" in capsys.readouterr().out


def test_flipped_bit_falls_back_to_the_older_checkpoint(tmp_path, capsys):
    whole = trained(tmp_path)
    newest = states.checkpoints(tmp_path)[-1]
    sound = newest.read_bytes()
    draw = seeding.generator(0, "flipped bits of a trainer's checkpoint")
    for bit in draw.integers(0, 8 * len(sound), FLIPS):
        newest.write_bytes(flipped(sound, int(bit)))
        objective = recipe()
        assert Trainer(objective, steps=20, save_every=5, folder=tmp_path)._resume() == 15
        assert f"{newest} is damaged; resuming from step-00000015.pt" in capsys.readouterr().out
    assert same(whole, trained(tmp_path)) and states.load(newest)["step"] == 20


def test_trainer_keeps_checkpoints_before_a_damaged_later_step(tmp_path):
    trained(tmp_path, keep=2)
    newest = states.checkpoints(tmp_path)[-1]
    newest.write_bytes(b"")
    Trainer(recipe(), steps=20, save_every=2, keep=1, folder=tmp_path).fit()
    assert [p.name for p in states.checkpoints(tmp_path)] == [newest.name]
    assert states.load(newest)["step"] == 20


def test_extra_state_is_resumed(tmp_path):
    trained(tmp_path)
    states.checkpoints(tmp_path)[-1].unlink()
    again = recipe()
    Trainer(again, steps=20, save_every=5, folder=tmp_path).fit()
    assert again.count == 20


def test_frozen_weights_stay_and_are_not_in_the_optimiser(tmp_path):
    objective = recipe()
    before = objective.agent.frozen.weight.clone()
    trainer = Trainer(objective, steps=3, folder=tmp_path, weight_decay=0.5)
    trainer.fit()
    assert torch.equal(objective.agent.frozen.weight, before)
    assert all(p.requires_grad for p in trainer.trained) and len(trainer.trained) == 4


def test_recipe_without_trainable_parts_is_rejected(tmp_path):
    with pytest.raises(ValueError, match="every parameter is frozen"):
        Trainer(recipe().requires_grad_(False), steps=1, folder=tmp_path)


def test_training_lowers_the_loss(tmp_path, capsys):
    trained(tmp_path, steps=300, log_every=100, save_every=0, lr=1e-2)
    lines = [line for line in capsys.readouterr().out.splitlines() if "steps_per_s" in line]
    first, *_, last = [float(line.split("loss ")[1].split()[0]) for line in lines]
    assert len(lines) == 3 and last < first


def test_plain_lines_name_step_rate_and_time_left(tmp_path, capsys):
    trained(tmp_path, log_every=10)
    out = capsys.readouterr().out
    assert "step 10/20" in out and "steps_per_s" in out and " s left" in out and "lr 0.0005" in out


def test_terminal_shows_a_bar_with_the_time_left(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("sys.stdout.isatty", lambda: True, raising=False)
    trained(tmp_path, log_every=10)
    out = capsys.readouterr().out
    assert "20/20 [00:0" in out and "step/s, loss " in out and "left" not in out


def test_scalars_and_pictures_are_in_tensorboard(tmp_path):
    from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

    trained(tmp_path, log_every=10, eval_every=20, figure_every=20)
    events = EventAccumulator(str(tmp_path))
    events.Reload()
    assert {"loss", "error", "lr", "grad_norm", "eval/weight"} <= set(events.Tags()["scalars"])
    assert [event.step for event in events.Scalars("loss")] == [10, 20]
    assert events.Tags()["images"] == ["noise"]


def test_nan_loss_stops_with_step_recipe_and_episodes(tmp_path):
    objective = recipe(bad_step=7)
    with pytest.raises(LossNotFinite) as error:
        Trainer(objective, steps=20, folder=tmp_path, save_every=5).fit()
    for part in ("step 7", "TinyRecipe", "episode-7", "step-00000005.pt"):
        assert part in str(error.value)
    assert all(torch.isfinite(p).all() for p in objective.parameters())
    assert states.checkpoints(tmp_path)[-1].name == "step-00000005.pt"


def test_infinite_gradient_stops_before_the_update(tmp_path):
    class Overflow(TinyRecipe):
        def forward(self, batch):
            # the derivative of sqrt at 0 is infinite
            return {"loss": (self.agent.body(batch["inputs"]) * 0).sqrt().sum()}

    output = Overflow()
    before = {name: value.clone() for name, value in output.agent.state_dict().items()}
    with pytest.raises(LossNotFinite, match="gradient norm nan"):
        Trainer(output, steps=3, folder=tmp_path).fit()
    assert same(before, output.agent.state_dict())


def test_trainer_rejects_the_folder_of_another_run(tmp_path):
    trained(tmp_path)
    with pytest.raises(ValueError, match=r"trainer\.lr: 0\.001 -> 0\.01"):
        trained(tmp_path, lr=1e-2)


@pytest.mark.parametrize(
    ("setting", "words"),
    [
        ({"precision": "fp8"}, "auto, fp32, bf16"),
        ({"steps": 0}, "trainer.steps must be a number from 1"),
        ({"grad_clip": -1.0}, "grad_clip must be a number from 0"),
        ({"grad_clip": float("nan")}, "grad_clip must be a number from 0"),
        ({"grad_clip": float("inf")}, "grad_clip must be a number from 0"),
        ({"lr": float("inf")}, "trainer.lr must be .* to 100, got inf"),
        ({"lr": float("nan")}, "trainer.lr must be .* got nan"),
        ({"lr": -1e-3}, "trainer.lr must be a number from 1e-12"),
        ({"lr": 1e9}, "trainer.lr must be a number from"),
        ({"weight_decay": float("inf")}, "trainer.weight_decay"),
        ({"weight_decay": -1.0}, "trainer.weight_decay"),
        ({"warmup": -5}, "trainer.warmup must be .* got -5"),
        ({"log_every": -1}, "trainer.log_every"),
        ({"save_every": 10**30}, "trainer.save_every"),
        ({"steps": 10**30}, "trainer.steps"),
        ({"keep": 10**30}, "trainer.keep"),
        ({"device": "banana"}, "trainer.device=banana cannot be used here .* auto, cpu"),
        ({"device": "cuda:99"}, "trainer.device=cuda:99 cannot be used here"),
        ({"device": "meta"}, "it holds no numbers"),
        ({"device": "mps"}, "trainer.device=mps cannot be used here"),
        ({"device": ""}, "trainer.device= cannot"),
    ],
)
def test_setting_out_of_range_names_the_allowed_values(tmp_path, setting, words):
    with pytest.raises(ValueError, match=words):
        trained(tmp_path, **setting)


@pytest.mark.parametrize(
    ("returned", "words"),
    [
        (lambda loss: loss, 'returned no "loss", but Tensor. It must return a dict'),
        (lambda loss: {"los": loss}, "returned no \"loss\", but 'los'"),
        (lambda loss: {}, 'returned no "loss", but nothing'),
        (lambda loss: {"loss": loss.expand(8)}, "'loss' of shape \\[8\\]"),
        (lambda loss: {"loss": loss.detach()}, "depends on no weight that trains"),
        (lambda loss: {"loss": float(loss.detach())}, "depends on no weight that trains"),
        (lambda loss: {"loss": loss, "note": "text"}, "returned 'note' as str"),
    ],
)
def test_wrong_forward_result_is_explained(tmp_path, returned, words):
    class Own(TinyRecipe):
        def forward(self, batch):
            return returned(super().forward(batch)["loss"])

    with pytest.raises(ValueError, match=f"forward\\(\\) of Own .*{words}"):
        Trainer(Own(), steps=1, folder=tmp_path).fit()


def test_weights_that_are_no_numbers_are_not_saved(tmp_path):
    class Poisoned(TinyRecipe):
        def forward(self, batch):
            # this hook makes a weight infinite after the loss, like an overflow in the update
            if self.count == 8:
                self.agent.body[2].bias.register_hook(self._poison)
            return super().forward(batch)

        def _poison(self, gradient):
            with torch.no_grad():
                self.agent.body[0].weight[0, 0] = float("inf")

    with pytest.raises(LossNotFinite, match=r"not finite \(agent.body.0.weight\)"):
        Trainer(Poisoned(), steps=9, folder=tmp_path, save_every=3).fit()
    assert [p.name for p in states.checkpoints(tmp_path)][-1] == "step-00000006.pt"


@pytest.mark.skipif(torch.cuda.is_available(), reason="there is CUDA")
def test_missing_gpu_is_named(tmp_path):
    with pytest.raises(
        ValueError, match="trainer.device=cuda cannot be used here .it is not available"
    ):
        trained(tmp_path, device="cuda")


def test_learning_rate_warms_up_and_falls_to_zero(tmp_path):
    trainer = Trainer(recipe(), steps=10, folder=tmp_path, warmup=4, lr=1.0)
    rates = []
    for _ in range(10):
        rates.append(trainer.optimizer.param_groups[0]["lr"])
        trainer.optimizer.step()
        trainer.scheduler.step()
    assert rates[:5] == pytest.approx([0.2, 0.4, 0.6, 0.8, 1.0])
    assert all(a > b for a, b in zip(rates[4:], rates[5:], strict=False))
    assert trainer.optimizer.param_groups[0]["lr"] == pytest.approx(0.0)


def test_differences_names_leaves_only():
    assert differences({"a": {"b": 1, "c": 2}}, {"a": {"b": 1, "c": 3}}) == ["a.c: 2 -> 3"]
    assert differences({"a": 1}, {"a": 1, "d": 2}) == ["d: None -> 2"]


def test_to_device_keeps_values_that_are_not_tensors():
    batch = {"x": torch.zeros(2), "nested": [torch.ones(1)], "episode_ids": ["a"]}
    moved = to_device(batch, torch.device("cpu"))
    assert moved["episode_ids"] == ["a"] and torch.equal(moved["nested"][0], torch.ones(1))
