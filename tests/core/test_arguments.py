"""Paths and key=value options of the commands without Hydra."""

from __future__ import annotations

import pytest

from mitigate.core.arguments import asks_help, check_paths, paths_and_options


def test_paths_and_options_may_stand_in_any_order():
    found = paths_and_options(
        ["severity=0.5", "in", "a=b=c", "./x=y"], ("IN", "OUT"), ("severity", "a")
    )
    assert found == (["in", "./x=y"], {"severity": "0.5", "a": "b=c"})


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "takes 1 path, IN, but there are none"),
        (["a", "b"], "there are 2: a, b"),
        (["a", "sede=1"], "Did you mean seed"),
        (["a", "seed=1", "seed=2"], "seed is given twice: '1' and '2'"),
        (["a", "--seed"], "There is no option --seed"),
    ],
)
def test_what_cannot_be_read_is_explained(arguments, words):
    with pytest.raises(ValueError, match=words):
        paths_and_options(arguments, ("IN",), ("seed",))


def test_nothing_and_a_wish_show_the_help():
    assert asks_help([]) and asks_help(["a", "--help"]) and not asks_help(["a"])


def test_an_option_among_paths_is_answered_with_how_options_are_written(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ValueError, match=r"no file out=report. Options are written --out DIR here"):
        check_paths(["runs/a", "out=report"], "--out DIR")
    (tmp_path / "out=report").mkdir()
    check_paths(["runs/a", "out=report", "runs/seed=0"], "--out DIR")
