"""Tests that a password in a ``safeguard=`` address is never printed, whatever characters surround
it."""

from __future__ import annotations

import sys
import traceback

import pytest

from mitigate.core import conf
from mitigate.core.addresses import check_arguments, check_choice
from mitigate.evaluation import evaluate
from mitigate.evaluation.config import check
from mitigate.guards.text import choices
from mitigate.training.cells import listed

URLS = [
    "https://me:PW@h/v1@m",
    "rules+https://me:PW@h/v1@m",
    "rules+https/PW",
    "lora+https://me:PW@h/v1@m",
    "prompted+https://me:PW@h/v1@m",
    " https://me:PW@h/v1@m",
    "\thttps://me:PW@h/v1@m",
    "ftp://me:PW@h/v1@m",
    "https//me:PW@h/v1@m",
    "https:/me:PW@h/v1@m",
    "//me:PW@h",
    "me:PW@h/v1",
    "https://me:PW",
    "https://h/v1?key=PW",
    "https://h/v1#PW",
    "http://me:1234@PW",
]
WORDS = [
    *(f"safeguard={url}" for url in URLS),
    "safeguard='https://me:PW@h/v1@m'",
    "safeguard=none,https://me:PW@h/v1@m",
    "safeguard=[none,https://me:PW@h/v1@m]",
    "safeguard=choice(none,https://me:PW@h/v1@m)",
    "safeguard={url: https://me:PW@h/v1@m}",
    "safeguard=https://me:a,PW,b@h/v1@m",
    "safeguard=https://me:a=PW@h/v1@m",
    "safeguard=https\\://me:PW@h/v1@m",
    "+safeguard=https://me:PW@h/v1@m",
    "++safeguard=lora+https://me:PW@h/v1@m",
    "~safeguard=https://me:PW@h/v1@m",
    "--safeguard=https://me:PW@h/v1@m",
    "--safeguard https://me:PW@h/v1@m",
    "safegard=https://me:PW@h/v1@m",
    "safeguard = https://me:PW@h/v1@m",
    "agent.safeguard=https//me:PW@h/v1@m",
    '+evaluations.x=["safeguard=https//me:PW@h/v1@m"]',
    "safeguard=me:PW",
    "safeguard=me=PW@h",
    "safeguard=me%3APW%40h",
    "safeguard=me\\:PW@h/v1",
    "safeguard=none,me:PW",
    "safeguard=choice(none,me:PW)",
    "safegard=me:PW@h/v1",
    "safe_guard=me:PW",
    "safeguard = me:PW",
    "--safeguard me:PW",
    '+evaluations.x=["safeguard=me:PW"]',
]


def output(monkeypatch, capfd, words: list[str]) -> str:
    """Return everything that an evaluation with an invalid command line prints."""
    monkeypatch.setattr(sys, "argv", ["evaluate", *words])
    with pytest.raises((SystemExit, ValueError)) as stop:
        evaluate.main()
    return "".join([*traceback.format_exception(stop.value), *capfd.readouterr()])


