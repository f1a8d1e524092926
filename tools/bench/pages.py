"""Measured tables in pages of the docs, between two lines that mark their place."""

from __future__ import annotations

from pathlib import Path

from mitigate.core.files import write_bytes


def put(text: str, page: Path, begin: str, end: str) -> None:
    """Put ``text`` between the lines ``begin`` and ``end`` of ``page``. Raises ValueError if the
    page has no such lines."""
    before, found, rest = page.read_text(encoding="utf-8").partition(begin)
    _, ended, after = rest.partition(end)
    if not (found and ended):
        raise ValueError(f"{page} has no lines {begin!r} and {end!r} for the table to go between.")
    write_bytes(page, f"{before}{begin}\n{text}\n{end}{after}".encode())
