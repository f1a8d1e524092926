"""Join result rows into one table: ``mitigate table RUNS... [--seed N] [--against NAME]``.

``--draw scene`` computes intervals for new scenes, instead of new episodes in the same scenes.

The command accepts row files, and run or sweep folders that may be incomplete. It prints the table
and writes ``table.md``, ``heatmap.png`` and ``severity.png``.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

from mitigate.core.markdown import plain_text
from mitigate.core.options import check_paths

OUT = Path("runs/table")


def run(
    paths: Iterable[Path | str],
    out: Path | str = OUT,
    seeds: Sequence[int] | None = None,
    against: str | None = None,
    drawn: str = "episode",
) -> list[Path]:
    """Join the rows of ``paths``, write the report to ``out``, and return its files (table first).

    Args:
        paths: row files or folders.
        out: folder of the report.
        seeds: the seeds to use, or None for all.
        against: the column with which the others are compared. The default is "base" or "before",
            or else the first column.
        drawn: unit that the bootstrap resamples, "episode" or "scene".

    Raises:
        FileNotFoundError: A path contains no rows.
        ValueError: Rows are damaged, or a seed or the column does not exist.
    """
    from mitigate.evaluation import report, rows

    all_rows = rows.gather(paths)
    available = sorted({row["seed"] for row in all_rows})
    for seed in seeds or ():
        if seed not in available:
            raise ValueError(
                f"seeds must be among {', '.join(map(str, available))}, got {seed}, which has "
                "no rows."
            )
    selected = [row for row in all_rows if seeds is None or row["seed"] in seeds]
    return report.write(selected, out, against=against, drawn=drawn)


def main(argv: Sequence[str] | None = None) -> int:
    """Run from the command line; return the exit status (2 for invalid input)."""
    parser = argparse.ArgumentParser(prog="mitigate table", description=__doc__)
    parser.add_argument("rows", nargs="+", metavar="ROWS", help="row files or run folders")
    parser.add_argument(
        "--seed",
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
        choices=("episode", "scene"),
        default="episode",
        help="unit that the bootstrap of the intervals draws (default episode)",
    )
    parser.add_argument("--out", type=Path, default=OUT, help=f"output folder (default {OUT})")
    options = parser.parse_intermixed_args(argv)
    try:
        check_paths(options.rows, "--out DIR")
        paths = run(options.rows, options.out, options.seed, options.against, options.draw)
    except (OSError, ValueError) as error:
        from mitigate.core.errors import error_message

        print(f"table: {error_message(error)}", file=sys.stderr)
        return 2
    print(plain_text(paths[0].read_text(encoding="utf-8")))
    print("\n".join(f"wrote {path}" for path in paths))
    return 0
