"""Read the frames of an episode of a LeRobot dataset, from videos or from images in rows.

RGB images are PNG or JPEG; depth images are TIFF or 16-bit PNG.
"""

from __future__ import annotations

import io
import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from mitigate.core.observation import RGB
from mitigate.corruptions.frame_files import MAX_PIXELS, counts
from mitigate.corruptions.lerobot import videos
from mitigate.corruptions.lerobot.dataset import Dataset
from mitigate.corruptions.lerobot.metadata import VIDEO, Camera, Episode
from mitigate.corruptions.lerobot.tables import BATCH_ROWS, FIX, check_columns, integers, open_table

FORMATS = {"rgb": ("PNG", "JPEG"), "depth": ("PNG", "TIFF")}
# Pillow modes of lerobot's depth images: I;16 is uint16, F is float32
MODES = {"rgb": ("RGB",), "depth": ("I;16", "F")}
MILLIMETRE = 0.001


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
                        c.name: as_frame(stored_image(path, batch, row, c, number)[0], c)
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

    The image is uint8 [H, W, 3], uint16 [H, W] or float32 [H, W].

    Raises:
        ValueError: If the image is damaged, or its type or size differs from the camera's.
    """
    place = f"{path}: {camera.name} of frame {number}"
    value = table.column(camera.name)[row].as_py()
    data = value and value.get("bytes")
    if not isinstance(data, bytes):
        raise ValueError(
            f"{place} must contain the bytes of an image; images in separate files are not "
            f"supported. {FIX}"
        )
    try:
        with Image.open(io.BytesIO(data), formats=FORMATS[camera.kind]) as image:
            if math.prod(image.size) > MAX_PIXELS:
                raise ValueError(f"it has {image.size[0]} x {image.size[1]} pixels")
            size, mode, form = image.size, image.mode, str(image.format)
            if size == (camera.width, camera.height) and mode in MODES[camera.kind]:
                image.load()
                return np.array(image), form
    except Exception as error:  # decoders raise many kinds of errors for untrusted files
        formats = " or ".join(FORMATS[camera.kind])
        cause = " ".join(str(error).split())[:200]
        raise ValueError(f"{place} cannot be decoded as {formats}: {cause}. {FIX}") from error
    raise ValueError(
        f"{place} must have {camera.width} x {camera.height} pixels of type "
        f"{' or '.join(MODES[camera.kind])}, got {size[0]} x {size[1]} of type {mode}. {FIX}"
    )


def as_frame(stored: np.ndarray, camera: Camera) -> np.ndarray:
    """Convert a stored image to a frame.

    The frame is uint8 [H, W, 3], or float32 metres [H, W] with 0 for no reading.
    """
    if camera.kind == RGB:
        return stored
    depth = stored.astype(np.float32) * np.float32(_unit(stored, camera))
    return np.where(np.isfinite(depth) & (depth > 0), depth, 0)


def store_depth(depth: np.ndarray, stored: np.ndarray, camera: Camera) -> np.ndarray:
    """Convert corrupted depth from metres to the type and unit of ``stored``.

    Pixels that the corruption did not change keep their stored values.
    """
    unit = _unit(stored, camera)
    new = counts(depth, unit) if stored.dtype == np.uint16 else depth / np.float32(unit)
    return np.where(depth == as_frame(stored, camera), stored, new).astype(stored.dtype)


def _unit(stored: np.ndarray, camera: Camera) -> float:
    if camera.unit is not None:
        return camera.unit
    return MILLIMETRE if stored.dtype == np.uint16 else 1.0
