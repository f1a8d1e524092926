"""A frame of one instant as its views, checked: what every corruption gets."""

from __future__ import annotations

import numpy as np

from mitigate.corruptions import registry
from mitigate.corruptions.depth_sensor import DepthSensor, check_unit

MOST_VIEWS = 36  # of one instant: R2R's discrete panoramas (3 elevations of 12); VLN-CE has 12


def rgb_views(frame: np.ndarray) -> np.ndarray:
    """The frame as contiguous uint8 [V, H, W, 3]; ValueError for anything else."""
    if frame.dtype != np.uint8:
        raise ValueError(
            f"RGB frames must be uint8 in 0-255, but this one is {frame.dtype}. Convert it first: "
            "np.rint(frame * 255).astype(np.uint8) if it is in 0-1, np.rint(frame).astype(np.uint8)"
            " if it is in 0-255. Float frames are refused because pipelines such as CLIP's divide "
            "by 255 only for uint8, so a float frame in 0-255 silently breaks them."
        )
    if frame.ndim not in (3, 4) or frame.shape[-1] != 3 or 0 in frame.shape:
        raise ValueError(
            f"RGB frames must be [H, W, 3] or [views, H, W, 3], but the shape is {frame.shape}. "
            "Move the channels last, drop an alpha channel, and corrupt a batch one instant at a "
            "time: every instant has its own key."
        )
    return _one_instant(np.ascontiguousarray(frame if frame.ndim == 4 else frame[None]))


def depth_views(frame: np.ndarray, sensor: DepthSensor, name: str) -> np.ndarray:
    """The frame as contiguous float32 [V, H, W]; ValueError for anything else, millimetres and RGB
    too."""
    if frame.ndim > 2 and frame.shape[-1] == 3:
        raise ValueError(
            f"{name} corrupts depth, and this looks like an RGB frame (the last axis of "
            f"{frame.shape} is 3). On RGB: {', '.join(registry.known('rgb'))}. If it is depth of 3 "
            "columns, give it a last axis of 1: frame[..., None]."
        )
    if frame.dtype != np.float32:
        raise ValueError(
            f"Depth must be float32 in metres, but this frame is {frame.dtype}. Convert it first: "
            "depth.astype(np.float32), divided by 1000 if it holds millimetres (uint16); a sensor "
            "that normalises to 0-1 goes through DepthSensor(z_min, z_max).to_metres."
        )
    shape = frame.shape[:-1] if frame.ndim > 2 and frame.shape[-1] == 1 else frame.shape
    if len(shape) not in (2, 3) or 0 in shape:
        raise ValueError(
            f"Depth must be [H, W], [H, W, 1], [views, H, W] or [views, H, W, 1], but the shape is "
            f"{frame.shape}. Corrupt a batch one instant at a time: every instant has its own key."
        )
    views = frame.reshape((1, *shape) if len(shape) == 2 else shape)
    views = _one_instant(np.ascontiguousarray(views))
    check_unit(views, sensor)
    return views


def _one_instant(views: np.ndarray) -> np.ndarray:
    """``views`` [V, ...] as they are; ValueError for more of them than a panorama has."""
    if len(views) > MOST_VIEWS:
        raise ValueError(
            f"There are {len(views)} views, but an instant has {MOST_VIEWS} at most. The leading "
            "axis is the views of one panorama, which share one mask. Is it a batch? Corrupt it "
            "one instant at a time: every instant has its own key."
        )
    return views
