"""Tests that errors of invalid leaderboard entries name the file and the key."""

from __future__ import annotations

import json
from typing import Any

import pytest

from mitigate.evaluation.leaderboard.entry import LARGEST, load
from mitigate.evaluation.leaderboard.figures import entry_of
from tests.evaluation.made_rows import column

WRONG: list[tuple[str, Any]] = [
    ("name", ""),
    ("name", "a\nb"),
    ("name", "x" * 201),
    ("name", ["base"]),
    ("agents", []),
    ("agents", [{"agent": "a b", "seed": 0}]),
    ("agents", [{"agent": "a", "seed": 0, "more": 1}]),
    ("agents", [{"agent": "a", "seed": True}]),
    ("agents", [{"agent": "a", "seed": 0}] * 101),
    ("sensors", "rgb"),
    ("sensors", [1]),
    ("training_data", "x" * 2001),
    ("severity", 1.5),
    ("severity", True),
    ("episodes", 0),
    ("episodes", 10**12),
    ("episodes", 3.0),
    ("scores", {}),
    ("scores", {"Clean SR": [0.5, 0.4, 0.6], "Clean SPL": None, "Best SR": None}),
    ("scores", {"Clean SR": [0.5, 0.6, 0.4], "Clean SPL": None}),
    ("scores", {"Clean SR": [1.5, 0.4, 1.6], "Clean SPL": None}),
    ("scores", {"Clean SR": [0.5], "Clean SPL": None}),
    ("scores", {"Clean SR": ["0.5", "0.4", "0.6"], "Clean SPL": None}),
    ("SR", {"clean": None}),
    ("SR", {"clean": None, "<script>": None}),
    ("SPL", {"spatter": None, "flare": None}),
    ("rows", {"file": "rows.jsonl", "sha256": "0" * 63, "count": 1}),
    ("rows", {"file": "../rows.jsonl", "sha256": "0" * 64, "count": 1}),
    ("rows", {"file": "/etc/passwd", "sha256": "0" * 64, "count": 1}),
    ("rows", {"file": "a\\..\\b", "sha256": "0" * 64, "count": 1}),
    ("rows", {"file": "rows.jsonl", "sha256": "0" * 64}),
    ("link", "\u202etxt.exe"),
    ("format", 1),
    ("format", True),
]


@pytest.fixture(scope="module")
def good() -> dict[str, Any]:
    entry = entry_of(column(5, {"spatter": 3}), "base", severity=0.6)
    return json.loads(json.dumps(entry.__dict__))


def test_valid_entry_is_accepted(good, tmp_path):
    path = tmp_path / "entry.json"
    path.write_text(json.dumps(good), encoding="utf-8")
    assert load(path).name == "base"


@pytest.mark.parametrize(("key", "value"), WRONG)
def test_invalid_value_is_rejected_by_its_key(good, tmp_path, key, value):
    path = tmp_path / "entry.json"
    path.write_text(json.dumps(good | {key: value}), encoding="utf-8")
    with pytest.raises(ValueError, match=rf"entry\.json: {key} must be .*, not ") as caught:
        load(path)
    assert "\n" not in str(caught.value) and len(str(caught.value)) < 600


def test_other_file_format_is_rejected(good, tmp_path):
    path = tmp_path / "entry.json"
    fewer = {key: value for key, value in good.items() if key != "rows"}
    nested = "[" * 100_000
    texts = [json.dumps(good | {"more": 1}), json.dumps(fewer), "[]", "{", nested, "NaN", "\0"]
    for text in texts:
        path.write_text(text, encoding="utf-8")
        with pytest.raises(ValueError, match=r"entry\.json"):
            load(path)
    path.write_text(json.dumps(good)[:-1] + " " * LARGEST + "}", encoding="utf-8")
    with pytest.raises(ValueError, match="more than"):
        load(path)
    with pytest.raises(FileNotFoundError, match="no entry"):
        load(tmp_path / "nowhere.json")
