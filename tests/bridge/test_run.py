"""Tests of ``mitigate run`` from the command line, with an agent's program on the fake lab."""

import fcntl
import json
import os
import shlex
import signal
import subprocess
import sys
import time
from functools import partial
from types import SimpleNamespace

import pytest

from mitigate.bridge import run as run_module
from mitigate.bridge.condition import Condition, Subset, Words
from mitigate.bridge.config import command_name
from mitigate.bridge.events import EVENTS
from mitigate.bridge.results import read
from mitigate.bridge.run import split_command
from mitigate.core.conf import options_text
from mitigate.corruptions import CLEAN, Corruption
from mitigate.evaluation import rows

from .conftest import AGENT, LAB


def test_run_is_a_command(tmp_path):
    result = subprocess.run(
        [sys.executable, "-m", "mitigate", "run", f"out={tmp_path}", "rule=etpnavv", "--", "true"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 1 and "Did you mean etpnav" in result.stderr


def test_run_measures_a_program_and_resumes(run, tmp_path):
    first = run(tmp_path / "o", "corruption=spatter name=stand split=toy")
    assert first.returncode == 0, first.stdout + first.stderr
    records = rows.read(tmp_path / "o" / "rows.jsonl")
    assert len(records) == 2 * 4 * 2  # 2 conditions x 4 episodes x 2 rules
    own_rows = [row for row in records if row["rule"].startswith("own")]
    assert {row["corruption"] for row in own_rows} == {"clean", "spatter"}
    assert {row["episode_id"] for row in own_rows} == {"s0/0", "s0/2", "s1/1", "s1/3"}
    assert sum(row["success"] for row in own_rows) == 4
    assert {row["name"] for row in own_rows} == {"stand"} and {
        row["split"] for row in own_rows
    } == {"toy"}
    assert "PRS-SR (RGB)" in (tmp_path / "o" / "table.md").read_text()
    again = run(tmp_path / "o", "conditions=[spatter,flare] name=stand split=toy")
    assert "clean: done before" in again.stdout and "spatter-s0.6: done before" in again.stdout
    assert "flare-s0.6: started" in again.stdout
    other = run(tmp_path / "o", "corruption=spatter name=stand split=toy seed=1")
    assert other.returncode == 1 and "was run with another seed" in other.stderr


@pytest.mark.slow
def test_run_chooses_equal_episodes_in_every_condition(run, tmp_path):
    result = run(
        tmp_path / "o", "corruption=spatter episodes=5", f"{AGENT} --episodes 24 --workers 2"
    )
    assert result.returncode == 0, result.stdout + result.stderr
    records = rows.read(tmp_path / "o" / "rows.jsonl")
    by = {}
    for row in records:
        by.setdefault(row["corruption"], set()).add(row["episode_id"])
    assert by["clean"] == by["spatter"] and 4 <= len(by["clean"]) <= 6
    assert json.loads((tmp_path / "o" / "episodes.json").read_text())["of"] == 24


@pytest.mark.slow
def test_run_reports_the_randomness_of_repeated_clean_runs(run, tmp_path):
    result = run(tmp_path / "o", "conditions=[clean] repeats=2")
    assert result.returncode == 0, result.stdout + result.stderr
    assert "2 clean runs of the same 4 episodes: SR 50.0, 50.0" in result.stdout
    assert len(rows.read(tmp_path / "o" / "rows.jsonl")) == 8  # of the first


def test_run_skips_conditions_that_do_not_apply(run, tmp_path):
    program = tmp_path / "rgb_only.py"
    program.write_text(
        "import mitigate_hook, numpy\n"
        "for name in 'ab':\n"
        "    episode = mitigate_hook.connect(name)\n"
        "    for step in range(3):\n"
        "        episode.corrupt({'rgb': numpy.full((8, 8, 3), 90, 'uint8')})\n"
        "    episode.finish(success=name == 'a', spl=0.5 * (name == 'a'))\n"
    )
    result = run(
        tmp_path / "o",
        "conditions=[spatter,multipath,mask,white_box]",
        f"{sys.executable} {program}",
    )
    assert result.returncode == 0, result.stdout + result.stderr
    assert "multipath-s0.6: not applicable, the agent has no depth camera" in result.stdout
    assert "mask-s0.6: not applicable, the program passes no instruction" in result.stdout
    assert "white_box-s0.6: not applicable" in result.stdout
    records = rows.read(tmp_path / "o" / "rows.jsonl")
    assert {row["corruption"] for row in records} == {"clean", "spatter"} and len(records) == 4


@pytest.mark.parametrize(
    ("command", "words"),
    [
        (f"{sys.executable} -c 'import sys; sys.exit(3)'", "ended with status 3"),
        (f"{sys.executable} -I -c 'print(5)'", "no Python process of it loaded the hook"),
        (
            f"{sys.executable} -c 'print(5)'",
            "used neither habitat-lab (habitat.core.env)",
        ),
        (
            f"{sys.executable} -c 'print(5)'",
            "A loop of your own needs three calls: mitigate_hook.connect(), episode.corrupt()",
        ),
        (
            f"{sys.executable} -I {LAB / 'agent.py'} x",
            "status 1, and no Python process",
        ),
        ("no-such-program", "cannot be started: No such file"),
        ("", "A command is missing"),
        (f"{AGENT} --episodes 1 --steps 0", "without an episode"),
    ],
)
def test_run_explains_failed_commands(run, tmp_path, command, words):
    result = run(tmp_path / "o", "conditions=[clean]", command)
    assert result.returncode == 1 and words in result.stderr, result.stderr


@pytest.mark.slow
def test_run_does_not_hang_after_a_dead_worker(run, tmp_path):
    result = run(
        tmp_path / "o",
        "conditions=[clean] patience=2",
        f"{AGENT} --workers 2 --die-at 1 --wait 60",
    )
    assert result.returncode == 1
    assert "ended in the middle of episode s" in result.stderr


@pytest.mark.slow
def test_run_ends_a_silent_command_that_lost_an_episode(run, tmp_path, monkeypatch):
    from mitigate.bridge import attempt

    monkeypatch.setattr(attempt, "MAX_SILENCE", 2)  # times patience
    program = tmp_path / "agent.py"
    program.write_text(
        "import mitigate_hook, numpy, os, time\n"
        "first = mitigate_hook.connect('a')\nfirst.corrupt({'rgb': numpy.zeros((8, 8, 3), 'u1')})\n"
        "mitigate_hook.connect('b')\ntime.sleep(60)\n"
    )
    result = run(tmp_path / "o", "conditions=[clean] patience=1", f"{sys.executable} {program}")
    assert result.returncode == 1 and "ended in the middle of episode a" in result.stderr


def test_run_ends_a_command_when_interrupted_at_its_start(run, tmp_path, monkeypatch):
    from mitigate.bridge import program

    started = []

    class Interrupted(subprocess.Popen):
        def __init__(self, *arguments, **options):
            super().__init__(*arguments, **options)
            started.append(self)
            os.kill(os.getpid(), signal.SIGINT)

    monkeypatch.setattr(program.subprocess, "Popen", Interrupted)
    with pytest.raises(KeyboardInterrupt):
        run(tmp_path / "o", "conditions=[clean]", f"{AGENT} --pause 5")
    assert started[0].poll() is not None


@pytest.mark.slow
def test_run_accepts_separate_calls_for_rgb_and_depth(run, tmp_path):
    program = tmp_path / "nav.py"
    program.write_text(
        "import mitigate_hook, numpy\n"
        "rgb, depth = numpy.full((8, 8, 3), 90, 'u1'), numpy.full((8, 8, 1), 2, 'f4')\n"
        "for name in 'ab':\n    episode = mitigate_hook.connect(name)\n"
        "    for _ in range(3):\n"
        "        seen = [episode.corrupt({'rgb': rgb}), episode.corrupt({'depth': depth})]\n"
        "    print((seen[0]['rgb'] != rgb).any(), (seen[1]['depth'] != depth).any())\n"
        "    episode.finish(success=1)\n"
    )
    out = tmp_path / "o"
    result = run(out, "conditions=[low_light,missing_data]", f"{sys.executable} {program}")
    assert result.returncode == 0 and "not applicable" not in result.stdout, result.stderr
    printed = [(out / f"conditions/{n}-s0.6/output.txt").read_text()
             for n in ("low_light", "missing_data")]  # fmt: skip
    assert printed == ["True False\n" * 2, "False True\n" * 2]
    assert (out / "conditions/clean/events.jsonl").read_text().count('"spec"') == 2


def test_run_chooses_episodes_again_after_a_failed_run(run, tmp_path, monkeypatch):
    from mitigate.bridge import plan

    monkeypatch.setattr(plan, "Subset", partial(Subset, settled=0.0))
    program, out = tmp_path / "nav.py", tmp_path / "o"
    begin = "import mitigate_hook, numpy\nrgb = numpy.zeros((8, 8, 3), 'u1')\n"
    program.write_text(f"{begin}mitigate_hook.wanted([('k', n) for n in range(3)])\n")
    assert run(out, "conditions=[clean] episodes=2", f"{sys.executable} {program}").returncode == 1
    program.write_text(
        f"{begin}for scene, name in mitigate_hook.wanted([('k', n) for n in range(90)]):\n"
        "    episode = mitigate_hook.connect(name, scene=scene)\n"
        "    episode.corrupt({'rgb': rgb})\n    episode.finish(success=1)\n"
    )
    for _ in range(2):
        result = run(out, "conditions=[clean] episodes=2", f"{sys.executable} {program}")
        assert "2 episodes" in result.stdout and result.returncode == 0
    assert json.loads((out / "episodes.json").read_text())["of"] == 90


@pytest.mark.slow
def test_run_does_not_finish_condition_that_lost_an_episode(run, tmp_path):
    """The agent's command ends with status 0, although one of its workers was killed."""
    out = tmp_path / "o"
    result = run(out, "conditions=[clean]", f"{AGENT} --workers 4 --die-at 1 --die-worker 2")
    assert result.returncode == 1 and "1 episode was left unfinished, such as s0/2" in result.stderr
    assert not (out / "conditions" / "clean" / "done.json").exists()


def test_run_rejects_the_folder_of_a_running_run(run, tmp_path):
    folder = tmp_path / "o" / "conditions" / "clean"
    folder.mkdir(parents=True)
    with open(folder / "lock", "w") as handle:
        fcntl.flock(handle, fcntl.LOCK_EX)
        result = run(tmp_path / "o", "conditions=[clean]")
    assert result.returncode == 1 and "Another run is using" in result.stderr


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ("patience=0", "patience must be 1 to 3600 seconds, got 0"),
        ("severity=0", "severity=0 changes nothing"),
        ("~suite.conditions", "suite has no conditions"),
        ("episodes=3 patience=3", "patience must be >= 5 seconds with episodes=3"),
    ],
)
def test_run_rejects_invalid_options(run, tmp_path, options, words):
    assert words in run(tmp_path / "o", options).stderr


