"""Open a LeRobot dataset and read its metadata and rows, but not its frames."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from mitigate.core.json_files import read_object
from mitigate.core.names import LONGEST_NAME, short, unknown
from mitigate.corruptions.lerobot.metadata import (
    IMAGE,
    INFO,
    MAX_FPS,
    NUMBERS,
    TASKS,
    VIDEO,
    Camera,
    Episode,
    check_features,
    check_version,
    read_camera,
    read_episodes,
    read_tasks,
)
from mitigate.corruptions.lerobot.tables import FIX, integers, numbers, read_columns

# columns that every file of data/ has (DEFAULT_FEATURES of lerobot)
COLUMNS = ("episode_index", "frame_index", "timestamp", "task_index")
TOLERANCE = 1e-4  # maximum seconds between a row and its video frame (tolerance_s of lerobot)
MAX_SIGNAL = 1 << 12  # maximum number of values per row of a feature that is read as a signal


@dataclass(frozen=True)
class Rows:
    """Rows of one file of data/, in the order of the file."""

    episodes: np.ndarray  # int64 [N], number of the episode
    frames: np.ndarray  # int64 [N], number of the frame in its episode
    times: np.ndarray  # float64 [N], seconds since the start of the episode
    tasks: np.ndarray  # int64 [N], number of the task


@dataclass(frozen=True)
class Dataset:
    """An opened dataset."""

    path: Path
    info: Mapping[str, Any]  # content of meta/info.json
    cameras: Mapping[str, Camera]  # cameras by name
    other_cameras: Mapping[str, str]  # the reason why a camera cannot be used, by name
    episodes: Mapping[int, Episode]  # episodes by number
    tasks: Mapping[int, str]  # text of each task, by number

    @property
    def features(self) -> Mapping[str, Any]:
        """Features by name, as in meta/info.json."""
        return self.info["features"]

    @cached_property
    def signals(self) -> dict[str, int]:
        """The number of values per row of each numeric feature, except ``COLUMNS``."""
        sizes = {
            name: math.prod(feature["shape"])
            for name, feature in self.features.items()
            if feature["dtype"] in NUMBERS and name not in (*COLUMNS, "index")
        }
        return {name: size for name, size in sizes.items() if size <= MAX_SIGNAL}

    def choose_cameras(self, kind: str, names: Sequence[str] | None = None) -> list[Camera]:
        """Return the cameras of a kind ("rgb" or "depth").

        If ``names`` is given, only the cameras in ``names`` are returned.

        Raises:
            ValueError: If a name is unknown, or its camera cannot be used.
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

    def choose_camera(self, kind: str, name: str | None, option: str) -> Camera:
        """Return the camera called ``name``, or the only camera of a kind if ``name`` is None.

        Raises:
            ValueError: If not exactly one camera matches; the message names ``option``.
        """
        cameras = self.choose_cameras(kind, name and [name])
        if len(cameras) != 1:
            raise ValueError(
                f"{option} must name one of the {kind} cameras of {self.path}, because "
                f"{len(cameras)} cameras match. All cameras: {', '.join(self.cameras) or 'none'}."
            )
        return cameras[0]

    def choose_episodes(self, numbers: Sequence[int] | None) -> list[Episode]:
        """Return the episodes with these numbers, or all episodes if ``numbers`` is None.

        Raises:
            ValueError: If a number is unknown.
        """
        for number in numbers or ():
            if number not in self.episodes:
                raise ValueError(
                    f"{self.path} has no episode {number}. Choose a number from "
                    f"{min(self.episodes)} to {max(self.episodes)}."
                )
        chosen = self.episodes if numbers is None else dict.fromkeys(numbers)
        return [self.episodes[number] for number in sorted(chosen)]

    def read_rows(self, data: str) -> Rows:
        """Read the rows of a file in data/.

        Raises:
            FileNotFoundError: If the file is missing.
            ValueError: If the file is damaged, or the rows of an episode are incomplete or not in
                order.
        """
        path = self.path / data
        table = read_columns(path, COLUMNS)
        whole = (np.array(integers(table, c, path), np.int64) for c in COLUMNS if c != "timestamp")
        episodes, frames, tasks = whole
        rows = Rows(episodes, frames, np.array(numbers(table, "timestamp", path)), tasks)
        for episode in self.episodes.values():
            if episode.data != data:
                continue
            mine = rows.episodes == episode.index
            if not np.array_equal(rows.frames[mine], np.arange(episode.length)):
                raise ValueError(
                    f"{path} must hold the rows of episode {episode.index} in order (frame_index "
                    f"0 to {episode.length - 1}), got {int(mine.sum())} rows. {FIX}"
                )
            if (np.diff(rows.times[mine]) <= 0).any():
                raise ValueError(
                    f"{path}: the timestamps of episode {episode.index} must increase. {FIX}"
                )
        return rows

    def instruction(self, rows: Rows, name: str) -> str:
        """Return the task of the first row of an episode, and warn if other rows have other tasks.

        Args:
            rows: The rows of the episode.
            name: Name of the episode in messages.

        Raises:
            ValueError: If the task is unknown.
        """
        first = int(rows.tasks[0])
        if first not in self.tasks:
            raise ValueError(
                f"{name} has the task {first}, which {TASKS} lacks. Copy the dataset again."
            )
        count = len(np.unique(rows.tasks))
        if count > 1:
            warnings.warn(
                f"{name} has {count} tasks. The instruction is the first: "
                f"{short(self.tasks[first], LONGEST_NAME)}.",
                stacklevel=3,
            )
        return self.tasks[first]

    def read_signals(self, data: str) -> dict[str, np.ndarray]:
        """Read the numeric features, such as state and action, from a file in data/.

        Returns:
            For each feature of ``signals``, an array float64 [N, size].

        Raises:
            FileNotFoundError: If the file is missing.
            ValueError: If the file is damaged, or a feature has a different shape.
        """
        path = self.path / data
        table = read_columns(path, (), list(self.signals))
        return {
            name: _flatten(table.column(name), size, name, path)
            for name, size in self.signals.items()
            if name in table.column_names
        }


