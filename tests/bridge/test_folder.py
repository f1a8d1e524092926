"""Tests of the folder of ``mitigate run``: complete conditions, repeated conditions, and the result
table."""

import json
import re
import shutil
import sys

import pytest

from mitigate.bridge import run as bridge_run
from mitigate.bridge.cell import hash_files, write_done
from mitigate.bridge.plan import Plan, default_folder, make_cells
from mitigate.bridge.results import read
from mitigate.core.files import sha256
from mitigate.core.output import FolderLostError
from mitigate.evaluation import rows
from mitigate.worlds.measures import RULES

from .conftest import config

PROGRAM = """
import os, sys, numpy, mitigate_hook
frame = numpy.full((8, 8, 3), 90, 'uint8')
for name in 'abcd':
    episode = mitigate_hook.connect(name, instruction='Go to the door.')
    try:
        seen = episode.corrupt({'rgb': frame})['rgb']
        if name in sys.argv[2:] and (seen != frame).any():
            raise RuntimeError('the agent is lost')
        episode.corrupt({'rgb': frame})
    except RuntimeError:
        continue
    episode.finish(success=name < 'c')
"""


@pytest.fixture
def program(tmp_path):
    """A program whose loop fails in some episodes if a frame is corrupted."""
    file = tmp_path / "nav.py"
    file.write_text(PROGRAM)
    return f"{sys.executable} {file} x"


def finish_again(folder):
    """Mark the condition as finished, with the number of episodes that its events now report."""
    entries = json.loads((folder / "done.json").read_text())
    write_done(folder, entries | {"episodes_told": len(read(folder).ends)})


def measured(out):
    """Return the set of conditions (corruption, severity) in the rows."""
    return {(row["corruption"], row["severity"]) for row in rows.read(out / "rows.jsonl")}


@pytest.mark.slow
def test_run_reports_unfinished_episodes(run, program, tmp_path):
    out = tmp_path / "o"
    result = run(out, "conditions=[low_light]", f"{program} a c")
    assert result.returncode == 1 and "2 episodes were left unfinished, such as a" in result.stderr
    assert "episode.finish(success=False)" in result.stderr
    folder = out / "conditions" / "low_light-s0.6"
    assert not (folder / "done.json").exists() and measured(out) == {("clean", 0.0)}


@pytest.mark.slow
def test_run_repeats_a_condition_that_lacks_episodes_of_clean(run, program, tmp_path):
    out = tmp_path / "o"
    assert run(out, "conditions=[low_light]", program).returncode == 0
    events = out / "conditions" / "low_light-s0.6" / "events.jsonl"
    remaining = [
        line for line in events.read_text().splitlines() if '"end"' not in line or "b" in line
    ]
    events.write_text("\n".join(line for line in remaining if '"episode": "a"' not in line) + "\n")
    finish_again(events.parent)
    again = run(out, "conditions=[low_light]", program)
    assert again.returncode == 0 and "of clean's 4 episodes" in again.stdout
    assert "clean: done before" in again.stdout and "low_light-s0.6: started" in again.stdout


@pytest.mark.slow
def test_run_reports_an_episode_that_never_began(run, program, tmp_path):
    folder = tmp_path / "o" / "conditions"
    assert run(tmp_path / "o", "conditions=[clean]", program).returncode == 0
    with open(folder / "clean" / "events.jsonl", "a") as file:
        file.write('{"event": "end", "scene": "", "episode": "z", "metrics": {"success": 1}}\n')
    finish_again(folder / "clean")
    result = run(tmp_path / "o", "conditions=[low_light]", program)
    assert (
        result.returncode == 1 and "1 of clean's 5 episodes is missing, such as z" in result.stderr
    )


BACKGROUND = """
import os, sys, time, numpy, mitigate_hook
frame = numpy.full((8, 8, 3), 90, 'uint8')
if os.fork() and not mitigate_hook.connect('own').corrupt({'rgb': frame}).get('x'):
    mitigate_hook._thread.session.end({'success': 1})
    time.sleep(0.5)
    os._exit(0)
%s
episode = mitigate_hook.connect('late')
episode.corrupt({'rgb': frame})
time.sleep(30)
"""


@pytest.mark.parametrize("session", ["", pytest.param("os.setsid()", marks=pytest.mark.slow)])
def test_run_reports_the_episode_of_a_background_process(run, tmp_path, monkeypatch, session):
    from mitigate.bridge import attempt

    monkeypatch.setattr(
        attempt, "DISCONNECT_TIME", 0.5
    )  # the time that the command waits for processes in a separate session
    file = tmp_path / "nav.py"
    file.write_text(BACKGROUND % session)
    result = run(tmp_path / "o", "conditions=[clean]", f"{sys.executable} {file}")
    assert result.returncode == 1 and "1 episode was left unfinished, such as late" in result.stderr
    assert not (tmp_path / "o/conditions/clean/done.json").exists()


