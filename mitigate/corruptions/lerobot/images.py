"""Decode the images in the rows of a LeRobot dataset: RGB is PNG or JPEG, depth is TIFF
or 16-bit PNG.
"""

from __future__ import annotations

import io
import math

import numpy as np
from PIL import Image

from mitigate.core.observation import RGB
from mitigate.corruptions.frame_files import MAX_PIXELS, counts
from mitigate.corruptions.lerobot.metadata import Camera

FORMATS = {"rgb": ("PNG", "JPEG"), "depth": ("PNG", "TIFF")}
# Pillow modes of lerobot's depth images: I;16 is uint16, F is float32
MODES = {"rgb": ("RGB",), "depth": ("I;16", "F")}
MILLIMETRE = 0.001


def decode(data: object, camera: Camera) -> tuple[np.ndarray, str]:
    """Decode an image.

    Args:
        data: The bytes of the file.
        camera: The camera of the image, which determines its type and size.

    Returns:
        The image (uint8 [H, W, 3], uint16 [H, W] or float32 [H, W]) and the format of the file.

    Raises:
        ValueError: If the image is damaged, or has a wrong format, type or size. The message begins
            with a verb, because the caller puts the name of the image before it.
    """
    if not isinstance(data, bytes):
        raise ValueError(
            "must contain the bytes of an image; images in separate files are not supported"
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
        raise ValueError(
            f"cannot be decoded as {formats}: {' '.join(str(error).split())[:200]}"
        ) from error
    modes = " or ".join(MODES[camera.kind])
    raise ValueError(
        f"must have {camera.width} x {camera.height} pixels of type {modes}, got {size[0]} x "
        f"{size[1]} of type {mode}"
    )


def metres(stored: np.ndarray, camera: Camera) -> np.ndarray:
    """Convert a depth image to float32 metres; 0 means no reading."""
    depth = stored.astype(np.float32) * np.float32(_unit(stored, camera))
    return np.where(np.isfinite(depth) & (depth > 0), depth, 0)


def store_depth(depth: np.ndarray, stored: np.ndarray, camera: Camera) -> np.ndarray:
    """Convert corrupted depth from metres to the type and unit of ``stored``.

    Pixels that the corruption did not change keep their stored values.
    """
    unit = _unit(stored, camera)
    new = counts(depth, unit) if stored.dtype == np.uint16 else depth / np.float32(unit)
    return np.where(depth == metres(stored, camera), stored, new).astype(stored.dtype)


def _unit(stored: np.ndarray, camera: Camera) -> float:
    if camera.unit is not None:
        return camera.unit
    return MILLIMETRE if stored.dtype == np.uint16 else 1.0


def as_frame(stored: np.ndarray, camera: Camera) -> np.ndarray:
    """Convert a stored image to a frame: uint8 [H, W, 3], or float32 metres [H, W]."""
    return stored if camera.kind == RGB else metres(stored, camera)
