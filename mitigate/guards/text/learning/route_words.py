"""Load words and phrases of routes in buildings: rooms, things, doors and clause templates.

``route_words.json`` lists these words and phrases, which were written for this project. In a
template, {a} is a thing and {aa} is a different thing. Further fields are {room}, {door}, {stairs},
{place}, {side} (left or right) and {n} (a number). ``learning/routes.py`` composes whole
instructions from them.
"""

from __future__ import annotations

import json
from pathlib import Path

_WORDS = json.loads(Path(__file__).with_name("route_words.json").read_text(encoding="utf-8"))
ROOMS: list[str] = _WORDS["rooms"]
THINGS: list[str] = _WORDS["things"]
LOOKS: list[str] = _WORDS["looks"]
STAIRS: list[str] = _WORDS["stairs"]
DOORS: list[str] = _WORDS["doors"]
PLACES: list[str] = _WORDS["places"]
OPEN: list[str] = _WORDS["open"]
MIDDLE: list[str] = _WORDS["middle"]
CLOSE: list[str] = _WORDS["close"]
ASIDES: list[str] = _WORDS["asides"]
