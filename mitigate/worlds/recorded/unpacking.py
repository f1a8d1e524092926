"""Bags of anybody, before and while ``rosbags`` reads them: nothing unpacks to more than allowed.

``rosbags`` unpacks chunks, messages and whole files without a bound, and asks SQLite for whatever
a data base calls its tables. Its decompressors are replaced by ones that stop, once, for this
process; data bases and metadata are looked at first.
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
LARGEST_METADATA = 1 << 20  # bytes (ours); one of 100 topics has 1e5
PACKED = (".zstd", ".zst")
_budgets: list[Budget] = []  # of the bags that are open, the newest last


class Bomb(ValueError):
    """Something unpacks to far more than it has."""


class Budget:
    """What a bag of ``size`` bytes may unpack to while it is read once."""

    def __init__(self, size: int) -> None:
        self.most = self.left = FREE + RATIO * size

    def spend(self, count: int) -> None:
        """Take ``count`` bytes. Raises Bomb if that is too many."""
        self.left -= count
        if self.left < 0:
            raise Bomb(
                f"it unpacks to more than {self.most >> 20} MiB, over {RATIO} times what it has, "
                "as no drive does: do not use it, or unpack it yourself"
            )


@contextmanager
def bounded(path: Path) -> Iterator[None]:
    """Within it, ``rosbags`` may read ``path`` (a file or a folder).

    Raises ValueError for a data base or metadata that no recorder writes; inside, what unpacks to
    too much raises Bomb.
    """
    files = [path] if path.is_file() else [file for file in path.iterdir() if file.is_file()]
    size = sum(file.stat().st_size for file in files)
    _check(files, size)
    _install()
    _budgets.append(Budget(size))
    budget = _budgets[-1]
    try:
        yield
    finally:
        _budgets.remove(budget)


def _check(files: list[Path], size: int) -> None:
    for file in files:
        if file.name == METADATA and file.stat().st_size > LARGEST_METADATA:
            raise ValueError(f"its {METADATA} has more than {LARGEST_METADATA} bytes")
        if file.suffix == ".db3":
            check_tables(file)
        if file.suffix in PACKED:  # rosbags unpacks these to the disk
            with open(file, "rb") as packed, _zstd().open(packed, "rb") as unpacked:
                budget = Budget(size)
                while block := unpacked.read(1 << 20):
                    budget.spend(len(block))


def check_tables(file: Path) -> None:
    """Raise ValueError for a data base in which a query of ours would run code of its own: views,
    triggers, virtual tables and computed columns."""
    try:
        with closing(sqlite3.connect(f"{file.resolve().as_uri()}?immutable=1", uri=True)) as base:
            listed = base.execute("SELECT type, name, sql FROM sqlite_master LIMIT 1000").fetchall()
            kinds = {kind for kind, _, _ in listed}
            computed = any(
                column[6]
                for kind, name, _ in listed
                if kind == "table"
                for column in base.execute("SELECT * FROM pragma_table_xinfo(?)", (name,))
            )
    except sqlite3.Error as error:
        raise ValueError(f"its data base cannot be read ({error})") from error
    virtual = any("virtual" in str(sql).lower().split()[:2] for _, _, sql in listed)
    if not kinds <= {"table", "index"} or computed or virtual:
        raise ValueError("its data base holds views, triggers or computed columns: do not use it")


def _spent(unpacked: bytes) -> bytes:
    if _budgets:
        _budgets[-1].spend(len(unpacked))
    return unpacked


def _most() -> int:
    """Bytes that may be unpacked now, and one more, by which too many are noticed."""
    return _budgets[-1].left + 1 if _budgets else FREE


def whole(make: Callable[[], Any], data: bytes) -> bytes:
    """Unpack ``data``, of one or several streams, by decompressors that ``make`` gives.

    Raises Bomb for too much, EOFError for data that are cut short.
    """
    found, left = [], bytes(data)
    while left:
        stream = make()
        found.append(_spent(stream.decompress(left, max_length=_most())))
        while not stream.eof:
            if stream.needs_input:
                raise EOFError("compressed data are cut short")
            found.append(_spent(stream.decompress(b"", max_length=_most())))
        left = stream.unused_data or b""
    return b"".join(found)


class Zstd:
    """In the place of the module ``zstd`` where ``rosbags`` reads."""

    @staticmethod
    def decompress(data: bytes) -> bytes:
        """As the module's."""
        return whole(_zstd().ZstdDecompressor, data)

    @staticmethod
    def open(file: Any, mode: str = "rb") -> io.BufferedIOBase:
        """As the module's; files were counted before (:func:`bounded`)."""
        return _zstd().open(file, mode)


def _zstd() -> Any:
    from rosbags.rosbag2 import storage_mcap

    found = storage_mcap.zstd
    return found


def _install() -> None:
    """Put bounded decompressors in the place of those of ``rosbags``."""
    from lz4.frame import LZ4FrameDecompressor
    from rosbags.rosbag1 import reader as one
    from rosbags.rosbag2 import reader as two
    from rosbags.rosbag2 import storage_mcap

    def lz4(data: bytes) -> bytes:
        return whole(LZ4FrameDecompressor, data)

    one.decompressors.update(
        {"none": _spent, "bz2": lambda data: whole(bz2.BZ2Decompressor, data), "lz4": lz4}
    )
    storage_mcap.DECOMPRESSORS.update(
        {
            "": lambda data, size: _spent(data),
            "lz4": lambda data, size: lz4(data),
            "zstd": lambda data, size: Zstd.decompress(data),
        }
    )
    two.zstd = Zstd  # type: ignore[assignment]
