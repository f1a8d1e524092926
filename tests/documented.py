"""Read the Python examples of the documentation that tests run."""

from __future__ import annotations

import re
from pathlib import Path

DOCS = Path(__file__).parents[1] / "docs"


def example(page: str, name: str) -> str:
    """Return the example on a page that follows a comment ``<!-- test: name -->``."""
    text = (DOCS / page).read_text(encoding="utf-8")
    match = re.search(rf"<!-- test: {name} -->\n```python\n(.*?)```", text, re.S)
    assert match is not None
    return match[1]
