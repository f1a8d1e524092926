"""Tests of LeRobot datasets that are written as conversations."""

from __future__ import annotations

import json
from pathlib import Path
from shutil import copytree
from types import SimpleNamespace

import cv2
import numpy as np
import pytest

from mitigate.agents.vlm.answers import ANSWERS
from mitigate.agents.vlm.conversation import TASK
from mitigate.agents.vlm.dataset import CONVERSATIONS, write_conversations
from mitigate.agents.vlm.lerobot import write_lerobot_conversations
from mitigate.agents.vlm.rollout import join_pieces
from mitigate.core.observation import DEPTH as DEPTH_ENTRY
from mitigate.core.observation import POSE, RGB
from mitigate.recipes.conversations import Conversations
from mitigate.replay.export_dataset import write_dataset as write_discrete
from tests.agents.vlm.corridor import PIXELS, Corridor, episode
from tests.documented import example
from tests.lerobot_files import DEPTH, FRONT, HEIGHT, LENGTHS, TASKS, WIDTH, rgb, write_dataset

pytest.importorskip("pyarrow", reason="needs pyarrow: pip install -e '.[lerobot]'")
pytest.importorskip("av", reason="needs av: pip install -e '.[lerobot]'")
import pyarrow as pa
import pyarrow.parquet as pq

EPISODES = [episode(1, 6, 'Walk to "{answers}".'), episode(3, 2)]
DATA = "data/chunk-000/file-000.parquet"


def drive(one) -> tuple[list[dict[str, np.ndarray]], list[int], str]:
    """Return the steps of the expert in the corridor, as ``write_discrete`` expects them."""
    world, steps, actions = Corridor(), [], []
    world.reset(one)
    while not world.done:
        depth = np.ones((PIXELS, PIXELS, 1), np.float32)
        steps.append({RGB: world.render(), DEPTH_ENTRY: depth, POSE: np.zeros(3)})
        actions.append(world.action())
        world.step(actions[-1])
    return steps, actions, one.instruction.text


@pytest.fixture(scope="module")
def discrete(tmp_path_factory) -> Path:
    """A dataset of the corridor, whose actions are integers."""
    path = tmp_path_factory.mktemp("datasets") / "corridor"
    write_discrete(path, [drive(one) for one in EPISODES])
    return path


@pytest.fixture(scope="module", params=["video", "image"])
def continuous(request, tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp(request.param) / "cups"
    return write_dataset(path, with_depth=True, stored=request.param)


@pytest.fixture(scope="module")
def film(tmp_path_factory) -> Path:
    return write_dataset(tmp_path_factory.mktemp("film") / "cups", cameras=(FRONT,))


def read_lines(folder: Path) -> list[dict]:
    text = (folder / CONVERSATIONS).read_text("utf-8")
    return [json.loads(line) for line in text.splitlines()]


def answers_in(folder: Path) -> list[str]:
    return [line["conversations"][1]["value"] for line in read_lines(folder)]


def read_image(folder: Path, name: str) -> np.ndarray:
    return cv2.imread(str(folder / name))[..., ::-1]


def change_column(folder: Path, column: str, values: list) -> None:
    table = pq.read_table(folder / DATA)
    index = table.column_names.index(column)
    pq.write_table(table.set_column(index, column, pa.array(values)), folder / DATA)


@pytest.mark.parametrize(("answers", "count"), [("navid", 5), ("actions", 8)])
def test_write_equals_the_conversations_of_the_recorded_expert(discrete, tmp_path, answers, count):
    options = {"answers": answers, "history": 1, "task": "{instruction} {answers}"}
    write_conversations(Corridor(), EPISODES, tmp_path / "world", **options)
    lines_count = write_lerobot_conversations(discrete, tmp_path / "out", size=PIXELS, **options)
    expected, lines = read_lines(tmp_path / "world"), read_lines(tmp_path / "out")
    assert lines_count == count
    assert {line.pop("episode_id") for line in expected} == {"1-6", "3-2"}
    names = {line.pop("episode_id") for line in lines}
    assert names == {"corridor/episode-000000", "corridor/episode-000001"}
    assert lines == expected
    for name in {name for line in lines for name in line["images"]}:
        frame = read_image(tmp_path / "out", name)
        assert np.array_equal(frame, read_image(tmp_path / "world", name))


def test_written_folder_is_read_by_conversations(discrete, tmp_path):
    write_lerobot_conversations(discrete, tmp_path, size=PIXELS)
    answers = ANSWERS["navid"]
    agent = SimpleNamespace(
        answers=answers, task=TASK, join=lambda pieces: join_pieces(pieces, len(answers))
    )
    source = Conversations(agent, str(tmp_path), decisions=4)
    assert [entry.instruction for entry in source.entries] == [
        *[EPISODES[0].instruction.text] * 3,
        *[EPISODES[1].instruction.text] * 2,
    ]
    batch = source.collate([source.work(job) for job in source.jobs(0)])
    assert len(batch.texts) == 4
    assert batch.frames.shape[1:] == (PIXELS, PIXELS, 3)


def test_actions_converts_rows_and_skips_those_without_an_action(continuous, tmp_path):
    converted = []

    def convert(recorded: np.ndarray) -> list[int | None]:
        converted.append(recorded)
        return {6: [1, None, 1, 2, 1, 0], 4: [None] * 4, 5: [3, 3, 3, 3, 0]}[len(recorded)]

    count = write_lerobot_conversations(
        continuous, tmp_path, camera=FRONT, actions=convert, size=16, history=2
    )
    assert [values.shape for values in converted] == [(length, 2) for length in LENGTHS]
    assert answers_in(tmp_path) == [
        *("forward 50 cm", "turn left 15 degrees", "forward 25 cm", "stop"),
        *("turn right 45 degrees", "turn right 15 degrees", "stop"),
    ]
    lines = read_lines(tmp_path)
    assert count == len(lines) == 7
    assert TASKS[0] in lines[0]["conversations"][0]["value"]
    assert [len(line["images"]) for line in lines] == [1, 2, 3, 3, 1, 2, 3]
    left = (WIDTH - HEIGHT) // 2
    for line, place in ((1, (0, 3)), (3, (0, 5)), (5, (2, 3))):
        square = rgb(FRONT, *place)[:, left : left + HEIGHT]
        expected = cv2.resize(square, (16, 16), interpolation=cv2.INTER_AREA)
        assert np.array_equal(read_image(tmp_path, lines[line]["images"][-1]), expected)


def test_rows_after_the_stop_are_left_out(film, tmp_path):
    write_lerobot_conversations(
        film, tmp_path, actions=lambda rows: [1, 0, 0] + [None] * (len(rows) - 3)
    )
    assert answers_in(tmp_path) == ["forward 25 cm", "stop"] * 3


def test_long_episodes_are_not_cut(tmp_path):
    (step, *_), _, text = drive(EPISODES[0])
    write_discrete(tmp_path / "in", [([step] * 502, [2, 3] * 250 + [2, 0], text)])
    assert write_lerobot_conversations(tmp_path / "in", tmp_path / "out", size=8, history=0) == 502
    assert answers_in(tmp_path / "out")[-1] == "stop"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({}, r"must be one integer: 0 \(stop\), .*, got float32 \[2\]. Pass actions="),
        ({"camera": "top"}, f"no camera 'top'.*{FRONT}"),
        ({"size": 0}, "size must be >= 1, got 0"),
        ({"actions": lambda rows: [1]}, "episode-000000: .*got 1 items for 6 rows"),
        ({"actions": lambda rows: rows}, "episode-000000, row 0: .*got array"),
        ({"actions": lambda rows: [1, 4] * 3}, r"episode-000000, row 1: .*or None, got 4"),
        ({"actions": lambda rows: [1, 0, 1] * 2}, "moves after the stop in row 1"),
        ({"actions": lambda rows: [None] * len(rows)}, "returned only None"),
    ],
)
def test_write_rejects_invalid_arguments(film, tmp_path, options, message):
    with pytest.raises(ValueError, match=message):
        write_lerobot_conversations(film, tmp_path / "out", **options)
    assert not (tmp_path / "out").exists()


