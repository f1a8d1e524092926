"""Join result rows into one table: ``mitigate table RUNS... [--out DIR]``.

Takes row files and run or sweep folders, partial ones too. Prints the table and writes
``table.md``, ``heatmap.png`` and ``severity.png``.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

from mitigate.core.arguments import check_paths

OUT = Path("runs/table")


def run(paths: Iterable[Path | str], out: Path | str = OUT) -> list[Path]:
    """Join the rows of ``paths``, write the report to ``out``; return its files, the table first.

    Raises FileNotFoundError for a path without rows, ValueError for rows that are damaged.
    """
    from mitigate.evaluation import report, rows

    return report.write(rows.gather(paths), out)


def main(argv: Sequence[str] | None = None) -> int:
    """Run from the command line; return the exit status (2 for a bad input)."""
    parser = argparse.ArgumentParser(prog="mitigate table", description=__doc__)
    parser.add_argument("rows", nargs="+", metavar="ROWS", help="row files or run folders")
    parser.add_argument("--out", type=Path, default=OUT, help=f"output folder (default {OUT})")
    options = parser.parse_intermixed_args(argv)
    try:
        check_paths(options.rows, "--out DIR")
        written = run(options.rows, options.out)
    except (OSError, ValueError) as error:
        from mitigate.core.errors import said

        print(f"table: {said(error)}", file=sys.stderr)
        return 2
    print(written[0].read_text(encoding="utf-8"))
    print("\n".join(f"wrote {path}" for path in written))
    return 0
