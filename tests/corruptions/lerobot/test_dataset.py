"""Tests of reading the metadata of LeRobot datasets: versions, features, paths, episodes and
damaged files."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from shutil import copytree
from typing import Any

import numpy as np
import pytest

from mitigate.corruptions.lerobot import open_dataset
from mitigate.corruptions.lerobot.dataset import rows_of
from mitigate.corruptions.lerobot.depth import DepthCode
from tests.lerobot_files import (
    DEPTH,
    FRONT,
    HEIGHT,
    LENGTHS,
    TASKS,
    WIDTH,
    WRIST,
    action,
    depth,
    depth_codes,
    write_dataset,
)

pytest.importorskip("pyarrow", reason="needs pyarrow: pip install -e '.[lerobot]'")
pytest.importorskip("av", reason="needs av: pip install -e '.[lerobot]'")
import pyarrow as pa
import pyarrow.parquet as pq

EPISODES = "meta/episodes/chunk-000/file-000.parquet"
DATA = "data/chunk-000/file-000.parquet"


@pytest.fixture(scope="module")
def original(tmp_path_factory) -> Path:
    return write_dataset(tmp_path_factory.mktemp("datasets") / "cups", with_depth=True)


@pytest.fixture
def folder(original, tmp_path) -> Path:
    """A copy of the dataset, which a test may damage."""
    return Path(copytree(original, tmp_path / "cups"))


def change_info(folder: Path, change: Callable[[dict[str, Any]], Any]) -> None:
    file = folder / "meta/info.json"
    info = json.loads(file.read_text())
    change(info)
    file.write_text(json.dumps(info))


def change_table(file: Path, **columns: Any) -> None:
    table = pq.read_table(file)
    for name, values in columns.items():
        index = table.column_names.index(name)
        table = table.set_column(index, name, pa.array(values))
    pq.write_table(table, file)


def test_open_dataset_reads_cameras_episodes_and_tasks(folder):
    dataset = open_dataset(folder)
    assert [(c.name, c.kind, c.height, c.width) for c in dataset.cameras.values()] == [
        (FRONT, "rgb", HEIGHT, WIDTH),
        (WRIST, "rgb", HEIGHT, WIDTH),
        (DEPTH, "depth", HEIGHT, WIDTH),
    ]
    assert [episode.length for episode in dataset.episodes.values()] == list(LENGTHS)
    second = dataset.episodes[1]
    assert second.videos[FRONT] == (f"videos/{FRONT}/chunk-000/file-000.mp4", 0.6)
    assert dataset.episodes[2].videos[WRIST] == (f"videos/{WRIST}/chunk-000/file-001.mp4", 0.0)
    assert dataset.tasks == dict(enumerate(TASKS))


def test_read_signals_returns_the_numbers_of_each_row(folder):
    dataset = open_dataset(folder)
    ((episode, _, mine),) = rows_of(dataset, dataset.choose_episodes([1]))
    signals = dataset.read_signals(episode.data)
    assert set(signals) == {"action", "observation.state"}
    expected = np.stack([action(1, frame) for frame in range(LENGTHS[1])])
    assert np.array_equal(signals["action"][mine], expected)


def test_open_dataset_reads_the_older_column_of_tasks_and_channels_first(folder):
    table = pa.table({"task": list(TASKS), "task_index": [0, 1]})
    pq.write_table(table, folder / "meta/tasks.parquet")

    def channels_first(info):
        info["features"][FRONT] |= {"shape": [3, HEIGHT, WIDTH], "names": ["c", "h", "w"]}

    change_info(folder, channels_first)
    dataset = open_dataset(folder)
    camera = dataset.cameras[FRONT]
    assert (camera.height, camera.width) == (HEIGHT, WIDTH)
    assert dataset.tasks == dict(enumerate(TASKS))


def test_open_dataset_keeps_cameras_that_it_cannot_read_apart(folder):
    change_info(folder, lambda info: info["features"][WRIST].update(shape=[HEIGHT, WIDTH, 4]))
    dataset = open_dataset(folder)
    assert WRIST not in dataset.cameras
    with pytest.raises(ValueError, match=f"{WRIST} .* has 4 channels instead of 3"):
        dataset.choose_cameras("rgb", [WRIST])


@pytest.mark.parametrize(
    ("version", "message"),
    [
        (
            "v2.1",
            "version 'v2.1', but v3.0 is needed. Run, in the environment.*convert_dataset_v21",
        ),
        ("v2.0", "Convert it to v2.1 first"),
        ("v4.0", "newer release of mitigate"),
        (3, "codebase_version must be v3.0, got 3"),
    ],
)
def test_open_dataset_rejects_other_versions(folder, version, message):
    change_info(folder, lambda info: info.update(codebase_version=version))
    with pytest.raises(ValueError, match=message):
        open_dataset(folder)


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("fps", 0, "fps must be above 0"),
        ("fps", "30", "fps must be above 0"),
        ("features", [], "features must be an object"),
        ("total_episodes", 9, "is incomplete: meta/info.json announces 9 episodes.* has 3"),
        ("data_path", "/etc/file-{file_index}", "data_path must be a path inside the dataset"),
        ("data_path", "../{file_index:03d}.parquet", "must be a path inside the dataset"),
        ("data_path", "{video_key}", "must be a path inside the dataset"),
        ("data_path", "data//{file_index:03d}.parquet", "must be a path inside the dataset"),
        ("data_path", ".data/{file_index:03d}.parquet", "must be a path inside the dataset"),
        ("data_path", "data/{chunk_index.__class__}", "must be a path inside the dataset"),
        ("data_path", "data/{file_index:099999999d}", "must be a path inside the dataset"),
        ("video_path", "videos/{0}/{file_index}.mp4", "video_path must be a path inside"),
        ("video_path", "videos/file-{file_index:03d}.mp4", "must contain {video_key}"),
        ("video_path", None, "video_path must be a path inside"),
    ],
)
def test_open_dataset_rejects_invalid_metadata(folder, key, value, message):
    change_info(folder, lambda info: info.update({key: value}))
    with pytest.raises(ValueError, match=message):
        open_dataset(folder)


@pytest.mark.parametrize(
    ("name", "feature", "message"),
    [
        ("x", {"dtype": "complex64", "shape": [1]}, "dtype of 'x' must be one of .*, got 'complex"),
        ("x", {"shape": [1]}, "dtype of 'x' must be one of .* got None"),
        ("x", {"dtype": "float32", "shape": [-1]}, "shape of 'x' must be a list of numbers"),
        ("x", {"dtype": "float32", "shape": "2"}, "shape of 'x' must be a list of numbers"),
        ("../x", {"dtype": "video", "shape": [2, 2, 3]}, "name of a feature must have"),
        ("..", {"dtype": "video", "shape": [2, 2, 3]}, "name of a feature must have"),
        (
            DEPTH,
            {"dtype": "image", "shape": [2, 2, 1], "info": {"is_depth_map": True, "depth_unit": 3}},
            "depth_unit of observation.depth must be m or mm, got 3",
        ),
        (
            DEPTH,
            {
                "dtype": "video",
                "shape": [2, 2, 1],
                "info": {"is_depth_map": True, "video.depth_max": 0.001},
            },
            "must have 0 <= depth_min < depth_max",
        ),
    ],
)
def test_open_dataset_rejects_invalid_features(folder, name, feature, message):
    change_info(folder, lambda info: info["features"].update({name: feature}))
    with pytest.raises(ValueError, match=message):
        open_dataset(folder)


@pytest.mark.parametrize("file", ["meta/tasks.parquet", EPISODES, DATA])
def test_a_missing_or_damaged_table_is_named(folder, file):
    path = folder / file
    content = path.read_bytes()

    def read():
        list(rows_of(open_dataset(folder), open_dataset(folder).choose_episodes(None)))

    path.write_bytes(content[: len(content) // 2])
    with pytest.raises(ValueError, match="truncated or damaged.*finalize"):
        read()
    path.unlink()
    with pytest.raises(FileNotFoundError, match=r"lacks the file|has no files meta/episodes"):
        read()


def test_read_rows_rejects_an_episode_with_missing_rows(folder):
    frames = [*range(6), 0, 1, 3, 4]
    change_table(folder / DATA, frame_index=frames)
    with pytest.raises(ValueError, match="rows of episode 1 in order.*0 to 3"):
        open_dataset(folder).read_rows(DATA)


def test_read_rows_rejects_timestamps_that_do_not_increase(folder):
    change_table(folder / DATA, timestamp=np.zeros(10, np.float32))
    with pytest.raises(ValueError, match="timestamps of episode 0 must increase"):
        open_dataset(folder).read_rows(DATA)


def test_read_signals_rejects_another_shape(folder):
    change_info(folder, lambda info: info["features"]["action"].update(shape=[3]))
    with pytest.raises(ValueError, match="each row of 'action' must hold 3 numbers"):
        open_dataset(folder).read_signals(DATA)


def test_open_dataset_rejects_numbers_of_files_out_of_range(folder):
    change_table(folder / EPISODES, **{"data/file_index": [0, -1, 0]})
    with pytest.raises(ValueError, match="must be between 0 and 999999, got 0 and -1"):
        open_dataset(folder)


def test_a_table_that_expands_too_far_is_rejected(folder, monkeypatch):
    monkeypatch.setattr("mitigate.corruptions.lerobot.tables.FREE", 0)
    monkeypatch.setattr("mitigate.corruptions.lerobot.tables.RATIO", 0)
    with pytest.raises(ValueError, match="expands to .* Do not use this file"):
        open_dataset(folder)


def test_a_git_lfs_pointer_is_named(folder):
    pointer = b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 9\n"
    (folder / "meta/tasks.parquet").write_bytes(pointer)
    with pytest.raises(ValueError, match="git lfs pull"):
        open_dataset(folder)


@pytest.mark.parametrize("code", [DepthCode(), DepthCode(0.2, 4.0, 0.0, log=False)])
def test_depth_codes_are_inverse_within_half_a_step(code):
    codes = np.arange(4096, dtype=np.uint16).reshape(64, 64)
    metres = code.metres(codes)
    assert metres[0, 0] == 0 and metres.max() == pytest.approx(code.far)
    assert np.array_equal(code.codes(metres), codes)


def test_depth_codes_equal_those_of_lerobot():
    millimetres = depth(0, 0)
    codes = DepthCode().codes(millimetres.astype(np.float32) / 1000)
    assert np.abs(codes.astype(int) - depth_codes(millimetres)).max() <= 1  # rounding at halves
    assert (codes[millimetres == 0] == 0).all()
