"""Read parquet files from untrusted sources, with limits on their size."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from mitigate.core.files import FREE, RATIO, lfs_problem
from mitigate.core.names import escaped
from mitigate.core.output import is_regular

MAX_ROWS = 1 << 24  # maximum rows per file (heuristic), enough for 150 hours at 30 Hz
BATCH_ROWS = 16  # number of rows with images per batch (heuristic)
INSTALL = "pip install -e '.[lerobot]'"
FIX = "Copy the dataset again."


def parquet() -> Any:
    """Return the module ``pyarrow.parquet``; raise ValueError if it is not installed."""
    try:
        import pyarrow.parquet
    except ModuleNotFoundError as error:
        raise ValueError(
            f"LeRobot datasets need pyarrow, which is not installed. Run {INSTALL}"
        ) from error
    return pyarrow.parquet


def check_file(path: Path) -> None:
    """Check that a file of a dataset exists.

    Raises:
        FileNotFoundError: If the file is missing.
        ValueError: If the path is a Git LFS pointer, a FIFO or a device.
    """
    if not is_regular(path):
        raise FileNotFoundError(f"The dataset lacks the file {path}. {FIX}")
    if pointer := lfs_problem(path):
        raise ValueError(f"{path} {pointer}.")


@contextmanager
def open_table(path: Path) -> Iterator[Any]:
    """Open a parquet file; errors during reading get a message that explains them.

    Yields:
        A ``pyarrow.parquet.ParquetFile``.

    Raises:
        FileNotFoundError: If the file is missing.
        ValueError: If the file is damaged, or expands to too many rows or bytes.
    """
    pq = parquet()
    import pyarrow

    check_file(path)
    try:
        with pq.ParquetFile(path, page_checksum_verification=True) as file:
            _check_size(path, file.metadata)
            yield file
    except (pyarrow.ArrowException, OSError, UnicodeDecodeError) as error:
        # errors of the operating system are not changed
        if isinstance(error, OSError) and error.strerror is not None:
            raise
        cause = escaped(" ".join(str(error).split()))
        raise ValueError(
            f"{path} cannot be read as parquet: it is truncated or damaged ({cause}). If you have "
            "just recorded the dataset, call dataset.finalize(). Otherwise, copy it again."
        ) from error


def _check_size(path: Path, metadata: Any) -> None:
    """Raise ValueError if a file has too many rows, or would expand to far too many bytes."""
    if metadata.num_rows > MAX_ROWS:
        raise ValueError(f"{path} must have at most {MAX_ROWS} rows, got {metadata.num_rows}.")
    groups = (metadata.row_group(index) for index in range(metadata.num_row_groups))
    size = sum(
        group.column(index).total_uncompressed_size
        for group in groups
        for index in range(metadata.num_columns)
    )
    if size > FREE + RATIO * path.stat().st_size:
        raise ValueError(
            f"{path} expands to {size >> 20} MiB, more than {RATIO} times its size. No valid "
            "dataset does so. Do not use this file."
        )


def read_columns(path: Path, columns: Sequence[str], optional: Sequence[str] = ()) -> Any:
    """Read columns of a parquet file.

    Args:
        path: The file.
        columns: Names of columns that must exist.
        optional: Names of columns that are read if they exist.

    Returns:
        A ``pyarrow.Table``.

    Raises:
        FileNotFoundError: If the file is missing.
        ValueError: If the file is damaged or lacks a column.
    """
    with open_table(path) as file:
        names = file.schema_arrow.names
        check_columns(path, names, columns)
        chosen = [*columns, *(name for name in optional if name in names)]
        # reading the column "a" also returns columns such as "a.b", which select() drops
        return file.read(columns=chosen).select(chosen)


def check_columns(path: Path, names: Sequence[str], columns: Sequence[str]) -> None:
    """Raise ValueError if a column is missing or appears twice."""
    for column in columns:
        if names.count(column) != 1:
            raise ValueError(
                f"{path} must have one column {column!r}, got {names.count(column)}. Its columns: "
                f"{', '.join(map(ascii, names[:20]))}. {FIX}"
            )


def integers(table: Any, column: str, path: Path) -> list[int]:
    """Return an integer column as a list; raise ValueError for other types or missing values."""
    import pyarrow

    values = table.column(column)
    if not pyarrow.types.is_integer(values.type) or values.null_count:
        raise ValueError(
            f"{path}: the column {column!r} must hold whole numbers, got {values.type} with "
            f"{values.null_count} missing values. {FIX}"
        )
    return values.to_pylist()


def numbers(table: Any, column: str, path: Path) -> list[float]:
    """Return a column of finite numbers as a list; raise ValueError for other columns."""
    import numpy as np
    import pyarrow

    values = table.column(column)
    is_number = pyarrow.types.is_floating(values.type) or pyarrow.types.is_integer(values.type)
    if not is_number or values.null_count or not np.isfinite(values.to_numpy()).all():
        raise ValueError(f"{path}: the column {column!r} must hold finite numbers. {FIX}")
    return [float(value) for value in values.to_pylist()]
