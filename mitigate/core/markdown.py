"""Names and tables in Markdown."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence


def markdown_of(name: str) -> str:
    """Return a ``name`` that may be of anybody as Markdown that shows it as it is, on one line: no
    further cell, no code, HTML, link or picture."""
    return re.sub(
        r"[\\|`*~\[\]!]|<(?=\S)|^#", lambda found: f"\\{found[0]}", " ".join(name.split())
    )


def markdown_table(head: Sequence[str], rows: Iterable[Iterable[object]], words: int = 1) -> str:
    """Return a table under ``head``. Its first columns, as many as ``words``, hold words and stand
    to the left; the others hold numbers and stand to the right. Cells are written as they are."""
    sides = ["---" if column < words else "---:" for column in range(len(head))]
    lines = (map(str, cells) for cells in (head, sides, *rows))
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)
