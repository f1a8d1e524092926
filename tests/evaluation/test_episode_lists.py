"""Tests that rows of one episode list are not used for a different list."""

from __future__ import annotations

import pytest

from mitigate.core.files import sha256
from mitigate.evaluation import rows
from mitigate.evaluation.episode_lists import keep_list_hash
from tests.evaluation.made_rows import cell


def test_keep_list_hash_rejects_another_list(tmp_path):
    for name in ("a", "b"):
        (tmp_path / f"{name}.json").write_text(name)
    keep_list_hash(tmp_path, "mine", str(tmp_path / "a.json"))
    keep_list_hash(tmp_path, "mine", str(tmp_path / "a.json"))
    keep_list_hash(tmp_path, "theirs", str(tmp_path / "b.json"))
    with pytest.raises(ValueError, match="rows of another list of mine"):
        keep_list_hash(tmp_path, "mine", str(tmp_path / "b.json"))


def test_keep_list_hash_reads_notes_of_older_versions(tmp_path):
    a, b = tmp_path / "a.json", tmp_path / "b.json"
    for listed in (a, b):
        listed.write_text(listed.name)
    rows.write(tmp_path / "rows.jsonl", cell(1, 1, split="mine"))
    old = tmp_path / "episodes.sha256"
    for known, source in (
        (f"{sha256(a)}  of/mine.json\n", b),  # another path
        (f"{sha256(b)}  of/theirs.json\n{sha256(b)}  {a}\n", a),  # another file there
    ):
        old.write_text(known)
        with pytest.raises(ValueError, match="rows of another list of mine"):
            keep_list_hash(tmp_path, "mine", str(source))
    keep_list_hash(tmp_path, "another", str(a))  # a list without rows
    old.write_text(f"{sha256(b)}  of/theirs.json\n{sha256(a)}  of/mine.json\n")
    keep_list_hash(tmp_path, "mine", str(a))
    assert (tmp_path / "episodes-mine.sha256").is_file()
