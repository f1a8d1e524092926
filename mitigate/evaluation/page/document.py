"""The page as one HTML file: styles, scripts and data inside, nothing fetched from anywhere.

What rows say is data to the scripts, which put it in as text. It cannot end its element (``<`` is
escaped), and the page's policy lets no other script, style or address in than those written here.
"""

from __future__ import annotations

import base64
import hashlib
import html
import json
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

from mitigate.core.files import atomic_text
from mitigate.corruptions import SUITE_VERSION

ASSETS = Path(__file__).parent / "assets"
SUFFIXES = (".html", ".htm")
SCRIPTS = ("dom", "data", "colours", "table", "heatmap", "episodes", "curves", "walks", "main")


def page(
    title: str,
    about: str,
    shown: Sequence[dict[str, Any]],
    *,
    curves: Sequence[dict[str, Any]] = (),
    grids: Sequence[dict[str, Any]] = (),
    packed: str = "",
    walks: Sequence[dict[str, Any]] = (),
    notes: Sequence[str] = (),
    first: int = 0,
) -> str:
    """Return an HTML page of sections (``model.section_data``, with the number of their "grid").

    ``about``: a sentence under the title. ``first``: the section that it opens with. The others
    are as the scripts read them: see the modules that make them.
    """
    data = {
        "title": title,
        "about": about,
        "sections": list(shown),
        "curves": list(curves),
        "grids": list(grids),
        "walks": list(walks),
        "notes": list(notes),
        "first": first,
        "end": f"Made by mitigate {version('mitigate')}, corruption suite {SUITE_VERSION}. "
        "This file is whole: it asks no network for anything.",
    }
    style = (ASSETS / "style.css").read_text(encoding="utf-8")
    scripts = [(ASSETS / f"{name}.js").read_text(encoding="utf-8") for name in SCRIPTS]
    script = '(() => {\n"use strict";\n' + "\n".join(scripts) + "})();\n"
    values = {
        "STYLE_HASH": _hash(style),
        "SCRIPT_HASH": _hash(script),
        "TITLE": html.escape(title),
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
