"""What ROS messages hold: places, lenses and pictures. They come from outside and are checked."""

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
from mitigate.worlds.recorded.source import Lens, plan_pose, rotated

FISHEYE = ("equidistant", "fisheye")  # distortion models of ROS
LARGEST_SIDE = 1 << 13  # pixels of an image (ours)
_COLOURS = {  # encoding: channels, and what makes RGB of them
    "rgb8": (3, None),
    "bgr8": (3, cv2.COLOR_BGR2RGB),
    "rgba8": (4, cv2.COLOR_RGBA2RGB),
    "bgra8": (4, cv2.COLOR_BGRA2RGB),
    "mono8": (1, cv2.COLOR_GRAY2RGB),
    "8UC3": (3, cv2.COLOR_BGR2RGB),
}
_DEPTHS = {"16UC1": ("u2", 0.001), "mono16": ("u2", 0.001), "32FC1": ("f4", 1.0)}  # REP 118


def place(message: Any) -> tuple[float, float, float]:
    """The plan pose in a message that holds one; NaN for a rotation that is none."""
    while (inner := _field(message, "pose")) is not None:
        message = inner
    turned = message.orientation
    ahead = rotated((turned.x, turned.y, turned.z, turned.w), (1.0, 0.0, 0.0))
    return plan_pose(float(message.position.x), float(message.position.y), ahead)


def _field(message: Any, *names: str) -> Any:
    """Return the first of these fields that a message has, or None: ROS 1 and 2 name some
    differently, and classes of messages are made from the bag."""
    return next((getattr(message, name) for name in names if hasattr(message, name)), None)


def stamp(raw: bytes, ros2: bool) -> float:
    """Seconds in the header that a serialised message begins with; 0 if it has none.

    A ROS 1 header is a counter and a time, little endian; CDR's has four bytes in front, the second
    of which says the order of bytes.
    """
    if len(raw) < 12:
        return 0.0
    order = "<" if not ros2 or raw[1] & 1 else ">"
    seconds, nano = struct.unpack_from(f"{order}Ii" if not ros2 else f"{order}iI", raw, 4)
    return seconds + nano / 1e9


def camera_matrix(message: Any) -> np.ndarray:
    """The 3x3 matrix of a CameraInfo, flat: ``K`` in ROS 1, ``k`` in ROS 2."""
    return np.asarray(_field(message, "k", "K")).reshape(-1)


def lens(kind: str, message: Any, path: Path) -> Lens:
    """The lens that a CameraInfo states. Raises ValueError if it
    has none."""
    matrix = camera_matrix(message).astype(np.float64)
    if matrix.shape != (9,) or not (matrix[0] > 0 and matrix[4] > 0 and np.isfinite(matrix).all()):
        raise ValueError(f"{path}: its CameraInfo has no focal lengths ({matrix.tolist()[:9]}).")
    size = (int(message.width), int(message.height))
    if min(size) < 1:
        raise ValueError(f"{path}: its CameraInfo says pictures of {size[0]} x {size[1]}.")
    model = str(_field(message, "distortion_model"))
    if model in FISHEYE:
        raise ValueError(
            f"{path}: the {kind} camera has a fisheye lens ({model}), which is read as a pinhole: "
            "record rectified images, and their CameraInfo."
        )
    focal, centre = (float(matrix[0]), float(matrix[4])), (float(matrix[2]), float(matrix[5]))
    return Lens(kind, focal=focal, centre=centre, size=size)


def image(message: Any, kind: str, path: Path) -> np.ndarray:
    """The picture in a message: uint8 [H, W, 3], or float32 metres [H, W], 0 for no reading.

    Raises ValueError for an encoding that is not known, and for one that does not fit ``kind``.
    """
    if _field(message, "format") is not None:
        return _compressed(message, kind, path)
    height, width, encoding = int(message.height), int(message.width), str(message.encoding)
    table: Mapping[str, tuple] = _COLOURS if kind == RGB else _DEPTHS
    if encoding not in table:
        raise ValueError(
            f"{path}: {kind} images are of the encoding {encoding!r}, which is not one of "
            f"{', '.join(table)}. Convert them, or choose another topic (topics.{kind}=)."
        )
    if not (0 < height <= LARGEST_SIDE and 0 < width <= LARGEST_SIDE):
        raise ValueError(f"{path}: an image has {height} x {width} pixels.")
    data, order = np.ascontiguousarray(message.data).view(np.uint8), "><"[not message.is_bigendian]
    item = np.dtype(order + _DEPTHS[encoding][0]) if kind == DEPTH else np.dtype(np.uint8)
    channels = 1 if kind == DEPTH else _COLOURS[encoding][0]
    used = width * channels * item.itemsize
    step = int(message.step) if height > 1 else used
    if step < used or len(data) < (height - 1) * step + used:
        raise ValueError(f"{path}: an image of {height} x {width} has {len(data)} bytes only.")
    padded = np.zeros(height * step, np.uint8)
    padded[: min(len(data), height * step)] = data[: height * step]
    rows = np.ascontiguousarray(padded.reshape(height, step)[:, :used])
    if kind == DEPTH:
        return _metres(rows.view(item) * _DEPTHS[encoding][1])
    pixels, change = rows.reshape(height, width, channels), _COLOURS[encoding][1]
    return pixels if change is None else cv2.cvtColor(pixels, change)


def _compressed(message: Any, kind: str, path: Path) -> np.ndarray:
    """A picture in PNG or JPEG; ``compressedDepth`` has 12 bytes in front."""
    data, form = np.ascontiguousarray(message.data).view(np.uint8), str(message.format)
    deep = "compressedDepth" in form
    data = data[12:] if deep else data
    found = cv2.imdecode(data, cv2.IMREAD_UNCHANGED) if _is_picture(data) else None
    if found is None:
        raise ValueError(f"{path}: an image in the format {form[:40]!r} cannot be decoded.")
    if kind == DEPTH:
        if found.dtype != np.uint16 or found.ndim != 2 or form.startswith("32FC1"):
            raise ValueError(
                f"{path}: compressed depth in the format {form[:40]!r} is not read, only 16-bit "
                "PNG in millimetres. Record the raw images."
            )
        return _metres(found * 0.001)
    if found.dtype != np.uint8:
        raise ValueError(f"{path}: a compressed RGB image has {found.dtype} pixels.")
    if found.ndim == 2:
        return cv2.cvtColor(found, cv2.COLOR_GRAY2RGB)
    return cv2.cvtColor(found[..., :3], cv2.COLOR_BGR2RGB)


def _is_picture(data: np.ndarray) -> bool:
    """Whether the bytes begin as a PNG or JPEG of sides that are read; nothing is decoded."""
    try:
        with Image.open(io.BytesIO(data.tobytes()), formats=("PNG", "JPEG")) as picture:
            return max(picture.size) <= LARGEST_SIDE
    except Exception:  # whatever is said of bytes from outside
        return False


def _metres(depth: np.ndarray) -> np.ndarray:
    """Depth with 0 for what is not finite or negative."""
    return np.where(np.isfinite(depth) & (depth > 0), depth, 0).astype(np.float32)
