"""Read poses, lenses and images from ROS messages. The content is checked because bags may come
from untrusted sources.
"""

from __future__ import annotations

import io
import struct
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from PIL import Image

from mitigate.core.observation import DEPTH, RGB
from mitigate.corruptions.frame_files import NO_READING
from mitigate.worlds.recorded.source import Lens, clean_depth, heading_along

FISHEYE = ("equidistant", "fisheye")  # names of fisheye distortion models in ROS
MAX_SIDE = 1 << 13  # maximum width and height of an image in pixels (heuristic)
# maximum number of characters of an encoding's name; longer names are cut (heuristic)
MAX_ENCODING = 100
# number of header bytes before the PNG data in `compressedDepth` images
COMPRESSED_DEPTH_HEADER = 12
_COLOURS = {  # maps the name of an encoding to the number of channels and the conversion to RGB
    "rgb8": (3, None),
    "bgr8": (3, cv2.COLOR_BGR2RGB),
    "rgba8": (4, cv2.COLOR_RGBA2RGB),
    "bgra8": (4, cv2.COLOR_BGRA2RGB),
    "mono8": (1, cv2.COLOR_GRAY2RGB),
    "8UC3": (3, cv2.COLOR_BGR2RGB),
}
# maps the name of an encoding to its pixel type
_DEPTHS = {"16UC1": "u2", "mono16": "u2", "32FC1": "f4"}


class DamagedImage(ValueError):
    """Raised if the bytes of a single image cannot be decoded."""


def encoding_of(message: Any) -> str:
    """Return the ``encoding`` of an Image, or the ``format`` of a CompressedImage."""
    return str(_field(message, "format", "encoding"))[:MAX_ENCODING]


def kind_of(encoding: str) -> str | None:
    """Return "rgb" or "depth", or None if both kinds of images may use the encoding."""
    if "compressedDepth" in encoding or encoding.startswith(("16UC1", "32FC1")):
        return DEPTH
    return RGB if "jpeg" in encoding or encoding.startswith(tuple(_COLOURS)) else None


def depth_unit(encoding: str) -> float:
    """Return the metres per count that REP 118 prescribes: 1 for 32FC1, and 0.001 for integers."""
    return 1.0 if encoding == "32FC1" else 0.001


def read_pose(message: Any) -> tuple[float, float, float]:
    """Return the plan pose (x, y, heading). The heading is NaN if the rotation is invalid."""
    while (inner := _field(message, "pose")) is not None:
        message = inner
    position, turn = message.position, message.orientation
    heading = heading_along((turn.x, turn.y, turn.z, turn.w), (1.0, 0.0, 0.0))
    return float(position.x), float(position.y), heading


def _field(message: Any, *names: str) -> Any:
    """Return the value of the first of ``names`` that is a field of the message, or None.

    Several names are needed because ROS 1 and ROS 2 name some fields differently.
    """
    return next((getattr(message, name) for name in names if hasattr(message, name)), None)


def read_stamp(raw: bytes, ros2: bool) -> float:
    """Return the time in seconds from the header of a serialised message, or 0 without a header.

    A ROS 1 message starts with a counter and a time, both little endian. A ROS 2 message (CDR)
    starts with four bytes; the second byte gives the byte order. The time follows.
    """
    if len(raw) < 12:
        return 0.0
    order = "<" if not ros2 or raw[1] & 1 else ">"
    seconds, nano = struct.unpack_from(f"{order}Ii" if not ros2 else f"{order}iI", raw, 4)
    return seconds + nano / 1e9


def camera_matrix(message: Any) -> np.ndarray:
    """Return the flattened 3x3 camera matrix of a CameraInfo."""
    return np.asarray(_field(message, "k", "K")).reshape(-1)


def read_lens(kind: str, message: Any, path: Path) -> Lens:
    """Return the lens of a CameraInfo. Raise ValueError if it is invalid or a fisheye lens."""
    matrix = camera_matrix(message).astype(np.float64)
    if matrix.shape != (9,) or not (matrix[0] > 0 and matrix[4] > 0 and np.isfinite(matrix).all()):
        raise ValueError(
            f"{path}: focal lengths in CameraInfo must be above 0, got {matrix.tolist()[:9]}."
        )
    size = (int(message.width), int(message.height))
    if min(size) < 1:
        raise ValueError(
            f"{path}: the image size in CameraInfo must be at least (1, 1), got {size}."
        )
    model = str(_field(message, "distortion_model"))
    if model in FISHEYE:
        raise ValueError(
            f"{path}: the {kind} camera must be a pinhole camera, got a fisheye lens ({model}). "
            "Record rectified images and their CameraInfo."
        )
    fx, _, cx, _, fy, cy, *_ = map(float, matrix)
    return Lens(kind, focal=(fx, fy), centre=(cx, cy), size=size)


