"""Tests of ``mitigate replay``: the decisions of agents on a recorded drive, and how corruptions
change them."""

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
from mitigate.worlds.apartments import simulator
from mitigate.worlds.apartments.tasks import load_episodes
from mitigate.worlds.recorded import Recording, open_recording
from mitigate.worlds.recorded.recording import NO_ACTION, movements

T = 30


class ByBrightness:
    """An agent that moves in bright frames, turns in dark ones, and records all reported
    motions."""

    views = 1

    def reset(self, instruction):
        self.instruction = instruction
        self.movements = []

    def act(self, observation):
        return FORWARD if observation[RGB].mean() > 100 else RIGHT

    def taken(self, action, metres, radians):
        self.movements.append((action, round(metres, 3), round(radians, 3)))


def drive(name="lab", driven=None) -> Recording:
    rng = np.random.default_rng(0)
    frames = {
        RGB: rng.integers(120, 255, (T, 16, 16, 3), np.uint8),
        DEPTH: rng.uniform(1, 5, (T, 16, 16, 1)).astype(np.float32),
    }
    poses = np.stack([np.zeros(T), 0.25 * np.arange(T), np.zeros(T)], 1)
    movement = None if driven is None else movements(np.array(driven))
    return Recording(name, "go on", frames, np.arange(T) * 1.0, poses, movement)


def test_walk_informs_the_agent_of_the_driver():
    agent = ByBrightness()
    driven = [FORWARD] * (T - 1) + [STOP]
    decisions = walk(agent, drive(driven=driven), CLEAN, 0)
    assert agent.instruction == "go on"
    assert decisions.actions.tolist() == [FORWARD] * T
    assert agent.movements == [(FORWARD, 0.25, 0.0)] * (T - 1) + [(STOP, 0.0, 0.0)]


def test_walk_applies_guards_before_the_agent():
    dark = Corruption("low_light", 1.0)
    observations = []

    class Brighten(Guard):
        def observe(self, observation):
            observations.append(observation)
            return {**observation, RGB: np.full_like(observation[RGB], 200)}

    assert set(walk(ByBrightness(), drive(), dark, 0).actions.tolist()) == {RIGHT}
    restored = walk(ByBrightness(), drive(), dark, 0, keep=[2], guards=Guards([Brighten()]))
    assert restored.actions.tolist() == [FORWARD] * T and len(observations) == T
    assert (restored.seen[2][RGB] == 200).all()


def test_table_names_the_restorer():
    recording = drive()
    decisions = {recording.name: walk(ByBrightness(), recording, CLEAN, 0)}
    changes = {"mine": {"clean": compare([recording], decisions, decisions)}}
    restorer = Restorer(sensors=[RGB], width=4)
    sentence = f"Frames of rgb went through the restorer `{restorer.hash}`."
    assert sentence in report.table(changes, 0.6, T, 1, Guards([restorer]))
    assert "restorer" not in report.table(changes, 0.6, T, 1)


def test_walk_without_a_driver_informs_of_clean_decisions():
    agent, clean = ByBrightness(), walk(ByBrightness(), drive(), CLEAN, 0)
    dark = walk(agent, drive(), Corruption("low_light", 0.9), 0, clean=clean)
    assert (dark.actions == RIGHT).mean() > 0.9
    assert agent.movements == [(FORWARD, 0.25, 0.0)] * T


def test_walk_repeats_the_same_corruption():
    dark = Corruption("low_light", 0.9)
    first, second = (walk(ByBrightness(), drive(), dark, 3, keep=[4]) for _ in range(2))
    assert (first.actions == RIGHT).mean() > 0.9
    assert np.array_equal(first.seen[4][RGB], second.seen[4][RGB])
    assert first.seen[4][RGB].mean() < drive().frames[RGB][4].mean()


def test_walk_of_an_rgb_agent_ignores_depth_corruptions():
    clean = walk(ByBrightness(), drive(), CLEAN, 0)
    holes = walk(ByBrightness(), drive(), Corruption("missing_data", 0.9), 0)
    assert np.array_equal(clean.actions, holes.actions)


def test_walk_rejects_a_drive_without_a_sensor():
    full = drive()
    depth = Recording("lab", "go", {DEPTH: full.frames[DEPTH]}, full.times, full.poses, None)
    with pytest.raises(ValueError, match="lab lacks an input of ByBrightness"):
        walk(ByBrightness(), depth, CLEAN, 0)


