"""Rows, table and pictures of a run's folder: of all that is finished there, whatever suite or
severity was asked for last."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations
from pathlib import Path

import numpy as np

from mitigate.bridge.cell import Cell, folder_name, missing_entries, read_done
from mitigate.bridge.events import DONE
from mitigate.bridge.plan import met
from mitigate.bridge.results import OWN
from mitigate.core.files import write_bytes, write_text
from mitigate.core.names import counted
from mitigate.corruptions import CLEAN, Corruption
from mitigate.evaluation import bootstrap, report, rows
from mitigate.evaluation.rows import ROWS, Row
from mitigate.worlds.measures import RULES

LABELS = ("agent", "seed", "split")  # of rows.IDENTITY; all rows of a run have the same


def write_report(made: Sequence[Cell], out: Path) -> None:
    """Write ``rows.jsonl``, the table and its pictures, and print the table."""
    done = [cell for cell in made if cell.is_done()]
    others, left_out = earlier(made, out)
    if others:
        print(f"also in the table, measured before: {', '.join(c.name for c in others)}")
    cells = [*done, *others]
    found = [row for cell in cells if cell.repeat == 0 for row in cell.rows()]
    if not found:
        raise ValueError(
            f"No episode told how it went, so there is no table. {out} holds what was seen."
        )
    _write_rows(out / ROWS, found, left_out)
    rule = made[0].rule
    written = report.write(found, out, first=OWN if rule is None else str(RULES[rule]), least=2)
    print((out / "table.md").read_text("utf-8"), *(f"wrote {w}" for w in written), sep="\n")
    again = [cell.rows() for cell in cells if cell.corruption.name == "clean"]
    if len(again) > 1:
        told = randomness(again)
        print(told, flush=True)
        write_text(out / "randomness.md", told)


def _write_rows(file: Path, found: Sequence[Row], left_out: Sequence[str]) -> None:
    """Write the rows of a run; none of the file's may be lost without a word.

    Rows of conditions that are ``left_out`` of the table, and rows of another agent, seed or split,
    are kept in a copy of the file.

    Raises:
        ValueError: The file holds rows of another condition or episode that ``found`` lacks. It
            stays as it is.
    """
    before = rows.read(file) if file.exists() else []
    now, labels = {_measured(row) for row in found}, {_label(row) for row in found}
    lost = [row for row in before if _measured(row) not in now]
    foreign = [row for row in before if _label(row) not in labels and _measured(row) in now]
    names = Counter(_folder_of(row) for row in lost)
    unexplained = [name for name in names if name not in left_out]
    if unexplained:
        raise ValueError(
            f"{file} holds {counted(len(before), 'row')}, and {len(lost)} of them are of episodes "
            f"that no finished condition gives any more ({', '.join(unexplained)}). The file was "
            "left as it is. Run these conditions again, or move the file to another folder and run "
            "the same command again."
        )
    told = list(names)
    if foreign:
        own = zip(*labels, strict=True)
        theirs = zip(*(_label(row) for row in foreign), strict=True)
        other = [n for n, a, b in zip(LABELS, own, theirs, strict=True) if not {*b} <= {*a}]
        told += [f"another {name}" for name in other]
    if told:
        copy = _free(file.with_name(f"{file.name}.before"))
        write_bytes(copy, file.read_bytes())
        print(f"The rows of {', '.join(told)} are now in {copy} alone.", flush=True)
    rows.write(file, found, fewer=True)  # another rule= gives other rows of the same episodes


def _measured(row: Row) -> tuple[str, float, str]:
    """What a row is of, by whatever rule: its condition and its episode."""
    return str(row["corruption"]), float(row["severity"]), str(row["episode_id"])


def _label(row: Row) -> tuple[object, ...]:
    """The agent, seed and split of a row, by which it is told from those of another run."""
    return tuple(row[name] for name in LABELS)


def _folder_of(row: Row) -> str:
    """The name of the condition's folder that a row comes from."""
    return folder_name(str(row["corruption"]), float(row["severity"]))


def _free(path: Path) -> Path:
    """Return ``path``, or the first of ``path``2, ``path``3, ... that does not exist."""
    number, free = 1, path
    while free.exists():
        number += 1
        free = path.with_name(f"{path.name}{number}")
    return free


def earlier(made: Sequence[Cell], out: Path) -> tuple[list[Cell], list[str]]:
    """Return the finished conditions in ``out`` that are none of ``made``, but of the same agent
    and settings, and the names of the others, which are left out; print why they are."""
    known, found, left_out = {cell.name for cell in made}, [], []
    for file in sorted((out / "conditions").glob(f"*/{DONE}")):
        if file.parent.name in known:
            continue
        cell, reason = _cell(made[0], file), "by an older version, or of a corruption that is gone"
        if cell is not None:
            reason = ", ".join(f"another {name}" for name in cell.changed_settings())
            reason = reason or cell.reason_to_repeat() or cell.unjudged()
        if cell is None or reason:
            name = file.parent.name
            print(f"{name}: measured before, but not in the table: {reason}", flush=True)
            left_out.append(name)
        else:
            found.append(cell)
    return found, left_out


def _cell(clean: Cell, file: Path) -> Cell | None:
    """The condition that a ``done.json`` tells of, like the ``clean`` one; None if it does not.
    Raises ValueError if it, or its events, are damaged."""
    held = read_done(file.parent) or {}
    if missing_entries(held):
        return None
    try:
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


def randomness(runs: Sequence[Sequence[Row]]) -> str:
    """Return a Markdown paragraph on repeated clean runs: their SR, the share of episodes that end
    otherwise in another run, and the SR difference of the first two with its interval.

    Only episodes that all runs hold count, by the rule of the first row.
    """
    rule = runs[0][0]["rule"]
    held = [{r["episode_id"]: r["success"] for r in run if r["rule"] == rule} for run in runs]
    names = sorted(set.intersection(*(set(run) for run in held)))
    if not names:
        return "The repeated clean runs have no episode in common.\n"
    won = np.array([[run[name] for name in names] for run in held])
    flips = np.mean([np.mean(a != b) for a, b in combinations(won, 2)])
    moved = bootstrap.mean(won[1] - won[0])
    rates = ", ".join(f"{100 * rate:.1f}" for rate in won.mean(axis=1))
    return (
        f"## The agent's own randomness\n\n{len(runs)} clean runs of the same {len(names)} "
        f"episodes: SR {rates}. From one run to another {100 * flips:.1f} % of the episodes end "
        f"otherwise; second minus first {100 * moved.value:+.1f} "
        f"{moved.interval('+.1f', 100)}. A difference between two conditions "
        "that is not larger says nothing.\n"
    )
