"""Write the page as one HTML file that contains all its styles, scripts and data.

The page embeds the rows as data, and its scripts insert this data only as text. The data cannot
close the HTML element that contains it, because ``<`` is escaped. The page's content security
policy allows only the scripts and styles that this module writes.
"""

from __future__ import annotations

import base64
import hashlib
import html
import json
from collections.abc import Iterable, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

from mitigate.core.files import write_text
from mitigate.core.names import counted
from mitigate.corruptions import SUITE_VERSION
from mitigate.evaluation.page.model import (
    MOST_EPISODES,
    Packed,
    curve_figures,
    number_count,
    section_data,
)
from mitigate.evaluation.rows import Row
from mitigate.evaluation.sections import sections

ASSETS = Path(__file__).parent / "assets"
SUFFIXES = (".html", ".htm")
# maximum number of results on a page (heuristic); computing this many takes a minute
MOST_NUMBERS = 50_000
# maximum length of a page in characters (heuristic); the episodes take up to 6 million of them
LARGEST_PAGE = 1 << 26
MOST_NAMES = 8  # maximum number of names that the first line lists (heuristic)
SCRIPTS = ("dom", "data", "colours", "table", "heatmap", "episodes", "curves", "walks", "main")


def _page(data: dict[str, Any], packed: str) -> str:
    """Return the HTML page; its scripts read ``data`` and the ``packed`` episodes.

    Each ``%NAME%`` in ``page.html`` is replaced by its value.
    """
    style = (ASSETS / "style.css").read_text(encoding="utf-8")
    scripts = [(ASSETS / f"{name}.js").read_text(encoding="utf-8") for name in SCRIPTS]
    script = '(() => {\n"use strict";\n' + "\n".join(scripts) + "})();\n"
    values = {
        "STYLE_HASH": _hash(style),
        "SCRIPT_HASH": _hash(script),
        "TITLE": html.escape(data["title"]),
        "STYLE": style,
        "DATA": _embedded(data),
        "PACKED": packed,
        "SCRIPT": script,
    }
    # an inserted value is not searched for further names
    pieces = (ASSETS / "page.html").read_text(encoding="utf-8").split("%")
    return "".join(values.get(piece, piece) for piece in pieces)


def check_out(out: Path | str) -> Path:
    """Return ``out`` as a path; raise ValueError unless it is the name of an HTML file.

    A page replaces an existing file, so the path must not be the path of a row file.
    """
    path = Path(out)
    if path.suffix.lower() not in SUFFIXES or path.is_dir():
        raise ValueError(
            f"The file of a page must end in .html, such as report.html, got {str(out)!r}."
        )
    return path


def write(text: str, out: Path | str) -> Path:
    """Write a page to ``out``, atomically. Raises as :func:`check_out`."""
    path = check_out(out)
    write_text(path, text)
    return path


def _embedded(data: Any) -> str:
    """Return ``data`` as JSON that an HTML parser reads as text, without any tags."""
    text = json.dumps(data, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def _hash(text: str) -> str:
    return base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()


def report(
    rows: Iterable[Row],
    *,
    title: str = "Results",
    walks: Sequence[dict[str, Any]] = (),
    notes: Sequence[str] = (),
    most: int = MOST_EPISODES,
) -> str:
    """Return an HTML page for ``rows``.

    Args:
        rows: result rows.
        title: heading of the page.
        walks: results of ``walks.walk_again``.
        notes: lines below the tables.
        most: maximum number of episodes on the page, summed over all cells of its tables.

    Raises:
        ValueError: If there are no rows, or the page would be too large.
    """
    rows = list(rows)
    parts, packed = sections(rows), Packed(most)
    count = sum(number_count(part) for part in parts)
    if count > MOST_NUMBERS:
        raise ValueError(_too_large(f"{count:,} numbers", f"{MOST_NUMBERS:,}"))
    tables = [{**section_data(part), "grid": packed.add(part)} for part in parts]
    sizes = [sum(cell[2] for line in table["cells"] for cell in line) for table in tables]
    if packed.left_out:
        left_out = (
            f"The episodes of {counted(len(packed.left_out), 'cell')} are not in this file, which "
            f"holds at most {most:,}. The numbers are correct. Name fewer rows to see them."
        )
        notes = [*notes, left_out]
    data = {
        "title": title,
        "about": f"{len(rows):,} rows: {_listed(sorted({row['name'] for row in rows}))}.",
        "sections": tables,
        "curves": curve_figures(parts),
        "grids": packed.grids,
        "walks": list(walks),
        "notes": list(notes),
        "first": sizes.index(max(sizes)),
        "end": f"Made by mitigate {version('mitigate')}, corruption suite {SUITE_VERSION}. "
        "This file is self-contained and needs no network.",
    }
    page = _page(data, packed.text())
    if len(page) > LARGEST_PAGE:
        raise ValueError(_too_large(f"{len(page):,} characters", f"{LARGEST_PAGE:,}"))
    return page


def _too_large(size: str, most: str) -> str:
    return (
        f"The page would hold {size}, more than {most}, which a browser cannot show, so no file "
        "was written. Name fewer rows, or use `mitigate table`."
    )


def _listed(names: Sequence[str]) -> str:
    more = f" and {len(names) - MOST_NAMES} more agents" if len(names) > MOST_NAMES else ""
    return ", ".join(names[:MOST_NAMES]) + more
