"""Tests that only regular output files are opened, and that a removed folder is noticed."""

from __future__ import annotations

import os
import shutil
import socket

import pytest

from mitigate.core import checksums, files, json_files, output, settings
from mitigate.core.locks import NAME, FolderLock, delete_leftovers
from mitigate.core.output import FolderLostError, UnsafePathError, open_output, output_folder
from mitigate.evaluation import rows

MODES = ("w", "wb", "a", "a+", "ab+", "r+")


def link(path):
    target = path.with_name("target.txt")
    target.write_text("mine")
    path.symlink_to(target.name)


def dangling_link(path):
    path.symlink_to("nowhere")


def hard_link(path):
    target = path.with_name("target.txt")
    target.write_text("mine")
    os.link(target, path)


def fifo(path):
    os.mkfifo(path)


def socket_file(path):
    with socket.socket(socket.AF_UNIX) as one:
        one.bind(str(path))


PLANTED = {
    "link": link,
    "dangling link": dangling_link,
    "hard link": hard_link,
    "fifo": fifo,
    "socket": socket_file,
}


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("plant", PLANTED.values(), ids=PLANTED)
def test_open_output_rejects_what_is_not_a_regular_file(tmp_path, plant, mode):
    plant(tmp_path / "file")
    with pytest.raises(UnsafePathError, match="file must be a regular file, got a .*Delete it"):
        open_output(tmp_path / "file", mode)
    assert not (tmp_path / "nowhere").exists()
    if (tmp_path / "target.txt").exists():
        assert (tmp_path / "target.txt").read_text() == "mine"


def test_open_output_rejects_a_device():
    with pytest.raises(UnsafePathError, match="got a device"):
        open_output("/dev/null", "w")


def test_open_output_rejects_link_that_appears_late(tmp_path, monkeypatch):
    monkeypatch.setattr(output, "_check_file", lambda path: None)
    link(tmp_path / "file")
    with pytest.raises(OSError, match="symbolic link"):
        open_output(tmp_path / "file", "w")
    assert (tmp_path / "target.txt").read_text() == "mine"


def test_open_output_writes_as_open_does(tmp_path):
    path = tmp_path / "file"
    with open_output(path, "w", encoding="utf-8") as file:
        file.write("long text")
    with open_output(path, "w", encoding="utf-8") as file:
        file.write("ä")
    with open_output(path, "a", encoding="utf-8") as file:
        file.write("b")
    with open_output(path, "r+", encoding="utf-8") as file:
        assert file.read() == "äb"
    with pytest.raises(FileExistsError):
        open_output(path, "x")
    with pytest.raises(FileNotFoundError):
        open_output(tmp_path / "none", "r+")


@pytest.mark.parametrize("plant", PLANTED.values(), ids=PLANTED)
def test_folder_lock_rejects_a_planted_lock_file(tmp_path, plant):
    folder = tmp_path / "got"
    folder.mkdir()
    plant(folder / NAME)
    with pytest.raises(UnsafePathError, match=r"\.lock must be a regular file"):
        FolderLock(folder).__enter__()
    if (folder / "target.txt").exists():
        assert (folder / "target.txt").read_text() == "mine"


@pytest.mark.parametrize("plant", PLANTED.values(), ids=PLANTED)
def test_append_rejects_a_planted_row_file(tmp_path, plant):
    plant(tmp_path / "rows.jsonl")
    with pytest.raises(UnsafePathError, match="rows.jsonl must be a regular file"):
        rows.append(tmp_path / "rows.jsonl", [])


@pytest.mark.parametrize("plant", PLANTED.values(), ids=PLANTED)
def test_atomic_writes_replace_what_is_planted_at_the_name(tmp_path, plant):
    for write in (
        lambda path: files.write_text(path, "new"),
        lambda path: checksums.write(path, lambda draft: draft.write_text("new")),
    ):
        shutil.rmtree(tmp_path / "in", ignore_errors=True)
        (tmp_path / "in").mkdir()
        plant(tmp_path / "in" / "file")
        write(tmp_path / "in" / "file")
        assert (tmp_path / "in" / "file").read_text() == "new"
        assert not (tmp_path / "in" / "file").is_symlink()
        if (tmp_path / "in" / "target.txt").exists():
            assert (tmp_path / "in" / "target.txt").read_text() == "mine"


def test_atomic_writes_ignore_links_at_predictable_temporary_names(tmp_path):
    link(tmp_path / f".file.{os.getpid()}.tmp")
    files.write_text(tmp_path / "file", "new")
    assert (tmp_path / "target.txt").read_text() == "mine"


@pytest.mark.parametrize("guard", [FolderLock, output_folder])
def test_output_folder_rejects_a_linked_folder_inside(tmp_path, guard):
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / "file").write_text("mine")
    out = tmp_path / "out"
    out.mkdir()
    (out / "episodes").symlink_to(elsewhere)
    with guard(out):
        for write in (
            lambda path: files.write_text(path, "new"),
            lambda path: open_output(path, "w"),
            lambda path: files.make_folder(path.parent),
            lambda path: files.make_folder(path.parent / "deeper"),
        ):
            with pytest.raises(UnsafePathError, match="episodes must be a folder, got a symbolic"):
                write(out / "episodes" / "file")
    assert [path.name for path in elsewhere.iterdir()] == ["file"]
    assert (elsewhere / "file").read_text() == "mine"


