"""The page as one HTML file: styles, scripts and data inside, nothing fetched from anywhere.

What rows say is data to the scripts, which put it in as text. It cannot end its element (``<`` is
escaped), and the page's policy lets no other script, style or address in than those written here.
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

from mitigate.core.files import atomic_text
from mitigate.core.names import counted
from mitigate.corruptions import SUITE_VERSION
from mitigate.evaluation.page.model import MOST_EPISODES, Packed, curves, section_data
from mitigate.evaluation.rows import Row
from mitigate.evaluation.sections import sections

ASSETS = Path(__file__).parent / "assets"
SUFFIXES = (".html", ".htm")
SCRIPTS = ("dom", "data", "colours", "table", "heatmap", "episodes", "curves", "walks", "main")


def _page(data: dict[str, Any], packed: str) -> str:
    """Return the HTML page of ``data``, as the scripts read them; ``packed``: the episodes."""
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
    return _filled((ASSETS / "page.html").read_text(encoding="utf-8"), values)


def check_out(out: Path | str) -> Path:
    """Return ``out``; raise ValueError unless it is the name of a page. A page replaces what is
    there, which must not be rows."""
    path = Path(out)
    if path.suffix.lower() not in SUFFIXES or path.is_dir():
        raise ValueError(
            f"A page cannot be written to {str(out)!r}, which it would replace: name a file that "
            "ends in .html, such as report.html."
        )
    return path


def write(text: str, out: Path | str) -> Path:
    """Write a page to ``out``, atomically. Raises as :func:`check_out`."""
    path = check_out(out)
    with atomic_text(path) as file:
        file.write(text)
    return path


def _filled(frame: str, values: dict[str, str]) -> str:
    """Return ``frame`` with each ``%NAME%`` replaced once; what is put in is not read again."""
    pieces = frame.split("%")
    return "".join(values.get(piece, piece) for piece in pieces)


def _embedded(data: Any) -> str:
    """Return JSON that an HTML parser takes as one text."""
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
    """Return the HTML page of ``rows``.

    ``walks`` as ``walks.walk_again`` yields them; ``notes``: lines under the tables; ``most``: how
    many episodes of cells it may hold.
    Raises ValueError if there are no rows.
    """
    held = list(rows)
    parts, packed = sections(held), Packed(most)
    shown = [{**section_data(part), "grid": packed.add(part, held)} for part in parts]
    largest = max(range(len(shown)), key=lambda n: _size(shown[n]))
    notes = list(notes)
    if packed.left_out:
        notes.append(
            f"The episodes of {counted(len(packed.left_out), 'cell')} are not in this file, which "
            f"holds {most:,} episodes at most: their numbers stand, but such cells do not open. "
            "Name fewer rows to see them."
        )
    data = {
        "title": title,
        "about": f"{len(held):,} rows: {_listed({row['name'] for row in held})}.",
        "sections": shown,
        "curves": curves(parts),
        "grids": packed.grids,
        "walks": list(walks),
        "notes": notes,
        "first": largest,
        "end": f"Made by mitigate {version('mitigate')}, corruption suite {SUITE_VERSION}. "
        "This file is whole: it asks no network for anything.",
    }
    return _page(data, packed.text())


def _size(shown: dict[str, Any]) -> int:
    return sum(cell[2] for line in shown["cells"] for cell in line)


def _listed(names: set[str], most: int = 8) -> str:
    held = sorted(names)
    more = f" and {len(held) - most} more agents" if len(held) > most else ""
    return ", ".join(held[:most]) + more
