"""Tests of reading episodes of LeRobot datasets as recorded drives."""

from __future__ import annotations

from pathlib import Path
from shutil import copytree

import numpy as np
import pytest

from mitigate.core.observation import DEPTH as DEPTH_ENTRY
from mitigate.core.observation import RGB
from mitigate.replay.inputs import load_drives, open_drives
from mitigate.replay.replay import ReplayConfig
from mitigate.worlds.recorded import RecordedWorld, Step, load, open_recording
from tests.lerobot_files import (
    DEPTH,
    FRONT,
    HEIGHT,
    TASKS,
    WRIST,
    action,
    depth,
    rgb,
    write_dataset,
)

pytest.importorskip("pyarrow", reason="needs pyarrow: pip install -e '.[lerobot]'")
pytest.importorskip("av", reason="needs av: pip install -e '.[lerobot]'")
import pyarrow as pa
import pyarrow.parquet as pq


@pytest.fixture(scope="module", params=["video", "image"])
def folder(request, tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp(request.param) / "cups"
    return write_dataset(path, with_depth=True, stored=request.param)


@pytest.fixture(scope="module")
def film(tmp_path_factory) -> Path:
    return write_dataset(tmp_path_factory.mktemp("film") / "cups", cameras=(FRONT,))


def test_each_episode_is_a_drive_with_its_task(folder):
    drives = open_recording(folder, cameras=[FRONT, DEPTH])
    assert [drive.name for drive in drives] == [f"cups/episode-00000{n}" for n in range(3)]
    assert [drive.instruction for drive in drives] == [TASKS[0], TASKS[1], TASKS[0]]
    assert all(drive.poses is None for drive in drives)


def test_frames_and_signals_of_a_drive_are_those_of_its_episode(folder):
    (drive,) = open_recording(folder, cameras=[WRIST, DEPTH], episodes=[1])
    frames = list(drive.frames([0, 2, 3]))
    assert len(frames) == 3
    for number, images in zip((0, 2, 3), frames, strict=True):
        assert np.array_equal(images[WRIST], rgb(WRIST, 1, number))
        assert np.allclose(images[DEPTH], depth(1, number) / 1000, atol=2e-3)
    assert np.array_equal(drive.signals["action"], [action(1, n) for n in range(4)])


def test_load_thins_a_drive_in_time_with_its_signals(folder):
    (drive,) = open_recording(folder, cameras=[FRONT], episodes=[0])
    recording = load(drive, views=1, size=HEIGHT, step=Step(seconds=0.2))
    assert np.allclose(recording.times, [0, 0.2, 0.4])
    assert np.array_equal(recording.signals["action"], [action(0, n) for n in (0, 2, 4)])


def test_an_agent_reads_the_state_but_not_the_recorded_action(folder):
    (drive,) = open_recording(folder, cameras=[FRONT, DEPTH], episodes=[0])
    recording = load(drive, views=1, size=HEIGHT, step=Step(seconds=0.2))
    world = RecordedWorld(recording)
    world.reset(world.episode())
    observation = world.step(0)
    assert {*observation} == {RGB, DEPTH_ENTRY, "observation.state"}
    assert np.array_equal(observation["observation.state"], -action(0, 2))
    assert world.episode().instruction.text == TASKS[0]


def test_several_cameras_need_a_choice(folder):
    with pytest.raises(ValueError, match=rf"has 2 rgb cameras: {FRONT}, {WRIST}. Choose one, for"):
        open_recording(folder)
    with pytest.raises(ValueError, match=rf"no camera 'top'.*{FRONT}, {WRIST}, {DEPTH}"):
        open_recording(folder, cameras=["top"])


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"episodes": [7]}, "has no episode 7. Choose a number from 0 to 2"),
        ({"unit": 0.001}, "unit= applies only to .*, but .* is a LeRobot dataset. Remove unit="),
        ({"yaw": 90.0}, "yaw= applies only to a bag, but .* is a LeRobot dataset. Remove yaw="),
    ],
)
def test_options_that_do_not_fit_a_dataset_are_rejected(film, options, message):
    with pytest.raises(ValueError, match=message):
        open_recording(film, **options)


@pytest.mark.parametrize("options", [{"episodes": [0]}, {"tolerance": 0.1}])
def test_options_of_datasets_are_rejected_for_other_folders(tmp_path, options):
    (tmp_path / "rgb").mkdir()
    with pytest.raises(ValueError, match="applies only to .*, but .* is a folder of frames"):
        open_recording(tmp_path, **options)


def test_a_folder_of_datasets_is_opened(film, tmp_path):
    copytree(film, tmp_path / "a")
    copytree(film, tmp_path / "b")
    drives = open_recording(tmp_path, episodes=[2])
    assert [drive.name for drive in drives] == ["a/episode-000002", "b/episode-000002"]


def test_several_tasks_in_one_episode_warn(film, tmp_path):
    folder = Path(copytree(film, tmp_path / "in"))
    file = folder / "data/chunk-000/file-001.parquet"
    table = pq.read_table(file)
    index = table.column_names.index("task_index")
    for tasks in ([0, 0, 1, 1, 1], [9] * 5):
        pq.write_table(table.set_column(index, "task_index", pa.array(tasks)), file)
        if tasks[0] == 0:
            with pytest.warns(UserWarning, match="has 2 tasks. The instruction is the first"):
                open_recording(folder, episodes=[2])
        else:
            with pytest.raises(ValueError, match="has the task 9, which meta/tasks.parquet lacks"):
                open_recording(folder, episodes=[2])


def test_replay_loads_the_chosen_episodes(film):
    config = ReplayConfig(agents=[], suite={}, episodes=[0, 2], size=HEIGHT)
    (drives,) = load_drives(config, open_drives(config, [film]), [1]).values()
    assert [drive.instruction for drive in drives] == [TASKS[0], TASKS[0]]
