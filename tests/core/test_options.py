"""Tests of parsing the arguments of a command line: paths, options and flags."""

from __future__ import annotations

import pytest

from mitigate.core import conf, options
from mitigate.core.options import asks_help, check_paths, paths_and_options

REPLACES = "{0} already exists, and +{0}= replaces it."


@pytest.mark.parametrize(
    ("primary", "value", "keys"),
    [
        ("table1", ["+columns.recurrent_ts=[agent=recurrent]"], ["columns.recurrent_ts"]),
        ("table1", ["+columns.mine=[agent=recurrent]", "jobs=1"], []),
        ("table1", ["columns.recurrent=[agent=recurrent]"], []),
        ("table1", ["~columns.recurrent", "+columns.recurrent=[agent=recurrent]"], []),
        ("evaluate", ["+env.episodes={mine: a.json}"], ["env.episodes"]),
        ("evaluate", ["+env.episodes.val_seen=mine.json", "+seed=1"], []),  # Hydra refuses them
        ("evaluate", ["++split=val_seen"], []),
        ("evaluate", ["+severity=1", "sevrity=2"], []),  # is refused anyway
    ],
)
def test_added_option_that_replaces_another_is_reported(primary, value, keys):
    reported = conf.notices(primary, value)
    assert [text.partition(" To add one")[0] for text in reported] == [
        REPLACES.format(k) for k in keys
    ]


def test_added_option_that_nothing_reads_names_the_nearest():
    (reported,) = conf.notices("evaluate", ["+episode=9", "++seed=3", "split=val_seen"])
    assert reported.startswith("+episode= adds an option that only your own configs can use.")
    assert reported.endswith("Did you mean episodes=...?")


def test_added_group_file_is_rejected(tmp_path):
    (tmp_path / "mine").mkdir()
    arguments = [f"--config-dir={tmp_path}", "+experiment=frozen", "+mine=one"]
    assert not conf.notices("train", arguments)


@pytest.mark.parametrize(
    ("line", "displayed"),
    [
        (["--out", "x"], "out=x"),
        (["--out=x", "seed=1"], "out=x"),
        (["split=val_seen", "--cell-size", "--severity", "0.6"], "cell_size=VALUE"),
        (["--severity", "seed=1"], "severity=VALUE"),
    ],
)
def test_check_dashes_shows_the_valid_form(line, displayed):
    with pytest.raises(ValueError, match=f"Write {displayed}, without dashes"):
        options.check_dashes(line)


def test_hydras_own_flags_and_values_with_dashes_pass():
    options.check_dashes(["--multirun", "--config-dir=mine", "-m", "--cfg", "job", "name=--x"])


@pytest.mark.parametrize("flag", ["-m", "--multirun"])
def test_multirun_flag_may_follow_other_options(flag):
    arguments = ["recipe=stacked", flag, "seed=0,1", "--config-dir", "mine"]
    assert options.flags_first(arguments) == [
        flag,
        "--config-dir",
        "mine",
        "recipe=stacked",
        "seed=0,1",
    ]
    assert options.flags_first(["a=1", "--config-dir=mine", "b=2"]) == [
        "--config-dir=mine",
        "a=1",
        "b=2",
    ]
    assert options.flags_first(["seed=0"]) == ["seed=0"]


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (["checkpoint=a/b"], ["a/b"]),
        (["++checkpoint=a", "seed=1", "checkpoint='b c'"], ["b c"]),
        ([r"checkpoint=my\=base"], ["my=base"]),
        (["checkpoint=a,b"], ["a", "b"]),
        # only the last option sets a checkpoint, and it cannot be parsed
        (["checkpointer=a", "name=checkpoint=b", "checkpoint=~/x"], []),
    ],
)
def test_option_value_is_parsed_as_hydra_does(value, expected):
    assert options.values(value, "checkpoint") == expected


@pytest.mark.parametrize("name", ["mine (2)", "a,b", 'say "hi"', "it's", "ü = x"])
def test_config_folder_may_have_any_name(tmp_path, name):
    folder = tmp_path / name
    (folder / "suite").mkdir(parents=True)
    (folder / "suite" / "own.yaml").write_text("conditions: [clean, flare]\n")
    arguments = [f"--config-dir={folder}", "suite=own"]
    assert list(conf.load_config("evaluate", arguments).suite.conditions) == ["clean", "flare"]


def test_paths_and_options_may_stand_in_any_order():
    matches = paths_and_options(
        ["severity=0.5", "in", "a=b=c", "./x=y"], ("IN", "OUT"), ("severity", "a")
    )
    assert matches == (["in", "./x=y"], {"severity": "0.5", "a": "b=c"})


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "takes 1 path, IN, got none"),
        (["a", "b"], "got 2: a, b"),
        (["a", "sede=1"], "Did you mean seed"),
        (["a", "seed=1", "seed=2"], "seed is set twice: '1' and '2'"),
        (["a", "--seed"], "There is no option --seed"),
    ],
)
def test_unreadable_option_is_explained(arguments, words):
    with pytest.raises(ValueError, match=words):
        paths_and_options(arguments, ("IN",), ("seed",))


def test_empty_line_and_help_flag_show_the_help():
    assert asks_help([]) and asks_help(["a", "--help"]) and not asks_help(["a"])


def test_option_among_paths_explains_the_syntax(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ValueError, match=r"no file out=report. Write options here as --out DIR"):
        check_paths(["runs/a", "out=report"], "--out DIR")
    (tmp_path / "out=report").mkdir()
    check_paths(["runs/a", "out=report", "runs/seed=0"], "--out DIR")
