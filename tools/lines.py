"""Count lines of code: ``python tools/lines.py [PATH ...] [--most N]``.

A line of code holds at least one token that is neither a comment nor part of a docstring. Without
paths, the tool counts the package and the recipes, per subpackage and in total. It also counts the
lines that use ``getattr`` or ``hasattr``.
"""

from __future__ import annotations

import argparse
import ast
import io
import sys
import tokenize
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PATHS = ("mitigate", "recipes")
OPTIONAL = ("getattr", "hasattr")
LAYOUT = {
    tokenize.COMMENT,
    tokenize.DEDENT,
    tokenize.ENCODING,
    tokenize.ENDMARKER,
    tokenize.INDENT,
    tokenize.NEWLINE,
    tokenize.NL,
}


def count(source: str) -> tuple[int, int]:
    """Return the number of code lines in ``source``, and the number of lines that use getattr or
    hasattr.
    """
    code: set[int] = set()
    optional: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type not in LAYOUT:
            code.update(range(token.start[0], token.end[0] + 1))
        if token.type == tokenize.NAME and token.string in OPTIONAL:
            optional.add(token.start[0])
    return len(code - _docstring_lines(source)), len(optional)


def _docstring_lines(source: str) -> set[int]:
    """Return the line numbers of all docstrings of the module, its classes and its functions."""
    lines: set[int] = set()
    kinds = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, kinds) and ast.get_docstring(node, clean=False) is not None:
            docstring = node.body[0]
            lines.update(range(docstring.lineno, (docstring.end_lineno or 0) + 1))
    return lines


def files(path: Path) -> list[Path]:
    """Return the Python files in ``path`` and its subfolders, but do not follow symbolic links to
    folders.
    """
    if path.is_file():
        return [path]
    links = {folder for folder in path.iterdir() if folder.is_symlink()}
    return [file for file in sorted(path.rglob("*.py")) if links.isdisjoint(file.parents)]


def totals(paths: list[Path]) -> dict[str, tuple[int, int, int]]:
    """Return, by subpackage, the numbers of files, of code lines, and of lines with getattr or
    hasattr.
    """
    sums: dict[str, list[int]] = defaultdict(lambda: [0, 0, 0])
    for path in paths:
        for file in files(path):
            inside = file.relative_to(path).parts if path.is_dir() else ()
            name = "/".join([path.name, *inside[:1]]) if len(inside) > 1 else path.name
            code, optional = count(file.read_text(encoding="utf-8"))
            for index, value in enumerate((1, code, optional)):
                sums[name][index] += value
    return {name: (values[0], values[1], values[2]) for name, values in sorted(sums.items())}


def main(arguments: list[str] | None = None) -> None:
    """Print the table; exit with an error if there are more lines of code than ``--most``."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("paths", nargs="*", type=Path, help="files or folders of Python code")
    parser.add_argument("--most", type=int, help="fail above this number of lines of code")
    options = parser.parse_args(arguments)
    table = totals(options.paths or [ROOT / path for path in PATHS])
    total = tuple(sum(values[index] for values in table.values()) for index in range(3))
    print(f"{'package':32} {'files':>6} {'code':>7} {'getattr':>8}")
    for name, values in [*table.items(), ("total", total)]:
        print(f"{name:32} {values[0]:6} {values[1]:7} {values[2]:8}")
    if options.most is not None and total[1] > options.most:
        sys.exit(f"error: lines of code must be <= {options.most} (--most), got {total[1]}.")


if __name__ == "__main__":
    main()
