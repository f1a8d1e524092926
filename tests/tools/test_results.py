"""Tests of ``make results``, which computes the published tables again."""

from __future__ import annotations

import sys

import pytest

from mitigate.core import conf
from mitigate.training.cells import cells, check
from mitigate.training.cells import read_options as table_options
from tools import results

HEAD = """
quick: false
only: null
costs: false
jobs: 2
launcher: local
tables:
  first:
    page: docs/a.md
    hours: 2
    commands:
      - python -c 'import sys; print(sys.argv[1]); open(sys.argv[1], "a").write("x")' {out}/{size}
    full: large
    quick: small
  second:
    page: docs/b.md
    hours: 3
    commands:
      - python -c 'raise SystemExit(3)'
"""


@pytest.fixture
def config(tmp_path, monkeypatch):
    file = tmp_path / "results.yaml"
    file.write_text(f"out: {tmp_path}/all tables\n{HEAD}")
    monkeypatch.setattr(results, "CONFIG", file)
    return file


def test_costs_are_printed_without_running(config, tmp_path, capsys):
    assert results.main(["costs=true"]) == 0
    printed = capsys.readouterr().out
    assert "| first | docs/a.md | 2 |" in printed and "| total |  | 5 |" in printed
    assert not (tmp_path / "all tables").exists()


def test_failed_table_is_reported_and_finished_table_is_kept(config, tmp_path, capfd):
    for _ in range(2):
        assert results.main([]) == 1
        assert "second: " in (printed := capfd.readouterr().out) and "status 3" in printed
    assert "| first | docs/a.md | done |" in printed
    folder = tmp_path / "all tables" / "full"
    assert (folder / "large").read_text() == "x"  # computed once
    assert str(folder / "large") in (folder / "first" / results.LOG).read_text()


def test_changed_command_computes_the_table_again(config, tmp_path):
    assert results.main(["only=first"]) == 0
    config.write_text(config.read_text().replace("full: large", "full: other"))
    assert results.main(["only=[first]"]) == 0
    assert {p.name for p in (tmp_path / "all tables/full").iterdir()} == {"large", "other", "first"}


def test_quick_tables_have_their_own_folder(config, tmp_path):
    assert results.main(["only=first", "quick=true"]) == 0
    assert (tmp_path / "all tables/quick/small").read_text() == "x"


@pytest.mark.parametrize(
    ("option", "message"),
    [
        ("only=frst", "Did you mean first"),
        ("quik=true", "quik"),
        ("jobs=many", "jobs"),
        ("quick", "quick"),
    ],
)
def test_wrong_options_are_explained(config, capsys, option, message):
    assert results.main([option]) == 2
    assert message in capsys.readouterr().err


@pytest.mark.slow
def test_every_table_has_valid_options():
    """The programs of ``results.yaml`` exist, and the options of its tables are valid."""
    options = results.read_options([])
    for quick in (False, True):
        for table in options.tables.values():
            for words in table.programs("runs/results", quick):
                if words[:2] in (["mitigate", "table1"], ["mitigate", "table2"]):
                    cfg = table_options(conf.composed(words[1], words[2:]))
                    check(cells(cfg), cfg)
                else:
                    assert words[0] in ("python", "mitigate")


def test_every_page_exists():
    for table in results.read_options([]).tables.values():
        assert (results.CONFIG.parents[1] / table.page).is_file()


def test_help_lists_the_options(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["results", "--help"])
    assert results.main() == 0
    printed = capsys.readouterr().out
    assert "quick: false" in printed and "table2:" in printed
