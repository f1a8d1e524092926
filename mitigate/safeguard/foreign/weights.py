"""Weights of the rules: ``weights.json``, written by ``python -m mitigate.safeguard.fit --write``.

They are of the counts of ``evidence.py``: of a sentence by itself (``OWN``), beside others
(``CONTEXT``), of a part of one (``PART``); and of ``front.py`` (``FRONT``). ``WORDS``: words and
pairs of them to the log odds of attacks against routes. ``STYLE``: words that mark a manner.
The environment's MITIGATE_RULES names another such file, to measure one fit beside another.
"""

from __future__ import annotations

import json
import os
from pathlib import Path

FILE = Path(__file__).with_suffix(".json")
USED = Path(os.environ.get("MITIGATE_RULES", FILE))

_fitted = json.loads(USED.read_text(encoding="utf-8"))
OWN: dict[str, float] = _fitted["own"]
CONTEXT: dict[str, float] = _fitted["context"]
PART: dict[str, float] = _fitted["part"]
FRONT: dict[str, float] = _fitted["front"]
WORDS: dict[str, float] = _fitted["words"]
STYLE = frozenset[str](_fitted["style"])
