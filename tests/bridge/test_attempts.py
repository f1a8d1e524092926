"""Tests of how a condition starts, and of errors before and during its start."""

import fcntl
import json
import sys
from functools import partial

import pytest

from mitigate.bridge import plan
from mitigate.bridge.condition import Subset
from mitigate.bridge.hook import mitigate_hook
from mitigate.bridge.plan import Plan, default_folder, make_cells
from mitigate.bridge.results import read
from mitigate.bridge.server import Listener

from .conftest import condition, config, python

SKIPS = """
import json, os, sys, numpy, mitigate_hook
results = sys.argv[1]
done = json.load(open(results)) if os.path.exists(results) else []
for _, name in mitigate_hook.wanted([("", name) for name in "abc"]):
    if name in done:
        continue
    episode = mitigate_hook.connect(name)
    episode.corrupt({"rgb": numpy.full((8, 8, 3), 90, "uint8")})
    episode.finish(success=True)
    json.dump(done + [name], open(results, "w"))
    if len(sys.argv) > 2 and not done:
        sys.exit(3)  # it is broken off
"""


@pytest.fixture
def skips(tmp_path):
    """A program that skips the episodes in its results file, and dies after its first episode."""
    file = tmp_path / "nav.py"
    file.write_text(SKIPS)
    return f"{sys.executable} {file}"


@pytest.mark.slow
def test_attempt_begins_in_an_empty_folder(run, skips, tmp_path):
    out = tmp_path / "o"
    broken = run(out, "conditions=[clean]", f"{skips} {{out}}/results.json die")
    assert broken.returncode == 1 and (out / "conditions/clean/results.json").exists()
    again = run(out, "conditions=[spatter]", f"{skips} {{out}}/results.json")
    assert again.returncode == 0 and "clean: 3 episodes" in again.stdout, again.stderr
    aside = out / "conditions/clean.unfinished"
    assert json.loads((aside / "results.json").read_text()) == ["a"]
    assert (aside / "events.jsonl").exists()


@pytest.mark.slow
def test_attempt_keeps_finished_result_until_next_one_finishes(run, skips, tmp_path):
    out, recorded = tmp_path / "o", tmp_path / "recorded"
    options, fails = f"conditions=[clean] record={recorded}", tmp_path / "fails"
    guard = f"import os, sys\nif os.path.exists({str(fails)!r}): sys.exit(3)\n"
    (tmp_path / "nav.py").write_text(guard + SKIPS)
    assert not run(out, "conditions=[clean]", f"{skips} {{out}}/results.json").stderr
    fails.write_text("")
    for _ in range(2):
        assert "status 3" in run(out, options, f"{skips} {{out}}/results.json").stderr
    aside = out / "conditions/clean.finished"
    assert (aside / "results.json").exists()
    fails.unlink()
    assert not run(out, options, f"{skips} {{out}}/results.json").stderr
    assert (out / "conditions/clean/results.json").exists()


def test_run_explains_results_of_an_earlier_run(run, skips, tmp_path):
    (tmp_path / "all.json").write_text('["a", "b", "c"]')
    result = run(tmp_path / "o", "conditions=[clean]", f"{skips} {tmp_path}/all.json")
    assert "without an episode" in result.stderr and "Delete them" in result.stderr
    assert f"replaced by {tmp_path / 'o/conditions/clean'}" in result.stderr


def test_run_measures_other_conditions_if_one_is_locked(run, skips, tmp_path):
    folder = tmp_path / "o/conditions/spatter-s0.6"
    folder.mkdir(parents=True)
    with open(folder / "lock", "w") as handle:
        fcntl.flock(handle, fcntl.LOCK_EX)
        result = run(tmp_path / "o", "conditions=[spatter,flare]", f"{skips} {{out}}/results.json")
    assert "spatter-s0.6: Another run is using" in result.stderr and "flare" not in result.stderr
    assert (tmp_path / "o/conditions/flare-s0.6/done.json").exists()


def test_run_names_a_damaged_marker(run, skips, tmp_path):
    file = tmp_path / "o/conditions/clean/done.json"
    file.parent.mkdir(parents=True)
    file.write_text('{"seed": ')
    result = run(tmp_path / "o", "conditions=[clean]", f"{skips} {{out}}/results.json")
    assert f"{file} is truncated or damaged" in result.stderr


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ("missing=-5", "missing must be metres >= 0, got -5"),
        ("token_length=-5", "token_length must be >= 1, got -5"),
        ("split=", "split='' cannot be written to rows"),
        (f"name={'x' * 201}", "cannot be written to rows: a line of at most 200"),
    ],
)
def test_run_rejects_invalid_options_before_it_starts(run, tmp_path, options, words):
    assert words in run(tmp_path / "o", options).stderr
    assert not (tmp_path / "o").exists()


def test_run_rejects_a_file_as_recording(run, tmp_path):
    file = tmp_path / "recorded"
    file.write_text("")
    with pytest.raises(OSError, match=f"Cannot write {file}"):
        run(tmp_path / "o", f"conditions=[clean] record={file}")


