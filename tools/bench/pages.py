"""Write measured tables into pages of the documentation, between two marker lines."""

from __future__ import annotations

from pathlib import Path

from mitigate.core.files import write_bytes


def put(text: str, page: Path, begin: str, end: str) -> None:
    """Replace the text between the lines ``begin`` and ``end`` of ``page``.

    Raises:
        ValueError: If the page does not contain these lines.
    """
    before, first_marker, rest = page.read_text(encoding="utf-8").partition(begin)
    _, last_marker, after = rest.partition(end)
    if not (first_marker and last_marker):
        raise ValueError(
            f"{page} must contain the lines {begin!r} and {end!r}, which enclose the table. Add "
            "them."
        )
    write_bytes(page, f"{before}{begin}\n{text}\n{end}{after}".encode())
