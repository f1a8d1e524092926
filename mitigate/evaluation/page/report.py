"""The page of result rows: a section for each table, their curves, episodes and walks."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from mitigate.core.names import counted
from mitigate.evaluation.page.curves import curves
from mitigate.evaluation.page.document import page
from mitigate.evaluation.page.episodes import MOST, Packed
from mitigate.evaluation.page.model import section_data
from mitigate.evaluation.rows import Row
from mitigate.evaluation.sections import sections


def report(
    rows: Iterable[Row],
    *,
    title: str = "Results",
    walks: Sequence[dict[str, Any]] = (),
    notes: Sequence[str] = (),
    most: int = MOST,
) -> str:
    """Return the HTML page of ``rows``.

    ``walks`` as ``walks.walk_again`` yields them; ``notes``: lines under the tables; ``most``: how
    many episodes of cells it may hold.
    Raises ValueError if there are no rows.
    """
    held = list(rows)
    parts, packed = sections(held), Packed(most)
    shown = [{**section_data(part), "grid": packed.add(part, held)} for part in parts]
    largest = max(range(len(shown)), key=lambda n: _size(shown[n]))
    notes = list(notes)
    if packed.left_out:
        notes.append(
            f"The episodes of {counted(len(packed.left_out), 'cell')} are not in this file, which "
            f"holds {most:,} episodes at most: their numbers stand, but such cells do not open. "
            "Name fewer rows to see them."
        )
    return page(
        title,
        f"{len(held):,} rows: {_listed({row['name'] for row in held})}.",
        shown,
        curves=curves(parts),
        grids=packed.grids,
        packed=packed.text(),
        walks=walks,
        notes=notes,
        first=largest,
    )


def _size(shown: dict[str, Any]) -> int:
    return sum(cell[2] for line in shown["cells"] for cell in line)


def _listed(names: set[str], most: int = 8) -> str:
    held = sorted(names)
    more = f" and {len(held) - most} more agents" if len(held) > most else ""
    return ", ".join(held[:most]) + more
