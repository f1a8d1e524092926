"""Load words and phrases of routes in buildings: rooms, things, doors and clause templates.

``route_words.json`` lists these words and phrases, which were written for this project. In a
template, {a} stands for an object and {aa} for a different object. Other fields are {room},
{door}, {stairs}, {place}, {look} (an adjective), {side} (left or right) and {n} (a number).
``learning/routes.py`` composes whole instructions from them.
"""

from __future__ import annotations

import json
from pathlib import Path

_FILE = Path(__file__).with_name("route_words.json")
WORDS: dict[str, list[str]] = json.loads(_FILE.read_text(encoding="utf-8"))