def answers(actions, aims=None) -> Answers:
    aims = np.full((len(actions), 2), np.nan) if aims is None else aims
    return Answers(np.array(actions), aims)


def test_share_weights_blocks_by_length():
    """The blocks of short drives contain few steps, so they must have less weight than full
    blocks."""
    drives = [np.zeros(14, bool)] * 40 + [np.ones(1, bool)] * 20
    estimate = _share(drives)
    assert estimate.value == pytest.approx(20 / 580)
    assert estimate.low < estimate.value < estimate.high < 0.1


def test_compare_counts_changes_and_agreement():
    drives = [drive("a", [FORWARD] * T), drive("b", [LEFT] * T)]
    clean = {"a": answers([FORWARD] * T), "b": answers([FORWARD] * (T - 1) + [STOP])}
    corrupted = {"a": answers([FORWARD] * 15 + [STOP] * 15), "b": answers([FORWARD] * T)}
    changes = compare(drives, clean, corrupted)
    assert changes.changed.value == pytest.approx(16 / 60)
    assert changes.changed.low < 16 / 60 < changes.changed.high
    assert (changes.stops, changes.missed) == (15, 1)
    assert changes.agreement.value == pytest.approx(15 / 60)
    assert changes.aim is None


def test_compare_ignores_steps_without_an_action():
    back = drive("a", [NO_ACTION] * 10 + [FORWARD] * 20)
    same = {"a": answers([FORWARD] * T)}
    assert compare([back], same, same).agreement.value == 1.0


def test_compare_gives_a_short_drive_a_wide_interval():
    short = compare([drive()], {"lab": answers([1] * 10)}, {"lab": answers([1, 2] * 5)})
    assert short.changed.low < 0.2 and short.changed.high > 0.8


def test_compare_ignores_missing_aims():
    here, there = np.zeros((T, 2)), np.tile([3.0, 4.0], (T, 1))
    here[:5] = np.nan
    changes = compare([drive()], {"lab": answers([1] * T, here)}, {"lab": answers([1] * T, there)})
    assert changes.aim.value == 1.0


def test_odometer_replaces_an_action_by_the_movement():
    corrected = Odometer()
    direct = Odometer()
    turn = math.radians(15)
    for answer, done, metres, radians in (
        (FORWARD, LEFT, 0.0, turn), (RIGHT, FORWARD, 0.25, 0.0), (LEFT, LEFT, 0.0, turn),
    ):  # fmt: skip
        corrected.add(answer)
        corrected.correct(done, metres, radians)
        direct.add(done)
    assert np.allclose(corrected.moves(), direct.moves(), atol=1e-6)


def test_odometer_measures_an_arc():
    odometer = Odometer()
    for _ in range(4):
        odometer.add(LEFT)
        odometer.correct(FORWARD, 0.5, math.radians(20))
    assert odometer.metres == pytest.approx(2.0)
    assert odometer.heading == pytest.approx(math.radians(80))


@pytest.fixture
def mitigate(monkeypatch, capsys):
    """Run ``mitigate`` with arguments, and return its exit status, stdout and stderr."""

    def run(*words: str) -> tuple[int, str, str]:
        # makes pytest restore sys.argv, because the command replaces it
        monkeypatch.setattr(sys, "argv", sys.argv)
        with pytest.raises(SystemExit) as ended:
            cli.main(words)
        output = capsys.readouterr()
        status = ended.value.code or 0
        if isinstance(status, str):  # the message that the interpreter prints at exit
            return 1, output.out, output.err + status
        return status, output.out, output.err

    return run


