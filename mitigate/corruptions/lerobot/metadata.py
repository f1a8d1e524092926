"""Read and check the metadata of a LeRobot dataset: features, cameras, tasks and episodes."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mitigate.core.names import short
from mitigate.core.observation import DEPTH, RGB
from mitigate.corruptions.frame_files import MAX_PIXELS
from mitigate.corruptions.lerobot.depth import DepthCode
from mitigate.corruptions.lerobot.tables import (
    BATCH_ROWS,
    FIX,
    check_columns,
    integers,
    numbers,
    open_table,
    read_columns,
)

INFO = "meta/info.json"
TASKS = "meta/tasks.parquet"
EPISODES = "meta/episodes"
VIDEO = "video"
IMAGE = "image"
# dtypes of lerobot: numpy dtypes, and the dtypes in src/lerobot/datasets/feature_utils.py
NUMBERS = (
    *("float16", "float32", "float64", "bool"),
    *(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)),
)
DTYPES = (*NUMBERS, IMAGE, VIDEO, "string", "language")
# Heuristic limits.
MAX_FEATURES = 1 << 12
MAX_NAME = 200  # maximum length of a feature's name in characters
MAX_TEMPLATE = 200  # maximum length of a path template in characters
MAX_TASK = 1 << 16  # maximum length of a task in characters
MAX_INDEX = 10**6  # maximum index of chunks and files
MAX_FPS = 1000.0

# the fields of a path template, which ``str.format`` fills
_FIELD = re.compile(r"\{(?:(?:chunk_index|file_index)(?::0[1-9]d)?|video_key)\}")
CONVERTER = "python -m lerobot.scripts.convert_dataset_v21_to_v30 --repo-id=USER/NAME --root=FOLDER"


@dataclass(frozen=True)
class Camera:
    """A camera of a dataset."""

    name: str  # name of the feature, such as "observation.images.front"
    kind: str  # "rgb" or "depth"
    stored: str  # "video", or "image" for encoded images in the rows of data/
    height: int  # pixels
    width: int  # pixels
    code: DepthCode | None = None  # how a depth video encodes metres; None for other cameras
    # metres per unit of depth images; None means 0.001 for integer images and 1 for others
    unit: float | None = None


@dataclass(frozen=True)
class Episode:
    """The files that contain an episode; their paths are relative to the dataset."""

    index: int  # number of the episode
    length: int  # number of frames
    data: str  # the file with the episode's rows
    # by camera: the video file, and the time in seconds at which the episode starts in the file
    videos: Mapping[str, tuple[str, float]]


def check_version(file: Path, info: Mapping[str, Any]) -> None:
    """Raise ValueError unless the dataset has version 3."""
    version = info.get("codebase_version")
    number = re.fullmatch(r"v?(\d+)\.(\d+)(\.\d+)?", version) if isinstance(version, str) else None
    if number is None:
        raise ValueError(f"{file}: codebase_version must be v3.0, got {short(version)}. {FIX}")
    if int(number[1]) < 3:
        before = "" if number[0].lstrip("v").startswith("2.1") else "Convert it to v2.1 first. "
        raise ValueError(
            f"{file.parent.parent} is a LeRobot dataset of version {short(version)}, but v3.0 is "
            f"needed. {before}Run, in the environment of lerobot: {CONVERTER}"
        )
    if int(number[1]) > 3:
        raise ValueError(
            f"{file.parent.parent} is a LeRobot dataset of version {short(version)}, but v3.x is "
            "needed. A newer release of mitigate may read it."
        )


def check_features(file: Path, info: Mapping[str, Any]) -> dict[str, Any]:
    """Return the features of the dataset; raise ValueError if one is invalid."""
    features = info.get("features")
    if not isinstance(features, dict) or not 0 < len(features) <= MAX_FEATURES:
        raise ValueError(
            f"{file}: features must be an object with 1 to {MAX_FEATURES} entries. {FIX}"
        )
    for name, feature in features.items():
        # lerobot also forbids slashes (_validate_feature_names)
        if not 0 < len(name) <= MAX_NAME or re.search(r"^\.|[/\\\0]", name):
            raise ValueError(
                f"{file}: the name of a feature must have 1 to {MAX_NAME} characters without / and "
                f"\\, and must not begin with a dot, got {short(name)}."
            )
        dtype = feature.get("dtype") if isinstance(feature, dict) else None
        if dtype not in DTYPES:
            raise ValueError(
                f"{file}: dtype of {short(name)} must be one of {', '.join(DTYPES)}, got "
                f"{short(dtype)}. {FIX}"
            )
        shape = feature.get("shape")
        sides = shape if isinstance(shape, list) else [None]
        if dtype != "language" and not all(type(s) is int and 0 < s <= MAX_PIXELS for s in sides):
            raise ValueError(
                f"{file}: shape of {short(name)} must be a list of numbers above 0, got "
                f"{short(shape)}. {FIX}"
            )
    return features


def read_camera(file: Path, name: str, feature: Mapping[str, Any]) -> Camera | str:
    """Return the camera of a feature, or the reason why it cannot be used.

    The reason begins with a verb ("has 2 dimensions instead of 3"), so that it can follow the name
    of the camera.
    """
    shape, names = feature["shape"], feature.get("names")
    info = {
        key: value
        for place in ("video_info", "info")
        if isinstance(feature.get(place), dict)
        for key, value in feature[place].items()
    }
    is_depth = bool(info.get("is_depth_map") or info.get("video.is_depth_map"))
    if len(shape) != 3:
        return f"has {len(shape)} dimensions instead of 3"
    named_first = isinstance(names, list) and str(names[:1]).lower().startswith("['c")
    channels = (1,) if is_depth else (3,)
    first = shape[0] in channels and (shape[2] not in channels or named_first)
    count, height, width = shape if first else (shape[2], shape[0], shape[1])
    if count not in channels:
        return f"has {count} channels instead of {channels[0]} ({DEPTH if is_depth else RGB})"
    if height * width > MAX_PIXELS:
        return f"has more than {MAX_PIXELS} pixels"
    stored = feature["dtype"]
    if not is_depth:
        return Camera(name, RGB, stored, height, width)
    if stored == VIDEO:
        code = DepthCode.of(info, f"{file}, {name}")
        return Camera(name, DEPTH, stored, height, width, code=code)
    unit = info.get("depth_unit")
    if unit not in (None, "m", "mm"):
        raise ValueError(f"{file}: depth_unit of {name} must be m or mm, got {short(unit)}.")
    metres = {None: None, "m": 1.0, "mm": 0.001}[unit]
    return Camera(name, DEPTH, stored, height, width, unit=metres)


def read_tasks(path: Path) -> dict[int, str]:
    """Read the text of each task.

    pandas writes the text of a task as the index of the table; the index may have no name.
    """
    tasks: dict[int, str] = {}
    with open_table(path) as file:
        names = file.schema_arrow.names
        text = "__index_level_0__" if "task" not in names else "task"
        check_columns(path, names, ("task_index", text))
        # read in batches, because a column of equal texts may be far larger in memory than its file
        for batch in file.iter_batches(BATCH_ROWS, columns=["task_index", text]):
            values = batch.column(text).to_pylist()
            for number, task in zip(integers(batch, "task_index", path), values, strict=True):
                if not isinstance(task, str) or len(task) > MAX_TASK:
                    raise ValueError(
                        f"{path}: task {number} must be a string of at most {MAX_TASK} characters, "
                        f"got {short(task)}. {FIX}"
                    )
                tasks[number] = task
    return tasks


def read_episodes(path: Path, info: Mapping[str, Any], videos: list[str]) -> dict[int, Episode]:
    """Return the episodes of the dataset at ``path`` by number."""
    files = sorted((path / EPISODES).glob("*/*.parquet"))
    if not files:
        raise FileNotFoundError(f"{path} has no files {EPISODES}/chunk-*/file-*.parquet. {FIX}")
    file = path / INFO
    data_path = _template(file, "data_path", info.get("data_path"))
    video_path = _template(file, "video_path", info.get("video_path")) if videos else ""
    if len(videos) > 1 and "{video_key}" not in video_path:
        raise ValueError(
            f"{file}: video_path must contain {{video_key}}, because the dataset has "
            f"{len(videos)} video cameras, got {short(video_path)}. {FIX}"
        )
    whole = ["episode_index", "length", "data/chunk_index", "data/file_index"]
    whole += [f"videos/{v}/{part}_index" for v in videos for part in ("chunk", "file")]
    starts = [f"videos/{video}/from_timestamp" for video in videos]
    episodes: dict[int, Episode] = {}
    for table_path in files:
        table = read_columns(table_path, [*whole, *starts])
        columns = {name: integers(table, name, table_path) for name in whole}
        times = {name: numbers(table, name, table_path) for name in starts}
        for row in range(table.num_rows):
            parts = {
                video: (
                    _fill(video_path, columns, row, f"videos/{video}", table_path),
                    times[start][row],
                )
                for video, start in zip(videos, starts, strict=True)
            }
            number, length = columns["episode_index"][row], columns["length"][row]
            if number in episodes or number < 0 or length < 1:
                raise ValueError(
                    f"{table_path}: each episode must have its own number and at least 1 frame, "
                    f"got episode {number} with {length} frames. {FIX}"
                )
            data = _fill(data_path, columns, row, "data", table_path)
            episodes[number] = Episode(number, length, data, parts)
    total = info.get("total_episodes")
    if total != len(episodes) or not episodes:
        raise ValueError(
            f"{path} is incomplete: {INFO} announces {short(total)} episodes, but "
            f"{EPISODES} has {len(episodes)}. {FIX}"
        )
    return dict(sorted(episodes.items()))


def _template(file: Path, key: str, template: object) -> str:
    """Check a path template that meta/info.json contains, and return it.

    Raises:
        ValueError: If the template is not a relative path, leads outside of the dataset, or has a
            field other than chunk_index, file_index and (for videos) video_key.
    """
    is_video = key == "video_path"
    fields = "{chunk_index:03d}, {file_index:03d}" + ", {video_key}" * is_video
    if isinstance(template, str) and len(template) <= MAX_TEMPLATE:
        plain = _FIELD.sub("0", template)
        has_fields = is_video or "{video_key" not in template
        # no part of the path may be empty, hidden or "..", so that each file has exactly one path
        if has_fields and re.fullmatch(r"[^./{}\\\0][^/{}\\\0]*(/[^./{}\\\0][^/{}\\\0]*)*", plain):
            return template
    raise ValueError(
        f"{file}: {key} must be a path inside the dataset with the fields {fields}, got "
        f"{short(template)}. {FIX}"
    )


def _fill(
    template: str, columns: Mapping[str, list[int]], row: int, prefix: str, path: Path
) -> str:
    """Return the path of the file that contains an episode's rows, or its frames of one camera.

    Args:
        template: A checked template.
        columns: Columns of a file in meta/episodes.
        row: Row of the episode.
        prefix: "data", or "videos/" and the name of the camera.
        path: The file that contains the columns.

    Raises:
        ValueError: If the index of a chunk or file is out of range.
    """
    chunk = columns[f"{prefix}/chunk_index"][row]
    file = columns[f"{prefix}/file_index"][row]
    if not (0 <= chunk < MAX_INDEX and 0 <= file < MAX_INDEX):
        raise ValueError(
            f"{path}: chunk_index and file_index must be between 0 and {MAX_INDEX - 1}, got "
            f"{chunk} and {file}. {FIX}"
        )
    video = prefix.removeprefix("videos/")
    return template.format(chunk_index=chunk, file_index=file, video_key=video)