def test_connection_names_a_write_error_of_the_run(tmp_path):
    from mitigate.bridge.recording import Recorder

    (tmp_path / "recorded").write_text("")
    met = condition(observer=Recorder(tmp_path / "recorded"))
    with Listener(met, tmp_path / "told") as listener:
        python(listener, "import mitigate_hook; mitigate_hook.connect('a')")
    problem = read(tmp_path / "told").problems[0]
    assert f"{tmp_path}/recorded must be a folder" in problem and "mitigate_hook.py" not in problem


def make_attempt(folder, *options):
    """Return the first condition and the default folder of a run with ``options``."""
    typed = config("conditions=[clean]", *options)
    return make_cells(Plan(typed, ("nav",), "nav", folder))[0], default_folder(typed, "nav")


def test_watch_changes_agent_and_folder(tmp_path, monkeypatch):
    file = tmp_path / "policy.yaml"
    file.write_text("good")
    plain, folder = make_attempt(tmp_path)
    assert plain.settings["watch"] is None and folder.name == "nav-s0.6"
    option = f"watch=[CKPT,{file}]"
    monkeypatch.setenv("CKPT", "good")
    known = [make_attempt(tmp_path, option)]
    assert known[0][0].settings["watch"]["CKPT"] == "good"
    monkeypatch.setenv("CKPT", "bad")
    known.append(make_attempt(tmp_path, option))
    file.write_text("bad")
    known.append(make_attempt(tmp_path, option))
    for part in (lambda one: one[0].label["agent"], lambda one: one[1].name):
        assert len({part(one) for one in [(plain, folder), *known]}) == 4


@pytest.mark.parametrize(
    ("name", "words"),
    [
        (
            "{}/polcy.yaml",
            "must be a file or an environment variable, and neither exists. Did you mean {}/",
        ),
        ("WATCHED_CKTP", "Did you mean WATCHED_CKPT?"),
        ("{}", "got the folder {}. Name the files in it"),
    ],
)
def test_watch_rejects_missing_names(run, tmp_path, monkeypatch, name, words):
    (tmp_path / "policy.yaml").write_text("good")
    monkeypatch.setenv("WATCHED_CKPT", "good")
    result = run(tmp_path / "o", f"watch=[{name.format(tmp_path)}]")
    assert words.format(tmp_path) in result.stderr and not (tmp_path / "o").exists()


def test_watch_reads_a_file_once(tmp_path, monkeypatch):
    file, read_files = tmp_path / "policy.yaml", []
    file.write_text("good")
    sha256 = plan.sha256
    monkeypatch.setattr(plan, "sha256", lambda path: read_files.append(path) or sha256(path))
    make_cells(Plan(config("suite=rgb", f"watch=[{file}]"), ("nav",), "nav", tmp_path))
    assert read_files == [str(file)]


def test_wanted_sends_names_in_parts(tmp_path):
    """The names of all episodes in a train split are too long for one message."""
    code = (
        "import mitigate_hook\nmitigate_hook.KEYS_PER_MESSAGE = 7\n"
        "print([n for _, n in mitigate_hook.wanted([('x.glb', n) for n in range(20)])])"
    )
    chosen = Subset(4, tmp_path, settled=0.0)
    with Listener(condition(chosen=chosen), tmp_path / "told") as listener:
        printed = python(listener, code).stdout
    expected = chosen.keep([f"x.glb/{n}" for n in range(20)])
    assert printed.strip() == str(expected) and len(expected) == 4
    assert json.loads((tmp_path / "episodes.json").read_text())["of"] == 20


def test_wanted_sends_no_names_without_a_choice(tmp_path):
    code = (
        "import mitigate_hook\nmitigate_hook._episode_key = None\n"
        "print(len(mitigate_hook.wanted([('x.glb', n) for n in range(20)])))"
    )
    with Listener(condition(), tmp_path) as listener:
        assert python(listener, code).stdout.strip() == "20"


@pytest.mark.parametrize("episodes", [["17", "18"], ["7"], [("a", "b", "c")], [5]])
def test_wanted_rejects_episodes_that_are_not_pairs(monkeypatch, episodes):
    monkeypatch.setenv(mitigate_hook.ADDRESS, "nowhere")
    with pytest.raises(ValueError, match="each episode of wanted\\(\\) must be a pair"):
        mitigate_hook.wanted(episodes)


@pytest.mark.slow
def test_run_explains_surplus_episodes(run, tmp_path, monkeypatch):
    from mitigate.bridge import plan

    monkeypatch.setattr(plan, "Subset", partial(Subset, settled=0.0))
    file = tmp_path / "nav.py"
    file.write_text(
        "import numpy, mitigate_hook\nfor shard in range(9):\n"  # each comes late
        "    for scene, name in mitigate_hook.wanted([('k', 9 * shard + n) for n in range(9)]):\n"
        "        episode = mitigate_hook.connect(name, scene=scene)\n"
        "        episode.corrupt({'rgb': numpy.zeros((8, 8, 3), 'u1')})\n"
        "        episode.finish(success=1)\n"
    )
    result = run(tmp_path / "o", "conditions=[clean] episodes=3", f"{sys.executable} {file}")
    assert (
        "episodes (3 asked for: some processes connected more than 4 s after the others"
        in result.stdout
    )
