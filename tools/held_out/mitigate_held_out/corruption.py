"""Convert the functions of the authors to records, and define what the authors have in common.

A function of an author has the arguments (views, severity, episode, frame). ``episode`` is a random
generator in the same state for all frames of an episode; ``frame`` is another generator for each
frame. The number of random values does not depend on the severity, so that a higher severity is a
stronger form of the same error. Depth is in metres, and 0 marks missing depth.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import cv2
import numpy as np

from mitigate.core.seeding import generator
from mitigate.corruptions import Record

Z_MIN = 0.1  # range in metres for which the authors wrote the depth functions
Z_MAX = 10.0


def corruption(author: str, modality: str, severity: str, **texts: str) -> Callable[..., Record]:
    """Return a decorator that converts a function to the record ``<author>_<name of function>``.

    Args:
        author: Letter of the author.
        modality: "rgb" or "depth".
        severity: What the severity controls.
        texts: The texts ``episode`` and ``frame`` of the record.
    """

    def record(function: Callable[..., np.ndarray]) -> Record:
        name = f"{author}_{function.__name__}"
        apply = partial(_apply_rgb if modality == "rgb" else _apply_depth, function, name)
        source = f"author {author.upper()}"
        return Record(name, modality, apply, severity, source=source, version="1", **texts)

    return record


def _generators(name, key):
    episode = generator(key.seed, name, key.episode)
    frame = generator(key.seed, f"{name}-frame", key.episode, key.frame)
    return episode, frame


def _apply_rgb(function, name, views, severity, key, heading=None):
    return np.ascontiguousarray(function(views, float(severity), *_generators(name, key)))


def _apply_depth(function, name, views, severity, key, sensor):
    clean = np.where(np.isfinite(views), views, 0).astype(np.float32)
    depth = function(clean, float(severity), *_generators(name, key))
    return np.where(
        depth <= 0, np.float32(sensor.missing), np.minimum(depth, np.float32(sensor.z_max))
    )


def to_uint8(values: np.ndarray) -> np.ndarray:
    """Round grey levels to uint8."""
    return np.clip(values + 0.5, 0, 255).astype(np.uint8)


def to_depth(depth: np.ndarray, missing: np.ndarray) -> np.ndarray:
    """Clip depth to the valid range, as float32, and set it to 0 in the mask ``missing``."""
    depth = np.clip(depth, Z_MIN, Z_MAX).astype(np.float32)
    depth[missing] = 0.0
    return depth


def enlarged_noise(rng: np.random.Generator, views: np.ndarray, cells: int) -> np.ndarray:
    """Return a smooth random field for each depth view, float32 [V, H, W].

    Each field is a grid of ``cells`` x ``cells`` standard normal numbers, enlarged by cubic
    interpolation.
    """
    count, height, width = views.shape
    grids = rng.standard_normal((count, cells, cells)).astype(np.float32)
    size = (width, height)
    return np.stack([cv2.resize(grid, size, interpolation=cv2.INTER_CUBIC) for grid in grids])
