"""Tests that a folder contains only old or only new files, and that changes are detected."""

from __future__ import annotations

import json
import os
import re
import shutil
from pathlib import Path

import pytest
import torch
from torch import nn

import mitigate
from mitigate.core import checkpoint, folders, seeding
from mitigate.core.files import sha256
from mitigate.guards.frames.restorer import load_restorer
from mitigate.guards.text import classifier
from mitigate.guards.text.language_models.adapter_folder import adapter_tensors, read_adapter

ROOT = Path(__file__).parents[2]
FLIPS = 50
KINDS = {
    "restorer": "restorer",
    "safeguard": "safeguard",
    "safeguard_classifier": "safeguard",
    "topological_imagenet/conv_adapter": "hardened",
}
# the kinds of all shipped folders
SHIPPED = {
    name: "hardened" if name.startswith("hardened/") else KINDS.get(name, "agent")
    for file in sorted((ROOT / "checkpoints").rglob("*.safetensors"))
    for name in [file.parent.relative_to(ROOT / "checkpoints").as_posix()]
}
READERS = {
    "base": mitigate.load,
    "recurrent/base": mitigate.load,
    "frontier/base": mitigate.load,
    "hardened/stacked": mitigate.load,
    "hardened/conv_adapter": mitigate.load,
    "restorer": load_restorer,
    "safeguard": lambda folder: adapter_tensors(folder, read_adapter(folder)[1]),
    "safeguard_classifier": classifier.load.__wrapped__,  # without its cache
}


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


def flip(file: Path) -> None:
    file.write_bytes(flipped(file.read_bytes(), 4 * file.stat().st_size))


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


@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_folder_has_a_manifest_of_all_its_files(name):
    folder = ROOT / "checkpoints" / name
    manifest = folders.check(folder)
    assert manifest.files.keys() | {folders.MANIFEST} == names(folder)
    assert manifest.kind == SHIPPED[name] and not manifest.replaced


@pytest.mark.parametrize("name", READERS)
def test_shipped_folder_loads_and_detects_flipped_bits(name, tmp_path, monkeypatch):
    # the settings of adapters name the folder of their base agent relative to ROOT
    monkeypatch.chdir(ROOT)
    folder = Path(shutil.copytree(ROOT / "checkpoints" / name, tmp_path / "mine"))
    assert READERS[name](folder) is not None
    for file in folders.check(folder).files:
        sound = (folder / file).read_bytes()
        flip(folder / file)
        with pytest.raises(ValueError, match=rf"{re.escape(file)}.* (sha256|damaged)"):
            READERS[name](folder)
        (folder / file).write_bytes(sound)
    assert READERS[name](folder) is not None


def test_weights_without_a_manifest_load(tmp_path):
    """Folders of other projects have no manifest."""
    shutil.copytree(ROOT / "checkpoints/frontier/base", tmp_path, dirs_exist_ok=True)
    (tmp_path / folders.MANIFEST).unlink()
    agent = mitigate.load(ROOT / "checkpoints/frontier/base")
    assert checkpoint.weights_sha(mitigate.load(tmp_path)) == checkpoint.weights_sha(agent)


def test_file_of_another_size_is_not_read(tmp_path, monkeypatch):
    folder = write_files(tmp_path, one="1")
    (folder / "one").write_text("10")

    def read(path):
        raise AssertionError(f"{path} was read")

    monkeypatch.setattr(folders, "sha256", read)
    with pytest.raises(ValueError, match="changed or truncated"):
        folders.check(folder)


@pytest.mark.parametrize("earlier", ["manifest", "nothing"])
@pytest.mark.parametrize("when", range(4))
def test_kill_leaves_the_old_or_the_new_file(tmp_path, monkeypatch, when, earlier):
    """A file is replaced in three writes: a manifest with the old and the new checksum, the file,
    and the final manifest."""
    old = nn.Linear(3, 2)
    new = nn.Linear(3, 2)
    checkpoint.save_weights(old, tmp_path)
    if earlier == "nothing":
        (tmp_path / folders.MANIFEST).unlink()
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


def test_folder_without_a_manifest_gets_one_when_it_is_written(tmp_path):
    module = nn.Linear(3, 2)
    checkpoint.save_agent(module, tmp_path, "agent: {}\n")
    (tmp_path / folders.MANIFEST).unlink()
    loaded = nn.Linear(3, 2)
    checkpoint.load_weights(loaded, tmp_path)
    assert torch.equal(loaded.weight, module.weight)
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
