"""Protect against decompression bombs and executable SQLite schemas in bags from untrusted sources.

``rosbags`` decompresses chunks, messages and whole files without a limit, and queries everything
that a database declares as a table. This module replaces the decompressors of ``rosbags`` by
versions that have a limit. The replacement happens once per process. It also checks databases and
metadata before ``rosbags`` opens them.
"""

from __future__ import annotations

import bz2
import io
import sqlite3
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

from mitigate.core.files import FREE, RATIO

METADATA = "metadata.yaml"
# maximum number of bytes of the metadata (heuristic); the metadata of 100 topics has 1e5 bytes
MAX_METADATA_BYTES = 1 << 20
COMPRESSED = (".zstd", ".zst")
_budgets: list[Budget] = []  # one budget per open bag, in the order of opening


class Bomb(ValueError):
    """Raised if compressed data expands to far more bytes than its compressed size."""


class Budget:
    """Counter that limits how many bytes a bag of ``size`` bytes may expand to."""

    def __init__(self, size: int) -> None:
        self.limit = self.left = FREE + RATIO * size

    def spend(self, count: int) -> None:
        """Subtract ``count`` bytes. Raise :class:`Bomb` if the budget is exceeded."""
        self.left -= count
        if self.left < 0:
            raise Bomb(
                f"it unpacks to more than {self.limit >> 20} MiB, over {RATIO} times its size, "
                "which no real recording does. Do not use it, or unpack it yourself"
            )


@contextmanager
def bounded(path: Path) -> Iterator[None]:
    """Limit how much data ``rosbags`` may decompress while it reads ``path``, a file or a folder.

    Raises:
        ValueError: If the database contains objects that no recorder writes, or if the metadata is
            too large. Inside the context, :class:`Bomb` is raised if the bag expands to too many
            bytes.
    """
    files = [path] if path.is_file() else [file for file in path.iterdir() if file.is_file()]
    size = sum(file.stat().st_size for file in files)
    _check(files, size)
    _install()
    budget = Budget(size)
    _budgets.append(budget)
    try:
        yield
    finally:
        _budgets.remove(budget)


def _check(files: list[Path], size: int) -> None:
    for file in files:
        if file.name == METADATA and file.stat().st_size > MAX_METADATA_BYTES:
            raise ValueError(f"its {METADATA} has more than {MAX_METADATA_BYTES} bytes")
        if file.suffix == ".db3":
            check_tables(file)
        # check the expanded size now, because rosbags decompresses these files to the disk
        if file.suffix in COMPRESSED:
            with open(file, "rb") as compressed, _zstd().open(compressed, "rb") as unpacked:
                budget = Budget(size)
                while block := unpacked.read(1 << 20):
                    budget.spend(len(block))


def check_tables(file: Path) -> None:
    """Check that a query of a database cannot run code that is stored in the database.

    Raises:
        ValueError: If the database has views, triggers, virtual tables or computed columns.
    """
    try:
        with closing(sqlite3.connect(f"{file.resolve().as_uri()}?immutable=1", uri=True)) as base:
            schema = base.execute("SELECT type, name, sql FROM sqlite_master LIMIT 1000").fetchall()
            kinds = {kind for kind, _, _ in schema}
            computed = any(
                column[6]
                for kind, name, _ in schema
                if kind == "table"
                for column in base.execute("SELECT * FROM pragma_table_xinfo(?)", (name,))
            )
    except sqlite3.Error as error:
        raise ValueError(f"its database cannot be read ({error})") from error
    virtual = any("virtual" in str(sql).lower().split()[:2] for _, _, sql in schema)
    if not kinds <= {"table", "index"} or computed or virtual:
        raise ValueError("its database has views, triggers or computed columns. Do not use it")


def _count(unpacked: bytes) -> bytes:
    """Subtract the length of decompressed data from the budget, and return the data.

    The budget is that of the bag that was opened last.
    """
    if _budgets:
        _budgets[-1].spend(len(unpacked))
    return unpacked


def _max_length() -> int:
    """Return the remaining budget plus one byte, so that exceeding the budget is noticed."""
    return _budgets[-1].left + 1 if _budgets else FREE


def decompress_bounded(make: Callable[[], Any], data: bytes) -> bytes:
    """Decompress one or several concatenated streams within the budget.

    ``make`` returns a new decompressor for each stream.

    Raises:
        Bomb: If the budget is exceeded.
        EOFError: If the data is incomplete.
    """
    blocks = []
    left = bytes(data)
    while left:
        stream = make()
        blocks.append(_count(stream.decompress(left, max_length=_max_length())))
        while not stream.eof:
            if stream.needs_input:
                raise EOFError("its compressed data is truncated")
            blocks.append(_count(stream.decompress(b"", max_length=_max_length())))
        left = stream.unused_data or b""
    return b"".join(blocks)


class Zstd:
    """Replacement for the module ``zstd`` that ``rosbags`` uses."""

    @staticmethod
    def decompress(data: bytes) -> bytes:
        """Decompress within the budget."""
        return decompress_bounded(_zstd().ZstdDecompressor, data)

    @staticmethod
    def open(file: Any, mode: str = "rb") -> io.BufferedIOBase:
        """Open a compressed file whose expanded size has been checked by :func:`bounded`."""
        return _zstd().open(file, mode)


def _zstd() -> Any:
    """Return the module ``zstd`` that ``rosbags`` imports."""
    from rosbags.rosbag2 import storage_mcap

    return storage_mcap.zstd


def _install() -> None:
    """Replace the decompressors of ``rosbags`` by bounded ones."""
    from lz4.frame import LZ4FrameDecompressor
    from rosbags.rosbag1 import reader as ros1_reader
    from rosbags.rosbag2 import reader as ros2_reader
    from rosbags.rosbag2 import storage_mcap

    def lz4(data: bytes) -> bytes:
        return decompress_bounded(LZ4FrameDecompressor, data)

    def bzip2(data: bytes) -> bytes:
        return decompress_bounded(bz2.BZ2Decompressor, data)

    ros1_reader.decompressors.update({"none": _count, "bz2": bzip2, "lz4": lz4})
    storage_mcap.DECOMPRESSORS.update(
        {
            "": lambda data, size: _count(data),
            "lz4": lambda data, size: lz4(data),
            "zstd": lambda data, size: Zstd.decompress(data),
        }
    )
    ros2_reader.zstd = Zstd  # type: ignore[assignment]
