"""Tests that rows of one episode list are not used for a different list."""

from __future__ import annotations

import pytest

from mitigate.evaluation.episode_lists import keep_list_hash


def test_keep_list_hash_rejects_another_list(tmp_path):
    for name in ("a", "b"):
        (tmp_path / f"{name}.json").write_text(name)
    keep_list_hash(tmp_path, "mine", str(tmp_path / "a.json"))
    keep_list_hash(tmp_path, "mine", str(tmp_path / "a.json"))
    keep_list_hash(tmp_path, "theirs", str(tmp_path / "b.json"))
    with pytest.raises(ValueError, match="rows of another list of mine"):
        keep_list_hash(tmp_path, "mine", str(tmp_path / "b.json"))
