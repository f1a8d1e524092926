"""Rows, table and pictures of a run's folder: of all that is finished there, whatever suite or
severity was asked for last."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from mitigate.bridge.cell import DONE, Cell
from mitigate.bridge.identity import met
from mitigate.bridge.randomness import randomness
from mitigate.bridge.results import OWN
from mitigate.bridge.verdict import lacks
from mitigate.core.files import write_text
from mitigate.corruptions import CLEAN, Corruption
from mitigate.evaluation import report, rows
from mitigate.evaluation.metrics import RULES
from mitigate.evaluation.rows import ROWS


def write_report(made: Sequence[Cell], out: Path) -> None:
    """Write ``rows.jsonl``, the table and its pictures, and print the table."""
    done = [cell for cell in made if cell.is_done()]
    others = earlier(made, out)
    if others:
        print(f"also in the table, measured before: {', '.join(c.name for c in others)}")
    cells = [*done, *others]
    found = [row for cell in cells if cell.repeat == 0 for row in cell.rows()]
    if not found:
        raise ValueError(
            f"No episode told how it went, so there is no table. {out} holds what was seen."
        )
    rows.write(out / ROWS, found)
    rule = made[0].rule
    written = report.write(found, out, first=OWN if rule is None else str(RULES[rule]), least=2)
    print((out / "table.md").read_text("utf-8"), *(f"wrote {w}" for w in written), sep="\n")
    again = [cell.rows() for cell in cells if cell.corruption.name == "clean"]
    if len(again) > 1:
        told = randomness(again)
        print(told, flush=True)
        write_text(out / "randomness.md", told)


def earlier(made: Sequence[Cell], out: Path) -> list[Cell]:
    """Return the finished conditions in ``out`` that are none of ``made``, but of the same agent
    and settings; say which of the others are left out, and why."""
    known, found = {cell.name for cell in made}, []
    for file in sorted((out / "conditions").glob(f"*/{DONE}")):
        if file.parent.name in known:
            continue
        cell, reason = _cell(made[0], file), "by an older version, or of a corruption that is gone"
        if cell is not None:
            reason = ", ".join(f"another {name}" for name in cell.others()) or cell.why_anew()
            reason = reason or lacks(cell)
        if cell is None or reason:
            name = file.parent.name
            print(f"{name}: measured before, but not in the table: {reason}", flush=True)
        else:
            found.append(cell)
    return found


def _cell(clean: Cell, file: Path) -> Cell | None:
    """The condition that a ``done.json`` tells of, like the ``clean`` one; None if it does not."""
    try:
        held = json.loads(file.read_text("utf-8"))
        severity = float(held["severity"])
        corruption = Corruption(str(held["condition"]), severity) if severity else CLEAN
        repeat = int(held["repeat"])
    except (ValueError, KeyError, TypeError):  # of an older version, or of a corruption now gone
        return None
    folder = file.parent
    return replace(
        clean,
        name=folder.name,
        corruption=corruption,
        repeat=repeat,
        folder=folder,
        settings=clean.settings | met(corruption),
        clean=clean.folder,
    )