@pytest.mark.slow
def test_run_skips_instruction_conditions_without_a_tokenizer(run, tmp_path):
    result = run(tmp_path / "o", "conditions=[capitalize,low_light,mask]", f"{AGENT} --tokens")
    assert result.returncode == 1 and "Without a tokenizer" in result.stderr
    refused, started = (
        result.stdout.index(text) for text in ("capitalize-s0.6, mask", "low_light-s0.6: s")
    )
    assert refused < started and not (tmp_path / "o/conditions/mask-s0.6").exists()
    measured = {row["corruption"] for row in rows.read(tmp_path / "o" / "rows.jsonl")}
    assert measured == {"clean", "low_light"}


def test_select_applicable_counts_instructions_in_other_languages(tmp_path, capsys):
    events = [
        {"event": "episode", "scene": "s", "episode": str(i), "text": "x", "language": spoken}
        for i, spoken in enumerate(["hi-IN", "en-GB", None, "hi-IN"])
    ]
    (tmp_path / EVENTS).write_text("".join(json.dumps(event) + "\n" for event in events))
    reports = read(tmp_path)
    cells = [
        SimpleNamespace(
            reports=lambda: reports, corruption=met, condition=Condition(met, 0, Words())
        )
        for met in (CLEAN, Corruption("mask", 0.6))
    ]
    assert run_module._select_applicable(cells) == (cells[1:], [])
    message = "run: instructions in other languages passed through unchanged: 2 in hi-IN\n"
    assert capsys.readouterr().out == message
    assert run_module._select_applicable(cells[:1]) == ([], []) and not capsys.readouterr().out


