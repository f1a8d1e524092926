"""Show, check and add entries of the leaderboard (docs/leaderboard.md).

mitigate leaderboard show --out leaderboard.html
mitigate leaderboard check docs/leaderboard/harden.json
mitigate leaderboard add rows.jsonl.gz --name mine --training-data "R2R-CE train"
"""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from mitigate.core.errors import command, error_message
from mitigate.core.files import find
from mitigate.evaluation import config  # noqa: F401 - registers the options
from mitigate.evaluation import rows as result_rows
from mitigate.evaluation.leaderboard.entry import LeaderboardEntry, load
from mitigate.evaluation.leaderboard.figures import entry_of, left_out
from mitigate.evaluation.page import document
from mitigate.evaluation.page.command import description
from mitigate.evaluation.rows import Row

FOLDER = "docs/leaderboard"
OUT = Path("runs/leaderboard.html")
NOT_COMPUTED = ("sensors", "training_data", "link", "version")
CLOSE = 1e-5  # tolerance, because figures in entries are rounded to six digits


def rows_of(entry: LeaderboardEntry) -> list[Row]:
    """Return all rows in the file that ``entry`` names, including rows of other agents.

    Raises:
        FileNotFoundError: If the file is not available.
        ValueError: If the file is damaged, or it is not a regular file.
    """
    file = entry.rows["file"]
    path = find(file)
    if file and path.exists() and not path.is_file():
        raise ValueError(f"{entry.name} must name one file of rows, but {file} is not a file.")
    if not file or not path.exists():
        raise FileNotFoundError(
            f"The rows of {entry.name} are not available ({file or 'the entry names no file'}). "
            f"Copy them to {file or 'a file and name it in the entry'} (relative to the current "
            "folder)."
        )
    return result_rows.gather([path])


def differences(entry: LeaderboardEntry, rows: Iterable[Row]) -> list[str]:
    """Return one line per difference between ``entry`` and the figures computed from its rows."""
    again = entry_of(
        _rows_behind(entry, rows),
        entry.name,
        severity=entry.severity,
        split=entry.split,
        file=entry.rows["file"],
    )
    lines = []
    figures = asdict(again)
    for key, stated in asdict(entry).items():
        computed = figures[key]
        pairs = {key: (stated, computed)}
        if isinstance(stated, dict):
            names = stated | computed
            pairs = {f"{key}, {n},": (stated.get(n), computed.get(n)) for n in names}
        lines += [
            f"{place} is {one!r:.120}, but its rows say {other!r:.120}"
            for place, (one, other) in pairs.items()
            if key not in NOT_COMPUTED and not _equal(one, other)
        ]
    return lines


def _equal(one: Any, other: Any) -> bool:
    if not isinstance(one, list) or not isinstance(other, list):
        return bool(one == other)
    pair = np.array([one, other], float)  # None becomes NaN
    return np.allclose(pair[0], pair[1], rtol=0, atol=CLOSE, equal_nan=True)


def show(paths: Sequence[Path | str] = (), out: Path | str = OUT) -> Path:
    """Write the page of the entries in ``paths`` (files or folders), and return its path."""
    document.check_out(out)
    return document.write(render([load(file) for file in _files(paths)]), out)


def render(entries: Sequence[LeaderboardEntry]) -> str:
    """Return the leaderboard page of ``entries``, sorted by mean SR (highest first).

    Figures are computed from the rows and not taken from the entries. Raises as :func:`rows_of`.
    """
    files: dict[str, list[Row]] = {}
    rows: list[Row] = []
    notes = []
    for entry in sorted(entries, key=_mean_sr, reverse=True):
        file = entry.rows["file"]
        files[file] = files.get(file) or rows_of(entry)
        rows += _rows_behind(entry, files[file])
        sensors = "; ".join(entry.sensors) or "not stated"
        notes.append(
            f"{entry.name} ({', '.join(one['agent'] for one in entry.agents)}): trained on "
            f"{entry.training_data or 'not stated'}; sensors {sensors}; {entry.link}"
        )
    return document.report(rows, title="Leaderboard", notes=notes)


def _mean_sr(entry: LeaderboardEntry) -> float:
    value = (entry.scores.get("Mean SR") or [None])[0]
    return -1.0 if value is None else value


