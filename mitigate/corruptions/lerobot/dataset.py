"""Open a LeRobot dataset: features, cameras, episodes and tasks, without its frames."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np

from mitigate.core.json_files import read_object
from mitigate.core.names import short, unknown
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
# dtypes of lerobot: those of numpy, and what src/lerobot/datasets/feature_utils.py adds
NUMBERS = (
    *("float16", "float32", "float64", "bool"),
    *(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)),
)
DTYPES = (*NUMBERS, IMAGE, VIDEO, "string", "language")
# columns of every row of data/: DEFAULT_FEATURES of lerobot
COLUMNS = ("episode_index", "frame_index", "timestamp", "task_index")
TOLERANCE = 1e-4  # seconds between a row and its video frame: tolerance_s of lerobot
# Heuristic limits.
MAX_FEATURES = 1 << 12
MAX_NAME = 200  # characters of the name of a feature
MAX_TEMPLATE = 200  # characters of a path template
MAX_TASK = 1 << 16  # characters of a task
MAX_INDEX = 10**6  # of chunks and files
MAX_FPS = 1000.0
MAX_SIGNAL = 1 << 12  # numbers per row of a feature that is read as a signal

_FIELD = re.compile(r"\{(chunk_index|file_index|video_key)(?::0?([1-9])d)?\}")
CONVERTER = "python -m lerobot.scripts.convert_dataset_v21_to_v30 --repo-id=USER/NAME --root=FOLDER"


@dataclass(frozen=True)
class Camera:
    """A camera of a dataset.

    Attributes:
        name: Name of the feature, such as "observation.images.front".
        kind: "rgb" or "depth".
        stored: "video" or "image" (encoded images in the rows of data/).
        height: Pixels.
        width: Pixels.
        code: How a depth video encodes metres; None for other cameras.
        unit: Metres per unit of depth images; None: 0.001 for whole numbers, 1 for others.
    """

    name: str
    kind: str
    stored: str
    height: int
    width: int
    code: DepthCode | None = None
    unit: float | None = None


@dataclass(frozen=True)
class Episode:
    """Where the parts of an episode are.

    Attributes:
        index: Number of the episode.
        length: Number of frames.
        data: Path of the file with its rows, relative to the dataset.
        videos: For each camera that is stored as video: path of the file, and seconds from the
            start of that file to the episode.
    """

    index: int
    length: int
    data: str
    videos: Mapping[str, tuple[str, float]]


@dataclass(frozen=True)
class Rows:
    """The rows of some episodes in one file of data/, in the order of the file.

    Attributes:
        episodes: int64 [N], number of the episode.
        frames: int64 [N], number of the frame in its episode.
        times: float64 [N], seconds since the start of the episode.
        tasks: int64 [N], number of the task.
    """

    episodes: np.ndarray
    frames: np.ndarray
    times: np.ndarray
    tasks: np.ndarray


@dataclass(frozen=True)
class Dataset:
    """An opened dataset.

    Attributes:
        path: The folder.
        info: Content of meta/info.json.
        fps: Frames per second.
        cameras: Cameras by name.
        other_cameras: Reason why a camera cannot be used, by name.
        episodes: The episodes, by their number.
        tasks: Text of each task, by its number.
    """

    path: Path
    info: Mapping[str, Any]
    fps: float
    cameras: Mapping[str, Camera]
    other_cameras: Mapping[str, str]
    episodes: Mapping[int, Episode]
    tasks: Mapping[int, str]

    @property
    def features(self) -> Mapping[str, Any]:
        """Features by name, as in meta/info.json."""
        return self.info["features"]

    @cached_property
    def signals(self) -> dict[str, int]:
        """Number of values per row of the features that hold numbers, without ``COLUMNS``."""
        sizes = {
            name: math.prod(feature["shape"])
            for name, feature in self.features.items()
            if feature["dtype"] in NUMBERS and name not in (*COLUMNS, "index")
        }
        return {name: size for name, size in sizes.items() if size <= MAX_SIGNAL}

    def choose_cameras(self, kind: str, names: Sequence[str] | None = None) -> list[Camera]:
        """Return the cameras of a kind ("rgb", "depth"), or those of ``names`` of this kind.

        Raises:
            ValueError: A name is unknown, or its camera cannot be used.
        """
        for name in names or ():
            if name in self.other_cameras:
                raise ValueError(
                    f"The camera {name} of {self.path} {self.other_cameras[name]}. Choose one of: "
                    f"{', '.join(self.cameras) or 'none'}."
                )
            if name not in self.cameras:
                raise ValueError(unknown("camera", name, list(self.cameras)))
        chosen = [c for c in self.cameras.values() if c.kind == kind]
        return [c for c in chosen if not names or c.name in names]

    def choose_episodes(self, numbers: Sequence[int] | None) -> list[Episode]:
        """Return the episodes with these numbers; None: all. ValueError for an unknown number."""
        for number in numbers or ():
            if number not in self.episodes:
                raise ValueError(
                    f"{self.path} has no episode {number}. Choose from {min(self.episodes)} to "
                    f"{max(self.episodes)}."
                )
        chosen = self.episodes if numbers is None else dict.fromkeys(numbers)
        return [self.episodes[number] for number in sorted(chosen)]

    def read_rows(self, data: str) -> Rows:
        """Read the rows of a file of data/.

        Raises:
            FileNotFoundError: The file is missing.
            ValueError: The file is damaged, or an episode lacks rows, or has them out of order.
        """
        path = self.path / data
        table = read_columns(path, COLUMNS)
        whole = (np.array(integers(table, c, path), np.int64) for c in COLUMNS if c != "timestamp")
        episodes, frames, tasks = whole
        rows = Rows(episodes, frames, np.array(numbers(table, "timestamp", path)), tasks)
        for episode in self.episodes.values():
            if episode.data == data:
                self._check_rows(path, episode, rows)
        return rows

    def _check_rows(self, path: Path, episode: Episode, rows: Rows) -> None:
        mine = rows.episodes == episode.index
        expected = np.arange(episode.length)
        if not np.array_equal(rows.frames[mine], expected):
            raise ValueError(
                f"{path} must hold the rows of episode {episode.index} in order (frame_index 0 to "
                f"{episode.length - 1}), got {int(mine.sum())} rows. {FIX}"
            )
        if len(expected) > 1 and np.diff(rows.times[mine]).min() <= 0:
            raise ValueError(
                f"{path}: the timestamps of episode {episode.index} must increase. {FIX}"
            )

    def read_signals(self, data: str) -> dict[str, np.ndarray]:
        """Read the numbers of each row of a file of data/, such as state and action.

        Returns:
            For each feature of ``signals``: float64 [N, size].

        Raises:
            FileNotFoundError: The file is missing.
            ValueError: The file is damaged, or a feature has a different shape.
        """
        path = self.path / data
        table = read_columns(path, (), list(self.signals))
        return {
            name: _flatten(table.column(name), size, name, path)
            for name, size in self.signals.items()
            if name in table.column_names
        }


def is_dataset(folder: Path | str) -> bool:
    """Return whether a folder holds a LeRobot dataset, of any version."""
    return (Path(folder) / INFO).is_file()


def open_dataset(folder: Path | str) -> Dataset:
    """Open a dataset and check its metadata.

    Args:
        folder: A dataset of version 3.

    Returns:
        The dataset.

    Raises:
        FileNotFoundError: A file of the metadata is missing.
        ValueError: The dataset has another version, is damaged or incomplete, or ``pyarrow`` is
            not installed.
    """
    path = Path(folder)
    file = path / INFO
    if not file.is_file():
        raise FileNotFoundError(f"{path} is not a LeRobot dataset: it lacks {INFO}.")
    info = read_object(file, FIX)
    _check_version(file, info)
    fps = info.get("fps")
    if isinstance(fps, bool) or not isinstance(fps, (int, float)) or not 0 < fps <= MAX_FPS:
        raise ValueError(f"{file}: fps must be above 0, at most {MAX_FPS:g}, got {short(fps)}.")
    features = _check_features(file, info)
    cameras: dict[str, Camera] = {}
    other: dict[str, str] = {}
    for name, feature in features.items():
        if feature["dtype"] in (IMAGE, VIDEO):
            camera = _camera(file, name, feature)
            if isinstance(camera, str):
                other[name] = camera
            else:
                cameras[name] = camera
    videos = [name for name in features if features[name]["dtype"] == VIDEO]
    episodes = _read_episodes(path, info, videos)
    return Dataset(path, info, float(fps), cameras, other, episodes, _read_tasks(path / TASKS))


def _check_version(file: Path, info: Mapping[str, Any]) -> None:
    version = info.get("codebase_version")
    number = re.fullmatch(r"v?(\d+)\.(\d+)(\.\d+)?", version) if isinstance(version, str) else None
    if number is None:
        raise ValueError(f"{file}: codebase_version must be v3.0, got {short(version)}. {FIX}")
    if int(number[1]) < 3:
        before = "" if number[0].lstrip("v").startswith("2.1") else "Convert it to v2.1 first. "
        raise ValueError(
            f"{file.parent.parent} is a LeRobot dataset of version {short(version)}, but v3.0 is "
            f"needed. {before}In the environment of lerobot: {CONVERTER}"
        )
    if int(number[1]) > 3:
        raise ValueError(
            f"{file.parent.parent} is a LeRobot dataset of version {short(version)}, but v3.x is "
            "needed. A newer release of mitigate may read it."
        )


def _check_features(file: Path, info: Mapping[str, Any]) -> dict[str, Any]:
    features = info.get("features")
    if not isinstance(features, dict) or not 0 < len(features) <= MAX_FEATURES:
        raise ValueError(
            f"{file}: features must be an object with 1 to {MAX_FEATURES} entries. {FIX}"
        )
    for name, feature in features.items():
        # lerobot forbids a slash too (_validate_feature_names)
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


def _camera(file: Path, name: str, feature: Mapping[str, Any]) -> Camera | str:
    """Return the camera of a feature, or why it cannot be used (the end of a sentence)."""
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
    kind, stored = (DEPTH if is_depth else RGB), feature["dtype"]
    if not is_depth:
        return Camera(name, kind, stored, height, width)
    if stored == VIDEO:
        return Camera(name, kind, stored, height, width, code=DepthCode.of(info, f"{file}, {name}"))
    unit = info.get("depth_unit")
    if unit not in (None, "m", "mm"):
        raise ValueError(f"{file}: depth_unit of {name} must be m or mm, got {short(unit)}.")
    metres = {None: None, "m": 1.0, "mm": 0.001}[unit]
    return Camera(name, kind, stored, height, width, unit=metres)


def _read_tasks(path: Path) -> dict[int, str]:
    """Read the text of each task.

    pandas writes the text as the index of the table, with or without a name.
    """
    tasks: dict[int, str] = {}
    with open_table(path) as file:
        names = file.schema_arrow.names
        text = "__index_level_0__" if "task" not in names else "task"
        check_columns(path, names, ("task_index", text))
        # a batch at a time: a column of equal texts may be far larger than its file
        for batch in file.iter_batches(BATCH_ROWS, columns=["task_index", text]):
            values = batch.column(text).to_pylist()
            for number, task in zip(integers(batch, "task_index", path), values, strict=True):
                if not isinstance(task, str) or len(task) > MAX_TASK:
                    raise ValueError(
                        f"{path}: task {number} must be a text of at most {MAX_TASK} characters, "
                        f"got {short(task)}. {FIX}"
                    )
                tasks[number] = task
    return tasks


def _read_episodes(path: Path, info: Mapping[str, Any], videos: list[str]) -> dict[int, Episode]:
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
            place = partial(_place, columns, row, table_path)
            parts = {
                video: (place(video_path, f"videos/{video}", video), times[start][row])
                for video, start in zip(videos, starts, strict=True)
            }
            number, length = columns["episode_index"][row], columns["length"][row]
            if number in episodes or number < 0 or length < 1:
                raise ValueError(
                    f"{table_path}: episodes must have different numbers and at least 1 frame, got "
                    f"episode {number} with {length} frames. {FIX}"
                )
            episodes[number] = Episode(number, length, place(data_path, "data"), parts)
    total = info.get("total_episodes")
    if total != len(episodes) or not episodes:
        raise ValueError(
            f"{path} is incomplete: {INFO} announces {short(total)} episodes, {EPISODES} has "
            f"{len(episodes)}. {FIX}"
        )
    return dict(sorted(episodes.items()))


def _template(file: Path, key: str, template: object) -> str:
    """Return a path template of meta/info.json after checking it.

    Raises:
        ValueError: It is not a relative path, leaves the dataset, or has other fields than
            chunk_index, file_index and video_key.
    """
    fields = "{chunk_index:03d}, {file_index:03d} and {video_key}"
    if isinstance(template, str) and len(template) <= MAX_TEMPLATE:
        plain = _FIELD.sub("0", template)
        # no part may be empty, hidden or "..", so that each file has one name
        if re.fullmatch(r"[^./{}\\\0][^/{}\\\0]*(/[^./{}\\\0][^/{}\\\0]*)*", plain):
            return template
    raise ValueError(
        f"{file}: {key} must be a path inside the dataset with the fields {fields}, got "
        f"{short(template)}. {FIX}"
    )


def _place(
    columns: Mapping[str, list[int]],
    row: int,
    path: Path,
    template: str,
    prefix: str,
    video: str = "",
) -> str:
    """Return the path of a part of an episode.

    Args:
        columns: Columns of meta/episodes.
        row: Row of the episode.
        path: The file of the columns.
        template: A checked template.
        prefix: "data", or "videos/" and the name of the camera.
        video: Name of the camera.

    Raises:
        ValueError: A number of a chunk or a file is out of range.
    """
    values = {name: columns[f"{prefix}/{name}"][row] for name in ("chunk_index", "file_index")}
    if not all(0 <= value < MAX_INDEX for value in values.values()):
        raise ValueError(
            f"{path}: chunk_index and file_index must be 0 to {MAX_INDEX - 1}, got "
            f"{values['chunk_index']} and {values['file_index']}. {FIX}"
        )

    def value(match: re.Match[str]) -> str:
        return video if match[1] == "video_key" else f"{values[match[1]]:0{match[2] or 1}d}"

    return _FIELD.sub(value, template)


def _flatten(column: Any, size: int, name: str, path: Path) -> np.ndarray:
    """Return a column of numbers, or of lists of ``size`` numbers, as float64 [N, size]."""
    import pyarrow

    array = pyarrow.chunked_array(column).combine_chunks() if column.num_chunks else column
    if isinstance(array.type, pyarrow.BaseExtensionType):  # if `datasets` is imported: arrays
        array = array.storage
    while _is_list(array.type):
        array = array.flatten()
    values = np.asarray(array.to_numpy(zero_copy_only=False))
    if values.dtype.kind not in "fiub" or len(values) != size * len(column):
        raise ValueError(
            f"{path}: each row of {short(name)} must hold {size} numbers, as {INFO} says, got "
            f"{len(values)} for {len(column)} rows ({short(str(column.type))}). {FIX}"
        )
    return values.astype(np.float64).reshape(len(column), size)


def _is_list(kind: Any) -> bool:
    from pyarrow import types

    return types.is_list(kind) or types.is_large_list(kind) or types.is_fixed_size_list(kind)


def rows_of(
    dataset: Dataset, episodes: Sequence[Episode]
) -> Iterator[tuple[Episode, Rows, np.ndarray]]:
    """Yield each episode, its rows, and where they are in their file (bool [rows of the file])."""
    read: dict[str, Rows] = {}
    for episode in episodes:
        if episode.data not in read:
            read = {episode.data: dataset.read_rows(episode.data)}  # keep one file in memory
        rows = read[episode.data]
        mine = rows.episodes == episode.index
        yield episode, Rows(*(values[mine] for values in vars(rows).values())), mine
