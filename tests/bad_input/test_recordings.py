"""Tests that untrusted recordings are either read, or rejected with an error that names them.

Both cases must use little memory and time.
"""

from __future__ import annotations

import bz2
import json
import sqlite3
import struct
import time
import tracemalloc
import zlib
from pathlib import Path

import lz4.frame
import numpy as np
import pytest
from rosbags.rosbag2 import storage_mcap

from mitigate.core.files import FREE
from mitigate.core.observation import DEPTH, POSE, RGB
from mitigate.replay.export_drive import write_bag, write_frames
from mitigate.worlds.recorded import Step, load, open_recording, unpacking
from mitigate.worlds.recorded import messages as ros
from mitigate.worlds.recorded.source import Lens

SIZE = 16
SLOWEST = 20.0  # maximum seconds until a rejection (on a busy machine)
MOST = 64 << 20  # maximum bytes that Python and NumPy may allocate before a rejection


def steps(count: int = 3) -> list[dict[str, np.ndarray]]:
    return [
        {
            RGB: np.full((SIZE, SIZE, 3), 40 * n, np.uint8),
            DEPTH: np.full((SIZE, SIZE, 1), 1.0 + n, np.float32),
            POSE: np.array([0, 0.25 * n, 0], np.float32),
        }
        for n in range(count)
    ]


def read(path: Path) -> list:
    return [load(one, views=1, size=SIZE, step=Step()) for one in open_recording(path)]


def refused(path: Path, message: str | None = None) -> None:
    """Check that ``path`` is rejected quickly and with little memory.

    The message must be one short paragraph.
    """
    began = time.monotonic()
    tracemalloc.start()
    try:
        with pytest.raises(ValueError, match=message) as error:
            read(path)
        assert tracemalloc.get_traced_memory()[1] < MOST
    finally:
        tracemalloc.stop()
    assert time.monotonic() - began < SLOWEST
    assert len(str(error.value)) < 1500 and "\n" not in str(error.value)


# ----------------------------------------------------------------------------------- folders


@pytest.fixture
def plain(tmp_path):
    write_frames(tmp_path / "drive", steps(), "walk on")
    return tmp_path / "drive"


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("poses.csv", "x,y,heading\n0,0\n"),
        ("poses.csv", "0,0,0\n" * 2 + "1e999,0,0\n"),
        ("poses.csv", "0,0,0\n" * 2 + f"{'9' * 100_000},0,0\n"),
        ("poses.csv", "\0" * 1000),
        ("instruction.txt", "go " * 40_000),
    ],
)
def test_plain_folder_with_false_values_is_rejected(plain, name, text):
    assert len(read(plain)) == 1
    (plain / name).write_text(text)
    refused(plain)


def test_huge_frame_is_rejected_before_decoding(plain):
    first = sorted((plain / "rgb").iterdir())[0]
    raw = bytearray(first.read_bytes())
    raw[16:24] = struct.pack(">II", 1 << 16, 1 << 16)
    raw[29:33] = struct.pack(">I", zlib.crc32(raw[12:29]))
    first.write_bytes(bytes(raw))
    refused(plain, "65536 x 65536|exceeds limit")


def tum(folder: Path) -> Path:
    write_frames(folder, steps(), "walk on")
    for kind in (RGB, DEPTH):
        files = sorted((folder / kind).iterdir())
        lines = [f"{n}.0 {kind}/{file.name}" for n, file in enumerate(files)]
        (folder / f"{kind}.txt").write_text("\n".join(lines) + "\n")
    return folder


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("rgb.txt", "0 ../../outside.png\n", "outside"),
        ("rgb.txt", "0 /etc/hostname\n", "outside"),
        ("rgb.txt", "0 rgb/a\0b.png\n", "outside"),
        ("rgb.txt", f"{'1' * 5000} rgb/0.png\n", "must be a finite number"),
        ("rgb.txt", "0\n", "words"),
        ("depth.txt", "nan depth/0.png\n", "must be a finite number"),
        ("groundtruth.txt", "0 0 0 0 0 0 0 inf\n", "must be a finite number"),
        ("groundtruth.txt", "# nothing\n", "no pose"),
    ],
)
def test_tum_folder_with_false_values_is_rejected(tmp_path, name, text, message):
    folder = tum(tmp_path / "drive")
    assert len(read(folder)) == 1
    (folder / name).write_text(text)
    refused(folder, message)


def test_long_list_is_rejected_before_it_is_read(tmp_path, monkeypatch):
    folder = tum(tmp_path / "drive")
    with open(folder / "rgb.txt", "wb") as file:
        file.truncate(1 << 30)  # a sparse file of 1 GiB without a line break
    monkeypatch.setattr("mitigate.worlds.recorded.folders.read_text.__defaults__", (1 << 20,))
    refused(folder, "must have at most 1048576 bytes")


