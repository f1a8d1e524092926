"""Tests that tables and examples in the report on corrupted instructions are reproducible."""

from __future__ import annotations

from tools.pages import instruction_samples as samples

FILE = "tests/guards/text/handwritten.txt"


def test_report_repeats_its_examples(capsys):
    assert samples.main([FILE, "--count", "12", "--show", "2"]) == 0
    out = capsys.readouterr().out
    assert out.startswith("12 instructions") and out.count("\n> ") == 2
    assert "| a distance added | 12 | 100.0 % |" in out
    assert all(f"- `{name}` " in out for name in samples.NAMES)
    samples.main([FILE, "--count", "12", "--show", "2"])
    assert capsys.readouterr().out.split("\n> ")[1:] == out.split("\n> ")[1:]


def test_report_leaves_out_lines_without_words(tmp_path, capsys):
    (tmp_path / "some.txt").write_text("Turn left at the sofa.\n...\n\nGo to the bed and stop.\n")
    assert samples.main([str(tmp_path / "some.txt")]) == 0
    assert capsys.readouterr().out.startswith("2 instructions")


def test_report_rejects_a_file_without_instructions(tmp_path, capsys):
    (tmp_path / "empty.txt").write_text("# nothing\n\n")
    assert samples.main([str(tmp_path / "empty.txt")]) == 2
    assert samples.main([str(tmp_path / "none.json")]) == 2
    assert "holds no instruction" in capsys.readouterr().err