@pytest.mark.parametrize("guard", [FolderLock, output_folder])
def test_output_folder_itself_may_be_a_link(tmp_path, guard):
    (tmp_path / "disk").mkdir()
    (tmp_path / "runs").symlink_to("disk")
    with guard(tmp_path / "runs" / "one"):
        files.write_text(tmp_path / "runs" / "one" / "in" / "file", "new")
        files.write_text(tmp_path / "disk" / "one" / "file", "new")
    (tmp_path / "link").symlink_to("disk/one")
    with guard(tmp_path / "link"):
        files.write_text(tmp_path / "link" / "in" / "file", "newer")
    assert (tmp_path / "disk" / "one" / "in" / "file").read_text() == "newer"


def test_delete_leftovers_does_not_follow_a_link(tmp_path):
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere" / f".file.{2**30}.tmp").write_text("mine")
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "agent").symlink_to("../elsewhere")
    assert delete_leftovers(tmp_path / "run", ["agent"]) == []


def removed(out):
    shutil.rmtree(out)


def remade(out):
    out.rename(out.with_name("aside"))
    out.mkdir()
    (out / NAME).touch()


def moved(out):
    out.rename(out.with_name("aside"))


@pytest.mark.parametrize("guard", [FolderLock, output_folder])
@pytest.mark.parametrize("lose", [removed, remade, moved])
def test_writes_notice_a_lost_output_folder(tmp_path, guard, lose):
    out = tmp_path / "out"
    writes = (
        lambda: files.write_text(out / "file", "new"),
        lambda: files.make_folder(out / "in"),
        lambda: rows.append(out / "rows.jsonl", []),
        lambda: open_output(out / "log", "a"),
    )
    message = "out was removed or replaced .*same command again"
    with pytest.raises(FolderLostError, match=message), guard(out):
        lose(out)
        for write in writes:
            with pytest.raises(FolderLostError, match=message):
                write()
    assert not out.exists() or [path.name for path in out.iterdir()] == [NAME]


@pytest.mark.parametrize("write", [files.write_text, lambda path, _: open_output(path, "a")])
def test_writes_notice_a_lost_inner_folder(tmp_path, write):
    with output_folder(tmp_path / "out"):
        files.write_text(tmp_path / "out" / "in" / "file", "new")
        shutil.rmtree(tmp_path / "out" / "in")
        with pytest.raises(FolderLostError, match="in was removed or replaced"):
            write(tmp_path / "out" / "in" / "other", "new")
        # a caller that deletes the folder itself must call this
        output.forget(tmp_path / "out" / "in")
        files.write_text(tmp_path / "out" / "in" / "other", "new")


def test_write_in_progress_notices_a_lost_folder(tmp_path):
    with output_folder(tmp_path / "out") as root:
        with pytest.raises(FolderLostError):
            files.write_atomically(
                tmp_path / "out" / "file", lambda path: shutil.rmtree(path.parent)
            )
        with pytest.raises(FolderLostError):
            root.check()
        (tmp_path / "out").mkdir()
        root.descriptor, old = os.open(tmp_path / "out", os.O_RDONLY), root.descriptor
        os.close(old)


def test_folder_lock_notices_a_lost_lock(tmp_path):
    for lose in (
        lambda: (tmp_path / NAME).unlink(),
        lambda: (tmp_path / NAME).rename(tmp_path / "aside"),
    ):
        message = r"\.lock was removed or replaced"
        with pytest.raises(FolderLostError, match=message), FolderLock(tmp_path):
            lose()
            with pytest.raises(FolderLostError):
                files.write_text(tmp_path / "file", "new")


def test_folder_lock_leaves_the_lock_of_another_process(tmp_path):
    with pytest.raises(FolderLostError), FolderLock(tmp_path):
        (tmp_path / NAME).unlink()
        (tmp_path / NAME).write_text("another")
    assert (tmp_path / NAME).read_text() == "another"


def test_folder_lock_names_an_expected_file_that_is_lost(tmp_path):
    lock = FolderLock(tmp_path)
    with pytest.raises(FolderLostError, match="rows.jsonl was removed"), lock:
        lock.expect(tmp_path / "rows.jsonl")


def test_folder_lock_keeps_the_first_error(tmp_path):
    with pytest.raises(KeyError), FolderLock(tmp_path / "out"):
        shutil.rmtree(tmp_path / "out")
        raise KeyError
    with FolderLock(tmp_path / "out"):  # the lock has been released
        pass


@pytest.mark.parametrize(
    "read",
    [
        rows.read,
        lambda path: files.read_bounded(path, 100),
        files.sha256,
        settings.read,
        lambda path: json_files.read_json(path, ""),
        lambda path: rows.gather([path.parent]),
    ],
)
def test_reading_rejects_a_fifo(tmp_path, read):
    fifo(tmp_path / "rows.jsonl")
    with pytest.raises(UnsafePathError, match="must be a regular file, got a FIFO"):
        read(tmp_path / "rows.jsonl")


@pytest.mark.parametrize("plant", [link, fifo])
def test_delete_folder_rejects_what_is_no_folder(tmp_path, plant):
    plant(tmp_path / "folder")
    with pytest.raises(UnsafePathError, match="folder must be a folder, got a .*Nothing was del"):
        output.delete_folder(tmp_path / "folder")