def test_hook_runs_the_sitecustomize_that_it_hides(run, tmp_path):
    (tmp_path / "own").mkdir()
    (tmp_path / "own" / "sitecustomize.py").write_text("print('the own one ran')\n")
    result = run(tmp_path / "o", "conditions=[clean]", PYTHONPATH=str(tmp_path / "own"))
    assert result.returncode == 0, result.stderr
    assert "the own one ran" in (tmp_path / "o/conditions/clean/output.txt").read_text()


def test_help_explains_every_option():
    printed = options_text("run")
    assert printed.count("\n") > 20 and "tokenizer: null  # for agents" in printed


def test_split_command_separates_options_and_command():
    assert split_command(["suite=full", "--", "bash", "run.sh", "--", "x"]) == (
        ["suite=full"],
        ["bash", "run.sh", "--", "x"],
    )
    assert split_command(["suite=full"]) == (["suite=full"], [])


@pytest.mark.parametrize(
    ("command", "name"),
    [
        ("conda run -n etpnav bash run_r2r/main.bash eval 2333", "main"),
        ("python -m vlfm.run", "vlfm.run"),
        ("python -m torch.distributed.launch train.py", "train"),
        ("./agent 7", "agent"),
        ("python main_llm_vis.py --split val", "main_llm_vis"),
    ],
)
def test_command_name_names_script_or_module(command, name):
    assert command_name(command.split()) == name


