"""``mitigate replay``: what agents answer along a drive, and what a corruption changes of it."""

from __future__ import annotations

import errno
import json
import math
import shlex
import sys
from dataclasses import replace

import numpy as np
import pytest
from omegaconf import OmegaConf

from mitigate import cli
from mitigate.agents.recurrent.policy import Odometer
from mitigate.core.conf import load_config
from mitigate.core.locks import FolderLock
from mitigate.core.observation import DEPTH, FORWARD, LEFT, POSE, RGB, RIGHT, STOP
from mitigate.corruptions import CLEAN, Corruption
from mitigate.evaluation import episode_lists
from mitigate.guards.frames.restorer import Restorer
from mitigate.guards.guard import Guard, Guards
from mitigate.replay import export_drive, replay, report
from mitigate.replay.export_drive import write_frames
from mitigate.replay.walk import Answers, _share, compare, walk
from mitigate.worlds.apartments.tasks import load_episodes
from mitigate.worlds.recorded import Recording, open_recording
from mitigate.worlds.recorded.recording import NONE, answered

T = 30


class ByBrightness:
    """Goes on in bright frames and turns in dark ones; remembers what it was told."""

    views = 1

    def reset(self, instruction):
        self.told, self.heard = instruction, []

    def act(self, observation):
        return FORWARD if observation[RGB].mean() > 100 else RIGHT

    def taken(self, action, metres, radians):
        self.heard.append((action, round(metres, 3), round(radians, 3)))


def drive(name="lab", driven=None) -> Recording:
    rng = np.random.default_rng(0)
    frames = {
        RGB: rng.integers(120, 255, (T, 16, 16, 3), np.uint8),
        DEPTH: rng.uniform(1, 5, (T, 16, 16, 1)).astype(np.float32),
    }
    poses = np.stack([np.zeros(T), 0.25 * np.arange(T), np.zeros(T)], 1)
    done = None if driven is None else answered(np.array(driven))
    return Recording(name, "go on", frames, np.arange(T) * 1.0, poses, done)


def test_an_agent_is_shown_every_step_and_told_what_the_driver_did():
    agent, driven = ByBrightness(), [FORWARD] * (T - 1) + [STOP]
    found = walk(agent, drive(driven=driven), CLEAN, 0)
    assert agent.told == "go on"
    assert found.actions.tolist() == [FORWARD] * T
    assert agent.heard == [(FORWARD, 0.25, 0.0)] * (T - 1) + [(STOP, 0.0, 0.0)]


def test_a_restorer_goes_over_the_frames_before_the_agent_does():
    dark, looks = Corruption("low_light", 1.0), []

    class Brightened(Guard):
        def observe(self, observation):
            looks.append(observation)
            return {**observation, RGB: np.full_like(observation[RGB], 200)}

    assert set(walk(ByBrightness(), drive(), dark, 0).actions.tolist()) == {RIGHT}
    found = walk(ByBrightness(), drive(), dark, 0, keep=[2], guards=Guards([Brightened()]))
    assert found.actions.tolist() == [FORWARD] * T and len(looks) == T
    assert (found.seen[2][RGB] == 200).all()


def test_the_table_says_which_restorer_the_frames_went_through():
    made = drive()
    answers = {made.name: walk(ByBrightness(), made, CLEAN, 0)}
    found = {"mine": {"clean": compare([made], answers, answers)}}
    restorer = Restorer(sensors=[RGB], width=4)
    said = f"Frames of rgb went through the restorer `{restorer.hash}`."
    assert said in report.table(found, 0.6, T, 1, Guards([restorer]))
    assert "restorer" not in report.table(found, 0.6, T, 1)


def test_where_nobody_knows_who_drove_all_walks_are_told_the_clean_answers():
    agent, clean = ByBrightness(), walk(ByBrightness(), drive(), CLEAN, 0)
    dark = walk(agent, drive(), Corruption("low_light", 0.9), 0, clean=clean)
    assert (dark.actions == RIGHT).mean() > 0.9
    assert agent.heard == [(FORWARD, 0.25, 0.0)] * T


def test_a_corruption_changes_the_answers_and_is_the_same_again():
    dark = Corruption("low_light", 0.9)
    first, second = (walk(ByBrightness(), drive(), dark, 3, keep=[4]) for _ in range(2))
    assert (first.actions == RIGHT).mean() > 0.9
    assert np.array_equal(first.seen[4][RGB], second.seen[4][RGB])
    assert first.seen[4][RGB].mean() < drive().frames[RGB][4].mean()