def is_dataset(folder: Path | str) -> bool:
    """Return whether a folder contains a LeRobot dataset of any version."""
    return (Path(folder) / INFO).is_file()


def open_dataset(folder: Path | str) -> Dataset:
    """Open a dataset of version 3 and check its metadata.

    Raises:
        FileNotFoundError: If a file of the metadata is missing.
        ValueError: If the dataset has another version, is damaged or incomplete, or ``pyarrow`` is
            not installed.
    """
    path = Path(folder)
    file = path / INFO
    if not file.is_file():
        raise FileNotFoundError(f"{path} is not a LeRobot dataset: it lacks {INFO}.")
    info = read_object(file, FIX)
    check_version(file, info)
    fps = info.get("fps")
    if isinstance(fps, bool) or not isinstance(fps, (int, float)) or not 0 < fps <= MAX_FPS:
        raise ValueError(f"{file}: fps must be above 0 and at most {MAX_FPS:g}, got {short(fps)}.")
    features = check_features(file, info)
    read = {
        name: read_camera(file, name, feature)
        for name, feature in features.items()
        if feature["dtype"] in (IMAGE, VIDEO)
    }
    cameras = {name: camera for name, camera in read.items() if isinstance(camera, Camera)}
    other = {name: reason for name, reason in read.items() if isinstance(reason, str)}
    videos = [name for name in features if features[name]["dtype"] == VIDEO]
    episodes = read_episodes(path, info, videos)
    return Dataset(path, info, cameras, other, episodes, read_tasks(path / TASKS))


def _flatten(column: Any, size: int, name: str, path: Path) -> np.ndarray:
    """Convert a column of numbers, or of lists of ``size`` numbers, to float64 [N, size]."""
    import pyarrow

    array = pyarrow.chunked_array(column).combine_chunks() if column.num_chunks else column
    # arrays have this type if `datasets` is imported
    if isinstance(array.type, pyarrow.BaseExtensionType):
        array = array.storage
    while _is_list(array.type):
        array = array.flatten()
    values = np.asarray(array.to_numpy(zero_copy_only=False))
    if values.dtype.kind not in "fiub" or len(values) != size * len(column):
        raise ValueError(
            f"{path}: each row of {short(name)} must hold {size} numbers, according to {INFO}, but "
            f"{len(column)} rows hold {len(values)} numbers ({short(str(column.type))}). {FIX}"
        )
    return values.astype(np.float64).reshape(len(column), size)


def _is_list(kind: Any) -> bool:
    from pyarrow import types

    return types.is_list(kind) or types.is_large_list(kind) or types.is_fixed_size_list(kind)


def rows_of(
    dataset: Dataset, episodes: Sequence[Episode]
) -> Iterator[tuple[Episode, Rows, np.ndarray]]:
    """Yield each episode, its rows, and a mask that marks these rows in their file.

    The mask is bool [rows of the file].
    """
    read: dict[str, Rows] = {}
    for episode in episodes:
        if episode.data not in read:
            # only one file is kept in memory
            read = {episode.data: dataset.read_rows(episode.data)}
        rows = read[episode.data]
        mine = rows.episodes == episode.index
        yield episode, Rows(*(values[mine] for values in vars(rows).values())), mine
