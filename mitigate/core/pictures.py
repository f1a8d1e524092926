"""Plot observations and paths for logs and reports."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import cv2
import numpy as np

from mitigate.core.observation import DEPTH, RGB, VIEWS, Z_MAX

AHEAD_IN_THE_MIDDLE = (6, 7, 8, 9, 10, 11, 0, 1, 2, 3, 4, 5)
NO_READING = (255, 255, 255)  # colour of invalid depth


def side_by_side(views: np.ndarray) -> np.ndarray:
    """Join views side by side.

    Args:
        views: uint8 [V, H, W, 3], or depth in metres [V, H, W, 1], which is shown in grey.

    Returns:
        uint8 [H, V * W, 3].
    """
    if views.shape[-1] == 1:
        grey = np.nan_to_num(views, posinf=0.0) / max(1e-6, float(np.nanmax(views)))
        views = np.repeat((255 * grey.clip(0, 1)).astype(np.uint8), 3, axis=-1)
    return np.concatenate(list(views), axis=1)


def strip(views: np.ndarray) -> np.ndarray:
    """Join the 12 views of a panorama, each cropped to 30 degrees, with the front view centred."""
    size = views.shape[2]
    half = int(round(np.tan(np.radians(15)) * size / 2))
    low, high = size // 2 - half, size // 2 + half
    return np.concatenate([views[k, :, low:high] for k in AHEAD_IN_THE_MIDDLE], axis=1)


def picture(observation: Mapping[str, Any] | None) -> np.ndarray | None:
    """Return a picture of an observation, uint8 [H, W, 3], or None if it has no frames.

    The picture shows the RGB frame, or the depth frame if there is no RGB frame.
    """
    entries = observation or {}
    frame = next((np.asarray(entries[name]) for name in (RGB, DEPTH) if name in entries), None)
    if frame is None:
        return None
    views = frame if frame.ndim == 4 else frame[None]
    return strip(views) if len(views) == VIEWS and views.shape[-1] == 3 else side_by_side(views)


def draw_path(
    axes: Any,
    path: Sequence[np.ndarray] | np.ndarray,
    colour: str,
    label: str | None = None,
    style: str = "-",
) -> None:
    """Plot a path [n, 2], in metres on the floor plan, on matplotlib axes."""
    points = np.asarray(path)
    axes.plot(points[:, 0], points[:, 1], style, color=colour, lw=2, label=label, zorder=6)
    axes.plot(*points[0], "o", color=colour, ms=6, zorder=7)
    axes.plot(*points[-1], "X", color=colour, ms=8, zorder=7)


def depth_picture(depth: np.ndarray, far: float = Z_MAX) -> np.ndarray:
    """Convert depth [H, W] in metres to a picture, uint8 RGB [H, W, 3].

    Near points are bright, points at ``far`` metres are dark, and missing values are white.
    """
    valid = np.isfinite(depth) & (depth > 0)
    near = 1.0 - np.where(valid, np.clip(depth / far, 0.0, 1.0), 0.0)
    picture = cv2.applyColorMap(np.rint(255.0 * near).astype(np.uint8), cv2.COLORMAP_VIRIDIS)
    picture = np.ascontiguousarray(picture[..., ::-1])
    picture[~valid] = NO_READING
    return picture
