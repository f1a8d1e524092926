"""Tests that the check of published figures finds figures that no command prints."""

from __future__ import annotations

import sys

import pytest

from tools import figures
from tools.figures import Figure, check, commands

TABLE = "    mitigate table docs/results/second/base-val_unseen.jsonl.gz --seed 0"
PRINTED = (
    "| base | **85.04** [82.31, 87.49] | -2.7 [-4.9, -0.5] | > 1 [> 1] | ≥ 0.96 [0.96, 0.97] |"
)


def page(figure: str, command: str = TABLE) -> str:
    return f"# Results\n\n## One\n\n{command}\n\n| base | {figure} |\n"


@pytest.mark.parametrize(
    "figure",
    [
        "85.04 [82.31, 87.49]",
        "**85.0** [82.3, 87.5]",
        "85 % [82, 87]",
        "**-2.7** [-4.9, -0.5]",
        "2.7 points [0.5, 4.9]",  # the same difference, stated the other way round
        "≥ 0.96 [0.96, 0.97]",
        "> 1 [> 1]",
    ],
)
def test_printed_figure_is_confirmed(figure):
    checked = check(page(figure), figures.figures(PRINTED))
    assert (checked.confirmed, checked.wrong, checked.without) == (1, [], [])


@pytest.mark.parametrize("figure", ["85.1 [82.3, 87.5]", "85.0 [82.3, 87.6]", "2.7 [-4.9, -0.5]"])
def test_other_figure_is_wrong_where_a_command_stands_next_to_it(figure):
    checked = check(page(figure), figures.figures(PRINTED))
    assert checked.confirmed == 0 and len(checked.wrong) == 1


def test_figure_without_a_command_in_its_section_is_only_counted():
    text = page("85.0 [82.3, 87.5]") + "\n### Two\n\n40.3 [34.7, 46.0], no rows were kept.\n"
    checked = check(text, figures.figures(PRINTED))
    assert checked.confirmed == 1 and not checked.wrong
    assert checked.without == [Figure("40.3", "34.7", "46.0")]


def test_commands_are_indented_lines_that_read_stored_rows():
    text = f"""Text `mitigate table docs/results/a.gz`.

{TABLE}   # a comment
    mitigate table runs/mine
    python -m tools.third_party.results --table docs/results/third-party/a.jsonl.gz
    mitigate evaluate checkpoint=checkpoints/base
"""
    assert commands(text) == [
        TABLE.strip(),
        "python -m tools.third_party.results --table docs/results/third-party/a.jsonl.gz",
    ]


@pytest.mark.slow
def test_page_is_recomputed_from_its_rows(tmp_path, monkeypatch, capsys):
    """A changed figure and a command that fails are reported."""
    rows = "docs/results/lost-frames.jsonl.gz"
    file = tmp_path / "page.md"
    monkeypatch.setattr(sys, "argv", ["figures", str(file)])
    command = f"    mitigate table {rows} --against harden"
    file.write_text(page("89.0 [81.7, 95.2]", command))
    assert figures.main() == 0
    file.write_text(page("89.0 [81.7, 94.0]", command))
    assert figures.main() == 1
    assert "wrong: 89.0 [81.7, 94.0]" in capsys.readouterr().out
    file.write_text(page("89.0 [81.7, 95.2]", f"    mitigate table {rows} --against nobody"))
    with pytest.raises(SystemExit, match="no column 'nobody'"):
        figures.main()
