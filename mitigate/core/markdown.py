"""Write names and tables in Markdown."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence


def markdown_of(name: str) -> str:
    """Escape a name from an untrusted file, so that Markdown shows it as plain text on one line."""
    return re.sub(
        r"[\\|`*~\[\]!]|<(?=\S)|^#", lambda match: f"\\{match[0]}", " ".join(name.split())
    )


def plain_text(markdown: str) -> str:
    """Return Markdown for a terminal, without the backslashes of :func:`markdown_of`."""
    return re.sub(r"\\([\\|`*~\[\]!<#])", r"\1", markdown)


def markdown_table(head: Sequence[str], rows: Iterable[Iterable[object]], words: int = 1) -> str:
    """Return a Markdown table.

    Args:
        head: titles of the columns.
        rows: cells of each row, which are written without escaping.
        words: number of leading columns that are left-aligned; the other columns are right-aligned.
    """
    sides = ["---" if column < words else "---:" for column in range(len(head))]
    lines = (map(str, cells) for cells in (head, sides, *rows))
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)