def test_write_needs_one_rgb_camera(continuous, tmp_path):
    for camera in (None, DEPTH):
        with pytest.raises(ValueError, match=f"camera must name one of the rgb cameras.*{FRONT}"):
            write_lerobot_conversations(continuous, tmp_path / "out", camera=camera)
    only_depth = write_dataset(tmp_path / "depth", cameras=(), with_depth=True)
    with pytest.raises(ValueError, match="because 0 cameras match. All cameras: observation.depth"):
        write_lerobot_conversations(only_depth, tmp_path / "out")


def test_write_warns_if_no_episode_stops(film, tmp_path):
    with pytest.warns(UserWarning, match="No episode of .* has a stop"):
        write_lerobot_conversations(film, tmp_path, actions=lambda rows: [1] * len(rows))


def test_write_names_the_invalid_integer_of_a_dataset(discrete, tmp_path):
    folder = Path(copytree(discrete, tmp_path / "in"))
    change_column(folder, "action", [1, 1, 7, 1, 1, 0, 2, 0])
    with pytest.raises(ValueError, match="in/episode-000000, row 2: .*, got 7"):
        write_lerobot_conversations(folder, tmp_path / "out")


@pytest.mark.parametrize("change", ["cut", "column", "feature", "video"])
def test_write_rejects_a_damaged_dataset(discrete, tmp_path, change):
    folder = Path(copytree(discrete, tmp_path / "in"))
    table = pq.read_table(folder / DATA)
    message = "must have the column 'action' with numbers. Copy the dataset again"
    if change == "cut":
        pq.write_table(table.slice(0, 7), folder / DATA)
        message = "must hold the rows of episode 1 in order"
    elif change == "column":
        pq.write_table(table.drop_columns(["action"]), folder / DATA)
    elif change == "feature":
        file = folder / "meta/info.json"
        info = json.loads(file.read_text())
        del info["features"]["action"]
        file.write_text(json.dumps(info))
        message = "must be one integer: .*, got no such feature"
    else:
        (video,) = folder.glob("videos/*front/*/*.mp4")
        video.write_bytes(video.read_bytes()[:600])
        message = "cannot be decoded: it is truncated or damaged"
    with pytest.raises(ValueError, match=message):
        write_lerobot_conversations(folder, tmp_path / "out")
    assert not (tmp_path / "out" / CONVERSATIONS).exists()


def test_documented_examples_run(film, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    copytree(film, "my-dataset")
    exec(example("vlm.md", "velocities"), {})
    # the robot drives 15 cm in the first episode, 46 cm in the second, and 110 cm in the third
    expected = ["stop", "forward 25 cm", "stop", "forward 75 cm", "stop"]
    assert answers_in(tmp_path / "conversations") == expected
