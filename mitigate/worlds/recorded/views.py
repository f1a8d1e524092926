"""Crop and resize recorded images to square views of 90 degrees, which agents expect."""

from __future__ import annotations

import math
from collections.abc import Iterable

import cv2
import numpy as np

from mitigate.core.observation import DEPTH
from mitigate.worlds.recorded.source import MIN_HFOV, Lens

# enlargement factor of the canvas for a partially covered view, so that rounding moves the edges of
# the frame only by a fraction of a pixel
SUPERSAMPLING = 4


def covered_tangent(cameras: Iterable[tuple[Lens, tuple[int, int]]]) -> float:
    """Return the tangent of half of the largest square field of view that all cameras cover.

    The maximum is 1, which means 90 degrees. ``cameras`` holds the lens of each camera, and the
    height and width of its images.

    Raises:
        ValueError: If the field of view would be narrower than ``MIN_HFOV``.
    """
    tangent = 1.0
    for lens, (height, width) in cameras:
        fx, fy, cx, cy = lens.intrinsics(height, width)
        tangent = min(tangent, cx / fx, (width - cx) / fx, cy / fy, (height - cy) / fy)
    if tangent < math.tan(math.radians(MIN_HFOV / 2)):
        raise ValueError(
            "crop=true needs cameras that all cover a square of at least "
            f"{MIN_HFOV:g} x {MIN_HFOV:g} degrees around their principal point. Remove crop=true"
        )
    return tangent


def border_fraction(lens: Lens, height: int, width: int, tangent: float = 1.0) -> float:
    """Return the fraction of a square view's pixels that lie outside an image."""
    left, right, top, bottom = _edges(lens, height, width, tangent)
    covered_x = max(0.0, min(width, right) - max(0.0, left)) / (right - left)
    covered_y = max(0.0, min(height, bottom) - max(0.0, top)) / (bottom - top)
    return 1 - covered_x * covered_y


def _edges(
    lens: Lens, height: int, width: int, tangent: float
) -> tuple[float, float, float, float]:
    """Return the left, right, top and bottom edges of a square view in pixels of the image."""
    fx, fy, cx, cy = lens.intrinsics(height, width)
    return cx - fx * tangent, cx + fx * tangent, cy - fy * tangent, cy + fy * tangent


def square_view(frame: np.ndarray, lens: Lens, size: int, tangent: float = 1.0) -> np.ndarray:
    """Crop and resize a frame, uint8 [H, W, 3] or float32 [H, W], to a square view.

    ``lens`` is the lens of the camera that took the frame, and ``size`` is the height and width of
    the view in pixels. ``tangent`` is the tangent of half the angle that the view covers, which is
    1 for 90 degrees.

    Returns:
        The view, uint8 [size, size, 3] or float32 [size, size, 1]. If the frame already is such a
        view, it is returned unchanged.
    """
    is_depth = lens.kind == DEPTH
    frame = frame.reshape(*frame.shape[:2], -1)
    height, width = frame.shape[:2]
    edges = _edges(lens, height, width, tangent)
    if min(edges[0], edges[2], width - edges[1], height - edges[3]) < -0.5:
        return _partial_view(frame, edges, size, is_depth)
    left, right, top, bottom = (round(edge) for edge in edges)
    view = frame[max(0, top) : bottom, max(0, left) : right]
    if view.shape[:2] != (size, size):
        view = _resize(view, size, size, is_depth)
    return view.reshape(size, size, -1)


def _partial_view(
    frame: np.ndarray, edges: tuple[float, float, float, float], size: int, is_depth: bool
) -> np.ndarray:
    """Paste a frame that covers only a part of the view."""
    height, width = frame.shape[:2]
    left, right, top, bottom = edges
    large = SUPERSAMPLING * size
    scale_x = large / (right - left)
    scale_y = large / (bottom - top)
    x0, x1 = (round(min(large, max(0, (x - left) * scale_x))) for x in (0, width))
    y0, y1 = (round(min(large, max(0, (y - top) * scale_y))) for y in (0, height))
    canvas = np.zeros((large, large, frame.shape[2]), frame.dtype)
    if x1 > x0 and y1 > y0:
        crop = frame[max(0, round(top)) : round(bottom), max(0, round(left)) : round(right)]
        resized = _resize(crop, x1 - x0, y1 - y0, is_depth)
        canvas[y0:y1, x0:x1] = resized.reshape(y1 - y0, x1 - x0, -1)
    return _resize(canvas, size, size, is_depth).reshape(size, size, -1)


def _resize(frame: np.ndarray, width: int, height: int, is_depth: bool) -> np.ndarray:
    """Resize a frame. Depth uses nearest-neighbour resampling, so missing depth stays missing."""
    shrinks = width < frame.shape[1] or height < frame.shape[0]
    smooth = cv2.INTER_AREA if shrinks else cv2.INTER_LINEAR
    method = cv2.INTER_NEAREST_EXACT if is_depth else smooth
    return cv2.resize(frame, (width, height), interpolation=method)
