"""Check the published figures: recompute the tables of the documentation from their result rows.

    python -m tools.figures              # or: make results-check
    python -m tools.figures docs/lab/random-compositions.md --list

A page shows figures with intervals, such as ``85.0 [82.3, 87.5]``, and the commands that print
them, as lines of code (``mitigate table FILES ...``). The check runs these commands. If a section
or subsection contains such a command, each of its figures must be among the figures that the
commands of the page print, rounded as on the page. Figures of other sections are only counted,
because some figures have no rows; ``--list`` lists those that no command prints.

The check does not compare the rows of tables, and it ignores figures without an interval.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from io import StringIO
from pathlib import Path

from mitigate.evaluation import table
from tools.third_party.results import stored_tables

ROOT = Path(__file__).resolve().parents[1]
PAGES = ("docs/results/*.md", "docs/lab/*.md")
# a command that prints a table of stored rows
TOOLS = r"mitigate table |python -m mitigate\.table |python -m tools\.third_party\.results --table "
COMMAND = re.compile(rf"^(?:    )?((?:{TOOLS}).*docs/results/.*)$")
VALUE = r"(?:[<>≤≥] ?)?[-+]?\d+(?:\.\d+)?"
FIGURE = re.compile(
    rf"({VALUE})(?:\*\*)?(?: ?%|\spoints)?(?:\*\*)?,?\s+\[({VALUE})(?:,\s+({VALUE}))?\]"
)


@dataclass(frozen=True)
class Figure:
    """A value with its interval, as text: "85.0", "82.3", "87.5"."""

    value: str
    low: str
    high: str

    def __str__(self) -> str:
        return f"{self.value} [{self.low}, {self.high}]"

    def is_printed(self, printed: set[Figure]) -> bool:
        """Return whether this figure is among ``printed``.

        It may have fewer decimal places. Without signs, a difference may have the opposite
        sign: "2.7 points [0.5, 4.9] more" where -2.7 [-4.9, -0.5] was printed.
        """
        unsigned = not any(part.startswith(("-", "+")) for part in self._parts)
        return any(
            all(map(_rounds, self._parts, figure))
            for known in printed
            for figure in ([known._parts, known._mirrored] if unsigned else [known._parts])
        )

    @property
    def _parts(self) -> tuple[str, str, str]:
        return self.value, self.low, self.high

    @property
    def _mirrored(self) -> tuple[str, str, str]:
        return _negative(self.value), _negative(self.high), _negative(self.low)


def _negative(value: str) -> str:
    number = value.lstrip("+")
    return number[1:] if number.startswith("-") else f"-{number}" if number[0].isdigit() else number


def _rounds(printed: str, full: str) -> bool:
    """Return whether ``printed`` is ``full``, perhaps with fewer decimal places."""
    bounds = "<>≤≥"
    if (printed[0] in bounds or full[0] in bounds) and printed[0] != full[0]:
        return False
    printed, full = printed.lstrip(f"{bounds} "), full.lstrip(f"{bounds} ")
    places = len(printed.partition(".")[2])
    return abs(float(printed) - float(full)) <= 0.5 * 10.0**-places + 1e-9


def figures(text: str) -> list[Figure]:
    """Return the figures with intervals in a text."""
    plain = text.replace("−", "-")
    return [Figure(value, low, high or low) for value, low, high in FIGURE.findall(plain)]


def commands(text: str) -> list[str]:
    """Return the commands in a text that print tables of stored rows."""
    matches = (COMMAND.match(line) for line in text.splitlines())
    return [match[1].partition("  #")[0].strip() for match in matches if match]


def run(command: str) -> list[Figure]:
    """Run a command of a page in this process; return the figures that it prints.

    Raises:
        RuntimeError: If the command fails.
    """
    # the shell expands braces: {base,harden}-val_unseen.jsonl.gz
    words = subprocess.run(
        ["bash", "-c", f"printf '%s\\n' {command}"], capture_output=True, text=True, check=True
    ).stdout.splitlines()
    if words[-2] == "--table":
        return figures(stored_tables(Path(words[-1])))
    arguments = words[words.index("table") + 1 :] if words[0] == "mitigate" else words[3:]
    with redirect_stdout(StringIO()) as printed, redirect_stderr(StringIO()) as errors:
        status = table.main([*arguments, "--print-only"])
    if status:
        raise RuntimeError(f"{command} failed:\n{errors.getvalue().strip()}")
    return figures(printed.getvalue())


@dataclass(frozen=True)
class Checked:
    """The result for one page.

    Attributes:
        confirmed: number of figures that a command of the page prints.
        wrong: figures that no command prints, in sections with a command.
        without: figures that no command prints, in sections without a command.
    """

    confirmed: int
    wrong: list[Figure]
    without: list[Figure]


def check(text: str, printed: list[Figure]) -> Checked:
    """Compare the figures of a page with the figures that its commands printed."""
    confirmed = 0
    wrong: list[Figure] = []
    without: list[Figure] = []
    known = set(printed)
    for section in re.split(r"^(?=###? )", text, flags=re.MULTILINE):
        unknown = wrong if commands(section) else without
        for figure in figures(section):
            if figure.is_printed(known):
                confirmed += 1
            else:
                unknown.append(figure)
    return Checked(confirmed, wrong, without)


def main() -> int:
    """Check the pages; return 1 if a figure is wrong."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("pages", nargs="*", type=Path, help="Markdown files (default: all results)")
    parser.add_argument("--list", action="store_true", help="also list figures without a command")
    options = parser.parse_args()
    pages = options.pages or [page for glob in PAGES for page in sorted(ROOT.glob(glob))]
    texts = {page: page.read_text("utf-8") for page in pages}
    unique = dict.fromkeys(command for text in texts.values() for command in commands(text))
    os.chdir(ROOT)  # the commands name files relative to it
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        try:
            printed = dict(zip(unique, pool.map(run, unique), strict=True))
        except RuntimeError as error:
            sys.exit(str(error))
    failed = False
    for page, text in texts.items():
        result = check(text, [figure for c in commands(text) for figure in printed[c]])
        wrong, without = len(result.wrong), len(result.without)
        if result.confirmed + wrong + without:
            print(
                f"{page}: {result.confirmed} confirmed, {wrong} wrong, {without} without a command"
            )
        for figure in result.wrong:
            print(f"  wrong: {figure}")
        for figure in result.without if options.list else ():
            print(f"  without a command: {figure}")
        failed |= bool(wrong)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
