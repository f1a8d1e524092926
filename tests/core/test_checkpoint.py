"""Tests that checkpoints are complete or rejected, that old ones are deleted, and that they contain
no code."""

from __future__ import annotations

import os
import pickle
import random
import resource
import signal

import numpy
import pytest
import torch
from safetensors.torch import save_file
from torch import nn

from mitigate.core import checkpoint, checksums, files, folders, seeding
from mitigate.training import states

STATE = {
    "step": 3,
    "finished": True,
    "model": {"w": torch.arange(100.0)},
    "optimizer": {},
    "scheduler": {},
    "rng": {},
    "config": {},
}


def test_save_and_load_round_trip(tmp_path):
    path = states.save(tmp_path, STATE)
    loaded = states.load(path)
    assert loaded["step"] == 3 and torch.equal(loaded["model"]["w"], STATE["model"]["w"])
    names = sorted(p.name for p in tmp_path.iterdir())
    assert names == ["step-00000003.pt", "step-00000003.pt.sha256"]


def test_save_keeps_only_the_newest(tmp_path):
    for step in (1, 2, 10, 100):
        states.save(tmp_path, {**STATE, "step": step}, keep=2)
    names = [path.name for path in states.checkpoints(tmp_path)]
    assert names == ["step-00000010.pt", "step-00000100.pt"]
    sums = sorted(path.name for path in tmp_path.glob("*.sha256"))
    assert sums == [f"{name}.sha256" for name in names]


def test_failed_write_keeps_the_old_file(tmp_path):
    path = states.save(tmp_path, STATE)
    before = path.read_bytes()

    def fail(file):
        file.write_bytes(b"half")
        raise OSError("disk full")

    with pytest.raises(OSError, match="disk full"):
        checksums.write(path, fail)
    assert path.read_bytes() == before
    assert sorted(tmp_path.iterdir()) == [path, checksums.sidecar(path)]


@pytest.mark.parametrize("share", [0.0, 0.3, 0.9, 0.99])
def test_truncated_checkpoint_is_named_with_the_older_one(tmp_path, share):
    states.save(tmp_path, {**STATE, "step": 1})
    path = states.save(tmp_path, {**STATE, "step": 2})
    os.truncate(path, int(path.stat().st_size * share))
    with pytest.raises(ValueError, match="step-00000002.pt") as error:
        states.load(path)
    assert "resume from step-00000001.pt" in str(error.value) and "\n" not in str(error.value)


def test_foreign_file_is_named_and_runs_no_code(tmp_path):
    class Evil:
        def __reduce__(self):
            return (os.mkdir, (str(tmp_path / "owned"),))

    for number, content in enumerate((Evil(), {"weights": 1}, [1, 2])):
        path = tmp_path / f"step-{number:08d}.pt"
        torch.save(content, path)
        with pytest.raises(ValueError, match=path.name):
            states.load(path)
    (tmp_path / "step-00000009.pt").write_bytes(pickle.dumps(Evil()))
    with pytest.raises(ValueError, match=r"step-00000009\.pt"):
        states.load(tmp_path / "step-00000009.pt")
    assert not (tmp_path / "owned").exists()


def test_missing_checkpoint_is_named(tmp_path):
    with pytest.raises(FileNotFoundError, match="step-7"):
        states.load(tmp_path / "step-7.pt")


def test_random_state_goes_through_a_checkpoint(tmp_path):
    seeding.seed_everything(5, "anything")
    state = {**STATE, "rng": seeding.global_state()}
    first = (torch.rand(3), numpy.random.rand(), random.random())
    seeding.set_global_state(states.load(states.save(tmp_path, state))["rng"])
    again = (torch.rand(3), numpy.random.rand(), random.random())
    assert torch.equal(first[0], again[0]) and first[1:] == again[1:]


def test_weights_round_trip_and_keep_their_hash(tmp_path):
    one, two = nn.Linear(3, 2), nn.Linear(3, 2)
    assert checkpoint.weights_sha(one) != checkpoint.weights_sha(two)
    checkpoint.save_weights(one, tmp_path)
    checkpoint.load_weights(two, tmp_path / "model.safetensors")
    assert checkpoint.weights_sha(one) == checkpoint.weights_sha(two)
    assert len(checkpoint.weights_sha(one)) == 12


def test_weights_of_another_module_are_refused(tmp_path):
    checkpoint.save_weights(nn.Linear(3, 2), tmp_path)
    with pytest.raises(ValueError, match="weight"):
        checkpoint.load_weights(nn.Linear(4, 2), tmp_path)


