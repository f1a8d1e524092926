"""Count lines of code: ``python tools/lines.py [PATH ...]``.

A line of code holds at least one token that is neither a comment nor part of a docstring. Without
paths, the tool counts the package and the recipes, per subpackage and in total. It also counts the
lines that use ``getattr`` or ``hasattr``.
"""

from __future__ import annotations

import argparse
import ast
import io
import tokenize
from collections import Counter
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


def main(arguments: list[str] | None = None) -> None:
    """Print a table with the files, code lines and lines with getattr of each subpackage."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("paths", nargs="*", type=Path, help="files or folders of Python code")
    table: dict[str, Counter[str]] = {}
    for path in parser.parse_args(arguments).paths or [ROOT / path for path in PATHS]:
        for file in files(path):
            inside = file.relative_to(path).parts if path.is_dir() else ()
            name = "/".join([path.name, *inside[:1]]) if len(inside) > 1 else path.name
            code, optional = count(file.read_text(encoding="utf-8"))
            table.setdefault(name, Counter()).update(files=1, code=code, getattr=optional)
    table = {name: table[name] for name in sorted(table)}
    table["total"] = sum(table.values(), Counter())
    print(f"{'package':32} {'files':>6} {'code':>7} {'getattr':>8}")
    for name, values in table.items():
        print(f"{name:32} {values['files']:6} {values['code']:7} {values['getattr']:8}")


if __name__ == "__main__":
    main()
