"""Tests of untrusted files: damaged gzip, gzip bombs, and JSON that is too deep or too large."""

from __future__ import annotations

import gzip
import json
import os
import resource
import tracemalloc
import zlib
from pathlib import Path

import pytest

from mitigate.core import checksums, files, json_files

TEXT = "".join(f'{{"line": {n}}}\n' for n in range(20_000))


@pytest.fixture
def packed(tmp_path):
    path = tmp_path / "text.gz"
    path.write_bytes(gzip.compress(TEXT.encode()))
    return path


def read(path) -> str:
    with files.open_text(path) as file:
        return file.read()


def test_gzip_is_read_whole_by_lines_and_in_pieces(packed):
    assert read(packed) == TEXT
    with files.open_text(packed) as file:
        assert "".join(file) == TEXT
    with files.open_text(packed) as file:
        assert "".join(iter(lambda: file.read(1000), "")) == TEXT


def test_damaged_gzip_gives_one_named_error(packed):
    raw = packed.read_bytes()
    damaged = [raw[: len(raw) // 2], raw[:-4], raw[:12], raw[:2]]
    damaged += [raw[:n] + bytes([raw[n] ^ 0x5A]) + raw[n + 1 :] for n in range(20, len(raw), 997)]
    for data in damaged:
        packed.write_bytes(data)
        with pytest.raises(gzip.BadGzipFile):
            # a flipped bit may leave the text unchanged, but the checksum detects it
            assert read(packed) == TEXT


def bomb(path, size):
    """Write a gzip file of ``size`` spaces without holding them in memory."""
    packer, block = zlib.compressobj(1, wbits=31), b" " * (1 << 22)
    with open(path, "wb") as file:
        for _ in range(size // len(block)):
            file.write(packer.compress(block))
        file.write(packer.flush())
    return path


@pytest.mark.slow
def test_gzip_bomb_is_rejected_before_unpacking(tmp_path):
    path = bomb(tmp_path / "bomb.gz", 1 << 28)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for take in (read, lambda p: list(files.open_text(p)), lambda p: files.open_text(p).readline()):
        with pytest.raises(gzip.BadGzipFile, match="unpacks to more than"):
            take(path)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 400_000  # KiB
    with pytest.raises(ValueError, match="unpacks to more than"):
        list(json_files.json_members(path, "episodes"))


JSON = {
    "deep lists": b"[" * 100_000,
    "deep mappings": b'{"a":' * 100_000,
    "digits": b"9" * 100_000,
    "not a number": b"NaN",
    "infinity": b'{"a": -Infinity}',
    "too great": b"1e999",
    "bytes": b"\xff\xfe\x00",
    "nothing": b"",
    "half": b'{"a": [1, 2',
    "large": b" " * (json_files.LARGEST_JSON + 1),
}


@pytest.mark.parametrize("raw", JSON.values(), ids=JSON)
def test_json_is_plain_data_or_value_error(tmp_path, raw):
    path = tmp_path / "card.json"
    path.write_bytes(raw)
    with pytest.raises(ValueError, match="is truncated or damaged .* Fetch it again") as error:
        json_files.read_json(path, "Fetch it again.")
    assert "\n" not in str(error.value) and len(str(error.value)) < 600
    path.write_text(json.dumps({"a": [1, 0.5, None, True, "x"]}))
    assert json_files.read_json(path, "") == {"a": [1, 0.5, None, True, "x"]}


def test_byte_order_mark_is_skipped(tmp_path):
    path = tmp_path / "a.json"
    for raw in (b'\xef\xbb\xbf{"a": 1}', gzip.compress(b'\xef\xbb\xbf{"a": 1}')):
        path.write_bytes(raw)
        assert read(path) == '{"a": 1}'
        assert dict(json_files.json_members(path, "none")) == {"a": 1}
    path.write_bytes(b'\xef\xbb\xbf{"a": 1}')
    assert json_files.read_json(path, "") == {"a": 1}


def test_folder_replaces_another_or_the_old_one_stays(tmp_path):
    draft, target, old = (tmp_path / name for name in ("draft", "target", "old"))
    target.mkdir()
    (target / "a").write_text("before")
    with pytest.raises(FileNotFoundError):
        files.put_folder(draft, target, old)  # there is no draft folder
    assert (target / "a").read_text() == "before" and not old.exists()
    draft.mkdir()
    (draft / "a").write_text("behind")
    files.put_folder(draft, target, old)
    assert (target / "a").read_text() == "behind" and (old / "a").read_text() == "before"
    assert not draft.exists()


def text_to(path):
    with files.atomic_text(path) as file:
        file.write("text")


def private(path):
    """Replace the file with a new file of mode 0600, as safetensors does."""
    path.unlink(missing_ok=True)
    os.close(os.open(path, os.O_CREAT | os.O_WRONLY, 0o600))


WRITERS = {
    "text": text_to,
    "bytes": lambda path: files.write_bytes(path, b"data"),
    "a private file": lambda path: files.write_atomically(path, private),
    "a file with a sidecar": lambda path: checksums.write(path, private),
}


@pytest.mark.parametrize("umask", [0o022, 0o027])
@pytest.mark.parametrize("write", WRITERS.values(), ids=WRITERS)
def test_file_mode_follows_the_umask(tmp_path, write, umask):
    before = os.umask(umask)
    try:
        write(tmp_path / "made")
    finally:
        os.umask(before)
    output = [*tmp_path.iterdir()]
    assert output and {path.stat().st_mode & 0o777 for path in output} == {0o666 & ~umask}


@pytest.mark.parametrize("write", WRITERS.values(), ids=WRITERS)
def test_write_error_names_the_target_not_the_draft(tmp_path, write):
    (tmp_path / "file").write_text("x")
    for place in (tmp_path / "file/under", Path("/proc/under")):
        with pytest.raises(OSError, match=f"Cannot write {place}.* choose another folder") as error:
            write(place)
        assert ".tmp" not in str(error.value)
    assert [*tmp_path.iterdir()] == [tmp_path / "file"]


def test_reader_error_passes_unchanged(tmp_path):
    with (
        pytest.raises(FileNotFoundError, match="No such file .*/gone'"),
        files.atomic_text(tmp_path / "made"),
    ):
        (tmp_path / "gone").read_bytes()
    assert not [*tmp_path.iterdir()]


@pytest.mark.parametrize("block", [b"x" * 4096, b"\n" * 4096], ids=["one line", "empty lines"])
def test_last_lines_read_little_of_a_huge_output(tmp_path, block):
    """Issue T2, item 9."""
    path = tmp_path / "log"
    with open(path, "wb") as file:
        file.seek(300 << 20)  # a sparse file
        file.write(block * 64 + b"end")
    tracemalloc.start()
    with open(path, "rb") as log:
        lines = files.last_lines(log, 12)
    memory = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert memory < 1 << 21
    assert len(lines) == 1 and len(lines[0]) < 210 and lines[0].endswith("end")


def test_last_lines_escape_control_characters(tmp_path):
    """Issue T2, item 9."""
    path = tmp_path / "log"
    path.write_bytes("first\n\x1b[31mrot\tgrün\x1b[0m\xff\n\n".encode() + b"\xff\n")
    with open(path, "rb") as log:
        assert files.last_lines(log, 2) == ["\\x1b[31mrot grün\\x1b[0mÿ", "\ufffd"]


def test_read_bounded_rejects_a_large_file_without_reading_it(tmp_path):
    """Issue T2, item 8."""
    path = tmp_path / "large"
    with open(path, "wb") as file:
        file.write(b"text")
    assert files.read_bounded(path, 4) == b"text"
    os.truncate(path, 8 << 30)  # sparse
    tracemalloc.start()
    try:
        with pytest.raises(ValueError, match="more than 4096 bytes"):
            files.read_bounded(path, 4096)
        assert tracemalloc.get_traced_memory()[1] < 1 << 20
    finally:
        tracemalloc.stop()
