"""Read the frames of an episode of a LeRobot dataset."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from mitigate.corruptions.lerobot import images, videos
from mitigate.corruptions.lerobot.dataset import Dataset
from mitigate.corruptions.lerobot.metadata import VIDEO, Camera, Episode
from mitigate.corruptions.lerobot.tables import BATCH_ROWS, FIX, check_columns, integers, open_table


def read_frames(
    dataset: Dataset,
    episode: Episode,
    cameras: Sequence[Camera],
    chosen: Sequence[int],
    times: Sequence[float],
    tolerance: float,
) -> Iterator[dict[str, np.ndarray]]:
    """Yield the frames of an episode, in order.

    Args:
        dataset: The dataset.
        episode: The episode.
        cameras: Cameras to read.
        chosen: Frame numbers, in increasing order.
        times: For each chosen frame, the seconds since the start of the episode.
        tolerance: Maximum time in seconds between a row and its video frame.

    Yields:
        A dict with the frame of each camera: uint8 [H, W, 3], or float32 metres [H, W] with 0 for
        no reading.

    Raises:
        FileNotFoundError: If a file is missing.
        ValueError: If a file is damaged, or a video has no frame near one of the times.
    """
    streams = [
        _video_frames(dataset, episode, camera, times, tolerance)
        for camera in cameras
        if camera.stored == VIDEO
    ]
    in_rows = [camera for camera in cameras if camera.stored != VIDEO]
    if in_rows:
        streams.append(_image_frames(dataset.path / episode.data, episode.index, in_rows, chosen))
    for parts in zip(*streams, strict=True):
        yield {name: frame for part in parts for name, frame in part.items()}


def _video_frames(
    dataset: Dataset, episode: Episode, camera: Camera, times: Sequence[float], tolerance: float
) -> Iterator[dict[str, np.ndarray]]:
    file, start = episode.videos[camera.name]
    in_file = [start + time for time in times]
    for frame in videos.decode(dataset.path / file, camera, in_file, tolerance):
        yield {camera.name: frame}


def _image_frames(
    path: Path, episode: int, cameras: Sequence[Camera], chosen: Sequence[int]
) -> Iterator[dict[str, np.ndarray]]:
    pending = list(chosen)[::-1]
    names = [camera.name for camera in cameras]
    with open_table(path) as file:
        check_images(path, file.schema_arrow, cameras)
        for batch in _batches(path, file, episode, names):
            numbers = integers(batch, "frame_index", path)
            is_in_episode = [number == episode for number in integers(batch, "episode_index", path)]
            for row, number in enumerate(numbers):
                if pending and is_in_episode[row] and number == pending[-1]:
                    pending.pop()
                    yield {
                        c.name: images.as_frame(stored_image(path, batch, row, c, number)[0], c)
                        for c in cameras
                    }
    if pending:
        raise ValueError(f"{path} lacks frame {pending[-1]} of episode {episode}. {FIX}")


def _batches(path: Path, file: Any, episode: int, names: Sequence[str]) -> Iterator[Any]:
    """Yield the rows of all row groups that contain the episode, in small batches."""
    for group in range(file.num_row_groups):
        column = file.read_row_group(group, columns=["episode_index"])
        if episode in integers(column, "episode_index", path):
            columns = ["episode_index", "frame_index", *names]
            yield from file.iter_batches(BATCH_ROWS, row_groups=[group], columns=columns)


def check_images(path: Path, schema: Any, cameras: Sequence[Camera]) -> None:
    """Raise ValueError unless the table has, for each camera, a column with the bytes of images."""
    from pyarrow import types

    check_columns(path, schema.names, [camera.name for camera in cameras])
    for camera in cameras:
        kind = schema.field(camera.name).type
        is_image = types.is_struct(kind) and kind.get_field_index("bytes") >= 0
        if not (is_image and _is_binary(kind.field("bytes").type)):
            raise ValueError(
                f"{path}: the column {camera.name} must hold images (a struct with bytes), got "
                f"{str(kind)[:80]}. {FIX}"
            )


def _is_binary(kind: Any) -> bool:
    from pyarrow import types

    return types.is_binary(kind) or types.is_large_binary(kind)


def stored_image(
    path: Path, table: Any, row: int, camera: Camera, number: int
) -> tuple[np.ndarray, str]:
    """Return an image from a table, as it is stored, and its file format.

    Raises:
        ValueError: If the image is damaged, or its type or size differs from the camera's.
    """
    value = table.column(camera.name)[row].as_py()
    try:
        return images.decode(value and value.get("bytes"), camera)
    except ValueError as error:
        raise ValueError(f"{path}: {camera.name} of frame {number} {error}. {FIX}") from error
