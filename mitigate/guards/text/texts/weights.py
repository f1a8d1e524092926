"""Weights of the rules: ``weights.json``.

They are written by ``python -m mitigate.guards.text.fit --write``.

They are of the counts of ``evidence.py``: of a sentence by itself (``OWN``), beside others
(``CONTEXT``), of a part of one (``PART``); and of ``front.py`` (``FRONT``). ``WORDS``: words and
pairs of them to the log odds of attacks against routes. ``STYLE``: words that mark a manner.
The environment's MITIGATE_RULES names another such file, to measure one fit beside another.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from mitigate.core.json_files import read_json

FILE = Path(__file__).with_suffix(".json")
USED = Path(os.environ.get("MITIGATE_RULES") or FILE)
TABLES = ("own", "context", "part", "front")  # of weights by the names of what they weigh
_AGAIN = (
    "MITIGATE_RULES names the weights of the rules: write some with `python -m "
    "mitigate.guards.text.fit --split tune > tune.json`, or unset it for those of the package."
)


def read_weights(path: Path) -> dict[str, Any]:
    """Return the weights in a file that ``fit`` wrote, of the names that the package's own has.

    Raises FileNotFoundError, or ValueError for what is damaged or of another version.
    """
    if not path.is_file():
        raise FileNotFoundError(f"There is no file {path}. {_AGAIN}")
    found = read_json(path, _AGAIN)
    ours = found if path == FILE else read_json(FILE, _AGAIN)
    if not isinstance(found, dict) or not {*ours} <= {*found}:
        raise ValueError(f"{path} must hold {', '.join(ours)}. {_AGAIN}")
    for name in (*TABLES, "words"):
        table = found[name]
        if not isinstance(table, dict) or not all(type(w) in (int, float) for w in table.values()):
            raise ValueError(f"{path}: {name} must be numbers by name. {_AGAIN}")
        if name in TABLES and (other := {*table} ^ {*ours[name]}):
            raise ValueError(
                f"{path}: {name} has or lacks {', '.join(sorted(other)[:5])}. {_AGAIN}"
            )
    style = found["style"]
    if not isinstance(style, list) or not all(isinstance(word, str) for word in style):
        raise ValueError(f"{path}: style must be a list of words. {_AGAIN}")
    return found


_fitted = read_weights(USED)
OWN: dict[str, float] = _fitted["own"]
CONTEXT: dict[str, float] = _fitted["context"]
PART: dict[str, float] = _fitted["part"]
FRONT: dict[str, float] = _fitted["front"]
WORDS: dict[str, float] = _fitted["words"]
STYLE = frozenset[str](_fitted["style"])