@pytest.mark.slow
def test_run_repeats_clean_if_it_lacks_episodes(run, tmp_path):
    out, file = tmp_path / "o", tmp_path / "nav.py"
    lost = "for name in 'abcd':\n    if name == 'd' and sys.argv[1] == 'clean': break\n"
    file.write_text(PROGRAM.replace("for name in 'abcd':\n", lost))
    result = run(out, "conditions=[low_light,spatter]", f"{sys.executable} {file} {{condition}}")
    assert (
        result.returncode == 1
        and "1 episode ended under it that the clean run lacks" in result.stderr
    )
    assert not list(out.glob("conditions/*/done.json")) and not (out / "rows.jsonl").exists()
    file.write_text(PROGRAM)
    result = run(out, "conditions=[low_light]", f"{sys.executable} {file} {{condition}}")
    assert result.returncode == 0 and "clean: started" in result.stdout


@pytest.mark.slow
def test_table_holds_all_finished_conditions(run, program, tmp_path):
    out = tmp_path / "o"
    run(out, "conditions=[low_light,spatter]", program)
    result = run(out, "conditions=[flare] severity=0.3", program)
    assert result.returncode == 0, result.stderr
    assert "measured before: low_light-s0.6, spatter-s0.6" in result.stdout
    expected = {("clean", 0.0), ("low_light", 0.6), ("spatter", 0.6), ("flare", 0.3)}
    assert measured(out) == expected and (out / "severity.png").exists()


@pytest.mark.slow
def test_table_leaves_out_other_settings(run, program, tmp_path):
    out = tmp_path / "o"
    run(out, "conditions=[low_light]", program)
    file = out / "conditions" / "low_light-s0.6" / "done.json"
    file.write_text(json.dumps(json.loads(file.read_text()) | {"seed": 7}))
    result = run(out, "conditions=[flare]", program)
    assert "low_light-s0.6: measured before, but not in the table: another seed" in result.stdout
    assert measured(out) == {("clean", 0.0), ("flare", 0.6)}


@pytest.mark.slow
def test_table_starts_with_the_requested_rule(run, tmp_path):
    out = tmp_path / "o"
    result = run(out, "conditions=[spatter] rule=objectnav")
    assert result.returncode == 0 and not list(out.glob("severity*.png"))
    text = (out / "table.md").read_text()
    first, second = re.findall("Success: (.+). Agents", text)
    assert first == str(RULES["objectnav"]) > second and "![severity" not in text


@pytest.mark.slow
def test_run_names_a_changed_program(run, program, tmp_path):
    out = tmp_path / "o"
    first = run(out, "conditions=[spatter]", program)
    assert "nothing was left" not in first.stdout
    (tmp_path / "nav.py").write_text(PROGRAM + "# edited\n")
    again = run(out, "conditions=[spatter]", program)
    assert again.returncode == 0 and "nothing was left to run" in again.stdout
    assert "nav.py changed since clean, spatter-s0.6 were run" in again.stdout


def test_run_names_a_program_that_changes_during_it(run, tmp_path):
    file = tmp_path / "nav.py"
    file.write_text(PROGRAM + "open(__file__, 'a').write('#')\n")
    result = run(tmp_path / "o", "conditions=[clean]", f"{sys.executable} {file} x")
    assert result.returncode == 0 and "nav.py changed since clean was run" in result.stdout


def test_run_mentions_crashes_on_corrupted_input_only_if_it_is_corrupted(run, tmp_path):
    file = tmp_path / "nav.py"
    file.write_text(PROGRAM.replace("(seen != frame).any()", "True"))
    result = run(tmp_path / "o", "conditions=[spatter]", f"{sys.executable} {file} x a")
    assert "1 episode was left unfinished" in result.stderr and "env.close()" in result.stderr
    assert "corrupted input" not in result.stderr


def test_run_ignores_a_file_that_the_command_creates(run, tmp_path):
    file, result_file = tmp_path / "nav.py", tmp_path / "out.json"
    file.write_text(PROGRAM + "open(sys.argv[2], 'a').write('1')\n")
    command = f"{sys.executable} {file} {{condition}} {result_file}"
    for _ in range(2):
        result = run(tmp_path / "o", "conditions=[spatter]", command)
        assert result.returncode == 0 and "changed since" not in result.stdout
    assert result_file.read_text() == "11"


def test_hash_files_finds_files_in_a_command(tmp_path):
    file = tmp_path / "nav.py"
    file.write_text("pass")
    words = ["python", "-c", "print(5)" * 99, str(file), f"--config={file}", str(tmp_path), "\0"]
    assert hash_files(words) == {str(file): {"size": 4, "sha256": sha256(file)}}


def test_run_repeats_a_condition_to_record_it(run, program, tmp_path):
    out, record = tmp_path / "o", tmp_path / "recorded"
    run(out, "conditions=[clean]", program)
    result = run(out, f"conditions=[clean] record={record}", program)
    assert "clean: started, measured again: it was not recorded in" in result.stdout
    assert (record / "clean" / "unnamed" / "d" / "end.json").exists()
    for options in (f"conditions=[clean] record={record}", "conditions=[clean]"):
        assert "clean: done before" in run(out, options, program).stdout


