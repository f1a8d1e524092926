"""Tests that a folder contains only old or only new files, and that changes are detected."""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path

import pytest
import torch
from torch import nn

from mitigate.agents.topological import TopologicalAgent
from mitigate.core import checkpoint, checksums, folders, seeding
from mitigate.core.files import sha256

ROOT = Path(__file__).parents[2]
FLIPS = 50


class Killed(BaseException):
    """Raised to simulate a kill; only ``finally`` blocks run after it."""


def flipped(data: bytes, bit: int) -> bytes:
    """Return ``data`` with one flipped bit."""
    changed = bytearray(data)
    changed[bit // 8] ^= 1 << bit % 8
    return bytes(changed)


def names(folder: Path) -> set[str]:
    return {file.name for file in folder.iterdir()}


def write_files(folder: Path, **files: str) -> Path:
    with folders.write_folder(folder, "agent") as draft:
        for name, text in files.items():
            (draft / name).write_text(text)
    return folder


def older(module: nn.Module, folder: Path) -> Path:
    """Write weights as earlier versions did: with a sidecar and no manifest."""
    file = folder / checkpoint.WEIGHTS
    return checksums.write(file, lambda draft: checkpoint.write_tensors(module, draft))


def test_write_folder_lists_size_and_sha256_of_every_file(tmp_path):
    folder = write_files(tmp_path / "a", one="1", two="22")
    manifest = json.loads((folder / folders.MANIFEST).read_text())
    assert manifest["format"] == 1 and manifest["kind"] == "agent"
    assert manifest["files"]["two"] == {"bytes": 2, "sha256": sha256(folder / "two")}
    assert names(folder) == {"one", "two", folders.MANIFEST}
    assert len({file.stat().st_mode for file in folder.iterdir()}) == 1


def test_write_folder_deletes_listed_files_alone(tmp_path):
    folder = write_files(tmp_path, one="1", two="2")
    (folder / "mine.txt").write_text("notes")
    write_files(folder, two="3")
    assert names(folder) == {"two", "mine.txt", folders.MANIFEST}
    assert folders.check(folder).files.keys() == {"two"}


def test_write_folder_keeps_the_old_folder_after_an_error(tmp_path):
    folder = write_files(tmp_path, one="1")
    with pytest.raises(RuntimeError), folders.write_folder(folder, "agent") as draft:
        (draft / "one").write_text("2")
        raise RuntimeError
    assert (folder / "one").read_text() == "1" and names(folder) == {"one", folders.MANIFEST}


def test_weights_detect_every_flipped_bit(tmp_path):
    path = checkpoint.save_weights(nn.Linear(30, 20), tmp_path)
    sound = path.read_bytes()
    places = seeding.generator(0, "flipped bits", "weights").integers(0, 8 * len(sound), FLIPS)
    for bit in places:
        path.write_bytes(flipped(sound, int(bit)))
        with pytest.raises(ValueError, match="Fetch or train them again"):
            checkpoint.load_weights(nn.Linear(30, 20), path)


def test_shipped_weights_with_a_flipped_bit_are_refused(tmp_path):
    folder = shutil.copytree(ROOT / "checkpoints/base", tmp_path / "base")
    file = folder / checkpoint.WEIGHTS
    file.write_bytes(flipped(file.read_bytes(), 8 * 2_000_000))
    with pytest.raises(ValueError, match="does not have the sha256"):
        checkpoint.load_weights(TopologicalAgent(), folder)


def test_file_of_another_size_is_not_read(tmp_path, monkeypatch):
    folder = write_files(tmp_path, one="1")
    (folder / "one").write_text("10")

    def read(path):
        raise AssertionError(f"{path} was read")

    monkeypatch.setattr(folders, "sha256", read)
    with pytest.raises(ValueError, match="changed or truncated"):
        folders.check(folder)


@pytest.mark.parametrize("earlier", ["manifest", "sidecar", "nothing"])
@pytest.mark.parametrize("when", range(4))
def test_kill_leaves_the_old_or_the_new_file(tmp_path, monkeypatch, when, earlier):
    """A file is replaced in three writes: a manifest with the old and the new checksum, the file,
    and the final manifest."""
    old = nn.Linear(3, 2)
    new = nn.Linear(3, 2)
    if earlier == "manifest":
        checkpoint.save_weights(old, tmp_path)
    else:
        note = older(old, tmp_path)
        if earlier == "nothing":
            note.with_name(f"{note.name}.sha256").unlink()
    replace, calls = os.replace, []

    def replace_until_killed(*paths):
        calls.append(paths)
        if len(calls) > when:
            raise Killed
        replace(*paths)

    monkeypatch.setattr(os, "replace", replace_until_killed)
    if when < 3:
        with pytest.raises(Killed):
            checkpoint.save_weights(new, tmp_path)
    else:
        checkpoint.save_weights(new, tmp_path)
    monkeypatch.undo()
    loaded = nn.Linear(3, 2)
    checkpoint.load_weights(loaded, tmp_path)
    assert torch.equal(loaded.weight, (old if when < 2 else new).weight)
    checkpoint.save_weights(new, tmp_path)
    checkpoint.load_weights(loaded, tmp_path)
    assert torch.equal(loaded.weight, new.weight)
    assert names(tmp_path) == {checkpoint.WEIGHTS, folders.MANIFEST}
    assert "replaced" not in json.loads((tmp_path / folders.MANIFEST).read_text())


def test_mixture_of_old_and_new_folder_is_rejected(tmp_path, monkeypatch):
    folder = write_files(tmp_path, one="1", two="1")
    replace = os.replace

    def replace_one(source, target):
        if Path(target).name == "two":
            raise Killed
        replace(source, target)

    monkeypatch.setattr(os, "replace", replace_one)
    with pytest.raises(Killed):
        write_files(folder, one="2", two="2")
    with pytest.raises(ValueError, match="changed or truncated"):
        folders.check(folder)
    monkeypatch.undo()
    assert folders.check(write_files(folder, one="2", two="2"))


def test_damaged_file_stays_invalid_after_replacement(tmp_path, monkeypatch):
    file = checkpoint.save_weights(nn.Linear(3, 2), tmp_path)
    damaged = flipped(file.read_bytes(), 700)
    file.write_bytes(damaged)
    write, calls = folders._write_manifest, []

    def write_once(*arguments):
        calls.append(arguments)
        if len(calls) > 1:
            raise Killed
        write(*arguments)

    monkeypatch.setattr(folders, "_write_manifest", write_once)
    checkpoint.save_weights(nn.Linear(3, 2), tmp_path)
    checkpoint.load_weights(nn.Linear(3, 2), tmp_path)
    file.write_bytes(damaged)
    with pytest.raises(ValueError, match="damaged"):
        checkpoint.load_weights(nn.Linear(3, 2), tmp_path)


HELD = {"format": 1, "kind": "agent"}
ENTRY = {"bytes": 1, "sha256": "0" * 64}
DAMAGED = {
    "nothing": b"",
    "a list": b"[]",
    "deep": b"[" * 100_000,
    "not a number": b'{"format": NaN}',
    "large": b" " * (1 << 24) + b"{}",
    "no files": HELD,
    "another format": HELD | {"format": 2, "files": {}},
    "no kind": {"format": 1, "files": {}},
    "files in a list": HELD | {"files": ["model.safetensors"]},
    "many files": HELD | {"files": {str(n): ENTRY for n in range(2000)}},
    "an entry of text": HELD | {"files": {"a": "0" * 64}},
    "a short sum": HELD | {"files": {"a": ENTRY | {"sha256": "0"}}},
    "a size of truth": HELD | {"files": {"a": ENTRY | {"bytes": True}}},
    "replaced by text": HELD | {"files": {}, "replaced": "all"},
    "a file outside": HELD | {"files": {"../../etc/passwd": ENTRY}},
    "the folder above": HELD | {"files": {"..": ENTRY}},
    "an absolute path": HELD | {"files": {"/etc/passwd": ENTRY}},
    "a long name": HELD | {"files": {"a" * 300: ENTRY}},
    "an unprintable name": HELD | {"files": {"a\n": ENTRY}},
}


@pytest.mark.parametrize("output", DAMAGED.values(), ids=DAMAGED)
def test_damaged_manifest_is_rejected(tmp_path, output):
    file = checkpoint.save_weights(nn.Linear(3, 2), tmp_path)
    raw = output if isinstance(output, bytes) else json.dumps(output).encode()
    (tmp_path / folders.MANIFEST).write_bytes(raw)
    for read in (
        lambda: folders.check(tmp_path),
        lambda: checkpoint.load_weights(nn.Linear(3, 2), file),
    ):
        with pytest.raises(ValueError) as error:
            read()
        assert folders.MANIFEST in str(error.value) and "\n" not in str(error.value)
        assert len(str(error.value)) < 1000
    (tmp_path / folders.MANIFEST).unlink()
    checkpoint.load_weights(nn.Linear(3, 2), file)


def test_older_folders_are_read_and_upgraded_when_written(tmp_path):
    module = nn.Linear(3, 2)
    file = older(module, tmp_path)
    (tmp_path / "config.yaml").write_text("agent: {}\n")
    loaded = nn.Linear(3, 2)
    checkpoint.load_weights(loaded, tmp_path)
    assert torch.equal(loaded.weight, module.weight)
    note = file.with_name(f"{file.name}.sha256")
    note.write_text(f"{'0' * 64}  {file.name}\n")
    with pytest.raises(ValueError, match="does not have the sha256"):
        checkpoint.load_weights(loaded, tmp_path)
    checkpoint.save_agent(module, tmp_path, "agent: {width: 2}\n")
    assert names(tmp_path) == {folders.MANIFEST, "config.yaml", checkpoint.WEIGHTS}
    assert folders.check(tmp_path).files.keys() == {"config.yaml", checkpoint.WEIGHTS}


def test_add_file_lists_the_file(tmp_path):
    checkpoint.save_weights(nn.Linear(3, 2), tmp_path)
    folders.add_file(tmp_path, "config.yaml", "agent: {}\n")
    assert folders.check(tmp_path).files.keys() == {"config.yaml", checkpoint.WEIGHTS}
    (tmp_path / "config.yaml").write_text("agent: []\n")
    with pytest.raises(ValueError, match=r"config\.yaml does not have the sha256"):
        folders.check(tmp_path)


@pytest.mark.parametrize("name", ["agent", "a" * 255, "[a]*"])
def test_replace_folder_replaces_the_whole_folder_or_nothing(tmp_path, name):
    target = tmp_path / name
    for text in ("first", "second"):
        with folders.replace_folder(target) as draft:
            (draft / text).touch()
    with pytest.raises(KeyError), folders.replace_folder(target) as draft:
        (draft / "third").touch()
        raise KeyError
    assert names(target) == {"second"} and names(tmp_path) == {name}


def test_replace_folder_restores_the_old_folder_after_a_kill(tmp_path):
    """One process was killed between the two renames of a folder. Another process is still
    writing."""
    target = tmp_path / "agent"
    killed = tmp_path / ".agent.01234567.999999999.tmp"
    (killed / "old").mkdir(parents=True)
    (killed / "old/weights").touch()
    running = tmp_path / f".agent.76543210.{os.getppid()}.tmp"
    running.mkdir()
    with pytest.raises(KeyError), folders.replace_folder(target):
        assert names(target) == {"weights"} and not killed.exists()
        raise KeyError
    assert names(target) == {"weights"} and running.exists()
