"""Join result rows into one table: ``mitigate table RUNS... [--seed N] [--against NAME]``.

Intervals describe new scenes if the rows have at least 10 scenes. With ``--draw episode``, they
describe new episodes in the same scenes, and are often narrower. With ``--critical 0.1,0.5``, the
table compares the severities at which 10 % and 50 % of the clean success are lost.

The command accepts row files, and folders of runs or sweeps, which may be incomplete. The command
prints the table and writes ``table.md``, ``heatmap.png`` and ``severity.png``. With ``--critical``,
it writes ``critical.md``, ``critical.json`` and ``critical.png`` instead. With ``--print-only``, it
writes no files.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from mitigate.core.errors import command
from mitigate.core.markdown import plain_text
from mitigate.core.options import check_paths

if TYPE_CHECKING:
    from mitigate.evaluation.rows import Row

OUT = Path("runs/table")


def run(
    paths: Iterable[Path | str],
    out: Path | str | None = OUT,
    seeds: Sequence[int] | None = None,
    against: str | None = None,
    drawn: str | None = None,
    critical: Sequence[float] | None = None,
    intervals: bool = False,
) -> str:
    """Read the rows in ``paths``, write a report to ``out``, and return the text to print.

    The text is the table, followed by the paths of the report's files.

    Args:
        paths: row files or folders.
        out: folder of the report, or None to write no files.
        seeds: the seeds to use, or None for all.
        against: the column with which the other columns are compared. The default is the column
            "base" or "before" if it exists, and otherwise the first column.
        drawn: unit that the bootstrap resamples, "scene" or "episode". The default is "scene" if
            there are at least 10 scenes, and otherwise "episode".
        critical: fractions of the clean success. If they are given, the report consists of critical
            severities and areas under the retention curve (``critical.py``).
        intervals: whether the table shows, for each corruption, an interval and the differences
            from the clean SR and from the reference column.

    Raises:
        FileNotFoundError: If a path contains no rows.
        ValueError: If rows are damaged, or if a seed or the column does not exist. It is also
            raised if ``critical`` is invalid or needs rows that are missing.
    """
    from mitigate.evaluation import critical_report, report
    from mitigate.evaluation.critical import scores
    from mitigate.evaluation.sections import sections

    rows = select(paths, seeds)
    if critical is not None:
        parts = scores(rows, critical, against, drawn)
        if out is None:
            return plain_text("\n\n".join(map(critical_report.markdown, parts)))
        files = critical_report.write(parts, out)
    elif out is None:
        return plain_text(report.markdown(sections(rows, against, drawn), intervals=intervals))
    else:
        files = report.write(rows, out, against=against, drawn=drawn, intervals=intervals)
    return "\n".join(
        [plain_text(files[0].read_text(encoding="utf-8")), *(f"wrote {file}" for file in files)]
    )


def select(paths: Iterable[Path | str], seeds: Sequence[int] | None) -> list[Row]:
    """Return the rows in ``paths``, only of ``seeds`` if they are given.

    Raises the errors of :func:`run`.
    """
    from mitigate.evaluation import rows

    all_rows = rows.gather(paths)
    available = {row["seed"] for row in all_rows}
    if absent := sorted({*(seeds or ())} - available):
        raise ValueError(
            f"seeds must be among {', '.join(map(str, sorted(available)))}, got {absent[0]}, which "
            "has no rows."
        )
    return [row for row in all_rows if seeds is None or row["seed"] in seeds]


def _losses(text: str) -> list[float]:
    """Return the comma-separated numbers in ``text``, which may be in brackets."""
    try:
        return [float(word) for word in text.strip("[] ").split(",")]
    except ValueError:
        raise argparse.ArgumentTypeError(
            f"must be fractions such as 0.1,0.5, got {text!r:.40}"
        ) from None


@command("table")
def main(argv: Sequence[str] | None = None) -> int:
    """Run from the command line; return the exit status (2 for invalid input)."""
    parser = argparse.ArgumentParser(prog="mitigate table", description=__doc__)
    parser.add_argument("paths", nargs="+", metavar="ROWS", help="row files or run folders")
    parser.add_argument(
        "--seed",
        dest="seeds",
        type=int,
        action="append",
        metavar="N",
        help="use only rows of this seed (repeat for more seeds)",
    )
    parser.add_argument(
        "--against", metavar="NAME", help="the column that the others are compared with"
    )
    parser.add_argument(
        "--draw",
        dest="drawn",
        choices=("scene", "episode"),
        help="unit that the bootstrap resamples for the intervals (default: scene if there are at "
        "least 10 scenes, otherwise episode)",
    )
    parser.add_argument(
        "--critical",
        type=_losses,
        metavar="LOSSES",
        help="compare the severities at which these fractions of the clean success are lost, such "
        "as 0.1,0.5",
    )
    parser.add_argument(
        "--intervals",
        action="store_true",
        help="for each corruption, also show an interval and the differences from the clean SR and "
        "from the reference column",
    )
    files = parser.add_mutually_exclusive_group()
    files.add_argument("--out", type=Path, default=OUT, help=f"output folder (default {OUT})")
    files.add_argument("--print-only", action="store_true", help="print the table; write no files")
    options = parser.parse_intermixed_args(argv)
    if options.critical and options.intervals:
        parser.error("--intervals cannot be combined with --critical, whose table has intervals")
    check_paths(options.paths, "--out DIR")
    chosen = vars(options)
    if chosen.pop("print_only"):
        chosen["out"] = None
    print(run(**chosen))
    return 0