@pytest.mark.slow
def test_run_says_how_to_resume_after_a_signal(tmp_path):
    agent = [sys.executable, str(LAB / "agent.py"), str(tmp_path / "seen"), "--pause", "5"]
    process = subprocess.Popen(
        [
            sys.executable,
            "-m",
            "mitigate",
            "run",
            f"out={tmp_path / 'o'}",
            "suite=clean",
            "--",
            *agent,
        ],
        env={**os.environ, "PYTHONPATH": str(LAB)},
        stderr=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        text=True,
        # a background job ignores SIGINT
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    events = tmp_path / "o" / "conditions" / "clean" / "events.jsonl"
    for _ in range(1200):  # wait up to a minute, because other work may use the cores
        if events.is_file():
            break
        time.sleep(0.05)
    for _ in range(3):  # Python drops a signal that arrives during a fork, so it is sent again
        process.send_signal(signal.SIGINT)
        try:
            printed = process.communicate(timeout=20)[1]
            break
        except subprocess.TimeoutExpired:
            continue
    assert process.returncode == 130 and "SIGINT: stopped. To resume: " in printed
    assert f"suite=clean -- {shlex.join(agent)}" in printed


def test_run_lists_the_launchers(monkeypatch):
    monkeypatch.setattr(sys, "argv", ["mitigate run", "launcher=foo", "--", "true"])
    monkeypatch.delenv("HYDRA_FULL_ERROR", raising=False)
    monkeypatch.setattr(run_module.signal, "signal", lambda *_: None)
    with pytest.raises(SystemExit, match="Choose one of: local, ray, slurm."):
        run_module.main()


def test_run_prints_little_of_a_command_that_prints_much(run, tmp_path):
    """Issue T2, item 9."""
    code = "import sys; sys.stdout.write('x' * (50 << 20) + chr(27) + '[31m'); sys.exit(3)"
    command = f"{sys.executable} -c {shlex.quote(code)}"
    result = run(tmp_path / "o", "conditions=[clean]", command)
    assert "the command ended with status 3" in result.stderr
    assert len(result.stderr) < 1000 and "\x1b" not in result.stderr
    assert result.stderr.count("xxx ... xxx") == 1