def test_an_agent_that_reads_no_depth_keeps_everything_under_depth_corruption():
    clean = walk(ByBrightness(), drive(), CLEAN, 0)
    holes = walk(ByBrightness(), drive(), Corruption("missing_data", 0.9), 0)
    assert np.array_equal(clean.actions, holes.actions)


def test_a_drive_without_what_the_agent_reads_says_so():
    half = drive()
    half = Recording("lab", "go", {DEPTH: half.frames[DEPTH]}, half.times, half.poses, None)
    with pytest.raises(ValueError, match="lab does not fit ByBrightness"):
        walk(ByBrightness(), half, CLEAN, 0)


def answers(actions, aims=None) -> Answers:
    aims = np.full((len(actions), 2), np.nan) if aims is None else aims
    return Answers(np.array(actions), aims)


def test_an_interval_holds_its_own_value_however_long_the_drives_are():
    """Short drives are runs of few steps, which must not count as much as whole ones."""
    walks = [np.zeros(14, bool)] * 40 + [np.ones(1, bool)] * 20
    found = _share(walks)
    assert found.value == pytest.approx(20 / 580)
    assert found.low < found.value < found.high < 0.1


def test_changes_are_counted_against_clean_answers_and_against_the_driver():
    drives = [drive("a", [FORWARD] * T), drive("b", [LEFT] * T)]
    clean = {"a": answers([FORWARD] * T), "b": answers([FORWARD] * (T - 1) + [STOP])}
    found = {"a": answers([FORWARD] * 15 + [STOP] * 15), "b": answers([FORWARD] * T)}
    changes = compare(drives, clean, found)
    assert changes.changed.value == pytest.approx(16 / 60)
    assert changes.changed.low < 16 / 60 < changes.changed.high
    assert (changes.stops, changes.missed, changes.steps) == (15, 1, 60)
    assert changes.agreement.value == pytest.approx(15 / 60)
    assert changes.aim is None


def test_steps_that_no_action_names_count_for_no_agreement():
    back = drive("a", [NONE] * 10 + [FORWARD] * 20)
    same = {"a": answers([FORWARD] * T)}
    assert compare([back], same, same).agreement.value == 1.0


def test_a_short_drive_has_an_honest_interval():
    short = compare([drive()], {"lab": answers([1] * 10)}, {"lab": answers([1, 2] * 5)})
    assert short.changed.low < 0.2 and short.changed.high > 0.8


def test_the_aim_is_compared_where_both_have_one():
    here, there = np.zeros((T, 2)), np.tile([3.0, 4.0], (T, 1))
    here[:5] = np.nan
    of = compare([drive()], {"lab": answers([1] * T, here)}, {"lab": answers([1] * T, there)})
    assert of.aim.value == 1.0


def test_an_odometer_counts_what_was_done_in_place_of_its_answer():
    told, own = Odometer(), Odometer()
    turn = math.radians(15)
    for answer, done, metres, radians in (
        (FORWARD, LEFT, 0.0, turn), (RIGHT, FORWARD, 0.25, 0.0), (LEFT, LEFT, 0.0, turn),
    ):  # fmt: skip
        told.add(answer)
        told.correct(done, metres, radians)
        own.add(done)
    assert np.allclose(told.moves(), own.moves(), atol=1e-6)


def test_an_odometer_counts_an_arc_as_it_was():
    odometer = Odometer()
    for _ in range(4):
        odometer.add(LEFT)
        odometer.correct(FORWARD, 0.5, math.radians(20))
    assert odometer.metres == pytest.approx(2.0)
    assert odometer.heading == pytest.approx(math.radians(80))