def read_image(message: Any, kind: str, path: Path, unit: float | None = None) -> np.ndarray:
    """Return the image of a message, which is an Image or a CompressedImage.

    RGB is uint8 [H, W, 3]. Depth is float32 [H, W] in metres, and missing depth is 0.

    Args:
        message: The message.
        kind: "rgb" or "depth".
        path: The bag, for error messages.
        unit: Metres per integer step of depth. If None, :func:`depth_unit` determines it.

    Raises:
        DamagedImage: If the image cannot be decoded.
        ValueError: If the encoding is unknown or wrong for this ``kind``.
    """
    if unit is None:
        unit = depth_unit(encoding_of(message))
    if _field(message, "format") is not None:
        return _read_compressed(message, kind, path, unit)
    height, width = int(message.height), int(message.width)
    encoding = str(message.encoding)
    table: Mapping[str, object] = _COLOURS if kind == RGB else _DEPTHS
    if encoding not in table:
        raise ValueError(
            f"{path}: the encoding of {kind} images must be one of {', '.join(table)}, got "
            f"{encoding!r}. Convert them, or choose another topic (topics.{kind}=)."
        )
    if not (0 < height <= MAX_SIDE and 0 < width <= MAX_SIDE):
        raise DamagedImage(
            f"{path}: images must have 1 to {MAX_SIDE} pixels per side, got {height} x {width}."
        )
    data = np.ascontiguousarray(message.data).view(np.uint8)
    channels, conversion = (1, None) if kind == DEPTH else _COLOURS[encoding]
    byte_order = "><"[not message.is_bigendian]
    dtype = np.dtype(byte_order + _DEPTHS[encoding]) if kind == DEPTH else np.dtype(np.uint8)
    row_bytes = width * channels * dtype.itemsize
    step = int(message.step) if height > 1 else row_bytes
    if step < row_bytes or len(data) < (height - 1) * step + row_bytes:
        raise DamagedImage(f"{path}: an image of {height} x {width} has only {len(data)} bytes.")
    padded = np.zeros(height * step, np.uint8)
    padded[: min(len(data), height * step)] = data[: height * step]
    rows = np.ascontiguousarray(padded.reshape(height, step)[:, :row_bytes])
    if kind == DEPTH:
        stored = rows.view(dtype)
        if dtype.kind == "u":
            stored = np.where(stored == NO_READING, 0, stored)
        return clean_depth(stored * unit)
    pixels = rows.reshape(height, width, channels)
    return pixels if conversion is None else cv2.cvtColor(pixels, conversion)


def _read_compressed(message: Any, kind: str, path: Path, unit: float) -> np.ndarray:
    """Decode a PNG or JPEG image."""
    data = np.ascontiguousarray(message.data).view(np.uint8)
    encoding = str(message.format)
    if "compressedDepth" in encoding:
        data = data[COMPRESSED_DEPTH_HEADER:]
    pixels = cv2.imdecode(data, cv2.IMREAD_UNCHANGED) if _is_image(data) else None
    if pixels is None:
        raise DamagedImage(f"{path}: an image in the format {encoding[:40]!r} cannot be decoded.")
    if kind == DEPTH:
        if pixels.dtype != np.uint16 or pixels.ndim != 2 or encoding.startswith("32FC1"):
            raise ValueError(
                f"{path}: compressed depth must be 16-bit PNG, got the format "
                f"{encoding[:40]!r}. Record the raw images."
            )
        return clean_depth(np.where(pixels == NO_READING, 0, pixels) * unit)
    if pixels.dtype != np.uint8:
        raise ValueError(f"{path}: compressed RGB images must be uint8, got {pixels.dtype}.")
    if pixels.ndim == 2:
        return cv2.cvtColor(pixels, cv2.COLOR_GRAY2RGB)
    return cv2.cvtColor(pixels[..., :3], cv2.COLOR_BGR2RGB)


def _is_image(data: np.ndarray) -> bool:
    """Return whether the bytes begin like a PNG or JPEG of an allowed size, without decoding."""
    try:
        with Image.open(io.BytesIO(data.tobytes()), formats=("PNG", "JPEG")) as opened:
            return max(opened.size) <= MAX_SIDE
    except Exception:  # Pillow raises many kinds of errors for damaged bytes
        return False
