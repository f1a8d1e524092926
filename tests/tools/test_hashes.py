"""Tests of the hashes that are used to compare environments."""

from __future__ import annotations

from tools import hashes


def test_main_prints_a_reproducible_hash_per_severity(capsys):
    lines = []
    for _ in range(2):
        hashes.main()
        lines.append(capsys.readouterr().out.splitlines())
    first, again = lines
    assert first == again and len(first) == 116
    assert len({line.split()[0] for line in first}) == 34 + 7
    assert len({line.rpartition(" ")[0] for line in first}) == 116