def _rows_behind(entry: LeaderboardEntry, rows: Iterable[Row]) -> list[Row]:
    """Return the rows of the entry's agents, seeds and conditions."""
    agents = {(one["agent"], one["seed"]) for one in entry.agents}
    matching = [row for row in rows if (row["agent"], row["seed"]) in agents]
    if not matching:
        names = ", ".join(f"{agent} with seed {seed}" for agent, seed in sorted(agents))
        raise ValueError(f"The rows hold no results of {names:.300}.")
    matching = [row for row in matching if (row["name"], row["split"]) == (entry.name, entry.split)]
    return [
        r for r in matching if r["corruption"] in entry.SR and r["severity"] in (0, entry.severity)
    ]


def _files(paths: Sequence[Path | str]) -> list[Path]:
    """Return the entry files in ``paths``, by default in ``docs/leaderboard``."""
    folders = [Path(path) for path in paths] or [find(FOLDER)]
    files = [f for p in folders for f in (sorted(p.glob("*.json")) if p.is_dir() else [p])]
    if not files:
        raise FileNotFoundError("There is no entry (*.json) in these folders.")
    return files


def check(paths: Sequence[Path | str] = ()) -> list[str]:
    """Print whether the rows of each entry give the same figures; return the differences."""
    wrong = []
    for file in _files(paths):
        name, verdict, omitted = str(file), "not a valid entry", ""
        try:
            entry = load(file)
            name, verdict = f"{file}: {entry.name}", "does NOT match its rows"
            rows = rows_of(entry)
            problems, omitted = differences(entry, rows), left_out(entry, rows)
        except (OSError, ValueError) as error:
            problems = [error_message(error)]
        print(f"{name}, {verdict if problems else 'matches its rows'}", flush=True)
        if omitted:
            print(f"{name}, WARNING: its rows also hold {omitted:.1000}", flush=True)
        wrong += [f"{name}, {line}" for line in problems]
    return wrong


def add(
    paths: Sequence[Path | str],
    name: str,
    *,
    folder: Path | str = FOLDER,
    overwrite: bool = False,
    **values: Any,
) -> Path:
    """Write an entry for the agent ``name`` from the rows in ``paths``; return the file.

    Args:
        paths: row files or folders.
        name: name of the agent in the rows.
        folder: folder for the entry.
        overwrite: whether to replace an existing entry with that name.
        **values: severity, split, sensors, training_data and link, as in ``entry_of``.

    Raises:
        ValueError: If the file exists already, or ``entry_of`` rejects the rows.
    """
    stem = re.sub(r"[^\w.-]+", "-", name).strip(".-")
    file = Path(folder) / f"{stem or 'entry'}.json"
    if file.exists() and not overwrite:
        raise ValueError(
            f"{file} exists already. Replace it with --overwrite, or name another folder "
            "(--folder) if it belongs to another agent."
        )
    files = [file for path in paths for file in result_rows.files(path)]
    inside = len(files) == 1 and not files[0].is_absolute() and ".." not in files[0].parts
    values["file"] = files[0].as_posix() if inside else ""
    return entry_of(result_rows.gather(paths), name, **values).save(file)


@command("leaderboard")
def main(argv: Sequence[str] | None = None) -> int:
    """Run from the command line, and return the exit status.

    The status is 2 for invalid input and 1 for a wrong entry.
    """
    parser = argparse.ArgumentParser(
        prog="mitigate leaderboard",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parts = parser.add_subparsers(dest="what", required=True, metavar="show | check | add")
    page = parts.add_parser("show", help="write the page of entries")
    checks = parts.add_parser("check", help="compute entries again from their rows")
    for part in (page, checks):
        part.add_argument("paths", nargs="*", metavar="ENTRY", help=f"default: all in {FOLDER}")
    page.add_argument("--out", type=Path, default=OUT, help=f"file to write (default {OUT})")
    entry = parts.add_parser("add", help="write the entry of an agent's rows")
    entry.add_argument("paths", nargs="+", metavar="ROWS", help="row file or folder")
    entry.add_argument("--name", required=True, help="the agent's name in the rows")
    entry.add_argument("--severity", type=float, default=0.6, help="default 0.6")
    entry.add_argument("--split", help="needed if the rows have several splits")
    entry.add_argument("--training-data", default="", help="what the agent was trained on")
    entry.add_argument("--link", default="", help="where its weights or paper are")
    entry.add_argument("--sensors", nargs="+", default=(), help="one text per sensor of the agent")
    entry.add_argument("--folder", default=FOLDER, help=f"where to write (default {FOLDER})")
    entry.add_argument("--overwrite", action="store_true", help="replace an entry of that name")
    options = vars(parser.parse_args(argv))
    what = options.pop("what")
    if what == "check":
        wrong = check(**options)
        print("\n".join(wrong), end="\n" * bool(wrong))
        return int(bool(wrong))
    print(description(show(**options) if what == "show" else add(**options)))
    return 0
