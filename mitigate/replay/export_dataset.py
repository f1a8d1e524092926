"""Write an oracle's episodes as a LeRobot dataset, version 3.

RGB frames are written as a lossless video. Depth frames are encoded in lerobot's 12-bit format and
written as a lossless video. The state is the pose (x, y, heading). The action is an integer that
identifies the oracle's action.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from mitigate.core.files import make_folder, write_atomically, write_bytes
from mitigate.core.observation import DEPTH, POSE, RGB
from mitigate.core.output import open_output
from mitigate.corruptions.lerobot import Camera, videos
from mitigate.corruptions.lerobot.depth import DepthCode
from mitigate.corruptions.lerobot.metadata import EPISODES, INFO, TASKS, VIDEO
from mitigate.corruptions.lerobot.tables import parquet

FPS = 1  # a step lasts one second
NAMES = {RGB: "observation.images.front", DEPTH: "observation.images.front_depth"}
DATA = "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
VIDEOS = "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4"
STATE = "observation.state"
ENCODINGS = {RGB: videos.LOSSLESS, DEPTH: videos.DEPTH}
# all episodes are written to the first data file and the first video file of each camera
FIRST = {"chunk_index": 0, "file_index": 0}


Step = dict[str, np.ndarray]  # the frames and the pose of a step
Recorded = tuple[list[Step], list[int], str]  # steps, the action at each step, and the instruction


def check_empty(out: Path) -> None:
    """Raise ValueError if ``out`` exists and is not an empty folder."""
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise ValueError(
            f"{out} must be a new or an empty folder for form=lerobot. Name another folder, or "
            "delete it."
        )


def write_dataset(out: Path, episodes: Sequence[Recorded]) -> None:
    """Write all files of a dataset to the folder ``out``.

    ``meta/info.json`` is written last, so that an incomplete dataset cannot be opened.
    """
    height, width = episodes[0][0][0][RGB].shape[:2]
    tasks = list(dict.fromkeys(task for _, _, task in episodes))
    cameras = {
        RGB: Camera(NAMES[RGB], RGB, VIDEO, height, width),
        DEPTH: Camera(NAMES[DEPTH], DEPTH, VIDEO, height, width, code=DepthCode()),
    }
    for kind, camera in cameras.items():
        path = out / VIDEOS.format(video_key=camera.name, **FIRST)
        frames = (np.squeeze(step[kind]) for steps, _, _ in episodes for step in steps)
        make_folder(path.parent)
        encode = partial(videos.encode, encoding=ENCODINGS[kind], fps=FPS)
        write_atomically(path, partial(encode, frames=frames, camera=camera))
    _write_table(out / DATA.format(**FIRST), _rows(episodes, tasks))
    _write_table(out / TASKS, {"task_index": range(len(tasks)), "task": tasks})
    _write_table(out / f"{EPISODES}/chunk-000/file-000.parquet", _index(episodes))
    info = _info(cameras, episodes, len(tasks))
    write_bytes(out / INFO, json.dumps(info, indent=4).encode())


def _write_table(path: Path, columns: dict[str, Any]) -> None:
    import pyarrow

    table = pyarrow.table({column: list(values) for column, values in columns.items()})

    def write(draft: Path) -> None:
        with open_output(draft, "wb") as file:
            parquet().write_table(table, file)

    make_folder(path.parent)
    write_atomically(path, write)


def _rows(episodes: Sequence[Recorded], tasks: list[str]) -> dict[str, Any]:
    lengths = [len(steps) for steps, _, _ in episodes]
    numbers = np.concatenate([np.arange(length) for length in lengths])
    return {
        STATE: [step[POSE].astype(np.float32) for steps, _, _ in episodes for step in steps],
        "action": [action for _, actions, _ in episodes for action in actions],
        "timestamp": (numbers / FPS).astype(np.float32),
        "frame_index": numbers,
        "episode_index": np.repeat(np.arange(len(lengths)), lengths),
        "index": np.arange(sum(lengths)),
        "task_index": np.repeat([tasks.index(task) for _, _, task in episodes], lengths),
    }


def _index(episodes: Sequence[Recorded]) -> dict[str, Any]:
    lengths = np.array([len(steps) for steps, _, _ in episodes])
    ends = np.cumsum(lengths)
    zeros = np.zeros(len(lengths), np.int64)
    columns = {
        "episode_index": np.arange(len(lengths)),
        "tasks": [[task] for _, _, task in episodes],
        "length": lengths,
        "dataset_from_index": ends - lengths,
        "dataset_to_index": ends,
        "data/chunk_index": zeros,
        "data/file_index": zeros,
    }
    for name in NAMES.values():
        columns |= {
            f"videos/{name}/chunk_index": zeros,
            f"videos/{name}/file_index": zeros,
            f"videos/{name}/from_timestamp": (ends - lengths) / FPS,
            f"videos/{name}/to_timestamp": ends / FPS,
        }
    return columns


def _info(cameras: dict[str, Camera], episodes: Sequence[Recorded], tasks: int) -> dict[str, Any]:
    features: dict[str, Any] = {}
    for kind, camera in cameras.items():
        encoding = ENCODINGS[kind]
        features[camera.name] = {
            "dtype": VIDEO,
            "shape": [camera.height, camera.width, 3 if kind == RGB else 1],
            "names": ["height", "width", "channels"],
            "info": {
                "video.codec": encoding.name,
                "video.pix_fmt": encoding.stored,
                "video.fps": FPS,
                "is_depth_map": kind == DEPTH,
            },
        }
    features[STATE] = {"dtype": "float32", "shape": [3], "names": ["x", "y", "heading"]}
    features["timestamp"] = {"dtype": "float32", "shape": [1], "names": None}
    for name in ("action", "frame_index", "episode_index", "index", "task_index"):
        features[name] = {"dtype": "int64", "shape": [1], "names": None}
    return {
        "codebase_version": "v3.0",
        "robot_type": "mitigate",
        "total_episodes": len(episodes),
        "total_frames": sum(len(steps) for steps, _, _ in episodes),
        "total_tasks": tasks,
        "chunks_size": 1000,
        "data_files_size_in_mb": 100,
        "video_files_size_in_mb": 200,
        "fps": FPS,
        "splits": {"train": f"0:{len(episodes)}"},
        "data_path": DATA,
        "video_path": VIDEOS,
        "features": features,
    }
