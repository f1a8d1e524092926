"""Write small LeRobot datasets of version 3, using only pyarrow and av.

The layout follows ``src/lerobot/datasets`` of lerobot 0.6: the first two episodes share one data
file and one video per camera, and the third episode has its own files.
"""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

FRONT, WRIST = "observation.images.front", "observation.images.wrist"
DEPTH = "observation.depth"
FPS = 10
LENGTHS = (6, 4, 5)
HEIGHT, WIDTH = 32, 48
TASKS = ("walk to the door", "pick up the red cup")
TASK_OF = (0, 1, 0)  # task of each episode
FILES = ((0, 1), (2,))  # episodes of each file


def rgb(camera: str, episode: int, frame: int) -> np.ndarray:
    """Return the frame of a camera, uint8 [H, W, 3]: a gradient that differs in each frame."""
    rng = np.random.default_rng([len(camera), episode, frame])
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH]
    red, green, blue = rng.integers(0, 256, 3)
    planes = np.stack([x * 5 + red, y * 7 + green, (x + y) * 3 + blue], -1)
    return (planes % 256).astype(np.uint8)


def depth(episode: int, frame: int) -> np.ndarray:
    """Return depth in millimetres, uint16 [H, W], with a hole (value 0)."""
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH]
    millimetres = 500 + 40 * x + 30 * y + 7 * frame + 100 * episode
    millimetres[4:8, 6:12] = 0
    return millimetres.astype(np.uint16)


def action(episode: int, frame: int) -> np.ndarray:
    """Return the action of a dataset row, float32 [2]."""
    return np.array([episode + frame / 10, -frame], np.float32)


def write_dataset(
    path: Path,
    *,
    cameras: tuple[str, ...] = (FRONT, WRIST),
    with_depth: bool = False,
    stored: str = "video",
    codec: str = "libx264rgb",
    image_format: str = "PNG",
) -> Path:
    """Write a dataset and return its folder.

    Args:
        path: The folder.
        cameras: Names of the RGB cameras.
        with_depth: Whether there is a depth camera too.
        stored: "video" or "image".
        codec: Encoder of RGB videos; libx264rgb keeps every pixel.
        image_format: Format of RGB images.
    """
    features: dict[str, Any] = {
        name: {
            "dtype": stored,
            "shape": [HEIGHT, WIDTH, 3],
            "names": ["height", "width", "channels"],
        }
        for name in cameras
    }
    if with_depth:
        info = {"is_depth_map": True, **({} if stored == "video" else {"depth_unit": "mm"})}
        features[DEPTH] = {"dtype": stored, "shape": [HEIGHT, WIDTH, 1], "names": None}
        features[DEPTH]["info"] = info
    features["observation.state"] = {"dtype": "float32", "shape": [2], "names": ["x", "y"]}
    features["action"] = {"dtype": "float32", "shape": [2], "names": ["dx", "dy"]}
    features["timestamp"] = {"dtype": "float32", "shape": [1], "names": None}
    for name in ("frame_index", "episode_index", "index", "task_index"):
        features[name] = {"dtype": "int64", "shape": [1], "names": None}
    info = {
        "codebase_version": "v3.0",
        "robot_type": "test",
        "total_episodes": len(LENGTHS),
        "total_frames": sum(LENGTHS),
        "total_tasks": len(TASKS),
        "chunks_size": 1000,
        "fps": FPS,
        "splits": {"train": f"0:{len(LENGTHS)}"},
        "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
        "video_path": "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4",
        "features": features,
    }
    (path / "meta/episodes/chunk-000").mkdir(parents=True)
    (path / "meta/info.json").write_text(json.dumps(info))
    (path / "meta/stats.json").write_text(json.dumps({"action": {"mean": [0.5, -2.0]}}))
    (path / "README.md").write_text("A dataset for tests.")
    _write_tasks(path)
    _write_rows(path, cameras, with_depth, stored, image_format)
    names = [*cameras, *([DEPTH] if with_depth else [])] if stored == "video" else []
    for name in names:
        for number, episodes in enumerate(FILES):
            file = path / "videos" / name / f"chunk-000/file-{number:03d}.mp4"
            _write_video(file, name, episodes, codec)
    _write_episodes(path, names)
    return path


def _write_tasks(path: Path) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    table = {"task_index": list(range(len(TASKS))), "__index_level_0__": list(TASKS)}
    pq.write_table(pa.table(table), path / "meta/tasks.parquet")