def recording(folder: Path) -> Path:
    """Write the files that ``mitigate run record=`` writes for one episode with one camera."""
    write_frames(folder / "made", steps(), "")
    episode = folder / "drive" / "scene" / "1"
    episode.mkdir(parents=True)
    (folder / "made" / "rgb").rename(episode / "rgb")
    description = {"rgb": {"kind": "rgb", "hfov": 90, "yaw": 0}}
    for name, content in (("episode.json", {"text": "go"}), ("cameras.json", description)):
        (episode / name).write_text(json.dumps(content))
    lines = [json.dumps({"position": [0, 0, n], "heading": 0}) for n in range(3)]
    (episode / "steps.jsonl").write_text("\n".join(lines))
    (folder / "drive" / "recording.json").write_text(json.dumps({"unit": 0.001}))
    return folder / "drive"


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("recording.json", '{"unit": {"a": 1}}'),
        ("recording.json", '{"unit": 1e300}'),
        ("recording.json", '{"unit": -1}'),
        ("recording.json", "[" * 100_000),
        ("recording.json", "[]"),
        ("scene/1/cameras.json", '{"rgb": {"kind": "rgb", "hfov": "wide"}}'),
        ("scene/1/cameras.json", '{"rgb": {"kind": "rgb", "hfov": 1e9}}'),
        ("scene/1/cameras.json", '{"rgb": {"kind": "rgb", "hfov": 90, "yaw": [1]}}'),
        ("scene/1/cameras.json", '{"rgb": {"kind": "rgb", "hfov": NaN}}'),
        ("scene/1/episode.json", '{"text": '),
        ("scene/1/steps.jsonl", '{"position": \n{}\n{}\n'),
    ],
)
def test_bag_with_false_values_is_rejected(tmp_path, name, text):
    folder = recording(tmp_path)
    assert len(read(folder)) == 1
    (folder / name).write_text(text)
    refused(folder)


@pytest.mark.parametrize("position", ["[1e400, 0, 0]", f"[{'9' * 400}, 0, 0]", "[[], 0, 0]", '"x"'])
def test_invalid_position_drops_poses_or_is_rejected(tmp_path, position):
    folder = recording(tmp_path)
    lines = [f'{{"position": {position}, "heading": 0}}'] * 3
    (folder / "scene/1/steps.jsonl").write_text("\n".join(lines))
    try:
        assert read(folder)[0].poses is None
    except ValueError as error:
        assert "steps.jsonl" in str(error)


# -------------------------------------------------------------------------------------- bags

BOMB = 1 << 28  # bytes of zeros


def mcap(bag: Path) -> Path:
    return next(bag.glob("*.mcap"))


def chunk(kind: str, packed: bytes, size: int) -> bytes:
    """Write an MCAP file with one chunk (mcap.dev/spec: opcode, length, content)."""

    def record(opcode: int, content: bytes) -> bytes:
        return bytes([opcode]) + struct.pack("<Q", len(content)) + content

    def text(value: str) -> bytes:
        return struct.pack("<I", len(value)) + value.encode()

    contents = struct.pack("<QQQI", 0, 1, size, 0) + text(kind) + struct.pack("<Q", len(packed))
    magic = b"\x89MCAP0\r\n"
    end = record(2, struct.pack("<QQI", 0, 0, 0))
    return magic + record(1, text("ros2") + text("")) + record(6, contents + packed) + end + magic


@pytest.fixture(scope="module")
def bombs():
    zstd = storage_mcap.zstd.ZstdCompressor()
    packed, zeros = b"", bytes(1 << 22)
    for _ in range(BOMB >> 22):
        packed += zstd.compress(zeros)
    packed += zstd.flush()
    with lz4.frame.LZ4FrameCompressor() as maker:
        small = maker.begin() + b"".join(maker.compress(zeros) for _ in range(BOMB >> 22))
        small += maker.flush()
    return {"zstd": packed, "lz4": small}


@pytest.mark.parametrize("kind", ["zstd", "lz4"])
def test_chunk_bomb_is_rejected(tmp_path, bombs, kind):
    (tmp_path / "robot.mcap").write_bytes(chunk(kind, bombs[kind], BOMB))
    if kind == "zstd":
        refused(tmp_path / "robot.mcap", "robot.*unpacks to more than")
    else:  # the size limit of an lz4 file is about half of the data, which is more than ``MOST``
        with pytest.raises(ValueError, match="unpacks to more than"):
            read(tmp_path / "robot.mcap")


def test_compressed_file_is_counted_before_it_is_unpacked(tmp_path, bombs):
    bag = write_bag(tmp_path / "robot", steps(), "mcap")
    note, file = bag / "metadata.yaml", mcap(bag)
    (bag / f"{file.name}.zstd").write_bytes(bombs["zstd"])
    text = note.read_text().replace(file.name, f"{file.name}.zstd")
    text = text.replace("compression_mode: ''", "compression_mode: file")
    note.write_text(text.replace("compression_format: ''", "compression_format: zstd"))
    file.unlink()
    refused(bag, "unpacks to more than")


