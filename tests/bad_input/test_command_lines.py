"""Tests that an invalid command line prints one paragraph and sets an exit status, without a
traceback or new files."""

from __future__ import annotations

import json
import sys

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mitigate import cli
from mitigate.core import conf
from mitigate.corruptions import frames_command
from mitigate.evaluation import evaluate, table
from mitigate.shipping import export, export_command
from mitigate.training import train
from mitigate.worlds import corrupt_episodes_command as episodes_command
from tests.bad_input.named import LONGEST
from tests.bad_input.test_episode_files import GOOD


def said_by(call, capsys) -> tuple[int, str]:
    """Return the exit status and the standard error of a command."""
    try:
        status = call()
    except SystemExit as stop:
        status = stop.code
    printed = capsys.readouterr().err
    if isinstance(status, str):
        status, printed = 1, printed + status
    assert "Traceback" not in printed and len(printed) < LONGEST, printed
    return status or 0, printed


HUGE = "9" * 400
WRONG = {
    "train": [
        ("trainer.lr=inf", "got inf"),
        ("trainer.lr=nan", "got nan"),
        ("trainer.lr=-1", "got -1"),
        ("trainer.lr=fast", "must be a number"),
        (f"trainer.lr={HUGE}", "trainer.lr"),
        ("stages.imitation.trainer.lr=inf", "got inf"),
        ("trainer.weight_decay=nan", "trainer.weight_decay"),
        (f"trainer.steps={HUGE}", "trainer.steps"),
        ("trainer.steps=1e9", "trainer.steps"),
        ("trainer.device=banana", "trainer.device=banana"),
        ("trainer.device=cuda:77", "trainer.device=cuda:77"),
        ("trainer.device=meta", "trainer.device=meta"),
        ("trainer.warmup=-1", "trainer.warmup"),
        ("agent.width=10000000", "agent.width is 10000000"),
        ("agent.size=10000000", "agent.size is 10000000"),
        ("agent.width=abc", "agent.width is 'abc'"),
        ("agent.blind=[smell]", "a list of rgb, depth"),
        ("agent.planner=hello", "null or a mapping"),
        ("+agent.adapters.target_modules=['(.*)*(.*)*x']", "patterns without groups"),
        ("env.size=10000000", "8 to 2048 pixels"),
        ("env.size=-4", "8 to 2048 pixels"),
        ("env.views=5", "views must be 12"),
        ("workers=100000", "got 100000"),
        ("workers=-1", "got -1"),
        (f"rollouts={HUGE}", "rollouts="),
        (f"seed={HUGE}", "seed must be a whole number"),
        ("severity=nan", "got nan"),
        ("severity=2", "got 2"),
        ("severity_depth=-inf", "severity_depth"),
        ("recipe=../../etc/passwd", "no recipe"),
        ("recipe=", "recipe"),
        ("agent=hello", "no agent"),
        ("init=/dev/null", "no weights at"),
        ("init=/etc/passwd", "must be a .safetensors file"),
        ("evaluation.split=nowhere", "no split"),
        ("evaluation.episodes=0", "whole list, got 0"),
        ("trainer=hello", "trainer"),
        ("stages=null", "stages"),
        ("a b", "key=value"),
        ("x=[1,2", "x=[1,2"),
        ("${oc.env:HOME}=1", "key=value"),
        ("seed=${oc.env:HOME}", "seed"),
    ],
    "evaluate": [
        ("workers=0", "workers"),
        ("workers=10000000", "workers"),
        (f"seed={HUGE}", "seed must be a whole number"),
        ("severity=inf", "everity"),
        ("conditions=spatter+mask", "a list, such as [spatter+mask]"),
        ("conditions=[]", "conditions must not be empty"),
        ("conditions=[../../x]", "no condition"),
        ("conditions=[clean,'a|b']", "no condition"),
        ("checkpoint=/etc", "no weights"),
        ("episodes=-3", "whole list, got -3"),
        ("split=../val", "no split"),
        ("safeguard=http://u:p@h/v1", "endpoint"),
        ("agent.width=10000000", "agent.width is 10000000"),
        ("launcher=nothing", "no launcher"),
    ],
}
# these command lines start Hydra, which takes three times as long as composing the config
THROUGH_HYDRA = {"trainer.lr=inf", "severity=2", "recipe=", "agent=hello", "a b", "x=[1,2"}
LINES = [
    pytest.param(
        *(name, option, words),
        id=f"{name} {option[:40]}",
        marks=[pytest.mark.slow] * (number % 4 > 0),
    )
    for name, lines in WRONG.items()
    for number, (option, words) in enumerate(lines)
]
FAST = settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)


@pytest.mark.parametrize(("name", "option", "words"), LINES)
def test_wrong_option_is_named_before_anything_is_written(
    tmp_path, monkeypatch, capsys, name, option, words
):
    monkeypatch.delenv("HYDRA_FULL_ERROR", raising=False)
    monkeypatch.setattr(sys, "argv", [name, f"runs={tmp_path}", option])

    def composed() -> None:
        train.run(conf.load_config("train", [*sys.argv[1:], f"folder={tmp_path}/run"]))

    def run():
        if name == "evaluate":
            return evaluate.main()
        return conf.main(train.hydra_main if option in THROUGH_HYDRA else composed, name)

    status, printed = said_by(run, capsys)
    assert status == 1 and words in printed, printed
    assert not list(tmp_path.rglob("*.safetensors")) and not list(tmp_path.rglob("*.pt"))


