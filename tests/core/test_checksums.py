"""Tests of the sha256 checksums of training states."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest
import torch

from mitigate.core import seeding
from mitigate.training import states

FLIPS = 50
STATE = {
    "finished": True,
    "model": {"w": torch.arange(300.0), "deep": {"b": torch.ones(7)}},
    "optimizer": {"state": {0: {"exp_avg": torch.zeros(300)}}},
    "scheduler": {},
    "rng": {},
    "config": {"a": 1},
}


class Killed(BaseException):
    """Raised to simulate a kill; only ``finally`` blocks run after it."""


def state(step: int) -> dict:
    return {"step": step, **STATE}


def flipped(data: bytes, bit: int) -> bytes:
    """Return ``data`` with one flipped bit."""
    changed = bytearray(data)
    changed[bit // 8] ^= 1 << bit % 8
    return bytes(changed)


def flips(data: bytes, name: str) -> list[bytes]:
    """Return ``FLIPS`` copies of ``data``, each with one flipped bit; ``name`` is the seed."""
    places = seeding.generator(0, "flipped bits", name).integers(0, 8 * len(data), FLIPS)
    return [flipped(data, int(bit)) for bit in places]


def note_of(path: Path) -> Path:
    return path.with_name(path.name + ".sha256")


def checked(folder: Path) -> int:
    """Return the exit status of ``sha256sum -c`` over all sidecars in ``folder``."""
    names = sorted(path.name for path in folder.glob("*.sha256"))
    assert names
    command = ["sha256sum", "--strict", "--status", "-c", *names]
    return subprocess.run(command, cwd=folder).returncode


def test_checkpoint_detects_every_flipped_bit(tmp_path):
    states.save(tmp_path, state(1))
    path = states.save(tmp_path, state(2))
    for changed in flips(path.read_bytes(), "step"):
        path.write_bytes(changed)
        with pytest.raises(states.Damaged, match="step-00000002.pt"):
            states.load(path)
        newest, loaded = states.load_newest(tmp_path)
        assert newest.name == "step-00000001.pt" and loaded["step"] == 1


def test_load_detects_flipped_bits_without_a_sidecar(tmp_path):
    """The zip file contains checksums of its entries, so a flipped bit is either detected or
    changes no entry."""
    path = states.save(tmp_path, state(1))
    note_of(path).unlink()
    expected, sound, refused = states.load(path), path.read_bytes(), 0
    for changed in flips(sound, "no sidecar"):
        path.write_bytes(changed)
        try:
            loaded = states.load(path)
        except states.Damaged:
            refused += 1
            continue
        assert str(loaded) == str(expected)
        assert torch.equal(loaded["model"]["w"], expected["model"]["w"])
    assert refused > FLIPS / 2
    path.write_bytes(sound)
    at = sound.index(STATE["model"]["w"].numpy().tobytes())
    path.write_bytes(flipped(sound, 8 * at + 77))
    with pytest.raises(states.Damaged, match="has changed bytes"):
        states.load(path)


@pytest.mark.parametrize("share", [0.0, 0.3, 0.99])
@pytest.mark.parametrize("noted", [True, False])
def test_truncated_checkpoint_is_skipped(tmp_path, share, noted, capsys):
    states.save(tmp_path, state(1))
    path = states.save(tmp_path, state(2))
    os.truncate(path, int(path.stat().st_size * share))
    if not noted:
        note_of(path).unlink()
    assert states.load_newest(tmp_path)[0].name == "step-00000001.pt"
    printed = capsys.readouterr().out
    assert printed == f"{path} is damaged; resuming from step-00000001.pt\n"


@pytest.mark.parametrize("text", ["", "\n", "0" * 64, "0" * 64 + "  other\n", "\xff", "x  model"])
def test_damaged_sidecar_is_named_and_may_be_deleted(tmp_path, text):
    path = states.save(tmp_path, state(1))
    note_of(path).write_bytes(text.encode("latin-1"))
    with pytest.raises(states.Damaged, match=r"If only the \.sha256 files are damaged"):
        states.load_newest(tmp_path)
    note_of(path).unlink()
    assert states.load_newest(tmp_path)[1]["step"] == 1


def test_damaged_checkpoints_are_not_deleted(tmp_path):
    for step in (1, 2):
        path = states.save(tmp_path, state(step))
        path.write_bytes(flipped(path.read_bytes(), 4000))
    before = {p: p.read_bytes() for p in tmp_path.iterdir()}
    with pytest.raises(states.Damaged, match="step-00000002.pt, step-00000001.pt.*none was"):
        states.load_newest(tmp_path)
    assert before == {p: p.read_bytes() for p in tmp_path.iterdir()}
    assert states.load_newest(tmp_path / "nothing") is None


def test_sidecars_are_what_sha256sum_checks(tmp_path):
    states.save(tmp_path, state(1))
    path = states.save(tmp_path, state(2))
    assert checked(tmp_path) == 0
    path.write_bytes(flipped(path.read_bytes(), 500))
    assert checked(tmp_path) != 0


def test_rotation_deletes_sidecars_and_orphans(tmp_path):
    (tmp_path / "step-00000001.pt.sha256").write_text("left by a kill")
    for step in (2, 3, 4, 5):
        states.save(tmp_path, state(step), keep=2)
    left = [f"step-0000000{step}.pt{end}" for step in (4, 5) for end in ("", ".sha256")]
    assert sorted(path.name for path in tmp_path.iterdir()) == left


def test_save_keeps_new_checkpoints_before_a_damaged_later_step(tmp_path):
    late = states.save(tmp_path, state(9))
    late.write_bytes(b"")
    for step in (4, 5):
        states.save(tmp_path, state(step), keep=1)
    assert [path.name for path in states.checkpoints(tmp_path)] == [
        "step-00000005.pt",
        "step-00000009.pt",
    ]
    assert states.load_newest(tmp_path)[1]["step"] == 5