def _write_episodes(path: Path, videos: list[str]) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    rows = []
    for number, episodes in enumerate(FILES):
        start = 0
        for episode in episodes:
            length = LENGTHS[episode]
            first = sum(LENGTHS[:episode])
            row: dict[str, Any] = {
                "episode_index": episode,
                "tasks": [TASKS[TASK_OF[episode]]],
                "length": length,
                "dataset_from_index": first,
                "dataset_to_index": first + length,
                "data/chunk_index": 0,
                "data/file_index": number,
                "stats/action/mean": [0.5, -2.0],
            }
            for video in videos:
                row[f"videos/{video}/chunk_index"] = 0
                row[f"videos/{video}/file_index"] = number
                row[f"videos/{video}/from_timestamp"] = start / FPS
                row[f"videos/{video}/to_timestamp"] = (start + length) / FPS
            start += length
            rows.append(row)
    pq.write_table(pa.Table.from_pylist(rows), path / "meta/episodes/chunk-000/file-000.parquet")


def _write_rows(
    path: Path, cameras: tuple[str, ...], with_depth: bool, stored: str, image_format: str
) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    (path / "data/chunk-000").mkdir(parents=True)
    for number, episodes in enumerate(FILES):
        columns: dict[str, list[Any]] = {}
        for episode in episodes:
            for frame in range(LENGTHS[episode]):
                row = {
                    "action": action(episode, frame),
                    "observation.state": -action(episode, frame),
                    "timestamp": np.float32(frame / FPS),
                    "frame_index": frame,
                    "episode_index": episode,
                    "index": sum(LENGTHS[:episode]) + frame,
                    "task_index": TASK_OF[episode],
                }
                if stored == "image":
                    for name in cameras:
                        image = Image.fromarray(rgb(name, episode, frame))
                        row[name] = _bytes(image, image_format)
                    if with_depth:
                        row[DEPTH] = _bytes(Image.fromarray(depth(episode, frame)), "TIFF")
                for name, value in row.items():
                    columns.setdefault(name, []).append(value)
        types = {
            "action": pa.list_(pa.float32(), 2),
            "observation.state": pa.list_(pa.float32(), 2),
            "timestamp": pa.float32(),
        }
        table = pa.table({n: pa.array(v, types.get(n)) for n, v in columns.items()})
        table = table.replace_schema_metadata({"huggingface": "kept"})
        file = path / f"data/chunk-000/file-{number:03d}.parquet"
        with pq.ParquetWriter(file, table.schema) as writer:
            start = 0
            for episode in episodes:  # like lerobot, write one row group per episode
                writer.write_table(table.slice(start, LENGTHS[episode]))
                start += LENGTHS[episode]


def _bytes(image: Image.Image, form: str) -> dict[str, Any]:
    with io.BytesIO() as file:
        image.save(file, form, **({"quality": 95} if form == "JPEG" else {}))
        return {"bytes": file.getvalue(), "path": f"frame-000000.{form.lower()}"}


def _write_video(file: Path, name: str, episodes: tuple[int, ...], codec: str) -> None:
    import av

    file.parent.mkdir(parents=True, exist_ok=True)
    lossless = {"qp": "0"} if codec == "libx264rgb" else {"crf": "20"}
    with av.open(str(file), "w") as output:
        if name == DEPTH:
            stream = output.add_stream(
                "hevc", FPS, options={"x265-params": "lossless=1:log-level=none"}
            )
            stream.pix_fmt = "gray12le"
        else:
            stream = output.add_stream(codec, FPS, options={**lossless, "g": "2"})
            stream.pix_fmt = "rgb24" if codec == "libx264rgb" else "yuv420p"
        stream.width, stream.height = WIDTH, HEIGHT
        for episode in episodes:
            for frame in range(LENGTHS[episode]):
                if name == DEPTH:
                    codes = depth_codes(depth(episode, frame))
                    picture = av.VideoFrame.from_ndarray(codes, format="gray12le")
                else:
                    picture = av.VideoFrame.from_ndarray(rgb(name, episode, frame), format="rgb24")
                output.mux(stream.encode(picture))
        output.mux(stream.encode())


def depth_codes(millimetres: np.ndarray) -> np.ndarray:
    """Encode depth in millimetres as lerobot does by default, in 12 bits."""
    near, far, shift = 10.0, 10000.0, 3500.0
    low, high = np.log(near + shift), np.log(far + shift)
    share = (np.log(millimetres.astype(np.float32) + np.float32(shift)) - low) / (high - low)
    return np.rint(share * 4095).clip(0, 4095).astype(np.uint16)