@pytest.mark.slow
def test_replay_writes_decisions_tables_and_pictures(tmp_path, mitigate, monkeypatch):
    monkeypatch.setattr(simulator, "MAX_STEPS", 12)  # a short drive
    drives = str(tmp_path / "drives")
    status, _, errors = mitigate("export_drive", drives, "episodes=1", "form=mcap", "env.size=64")
    assert status == 0, errors
    (bag,) = [path for path in (tmp_path / "drives").iterdir() if path.is_dir()]
    out = tmp_path / "out"
    options = ("conditions=[foreign_object]", f"out={out}")
    agents = "agents=[checkpoints/recurrent/base,checkpoints/recurrent/teacher]"
    status, printed, errors = mitigate("replay", str(bag), agents, *options)
    assert status == 0, errors
    lines = [json.loads(line) for line in (out / "decisions.jsonl").read_text().splitlines()]
    steps = max(line["step"] for line in lines) + 1
    assert len(lines) == 2 * 2 * steps
    assert {line["agent"] for line in lines} == {"recurrent", "recurrent_teacher"}
    clean = [line for line in lines if line["condition"] == "clean"]
    assert all(line["action"] == line["clean"] for line in clean)
    filtered = ("conditions=[missing_data]", f"out={tmp_path}/filtered", agents.split(",")[0] + "]")
    status, _, errors = mitigate(
        "replay", str(bag), *filtered, "restore=tests.guards.filters:median"
    )
    assert status == 0, errors
    table = (tmp_path / "filtered/table.md").read_text()
    assert "Frames of rgb went through the restorer `" in table
    assert (out / "changes.png").is_file() and (out / "table.md").is_file()
    assert json.loads((out / "replay.json").read_text())["drives"] == [str(bag)]
    assert "foreign_object" in printed


def test_replay_rejects_an_unused_restorer_before_reading_frames(tmp_path, mitigate):
    colours = tmp_path / "lab/rgb"
    colours.mkdir(parents=True)
    for number in range(3):
        (colours / f"{number:06d}.png").write_bytes(b"not even a picture")
    Restorer(sensors=[DEPTH], depth_width=4).save(tmp_path / "mine")
    options = (f"restore={tmp_path}/mine", "agents=[checkpoints/recurrent/base]")
    status, _, errors = mitigate("replay", str(colours.parent), *options, f"out={tmp_path}/out")
    assert status == 1 and "is for depth, but lab shows rgb: omit restore=" in errors
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("name", ["table.md", "decisions.jsonl"])
def test_replay_rejects_a_folder_of_another_command(tmp_path, mitigate, name):
    (tmp_path / name).write_text("mine")
    options = ("agents=[checkpoints/recurrent/base]", f"out={tmp_path}")
    status, _, wrong = mitigate("replay", "drive", *options)
    assert status == 1 and f"{tmp_path / name} was not written by a replay" in wrong
    assert (tmp_path / name).read_text() == "mine"