ROWS = {
    "nothing": b"",
    "a list": b"[]\n",
    "half a row": b'{"agent": "0',
    "deep": b"[" * 60_000 + b"\n",
    "bytes": bytes(range(256)),
    "gzip cut": b"\x1f\x8b\x08\x00",
}


@pytest.mark.parametrize("raw", ROWS.values(), ids=ROWS)
def test_table_refuses_what_is_no_rows(tmp_path, capsys, raw):
    (tmp_path / "rows.jsonl").write_bytes(raw)
    arguments = [str(tmp_path / "rows.jsonl"), "--out", str(tmp_path / "out")]
    status, printed = said_by(lambda: table.main(arguments), capsys)
    assert status == 2 and printed.startswith("table: ")
    assert not (tmp_path / "out" / "table.md").exists()


@pytest.mark.parametrize(
    ("value", "missing"), [([], "run, name"), (["runs/a"], "name"), (["--onnx"], "run, name")]
)
def test_export_asks_for_what_it_needs_and_no_more(monkeypatch, capsys, value, missing):
    monkeypatch.setattr(sys, "argv", ["mitigate export", *value])
    status, printed = said_by(export_command.main, capsys)
    assert status == 2
    assert printed.splitlines()[-1].endswith(f"the following arguments are required: {missing}")


FOLDERS = [
    [],
    ["a"],
    ["a", "b", "c"],
    ["a", "b", "--unknown"],
    ["a", "b", "severity=0.5"],
    ["a", "b", "corruption=../../x", "severity=0.5"],
    ["a", "b", "corruption=spatter", "severity=nan"],
    ["a", "b", "corruption=spatter", "severity=2"],
    ["a", "b", "corruption=spatter", "severity=0.5", f"seed={HUGE}x"],
    ["a", "b", "corruption=spatter", "severity=0.5", "unit=0"],
    ["a", "b", "corruption=spatter", "severity=0.5", "unit=parsec"],
    ["a", "b", "corruption=spatter", "severity=0.5", "format=exe"],
    ["a", "b", "corruption=spatter", "severity=0.5", "episode=["],
    ["a", "a", "corruption=spatter", "severity=0.5"],
    ["/dev/null", "b", "corruption=spatter", "severity=0.5"],
    ["a\0b", "b", "corruption=spatter", "severity=0.5"],
]


@pytest.mark.parametrize("line", FOLDERS, ids=lambda line: " ".join(line)[-40:] or "nothing")
def test_corrupt_refuses_a_wrong_line(tmp_path, monkeypatch, capsys, line):
    monkeypatch.chdir(tmp_path)
    status, printed = said_by(lambda: frames_command.main(line), capsys)
    assert status == 2 and (printed or not line)
    assert not list(tmp_path.iterdir())


EPISODES = [
    ["in.json", "out.json"],
    ["in.json", "in.json", "corruption=capitalize", "severity=1"],
    ["in.json", "out.json", "corruption=white_box", "severity=1"],
    ["in.json", "out.json", "corruption=spatter", "severity=1"],
    ["in.json", "out.json", "corruption=capitalize", "severity=inf"],
    ["in.json", "out.json", "corruption=capitalize", "severity=x"],
    ["in.json", "out.json", "corruption=capitalize", "severity=1", "seed=1.5"],
    ["in.json", "out.json", "corruption=capitalize", "severity=1", "what=ever"],
    ["in.json", "out.json", "corruption=black_box", "severity=1", "split=../x"],
    ["in.json", "out.json", "corruption=capitalize", "severity=1", "tokenizer=../nowhere"],
    ["/dev/null", "out.json", "corruption=capitalize", "severity=1"],
    [".", "out.json", "corruption=capitalize", "severity=1"],
]


@pytest.mark.parametrize("line", EPISODES, ids=lambda line: " ".join(line)[-40:])
def test_corrupt_episodes_refuses_a_wrong_line(tmp_path, monkeypatch, capsys, line):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "in.json").write_text(json.dumps({"episodes": [GOOD]}))
    before = (tmp_path / "in.json").read_bytes()
    status, printed = said_by(lambda: episodes_command.main(line), capsys)
    assert status == 2 and printed.startswith("corrupt_episodes: ")
    assert [p.name for p in tmp_path.iterdir()] == ["in.json"]
    assert (tmp_path / "in.json").read_bytes() == before


@pytest.mark.parametrize("name", ["", "..", "a/b", "-x", "a b", "../../x", "x" * 300, "a\nb", "."])
def test_export_refuses_a_name_that_is_no_folder(tmp_path, name):
    with pytest.raises((ValueError, FileNotFoundError)):
        export.export(tmp_path, name, out=tmp_path / "out")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("name", ["trian", "../train", "--x", "train=1", "\0", "x" * 1000])
def test_unknown_command_is_named(capsys, name):
    status, printed = said_by(lambda: cli.main([name[:99]]), capsys)
    assert status == 1 and "no command" in printed


@FAST
@given(st.lists(st.text(max_size=12), max_size=4))
def test_parse_reads_any_words_as_folders_or_fails(tmp_path, monkeypatch, capsys, words):
    monkeypatch.chdir(tmp_path)
    for main in (frames_command.main, table.main):
        if not any(word.startswith("-") for word in words):
            said_by(lambda main=main: main(["/nowhere", *words]), capsys)
