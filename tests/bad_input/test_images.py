"""Tests that untrusted image files are decoded completely or skipped with a reason, without partial
output."""

from __future__ import annotations

import io
import struct
import zipfile
import zlib

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from PIL import Image

from mitigate.corruptions import frames_command
from mitigate.corruptions.frame_files import PNG_START, LeftOutError, corrupt_file, read


def chunk(name: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def png(width: int, height: int, bits: int = 8, colour: int = 2, rows: bytes = b"") -> bytes:
    head = struct.pack(">IIBBBBB", width, height, bits, colour, 0, 0, 0)
    return PNG_START + chunk(b"IHDR", head) + chunk(b"IDAT", rows) + chunk(b"IEND", b"")


def picture(kind: str, mode: str = "RGB", size: tuple[int, int] = (8, 8)) -> bytes:
    with io.BytesIO() as file:
        Image.new(mode, size).save(file, kind)
        return file.getvalue()


def npy(head: str, data: bytes = b"") -> bytes:
    text = head.encode() + b" " * (64 - (len(head) + 11) % 64) + b"\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text + data


def zipped() -> bytes:
    with io.BytesIO() as file:
        np.savez(file, a=np.ones((4, 4), np.float32))
        return file.getvalue()


FAST = settings(
    max_examples=80, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
GOOD_PNG, GOOD_JPEG = picture("PNG"), picture("JPEG")
FRAMES = {
    "nothing.png": b"",
    "head.png": GOOD_PNG[:20],
    "half.png": GOOD_PNG[: len(GOOD_PNG) - 30],
    "wide.png": png(1 << 30, 1, rows=zlib.compress(bytes(100))),
    "large.png": png(20_000, 20_000, rows=zlib.compress(bytes(1 << 20))),
    "deep_bomb.png": png(30_000, 30_000, 16, 0, zlib.compress(bytes(1 << 20))),
    "no_width.png": png(0, 8),
    "no_rows.png": png(8, 8),
    "rubbish_rows.png": png(8, 8, rows=b"rubbish"),
    "alpha.png": picture("PNG", "RGBA"),
    "grey.png": picture("PNG", "L"),
    "palette.png": picture("PNG", "P"),
    "jpeg.png": GOOD_JPEG,
    "a_text.png": b"hello, I am a picture " * 9,
    "wrong_sum.png": GOOD_PNG[:30] + b"\x00\x01" + GOOD_PNG[32:],
    "nothing.jpg": b"",
    "half.jpg": GOOD_JPEG[: len(GOOD_JPEG) // 2],
    "cmyk.jpg": picture("JPEG", "CMYK"),
    "grey.jpg": picture("JPEG", "L"),
    "large.jpg": GOOD_JPEG.replace(b"\x00\x08\x00\x08", b"\xff\xff\xff\xff", 1),
    "gif.jpg": picture("GIF"),
    "tiff.jpg": picture("TIFF"),
    "nothing.npy": b"",
    "no_head.npy": b"\x93NUMPY\x01\x00\xff\xff",
    "large.npy": npy("{'descr': '<f4', 'fortran_order': False, 'shape': (999999, 999999)}"),
    "negative.npy": npy("{'descr': '<f4', 'fortran_order': False, 'shape': (-4, -4)}", bytes(64)),
    "objects.npy": npy("{'descr': '|O', 'fortran_order': False, 'shape': (2,)}", b"cos\nsystem\n."),
    "code.npy": npy("__import__('os').system('id')"),
    "unknown_type.npy": npy("{'descr': '<q9', 'fortran_order': False, 'shape': (2,)}"),
    "short.npy": npy("{'descr': '<f4', 'fortran_order': False, 'shape': (64, 64)}", bytes(8)),
    "deep_head.npy": npy("(" * 50_000),
    "whole_numbers.npy": npy(
        "{'descr': '<i4', 'fortran_order': False, 'shape': (2, 2)}", bytes(16)
    ),
    "a_zip.npy": zipped(),
    "a_pickle.npy": b"\x80\x04\x95cos\nsystem\n(S'touch x'\ntR.",
}


@pytest.mark.parametrize("name", FRAMES)
def test_corrupt_skips_invalid_frames_with_a_reason(tmp_path, name):
    path = tmp_path / name
    path.write_bytes(FRAMES[name])
    for take in (
        lambda: corrupt_file(path, path.suffix, 0.001, lambda frame: frame),
        lambda: read(path, 0.001),
    ):
        with pytest.raises(LeftOutError) as error:
            take()
        assert "\n" not in str(error.value) and 0 < len(str(error.value)) < 500


@pytest.mark.parametrize("corruption", ["spatter", "missing_data"])
def test_corrupt_reports_invalid_frames_and_writes_none(tmp_path, capsys, corruption):
    source, out = tmp_path / "in", tmp_path / "out"
    source.mkdir()
    for name, raw in FRAMES.items():
        (source / name).write_bytes(raw)
    (source / "good.png").write_bytes(GOOD_PNG)
    np.save(source / "good.npy", np.ones((8, 8), np.float32))
    arguments = [str(source), str(out), f"corruption={corruption}", "severity=0.5"]
    assert frames_command.main(arguments) == 1
    assert "left out" in capsys.readouterr().err
    assert {p.name for p in out.rglob("*") if p.suffix != ".json"} <= {"good.png", "good.npy"}


@FAST
@given(st.sampled_from(["a.png", "a.jpg", "a.npy"]), st.data())
def test_flipped_and_cut_frames_are_read_or_left_out(tmp_path, name, data):
    with io.BytesIO() as file:
        np.save(file, np.ones((8, 8), np.float32))
        sound = {"a.png": GOOD_PNG, "a.jpg": GOOD_JPEG, "a.npy": file.getvalue()}[name]
    at = data.draw(st.integers(0, len(sound) - 1))
    raw = sound[:at] + data.draw(st.binary(max_size=4)) + sound[at + data.draw(st.integers(0, 9)) :]
    (tmp_path / name).write_bytes(raw)
    try:
        assert read(tmp_path / name, 0.001).ndim == 3
    except LeftOutError as error:
        assert "\n" not in str(error)


def test_load_image_rejects_archives_unopened(tmp_path):
    with zipfile.ZipFile(tmp_path / "a.npy", "w") as archive:
        archive.writestr("../../outside.npy", b"x")
    with pytest.raises(LeftOutError):
        read(tmp_path / "a.npy", 0.001)
    assert not (tmp_path.parent.parent / "outside.npy").exists()