def test_run_stops_after_clean_without_results(run, tmp_path, monkeypatch):
    from mitigate.bridge import results

    monkeypatch.setattr(results, "rows", lambda *_: [])
    result = run(tmp_path / "o", "conditions=[spatter]")
    assert (
        result.returncode == 1
        and "none of 4 episodes that ended reported a result" in result.stderr
    )
    assert "spatter" not in result.stdout and result.stdout.count("reported a result") == 0


def test_run_fails_if_a_worker_stops_itself(run, tmp_path):
    program = tmp_path / "agent.py"
    program.write_text(
        "import mitigate_hook, numpy, os\n"
        "if os.fork() == 0:\n"
        "    mitigate_hook.connect('w').corrupt({'image': numpy.zeros((9, 9, 3))})\n"
        "os.wait()\n" + PROGRAM
    )
    result = run(tmp_path / "o", "conditions=[clean]", f"{sys.executable} {program}")
    assert (
        result.returncode == 1
        and "the entry image of an observation may be a frame" in result.stderr
    )


def make_attempt(options, folder):
    """Return the first condition and the default folder of a run with ``options``."""
    typed = config(*options)
    return make_cells(Plan(typed, ("nav",), "nav", folder))[0], default_folder(typed, "nav")


def test_safeguard_changes_agent_and_folder(tmp_path):
    plain, folder = make_attempt(["conditions=[clean]"], tmp_path)
    guarded, other = make_attempt(["conditions=[clean]", "safeguard=rules"], tmp_path)
    assert (
        plain.label["agent"] != guarded.label["agent"] and guarded.label["name"] == "nav+classifier"
    )
    assert [name for name in plain.settings if plain.settings[name] != guarded.settings[name]] == [
        "safeguard"
    ]
    assert folder.name == "nav-s0.6" and other.name == "nav-classifier-s0.6"
    assert make_attempt(["conditions=[clean]", "episodes=60"], tmp_path)[1].name == "nav-s0.6-e60"


LOSE = """
import numpy, shutil, sys, time, mitigate_hook
for name in 'ab':
    episode = mitigate_hook.connect(name, instruction='Go to the door.')
    episode.corrupt({'rgb': numpy.full((8, 8, 3), 90, 'uint8')})
    if name == 'b':
        shutil.rmtree(sys.argv[1])
        time.sleep(2)
    episode.finish(success=True)
"""


@pytest.mark.parametrize("lost", ["o/conditions/clean", "o"])
def test_run_notices_a_lost_folder(run, tmp_path, lost):
    (tmp_path / "nav.py").write_text(LOSE)
    command = f"{sys.executable} {tmp_path / 'nav.py'} {tmp_path / lost}"
    with pytest.raises(FolderLostError, match="removed or replaced .* run the same command again"):
        print(run(tmp_path / "o", "conditions=[clean]", command))
    assert not (tmp_path / "o" / "table.md").exists()


@pytest.mark.slow
def test_run_notices_a_finished_condition_that_is_lost(run, program, tmp_path, monkeypatch):
    run_here = bridge_run._run_here

    def lose(waiting, jobs):
        problems = run_here(waiting, jobs)
        for cell in waiting:
            if cell.name != "clean":
                shutil.rmtree(cell.folder)
        return problems

    monkeypatch.setattr(bridge_run, "_run_here", lose)
    result = run(tmp_path / "o", "conditions=[low_light]", program)
    assert result.returncode == 1 and "low_light-s0.6: its result in" in result.stderr


@pytest.mark.parametrize("name", ["lock", "output.txt", "events.jsonl"])
def test_run_does_not_write_through_a_link(run, program, tmp_path, name):
    folder = tmp_path / "o" / "conditions" / "clean"
    folder.mkdir(parents=True)
    (tmp_path / "thesis.txt").write_text("mine")
    (folder / name).symlink_to(tmp_path / "thesis.txt")
    result = run(tmp_path / "o", "conditions=[clean]", program)
    assert (tmp_path / "thesis.txt").read_text() == "mine"
    if name == "lock":
        assert result.returncode == 1 and "lock must be a regular file" in result.stderr
    else:  # files of an earlier attempt are moved away, and the run succeeds
        assert result.returncode == 0 and (folder / name).is_file()


def test_run_rejects_a_linked_folder_of_a_condition(run, program, tmp_path):
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "o").mkdir()
    (tmp_path / "o" / "conditions").symlink_to("../elsewhere")
    result = run(tmp_path / "o", "conditions=[clean]", program)
    assert (
        result.returncode == 1
        and "conditions must be a folder, got a symbolic link" in result.stderr
    )
    assert not [*(tmp_path / "elsewhere").iterdir()]