@pytest.mark.parametrize(
    ("module", "options", "advice"),
    [
        (replay, ["agents=[a]", "seed=1"], "To run it again"),
        (export_drive, ["episodes=1"], "To run it again, after deleting what it wrote"),
    ],
)
def test_interrupted_command_prints_how_to_repeat_it(
    monkeypatch, mitigate, module, options, advice
):
    def stopped(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(module, "run", stopped)
    name = module.__name__.rpartition(".")[2]
    status, _, errors = mitigate(name, "my drive", *options)
    command = shlex.join(["mitigate", name, *options, "my drive"])
    assert status == 130 and f"SIGINT: stopped. {advice}: {command}\n" in errors


@pytest.mark.slow
def test_export_drive_writes_a_lerobot_dataset(tmp_path):
    pytest.importorskip("pyarrow", reason="needs pyarrow: pip install -e '.[lerobot]'")
    pytest.importorskip("av", reason="needs av: pip install -e '.[lerobot]'")
    options = ["form=lerobot", "env.size=16", "episodes=2"]
    config = OmegaConf.to_object(load_config("export_drive", options))
    export_drive.run(config, tmp_path / "drives")
    frames = OmegaConf.to_object(load_config("export_drive", ["env.size=16", "episodes=2"]))
    folders = export_drive.run(frames, tmp_path / "frames")
    episodes = open_recording(tmp_path / "drives")
    for drive, folder in zip(episodes, folders, strict=True):
        (expected,) = open_recording(folder)
        assert drive.instruction == expected.instruction
        assert np.allclose(drive.signals["observation.state"], expected.poses, atol=1e-5)
        assert drive.signals["action"][-1] == STOP
        every = range(len(drive.times))
        for one, two in zip(drive.frames(every), expected.frames(every), strict=True):
            assert np.array_equal(one["observation.images.front"], two[RGB])
            metres = one["observation.images.front_depth"]
            farthest = 10  # metres, of lerobot's codes
            assert np.allclose(metres, np.minimum(two[DEPTH], farthest), atol=3e-3)
    with pytest.raises(ValueError, match="must be a new or an empty folder"):
        export_drive.run(config, tmp_path / "drives")


@pytest.mark.parametrize("form", ["frames", "bag", "mcap"])
def test_export_drive_makes_safe_paths_and_whole_drives(tmp_path, form, monkeypatch):
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
    paths = export_drive.run(config, out)
    assert [path.stem for path in paths] == ["é-0", "é-1"]
    assert [*tmp_path.iterdir()] == [tmp_path / "a"] and [*(tmp_path / "a").iterdir()] == [out]
    drives = [open_recording(path)[0] for path in paths]
    assert [drive.instruction for drive in drives] == [e.instruction.text for e in listed]
    with pytest.raises(ValueError, match="already exists. Name another folder"):
        export_drive.run(config, out)
    listed[:] = [replace(listed[0], episode_id=name) for name in ("a/b", "a.b")]
    with pytest.raises(ValueError, match="Episodes 'a/b' and 'a.b' have the same path"):
        export_drive.run(config, tmp_path / "other")


def full(*_):
    raise OSError(errno.ENOSPC, "No space left on device")


@pytest.fixture
def lab(tmp_path):
    """A folder with a short recorded drive."""
    rng, path = np.random.default_rng(0), tmp_path / "lab"
    frames = {RGB: rng.integers(0, 255, (16, 16, 3), np.uint8), DEPTH: np.ones((16, 16, 1))}
    write_frames(path, [frames | {POSE: np.array([0, n, 0])} for n in range(3)], "go on")
    return str(path)


@pytest.mark.slow
def test_replay_keeps_other_files_of_its_folder(tmp_path, lab, mitigate):
    out = tmp_path / "out"
    out.mkdir()
    (out / "mine.png").write_text("a picture of mine")
    options = ("agents=[checkpoints/recurrent/base]", "conditions=[flare]", f"out={out}")
    for _ in range(2):
        status, _, errors = mitigate("replay", lab, *options)
        assert status == 0, errors
        assert (out / "mine.png").read_text() == "a picture of mine"
        (out / "recurrent-flare.png").write_text("of the run before")
    status, _, errors = mitigate("replay", lab, *options)
    picture = out / "recurrent-flare.png"
    assert status == 0 and (not picture.exists() or picture.read_bytes()[1:4] == b"PNG"), errors
    assert not (out / ".lock").exists()


@pytest.mark.slow
def test_replay_rejects_a_file_or_a_folder_in_use(tmp_path, lab, mitigate):
    out = tmp_path / "out"
    options = ("agents=[checkpoints/recurrent/base]", "conditions=[flare]", f"out={out}")
    out.write_text("a file")
    status, printed, errors = mitigate("replay", lab, *options)
    assert status == 1 and "out must be a folder" in errors and "read lab" not in printed + errors
    out.unlink()
    out.mkdir()
    for text, words in (("[1]", "was not written by a replay"), ("{", "is truncated or damaged")):
        (out / "replay.json").write_text(text)
        status, _, errors = mitigate("replay", lab, *options)
        assert status == 1 and words in errors and "Name another folder (out=...)" in errors
    (out / "replay.json").unlink()
    with FolderLock(out):
        status, _, errors = mitigate("replay", lab, *options)
    assert status == 1 and "is in use" in errors


def test_report_raises_if_a_picture_cannot_be_written(tmp_path):
    recording = drive()
    clean = walk(ByBrightness(), recording, CLEAN, 0)
    dark = walk(ByBrightness(), recording, Corruption("low_light", 0.9), 0, keep=[4])
    (tmp_path / "a.png").mkdir()
    with pytest.raises(OSError, match="a.png"):
        report.picture(recording, Corruption("low_light", 0.9), clean, dark, tmp_path / "a.png")
    changes = {"a|b$\\frac{$": {"low_light": compare([recording], {"lab": clean}, {"lab": dark})}}
    with pytest.raises(OSError, match="a.png"):
        report.heatmap(changes, 0.6, tmp_path / "a.png")
    assert [path.name for path in tmp_path.iterdir()] == ["a.png"]
    assert "| a\\|b$" in report.table(changes, 0.6, T, 1)
    # Matplotlib must not parse the name as a formula
    assert report.heatmap(changes, 0.6, tmp_path / "b.png").is_file()


@pytest.mark.parametrize(
    ("options", "message"),
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
def test_replay_explains_a_mistake_in_one_paragraph(options, message, mitigate):
    status, _, errors = mitigate("replay", *(options or ["seed=1"]))
    assert status != 0 and "Traceback" not in errors
    assert message in errors