def test_unpacked_size_is_bounded_and_streams_are_joined():
    for make, pack in (
        (bz2.BZ2Decompressor, bz2.compress),
        (lz4.frame.LZ4FrameDecompressor, lz4.frame.compress),
        (storage_mcap.zstd.ZstdDecompressor, storage_mcap.zstd.compress),
    ):
        assert unpacking.decompress_bounded(make, pack(b"one") + pack(b"two")) == b"onetwo"
        with pytest.raises((EOFError, ValueError)):
            unpacking.decompress_bounded(make, pack(b"x" * 1000)[:-6])
    budget = unpacking.Budget(0)
    for _ in range(FREE >> 20):
        budget.spend(1 << 20)
    with pytest.raises(unpacking.Bomb):
        budget.spend(1)


@pytest.mark.parametrize(
    "script",
    [
        "CREATE VIEW schema AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i FROM n) "
        "SELECT i AS schema_version FROM n",
        "CREATE TABLE topics2(id, name AS (zeroblob(1000000000)))",
        "CREATE TABLE t(a); CREATE TRIGGER x AFTER INSERT ON t BEGIN DELETE FROM t; END",
    ],
)
def test_database_with_computation_is_rejected(tmp_path, script):
    file = tmp_path / "robot.db3"
    base = sqlite3.connect(file)
    base.executescript("CREATE TABLE messages(id); CREATE TABLE topics(id);" + script)
    base.close()
    refused(file, "robot.*views, triggers or computed")


@pytest.mark.parametrize("raw", [b"", b"SQLite format 3\0" + bytes(50), b"\0" * 5000])
def test_file_that_is_no_database_is_rejected(tmp_path, raw):
    (tmp_path / "robot.db3").write_bytes(raw)
    refused(tmp_path / "robot.db3", "robot")


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "a: &a [*a]",
        "rosbag2_bagfile_information: 5",
        "x" * (1 << 21),
        "!!python/name:os",
    ],
)
def test_metadata_with_lies_are_refused(tmp_path, text):
    bag = write_bag(tmp_path / "robot", steps(), "mcap")
    (bag / "metadata.yaml").write_text(text)
    refused(bag, "robot")


def test_metadata_name_no_file_outside_of_the_bag(tmp_path):
    bag = write_bag(tmp_path / "robot", steps(), "mcap")
    mcap(bag).rename(tmp_path / "outside.mcap")
    note = bag / "metadata.yaml"
    note.write_text(note.read_text().replace("robot.mcap", "../outside.mcap"))
    refused(bag, "missing|outside")


class Message:
    """Return a ROS message with these fields."""

    def __init__(self, **fields) -> None:
        self.__dict__.update(fields)


def picture(**changes) -> Message:
    content = {"height": 4, "width": 4, "encoding": "rgb8", "step": 12, "is_bigendian": 0}
    return Message(**{**content, "data": np.zeros(48, np.uint8), **changes})


@pytest.mark.parametrize(
    "changes",
    [
        {"height": 1 << 31, "width": 1 << 31},
        {"height": 0},
        {"height": 8192, "width": 8192},
        {"step": 1 << 31},
        {"step": 3},
        {"encoding": "32FC1"},
        {"encoding": "x" * 10_000},
    ],
)
def test_image_with_false_header_is_rejected(changes):
    with pytest.raises(ValueError, match="bag"):
        ros.read_image(picture(**changes), RGB, Path("bag"))


def test_row_with_false_step_takes_no_memory():
    row = ros.read_image(picture(height=1, step=1 << 31), RGB, Path("bag"))
    assert row.shape == (1, 4, 3)


@pytest.mark.parametrize("size", [(1 << 15, 1 << 15), (1 << 20, 1)])
def test_huge_compressed_image_is_not_decoded(monkeypatch, size):
    def record(kind: bytes, data: bytes) -> bytes:
        return (
            struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        )

    head = record(b"IHDR", struct.pack(">IIBBBBB", *size, 8, 2, 0, 0, 0))
    raw = b"\x89PNG\r\n\x1a\n" + head + record(b"IDAT", zlib.compress(b"")) + record(b"IEND", b"")
    monkeypatch.setattr(ros.cv2, "imdecode", lambda *_: pytest.fail("it was decoded"))
    for data in (raw, b"II*\0" + raw, b"GIF89a", b""):
        with pytest.raises(ValueError, match="cannot be decoded"):
            message = Message(format="png", data=np.frombuffer(data, np.uint8))
            ros.read_image(message, RGB, Path("bag"))


@pytest.mark.parametrize(
    ("focal", "centre"), [((8, 1e-300), (8, 8)), ((8, 1e300), (8, 8)), ((8, 8), (1e300, 8))]
)
def test_lens_without_field_of_view_is_rejected(focal, centre):
    assert Lens(RGB, focal=(8, 8), centre=(8, 8), size=(16, 16))
    with pytest.raises(ValueError, match="must be"):
        Lens(RGB, focal=focal, centre=centre, size=(16, 16))
