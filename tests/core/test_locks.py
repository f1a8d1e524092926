"""Tests that only one process at a time uses a folder, and that temporary files of killed processes
are deleted."""

from __future__ import annotations

import gc
import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from mitigate.core.conf import load_config
from mitigate.core.locks import NAME, FolderLock, delete_leftovers
from mitigate.evaluation import evaluate
from mitigate.training import train

DEAD = 2**30  # a number larger than any process id (Linux: at most 2**22)
HOLD = (
    "import sys; from mitigate.core.locks import FolderLock; lock = FolderLock(sys.argv[1])\n"
    "lock.__enter__(); print('in', flush=True); sys.stdin.read()"
)


@pytest.fixture
def other(tmp_path):
    """Start a second process that holds the lock of ``tmp_path / "run"``."""
    command = [sys.executable, "-c", HOLD, str(tmp_path / "run")]
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])}
    options = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "env": environment}
    with subprocess.Popen(command, **options) as process:
        assert process.stdout.readline() == b"in\n"
        yield process
        process.kill()


def test_second_process_is_rejected_and_names_the_first(tmp_path, other):
    with pytest.raises(ValueError, match=rf"is in use: process {other.pid} on .* Wait for it"):
        FolderLock(tmp_path / "run").__enter__()
    with FolderLock(tmp_path / "another"):
        pass


def test_lock_of_a_killed_process_does_not_block(tmp_path, other):
    other.send_signal(signal.SIGKILL)
    other.wait()
    assert (tmp_path / "run" / NAME).is_file()  # stale
    with FolderLock(tmp_path / "run"):
        pass
    assert not (tmp_path / "run" / NAME).exists()


@pytest.mark.parametrize("note", ["", "{", "[]", '{"pid": "x"}', "[" * 9999, "\x00"])
def test_damaged_lock_note_does_not_block(tmp_path, note):
    (tmp_path / NAME).write_text(note)
    with FolderLock(tmp_path):
        with pytest.raises(ValueError, match=f"process {os.getpid()} on"):
            FolderLock(tmp_path).__enter__()
        # the failed attempt did not release the lock
        with pytest.raises(ValueError, match="is in use"):
            FolderLock(tmp_path).__enter__()


def test_worker_does_not_inherit_the_lock(tmp_path):
    with FolderLock(tmp_path):
        child = os.fork()
        if child == 0:
            signal.pause()
    try:
        with FolderLock(tmp_path):
            pass
    finally:
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)


def test_cleanup_deletes_only_partial_files(tmp_path):
    dead, alive = DEAD, os.getppid()
    left = [f".step-00000100.pt.{dead}.tmp", f"agent/.model.safetensors.{dead}.tmp"]
    remaining = [
        "step-00000050.pt",
        ".step-00000100.pt",
        "notes.tmp",
        ".mine.tmp",
        "agent/.x.tmp.5",
    ]
    remaining += [
        f".rows.jsonl.{alive}.tmp",
        f"agent/.model.safetensors.{alive}.tmp",
    ]  # being written
    remaining += [f"mine/.notes.{dead}.tmp", f"agent/b/.x.{dead}.tmp"]  # of others
    remaining += ["locked/.lock", f"locked/.rows.jsonl.{dead}.tmp"]
    for name in (*left, *remaining):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("x")
    (tmp_path / ".adapter-abc.0.tmp").mkdir()
    (tmp_path / f".away.{dead}.tmp").symlink_to(tmp_path / "agent")
    within = ("agent", "locked", "not there")
    with FolderLock(tmp_path, within):
        pass
    assert all((tmp_path / name).is_file() for name in remaining)
    assert not any((tmp_path / name).exists() for name in left)
    assert not delete_leftovers(tmp_path, within) and (tmp_path / "agent").is_dir()


@pytest.mark.parametrize("name", ["train", "evaluate"])
def test_second_run_in_a_folder_is_rejected(tmp_path, name):
    place = {"train": "folder", "evaluate": "out"}[name]
    small = ["debug=smoke"] if name == "train" else ["episodes=1", "conditions=[clean]"]
    cfg = load_config(name, [*small, f"{place}={tmp_path}"])
    with FolderLock(tmp_path), pytest.raises(ValueError, match="is in use: process"):
        {"train": train.run, "evaluate": evaluate.run}[name](cfg)
    assert not list(tmp_path.iterdir())


def test_failed_block_leaves_no_empty_folders(tmp_path):
    with pytest.raises(KeyError), FolderLock(tmp_path / "runs" / "a"):
        raise KeyError
    assert not list(tmp_path.iterdir())
    with FolderLock(tmp_path / "runs" / "a"):
        pass
    assert (tmp_path / "runs" / "a").is_dir()


def test_failed_block_keeps_earlier_folders_and_files(tmp_path):
    (tmp_path / "earlier").mkdir()
    with pytest.raises(KeyError), FolderLock(tmp_path / "earlier"):
        raise KeyError
    with pytest.raises(KeyError), FolderLock(tmp_path / "new"):
        (tmp_path / "new" / "rows.jsonl").touch()
        raise KeyError
    assert (tmp_path / "earlier").is_dir() and (tmp_path / "new" / "rows.jsonl").is_file()


def test_rejected_training_leaves_no_folder(tmp_path):
    folder = tmp_path / "runs" / "rejected"
    cfg = load_config("train", ["recipe=da_per_episode", f"folder={folder}", "init=missing"])
    with pytest.raises(FileNotFoundError):
        train.run(cfg)
    assert not list(tmp_path.iterdir())


def test_folder_that_cannot_be_created_is_named(tmp_path):
    (tmp_path / "file").write_text("x")
    for place in (tmp_path / "file/under", Path("/proc/under")):
        with pytest.raises(OSError, match=f"Cannot write {place}: .* choose another folder"):
            FolderLock(place).__enter__()


def test_rejected_second_lock_keeps_the_first(tmp_path):
    code = "import sys; from mitigate.core.locks import FolderLock\n"
    code += "FolderLock(sys.argv[1]).__enter__()"
    with FolderLock(tmp_path):
        for _ in range(2):
            with pytest.raises(ValueError, match="is in use"):
                FolderLock(tmp_path).__enter__()
        gc.collect()
        environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])}
        other = subprocess.run(
            [sys.executable, "-c", code, str(tmp_path)],
            env=environment,
            capture_output=True,
            text=True,
        )
    assert "is in use: process" in other.stderr


def test_cleanup_deletes_files_of_a_reused_process_id(tmp_path):
    """In a restarted container, every process has the same process id as before."""
    (tmp_path / "walks").mkdir()
    settings, other = (tmp_path / f".{n}.pt.{n}.tmp" for n in (os.getpid(), os.getppid()))
    dead = tmp_path / "walks" / ".x.pt.4194300.tmp"
    for file in (settings, other, dead):
        file.touch()
    with FolderLock(tmp_path, ("walks",)):
        assert not settings.exists() and not dead.exists() and other.exists()


@pytest.mark.parametrize("command", ["[" * 4000, "\x1b[31m" + "x" * 3000])
def test_lock_note_is_printed_escaped_and_short(tmp_path, other, command):
    """Issue T2, item 11."""
    note = json.dumps({"pid": 1, "host": "\x1b[2J" * 100, "command": command})
    for text in (note, command):
        (tmp_path / "run" / NAME).write_text(text)
        with pytest.raises(ValueError, match="is in use") as error:
            FolderLock(tmp_path / "run").__enter__()
        assert str(error.value).isprintable() and len(str(error.value)) < 700
