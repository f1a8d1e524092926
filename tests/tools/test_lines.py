"""Tests of the tool that counts lines of code."""

from tools import lines

SOURCE = '''"""Docstring
of two lines."""

# a comment
import os  # counted


class Thing:
    """Docstring."""

    text = """two
lines"""


def read(thing):
    """Docstring."""
    return getattr(thing, "text", os.sep)
'''


def test_count_ignores_blanks_comments_and_docstrings():
    assert lines.count(SOURCE) == (6, 1)


def test_main_does_not_follow_links(tmp_path, capsys):
    (tmp_path / "part").mkdir()
    (tmp_path / "part" / "code.py").write_text(SOURCE, encoding="utf-8")
    (tmp_path / "link").symlink_to(tmp_path / "part")
    lines.main([str(tmp_path)])
    assert capsys.readouterr().out.splitlines()[-1].split() == ["total", "1", "6", "1"]