@pytest.mark.parametrize("flags", [[], ["-m"]], ids=["run", "multirun"])
@pytest.mark.parametrize("full", ["", "1"], ids=["paragraph", "HYDRA_FULL_ERROR"])
@pytest.mark.parametrize("word", WORDS)
def test_command_line_never_repeats_a_password(tmp_path, monkeypatch, capfd, word, full, flags):
    """Issue T2, item 6."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv(conf.FULL, full)
    words = word.split(" ") if " = " in word or word.startswith("-") else [word]
    text = output(monkeypatch, capfd, [*flags, *words, "checkpoint=nowhere"])
    assert "PW" not in text and "endpoint" in text
    assert not list(tmp_path.iterdir())  # no multirun.yaml and no result folder has been written


@pytest.mark.parametrize("url", URLS)
def test_choices_never_repeat_a_password(url):
    """Issue T2, item 6."""
    with pytest.raises(ValueError, match="endpoint") as error:
        choices.check(url)
    assert "PW" not in "".join(traceback.format_exception(error.value))


def test_unknown_value_is_repeated_only_if_it_is_a_name():
    """Issue T2, item 6."""
    with pytest.raises(ValueError, match="'clasifier'. Did you mean classifier"):
        choices.check("clasifier")
    for value in ("me:PW", ["PW"], {"url": "PW"}, "PW%40h"):
        with pytest.raises(ValueError, match="the name of an existing safeguard") as error:
            choices.check(value)
        assert "PW" not in str(error.value)


@pytest.mark.parametrize("full", ["", "1"])
@pytest.mark.parametrize("flag", ["", "-m", "--cfg=job"])
@pytest.mark.parametrize("mode", ["", "  mode: MULTIRUN\n"])
def test_swept_values_of_a_config_file_never_repeat_a_password(
    tmp_path, monkeypatch, capfd, full, flag, mode
):
    """Issue T2, item 6."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv(conf.FULL, full)
    (tmp_path / "configs/suite").mkdir(parents=True)
    (tmp_path / "configs/suite/mine.yaml").write_text(
        f"# @package _global_\nhydra:\n{mode}  sweeper:\n    params:\n"
        "      safeguard: none,https://me:PW@h/v1@m\n"
    )
    words = ["--config-dir", str(tmp_path / "configs"), "suite=mine", "checkpoint=nowhere", flag]
    text = output(monkeypatch, capfd, [word for word in words if word])
    assert "PW" not in text and "endpoint" in text
    assert [path.name for path in tmp_path.iterdir()] == ["configs"]


@pytest.mark.parametrize("value", ["https://me:PW@h/v1@m", "['https://me:PW@h/v1@m']"])
@pytest.mark.parametrize("full", ["", "1"])
def test_config_file_never_repeats_a_password(tmp_path, monkeypatch, capfd, full, value):
    """Issue T2, item 6."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv(conf.FULL, full)
    (tmp_path / "suite").mkdir()
    file = tmp_path / "suite" / "mine.yaml"
    file.write_text(f"# @package _global_\nsafeguard: {value}\n")
    text = output(monkeypatch, capfd, ["--config-dir", str(tmp_path), "suite=mine"])
    assert "PW" not in text


def test_environment_variable_never_repeats_a_password(monkeypatch):
    """Issue T2, item 6."""
    monkeypatch.setenv("MY_URL", "https://me:PW@h/v1@m")
    config = conf.typed(conf.load_config("evaluate", ["safeguard=${oc.env:MY_URL}"]), "evaluate")
    with pytest.raises(ValueError, match="endpoint") as error:
        check(config)
    assert "PW" not in str(error.value)


def test_columns_of_a_table_never_repeat_a_password():
    """Issue T2, item 6."""
    with pytest.raises(ValueError, match="endpoint") as error:
        listed({"x": ["agent=recurrent", "safeguard=https://me:P=PW@h/v1@m"]}, "columns")
    assert "PW" not in str(error.value)


@pytest.mark.parametrize(
    "word",
    [
        "safeguard=none",
        "safeguard=rules,lora",
        "safeguard=http://h:8000/v1@m",
        "safeguard='http://h/v1@org/model:2'",
        "safeguard=none,http://h/@m",
        "safeguard=${oc.env:URL}",
        "safeguard=checkpoints/safeguard",
        'columns.x=["restore=my.module:call","safeguard=http://h/v1@m"]',
        "out=runs/safeguard#1",
        "env@other=apartments",
        "hydra.searchpath=[file:///a@b]",
        "checkpoint=a//b",
        "safeguard=${weights.safeguard}",
        'columns.x=["safeguard=http://h/v1@m","restore=my.module:call"]',
        "recipe=safeguard_lora",
        "stages.safeguard_lora.trainer.steps=4",
    ],
)
def test_valid_words_pass(word):
    """Issue T2, item 6."""
    check_arguments([word])


def test_folder_with_marks_of_an_address_passes(tmp_path, monkeypatch):
    """Issue T2, item 6."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "my@guard").mkdir()
    check_choice("my@guard")
    check_arguments(["safeguard=my@guard"])