@pytest.mark.parametrize("width", [torch.float64, torch.float16, torch.bfloat16])
def test_floats_of_any_width_are_read(tmp_path, width):
    module = nn.BatchNorm1d(3)
    save_file({k: v.to(width) if "num" not in k else v for k, v in module.state_dict().items()},
              tmp_path / "model.safetensors")  # fmt: skip
    checkpoint.load_weights(module, tmp_path)
    assert module.weight.dtype == torch.float32 and module.num_batches_tracked.dtype == torch.int64


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("weight", torch.int64),
        ("weight", torch.uint8),
        ("weight", torch.bool),
        ("weight", torch.complex64),
        ("num_batches_tracked", torch.float32),
        ("num_batches_tracked", torch.bool),
    ],
)
def test_numbers_of_another_kind_are_refused_by_name(tmp_path, name, kind):
    module = nn.BatchNorm1d(3)
    content = module.state_dict()
    save_file({**content, name: content[name].to(kind)}, tmp_path / "model.safetensors")
    with pytest.raises(ValueError, match=rf"of another shape or type \({name} "):
        checkpoint.load_weights(module, tmp_path)


def test_truncated_weights_are_refused(tmp_path):
    path = checkpoint.save_weights(nn.Linear(3, 2), tmp_path)
    os.truncate(path, path.stat().st_size - 4)
    with pytest.raises(ValueError, match="truncated"):
        checkpoint.load_weights(nn.Linear(3, 2), tmp_path)


def test_unreadable_weights_are_not_called_damaged(tmp_path, monkeypatch):
    checkpoint.save_weights(nn.Linear(3, 2), tmp_path)

    def refused(path):
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr("mitigate.core.folders.sha256", refused)
    with pytest.raises(PermissionError, match=r"denied.*model\.safetensors"):
        checkpoint.load_weights(nn.Linear(3, 2), tmp_path)


def test_missing_weights_say_what_to_train(tmp_path):
    with pytest.raises(FileNotFoundError, match="make train RECIPE=base"):
        checkpoint.load_weights(nn.Linear(3, 2), tmp_path)


def test_load_reads_one_part_of_whole_weights(tmp_path):
    whole = nn.ModuleDict({"a": nn.Linear(2, 2), "b": nn.Linear(2, 3)})
    file = checkpoint.save_weights(whole, tmp_path)
    part = nn.Linear(2, 3)
    checkpoint.load_part(part, "b", tmp_path)
    assert torch.equal(part.weight, whole["b"].weight)
    smaller = nn.Linear(2, 3, bias=False)  # missing entries are omitted
    checkpoint.load_part(smaller, "b", tmp_path)
    assert torch.equal(smaller.weight, whole["b"].weight)
    with pytest.raises(ValueError, match="no part 'c'"):
        checkpoint.load_part(part, "c", file)
    with pytest.raises(ValueError, match="do not fit"):
        checkpoint.load_part(part, "a", file)


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -float("inf")])
def test_weights_that_are_no_numbers_are_refused(tmp_path, value):
    module = torch.nn.Sequential(torch.nn.Linear(3, 3), torch.nn.BatchNorm1d(3))
    with torch.no_grad():
        module[0].weight[1, 1] = value
    file = checkpoint.save_weights(module, tmp_path)
    with pytest.raises(ValueError, match="holds? NaN.*0.weight"):
        checkpoint.load_weights(module, file)
    assert checkpoint.not_finite(torch.nn.Linear(2, 2)) == []


def test_infinite_mask_is_not_damage(tmp_path):
    module = torch.nn.Linear(2, 2)
    module.register_buffer("mask", torch.full((2, 2), -float("inf")))
    checkpoint.load_weights(module, checkpoint.save_weights(module, tmp_path))
    module.mask[0, 0] = float("nan")
    assert checkpoint.not_finite(module) == ["mask"]


def test_full_disk_is_named_and_files_stay(tmp_path):
    model = torch.nn.Linear(2, 2)
    before = checkpoint.save_weights(model, tmp_path).read_bytes()
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)
    before_signal = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    state = {k: {} for k in states.REQUIRED} | {"step": 1, "model": {"w": torch.zeros(99999)}}
    resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, limit[1]))  # simulates a full disk
    try:
        with pytest.raises(OSError, match="could not be written|too large"):
            states.save(tmp_path, state)
        with pytest.raises(OSError, match="could not be written|too large"):
            checkpoint.save_weights(torch.nn.Linear(99, 999), tmp_path)
        with pytest.raises(OSError):
            files.write_bytes(tmp_path / "x", bytes(99_999))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limit)
        signal.signal(signal.SIGXFSZ, before_signal)
    assert (tmp_path / checkpoint.WEIGHTS).read_bytes() == before
    assert sorted(p.name for p in tmp_path.iterdir()) == [
        folders.MANIFEST,
        checkpoint.WEIGHTS,
    ]
