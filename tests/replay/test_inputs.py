"""Tests of the inputs of a replay: users' agents, missing inputs, and the report of what was
read."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest

import mitigate
from mitigate import cli
from mitigate.core.observation import DEPTH, FORWARD, LEFT, POSE, RGB, STOP
from mitigate.corruptions import CLEAN, Corruption
from mitigate.replay import report
from mitigate.replay.export_drive import write_frames
from mitigate.replay.inputs import check_drives, load_agents
from mitigate.replay.walk import Answers, compare, neglected_actions, walk
from mitigate.worlds.recorded import Recording, open_recording
from mitigate.worlds.recorded.recording import movements

SIZE = 16
COUNT = 4


class Careful:
    """An agent that turns left while an obstacle is close, and otherwise drives forward."""

    sensors = (DEPTH,)

    def reset(self, instruction):
        assert instruction

    def act(self, observation):
        return LEFT if np.median(observation[DEPTH]) < 0.5 else FORWARD


class Steering:
    """An agent with two continuous actions: a constant, and the brightness of the frame."""

    def reset(self, instruction):
        pass

    def act(self, observation):
        return np.array([0.5, observation[RGB].mean() / 255], np.float32)


def nothing():
    return object()


@pytest.fixture
def lab(tmp_path) -> Path:
    """A folder with a short recorded drive."""
    rng = np.random.default_rng(0)
    frames = [
        {
            RGB: rng.integers(0, 255, (SIZE, SIZE, 3), np.uint8),
            DEPTH: np.full((SIZE, SIZE, 1), 2.0),
            POSE: np.array([0, 0.25 * number, 0]),
        }
        for number in range(COUNT)
    ]
    write_frames(tmp_path / "lab", frames, "go on")
    return tmp_path / "lab"


# ------------------------------------------------------------------------------------ agents


def test_replay_recordings_writes_the_report_of_an_own_agent(lab, tmp_path, capsys):
    out = mitigate.replay_recordings(
        Careful(), lab, conditions=["missing_data"], size=SIZE, out=tmp_path / "out"
    )
    assert out == tmp_path / "out"
    lines = [json.loads(line) for line in (out / "decisions.jsonl").read_text().splitlines()]
    assert len(lines) == 2 * COUNT and {line["agent"] for line in lines} == {"Careful"}
    assert (out / "changes.png").is_file()
    table = (out / "table.md").read_text()
    printed = capsys.readouterr().out
    for text in (table, printed):
        assert "| missing_data |" in text and "**mean of 1**" in text
        assert "lab: 4 steps, one per frame" in text
        assert "depth: depth, 16-bit PNG, 0.001 metres per count (assumed), 16 x 16" in text
        assert "Below 80 steps the intervals are too wide" in text
    assert f"replay: {2} runs" in printed


def test_replay_leaves_out_corruptions_of_unread_sensors(lab, tmp_path, capsys):
    conditions = ["low_light", "low_light+missing_data"]
    mitigate.replay_recordings(Careful(), lab, conditions=conditions, size=SIZE, out=tmp_path / "o")
    table = (tmp_path / "o/table.md").read_text()
    assert "| low_light+missing_data |" in table and "| low_light |" not in table
    reason = "Careful, low_light: not applicable, the agent does not read rgb frames"
    assert reason in capsys.readouterr().out


def test_replay_command_runs_an_own_agent(lab, tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "argv", sys.argv)
    options = (f"agents=[{__name__}:Careful]", "conditions=[missing_data]", f"out={tmp_path}/out")
    with pytest.raises(SystemExit) as ended:
        cli.main(["replay", str(lab), *options])
    assert not ended.value.code
    assert (tmp_path / "out/table.md").is_file()


def test_replay_recordings_explains_an_unknown_option(lab):
    with pytest.raises(ValueError, match="colour"):
        mitigate.replay_recordings(Careful(), lab, colour="red")


def test_load_agents_points_to_own_code_if_there_are_no_weights():
    with pytest.raises(FileNotFoundError, match=r"agents=\[module:callable\]"):
        load_agents(["mine.Mine"])


@pytest.mark.parametrize(
    ("agents", "message"),
    [
        (
            [f"{__name__}:nothing"],
            "returned <object object.*, which lacks reset: an agent is",
        ),
        (Careful, "contains <class .*, which is a class, not an object"),
        ([Careful(), Careful()], "In Python, give names"),
        ([], "at least one folder of weights or module:callable"),
        ([f"{__name__}:Carful"], "Did you mean Careful"),
    ],
)
def test_load_agents_rejects_objects_that_are_no_agents(agents, message):
    with pytest.raises(ValueError, match=message):
        load_agents(agents)


def test_load_agents_names_agents_by_class_or_by_the_user():
    assert [*load_agents(Careful())] == ["Careful"]
    assert [*load_agents({"mine": f"{__name__}:Careful"})] == ["mine"]


# ------------------------------------------------------------------------------------ drives


def test_check_drives_names_a_missing_sensor_before_frames_are_read(lab):
    for file in (lab / "depth").iterdir():
        file.unlink()
    for file in (lab / "rgb").iterdir():
        file.write_bytes(b"not a picture")
    with pytest.raises(ValueError, match=r"mine reads depth, which lab lacks.*topics.depth="):
        check_drives(open_recording(lab), {"mine": Careful()})


def test_check_drives_names_a_missing_instruction(lab):
    (lab / "instruction.txt").unlink()
    with pytest.raises(ValueError, match="lab has no instruction. Set instruction="):
        check_drives(open_recording(lab), {"mine": Careful()})


def test_check_prints_what_was_read_and_writes_nothing(lab, tmp_path, capsys):
    out = tmp_path / "out"
    (lab / "instruction.txt").unlink()
    with pytest.warns(UserWarning, match="no instruction"):
        mitigate.replay_recordings(Careful(), lab, check=True, out=out)
    printed = capsys.readouterr().out
    assert "rgb: rgb, PNG, 16 x 16, 90 x 90 degrees (assumed)" in printed
    assert "instruction: none" in printed and not out.exists()


def test_replay_rejects_a_folder_with_other_options(lab, tmp_path):
    out = tmp_path / "out"
    options = {"conditions": ["missing_data"], "size": SIZE, "out": out}
    mitigate.replay_recordings(Careful(), lab, **options)
    with pytest.raises(ValueError, match=r"with crop=False.* has crop=True"):
        mitigate.replay_recordings(Careful(), lab, crop=True, **options)


# --------------------------------------------------------------------------------- decisions


def recording(actions: list[int]) -> Recording:
    count = len(actions)
    frames = {RGB: np.random.default_rng(0).integers(99, 255, (count, 8, 8, 3), np.uint8)}
    poses = np.zeros((count, 3))
    times = np.arange(count) * 1.0
    return Recording("lab", "go", frames, times, poses, movements(np.array(actions)))


def test_neglected_actions_are_those_that_mostly_the_driver_takes():
    drive = recording([FORWARD] * 7 + [LEFT] * 2 + [STOP])
    turns = {"lab": Answers(np.full(10, LEFT), np.full((10, 2), np.nan))}
    assert neglected_actions([drive], turns) == ["forward"]
    moves = {"lab": Answers(np.full(10, FORWARD), np.full((10, 2), np.nan))}
    assert neglected_actions([drive], moves) == ["left"]
    same = {"lab": Answers(drive.driven.actions, np.full((10, 2), np.nan))}
    assert neglected_actions([drive], same) == []


def test_table_shows_a_warning_next_to_the_numbers():
    drive = recording([FORWARD] * 10)
    clean = {"lab": walk(Steering(), drive, CLEAN, 0)}
    changes = {"mine": {"clean": compare([drive], clean, clean)}}
    text = report.table(changes, 0.6, 10, 1, notes=["mine rarely chooses forward."])
    assert text.index("**Warning:** mine rarely chooses forward.") < text.index("| condition |")


def test_compare_measures_the_distance_of_continuous_actions():
    drive = recording([FORWARD] * 100)
    clean = walk(Steering(), drive, CLEAN, 0)
    dark = walk(Steering(), drive, Corruption("low_light", 0.8), 0, clean=clean)
    assert clean.actions.shape == (100, 2)
    change = compare([drive], {"lab": clean}, {"lab": dark})
    gaps = np.abs(dark.actions - clean.actions)[:, 1]
    assert change.changed.value == 1 and change.agreement is None
    assert change.distance.value == pytest.approx(gaps.mean())
    assert change.distance.low < gaps.mean() < change.distance.high
    same = compare([drive], {"lab": clean}, {"lab": clean})
    assert same.changed.value == same.distance.value == 0
    text = report.table({"mine": {"clean": same, "low_light": change}}, 0.8, 100, 1)
    assert "| distance |" in text and f"{gaps.mean():.3g} [" in text


def test_walk_rejects_actions_of_several_shapes():
    class Confused(Steering):
        def act(self, observation):
            self.calls = getattr(self, "calls", 0) + 1
            return np.ones(self.calls)

    with pytest.raises(ValueError, match="Confused must return actions of one shape"):
        walk(Confused(), recording([FORWARD] * 3), CLEAN, 0)
