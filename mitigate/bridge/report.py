"""Write the rows, the table and the figures of a run's folder.

These files contain all finished conditions in the folder, including conditions that earlier calls
of ``mitigate run`` finished.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations
from pathlib import Path

import numpy as np

from mitigate.bridge.cell import Cell, folder_name, read_done
from mitigate.bridge.events import DONE
from mitigate.bridge.plan import corruption_settings
from mitigate.bridge.results import OWN
from mitigate.core.files import write_bytes, write_text
from mitigate.core.markdown import plain_text
from mitigate.core.names import counted
from mitigate.corruptions import CLEAN, Corruption
from mitigate.evaluation import bootstrap, report, rows
from mitigate.evaluation.rows import ROWS, Row
from mitigate.worlds.measures import RULES

# keys of rows.IDENTITY whose values are the same in all rows of a run
LABELS = ("agent", "seed", "split")


def write_report(cells: Sequence[Cell], out: Path) -> None:
    """Write ``rows.jsonl``, the table and its figures to ``out``, and print the table.

    ``cells`` are the conditions of this call, clean first. Raises ValueError if no episode has a
    result, or existing rows would be lost.
    """
    done = [cell for cell in cells if cell.is_done()]
    others, left_out = find_earlier(cells, out)
    if others:
        print(f"also in the table, measured before: {', '.join(c.name for c in others)}")
    finished = [*done, *others]
    new_rows = [row for cell in finished if cell.repeat == 0 for row in cell.rows()]
    if not new_rows:
        raise ValueError(
            f"No episode reported a result, so there is no table. The reports are in {out}."
        )
    _write_rows(out / ROWS, new_rows, left_out)
    rule = cells[0].config.rule
    first = OWN if rule is None else str(RULES[rule])
    paths = report.write(new_rows, out, first=first, least=2)
    if len({row["rule"] for row in new_rows}) > 1:
        print(
            "There are tables for two success rules: first the rule of the program or of rule=, "
            "then a common rule, to compare programs whose own rules differ.\n"
        )
    table = plain_text((out / "table.md").read_text("utf-8"))
    print(table, *(f"wrote {path}" for path in paths), sep="\n")
    clean_runs = [cell.rows() for cell in finished if cell.corruption.name == "clean"]
    if len(clean_runs) > 1:
        text = describe_randomness(clean_runs)
        print(text, flush=True)
        write_text(out / "randomness.md", text)


def _write_rows(file: Path, new_rows: Sequence[Row], left_out: Sequence[str]) -> None:
    """Write the rows of a run; never drop rows of an existing file without a message.

    The existing file is copied if it holds rows of conditions in ``left_out``, or rows of a
    different agent, seed or split.

    Raises:
        ValueError: If the file holds rows of a condition or episode that is not in ``new_rows``. In
            this case, the file is not changed.
    """
    before = rows.read(file) if file.exists() else []
    now = {_condition_and_episode(row) for row in new_rows}
    dropped = [key for key in map(_condition_and_episode, before) if key not in now]
    lost = Counter(folder_name(condition, severity) for condition, severity, _ in dropped)
    unexplained = [name for name in lost if name not in left_out]
    if unexplained:
        raise ValueError(
            f"{file} holds {counted(len(before), 'row')}. The results of {lost.total()} of them "
            f"are no longer in the run's folder (conditions: {', '.join(unexplained)}), so a new "
            "file would lack them. The file was not changed. Run these conditions again, or move "
            "the file to another folder."
        )
    labels = {name: {row[name] for row in new_rows} for name in LABELS}
    same_episodes = [row for row in before if _condition_and_episode(row) in now]
    changed = [n for n in LABELS if any(row[n] not in labels[n] for row in same_episodes)]
    removed = [*lost, *(f"another {name}" for name in changed)]
    if removed:
        copy = _unused(file.with_name(f"{file.name}.before"))
        write_bytes(copy, file.read_bytes())
        print(f"The rows of {', '.join(removed)} are now only in {copy}.", flush=True)
    # with a different rule=, the same episodes have different rows
    rows.write(file, new_rows, fewer=True)


def _condition_and_episode(row: Row) -> tuple[str, float, str]:
    """Return a key for the condition and the episode of a row.

    Rows that differ only in their success rule have the same key.
    """
    return str(row["corruption"]), float(row["severity"]), str(row["episode_id"])


def _unused(path: Path) -> Path:
    """Return the first of ``path``, ``path``2, ``path``3, ... that does not exist."""
    number, unused = 1, path
    while unused.exists():
        number += 1
        unused = path.with_name(f"{path.name}{number}")
    return unused


def find_earlier(cells: Sequence[Cell], out: Path) -> tuple[list[Cell], list[str]]:
    """Return finished conditions in ``out`` that are not in ``cells``.

    Returns:
        The conditions with the same agent and settings, and the names of the other conditions. For
        the other conditions, the function prints why they are left out of the table.
    """
    known = {cell.name for cell in cells}
    earlier: list[Cell] = []
    left_out: list[str] = []
    for file in sorted((out / "conditions").glob(f"*/{DONE}")):
        if file.parent.name in known:
            continue
        cell = _read_cell(cells[0], file)
        reason = "with a corruption that no longer exists"
        if cell is not None:
            reason = ", ".join(f"another {name}" for name in cell.changed_settings())
            reason = reason or cell.reason_to_repeat() or cell.rule_problem()
        if cell is None or reason:
            name = file.parent.name
            print(f"{name}: measured before, but not in the table: {reason}", flush=True)
            left_out.append(name)
        else:
            earlier.append(cell)
    return earlier, left_out


def _read_cell(clean: Cell, file: Path) -> Cell | None:
    """Return the condition that a ``done.json`` describes; other options are taken from ``clean``.

    The result is None if the corruption no longer exists. Raises ValueError if the file or its
    events are damaged.
    """
    folder = file.parent
    entries = read_done(folder)
    assert entries is not None
    try:
        severity = float(entries["severity"])
        corruption = Corruption(entries["condition"], severity) if severity else CLEAN
    except ValueError:
        return None
    return replace(
        clean,
        name=folder.name,
        folder=folder,
        condition=replace(clean.condition, corruption=corruption, repeat=entries["repeat"]),
        settings=clean.settings | corruption_settings(corruption),
        clean=clean.folder,
    )


def describe_randomness(runs: Sequence[Sequence[Row]]) -> str:
    """Return a Markdown paragraph on repeated clean runs.

    The paragraph states the SR of each run, the fraction of episodes whose outcome differs between
    runs, and the SR difference between the first two runs with its confidence interval. Only
    episodes that occur in all runs are used. The success rule of the first row applies.
    """
    rule = runs[0][0]["rule"]
    successes = [{r["episode_id"]: r["success"] for r in run if r["rule"] == rule} for run in runs]
    names = sorted(set.intersection(*(set(run) for run in successes)))
    if not names:
        return "The repeated clean runs have no episode in common.\n"
    outcomes = np.array([[run[name] for name in names] for run in successes])
    flips = np.mean([np.mean(a != b) for a, b in combinations(outcomes, 2)])
    difference = bootstrap.mean(outcomes[1] - outcomes[0])
    rates = ", ".join(f"{100 * rate:.1f}" for rate in outcomes.mean(axis=1))
    return (
        f"## Randomness of the agent\n\n{len(runs)} clean runs of the same {len(names)} "
        f"episodes: SR {rates}. Between two runs {100 * flips:.1f} % of the episodes end "
        f"differently; second minus first {100 * difference.value:+.1f} "
        f"{difference.interval('+.1f', 100)}. A difference between two conditions "
        "that is not larger may be random.\n"
    )