@pytest.fixture
def mitigate(monkeypatch, capsys):
    """Runs ``mitigate`` with some words; returns its status and what it printed and complained."""

    def run(*words: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", sys.argv)  # which it replaces
        with pytest.raises(SystemExit) as ended:
            cli.main(words)
        said, status = capsys.readouterr(), ended.value.code or 0
        if isinstance(status, str):  # what the interpreter prints at the end
            return 1, said.out, said.err + status
        return status, said.out, said.err

    return run


def test_the_command_writes_decisions_tables_and_pictures(tmp_path, mitigate):
    drives = str(tmp_path / "drives")
    status, _, wrong = mitigate("export_drive", drives, "episodes=1", "form=mcap", "env.size=64")
    assert status == 0, wrong
    (bag,) = [path for path in (tmp_path / "drives").iterdir() if path.is_dir()]
    out = tmp_path / "out"
    options = ("conditions=[foreign_object,missing_data]", f"out={out}")
    agents = "agents=[checkpoints/recurrent/base,checkpoints/recurrent/teacher]"
    status, printed, wrong = mitigate("replay", str(bag), agents, *options)
    assert status == 0, wrong
    lines = [json.loads(line) for line in (out / "decisions.jsonl").read_text().splitlines()]
    steps = max(line["step"] for line in lines) + 1
    assert len(lines) == 2 * 3 * steps
    assert {line["agent"] for line in lines} == {"recurrent", "recurrent_teacher"}
    clean = [line for line in lines if line["condition"] == "clean"]
    assert all(line["action"] == line["clean"] for line in clean)
    filtered = ("conditions=[missing_data]", f"out={tmp_path}/filtered", agents.split(",")[0] + "]")
    status, _, wrong = mitigate(
        "replay", str(bag), *filtered, "restore=tests.guards.filters:median"
    )
    assert status == 0, wrong
    table = (tmp_path / "filtered/table.md").read_text()
    assert "Frames of rgb went through the restorer `" in table
    assert (out / "changes.png").is_file() and (out / "table.md").is_file()
    assert json.loads((out / "replay.json").read_text())["drives"] == [str(bag)]
    assert "Foreign object" in printed


def test_a_restorer_of_what_a_drive_does_not_show_is_refused_before_a_frame_is_read(
    tmp_path, mitigate
):
    colours = tmp_path / "lab/rgb"
    colours.mkdir(parents=True)
    for number in range(3):
        (colours / f"{number:06d}.png").write_bytes(b"not even a picture")
    Restorer(sensors=[DEPTH], depth_width=4).save(tmp_path / "mine")
    options = (f"restore={tmp_path}/mine", "agents=[checkpoints/recurrent/base]")
    status, _, wrong = mitigate("replay", str(colours.parent), *options, f"out={tmp_path}/out")
    assert status == 1 and "is for depth, but lab shows rgb: leave restore= out" in wrong
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("name", ["table.md", "decisions.jsonl"])
def test_replay_rejects_a_folder_of_another_command(tmp_path, mitigate, name):
    (tmp_path / name).write_text("mine")
    options = ("agents=[checkpoints/recurrent/base]", f"out={tmp_path}")
    status, _, wrong = mitigate("replay", "drive", *options)
    assert status == 1 and f"{tmp_path / name} was not written by a replay" in wrong
    assert (tmp_path / name).read_text() == "mine"


@pytest.mark.parametrize(
    ("module", "options", "told"),
    [
        (replay, ["agents=[a]", "seed=1"], "To run it again"),
        (export_drive, ["episodes=1"], "To run it again, once what it wrote is deleted"),
    ],
)
def test_one_that_is_stopped_says_the_whole_command_and_does_not_promise_to_go_on(
    monkeypatch, mitigate, module, options, told
):
    def stopped(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(module, "run", stopped)
    name = module.__name__.rpartition(".")[2]
    status, _, said = mitigate(name, "my drive", *options)
    command = shlex.join(["mitigate", name, *options, "my drive"])
    assert status == 130 and f"SIGINT: stopped. {told}: {command}\n" in said


@pytest.mark.parametrize("form", ["frames", "bag", "mcap"])
def test_the_id_of_an_episode_is_no_path_and_a_drive_is_whole_or_not_there(
    tmp_path, form, monkeypatch
):
    options = [f"form={form}", "env.size=16", "episodes=2"]
    config = OmegaConf.to_object(load_config("export_drive", options))
    listed = [
        replace(e, episode_id=f"../../é.{n}") for n, e in enumerate(load_episodes("val_seen")[:2])
    ]
    monkeypatch.setattr(episode_lists, "episodes", lambda *_: listed)
    out = tmp_path / "a/b"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(export_drive, "write_bytes", full)
        patch.setattr(export_drive, "write_bag", full)
        with pytest.raises(OSError, match="No space left"):
            export_drive.run(config, out)
    assert [*out.iterdir()] == []
    written = export_drive.run(config, out)
    assert [path.stem for path in written] == ["é-0", "é-1"]
    assert [*tmp_path.iterdir()] == [tmp_path / "a"] and [*(tmp_path / "a").iterdir()] == [out]
    found = [open_recording(path)[0] for path in written]
    assert [drive.instruction for drive in found] == [e.instruction.text for e in listed]
    with pytest.raises(ValueError, match="is there already: name another folder"):
        export_drive.run(config, out)
    listed[:] = [replace(listed[0], episode_id=name) for name in ("a/b", "a.b")]
    with pytest.raises(ValueError, match="Two episodes would be the drive .*'a/b' and 'a.b'"):
        export_drive.run(config, tmp_path / "other")


def full(*_):
    raise OSError(errno.ENOSPC, "No space left on device")


@pytest.fixture
def lab(tmp_path):
    """A short drive in a folder."""
    rng, path = np.random.default_rng(0), tmp_path / "lab"
    frames = {RGB: rng.integers(0, 255, (16, 16, 3), np.uint8), DEPTH: np.ones((16, 16, 1))}
    write_frames(path, [frames | {POSE: np.array([0, n, 0])} for n in range(3)], "go on")
    return str(path)


def test_what_is_in_a_folder_stays_there_but_what_a_replay_wrote(tmp_path, lab, mitigate):
    out = tmp_path / "out"
    out.mkdir()
    (out / "mine.png").write_text("a picture of mine")
    options = ("agents=[checkpoints/recurrent/base]", "conditions=[flare]", f"out={out}")
    for _ in range(2):
        status, _, wrong = mitigate("replay", lab, *options)
        assert status == 0, wrong
        assert (out / "mine.png").read_text() == "a picture of mine"
        (out / "recurrent-flare.png").write_text("of the run before")
    status, _, wrong = mitigate("replay", lab, *options)
    kept = out / "recurrent-flare.png"
    assert status == 0 and (not kept.exists() or kept.read_bytes()[1:4] == b"PNG"), wrong
    assert not (out / ".lock").exists()


def test_a_folder_that_is_none_or_in_use_is_refused(tmp_path, lab, mitigate):
    out = tmp_path / "out"
    options = ("agents=[checkpoints/recurrent/base]", "conditions=[flare]", f"out={out}")
    out.write_text("a file")
    status, printed, wrong = mitigate("replay", lab, *options)
    assert status == 1 and "out is no folder" in wrong and "read lab" not in printed + wrong
    out.unlink()
    out.mkdir()
    for text, words in (("[1]", "is not what a replay writes"), ("{", "is cut short or damaged")):
        (out / "replay.json").write_text(text)
        status, _, wrong = mitigate("replay", lab, *options)
        assert status == 1 and words in wrong and "Name another folder (out=...)" in wrong
    (out / "replay.json").unlink()
    with FolderLock(out):
        status, _, wrong = mitigate("replay", lab, *options)
    assert status == 1 and "is in use" in wrong


def test_a_picture_that_cannot_be_written_is_no_picture_and_is_told(tmp_path):
    made = drive()
    clean = walk(ByBrightness(), made, CLEAN, 0)
    dark = walk(ByBrightness(), made, Corruption("low_light", 0.9), 0, keep=[4])
    (tmp_path / "a.png").mkdir()
    with pytest.raises(OSError, match="a.png"):
        report.picture(made, Corruption("low_light", 0.9), clean, dark, tmp_path / "a.png")
    found = {"a|b$\\frac{$": {"low_light": compare([made], {"lab": clean}, {"lab": dark})}}
    with pytest.raises(OSError, match="a.png"):
        report.heatmap(found, 0.6, tmp_path / "a.png")
    assert [path.name for path in tmp_path.iterdir()] == ["a.png"]
    assert "| a\\|b$" in report.table(found, 0.6, T, 1)
    assert report.heatmap(found, 0.6, tmp_path / "b.png").is_file()  # a name is no formula


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ([], "FOLDER_OR_BAG"),
        (["none"], "no recording"),
        (["tests", "agents=[checkpoints/nothing]"], "nothing"),
        (["tests", "agents=[checkpoints/restorer]"], "the card of another kind of folder"),
        (["tests", "conditions=[fog2]"], "fog2"),
        (["tests", "suite=clean"], "nothing to compare"),
        (["tests", "colour=red"], "colour"),
    ],
)
def test_a_users_mistake_is_one_paragraph(options, says, mitigate):
    status, _, wrong = mitigate("replay", *(options or ["seed=1"]))
    assert status != 0 and "Traceback" not in wrong
    assert says in wrong
