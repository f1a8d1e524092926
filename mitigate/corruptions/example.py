"""Provide two example frames for trying corruptions."""

from __future__ import annotations

from pathlib import Path

import numpy as np

_FOLDER = Path(__file__).parent / "examples"
_MILLIMETRES_PER_METRE = 1000.0


def example_rgb() -> np.ndarray:
    """Return a photograph of a coffee cup.

    The photographer, Rachel Michetti, released it under CC0. Source: scikit-image, ``data.coffee``.

    Returns:
        uint8 array of shape [400, 600, 3], RGB.
    """
    import cv2  # imported here, because agents must be loadable without OpenCV

    picture = cv2.imread(str(_FOLDER / "photograph.jpg"), cv2.IMREAD_COLOR)
    assert picture is not None
    return np.ascontiguousarray(picture[..., ::-1])


def example_depth() -> np.ndarray:
    """Return the depth image of a room, rendered by :mod:`mitigate.worlds.apartments`.

    Returns:
        float32 array of shape [360, 480, 1], metres.
    """
    import cv2

    millimetres = cv2.imread(str(_FOLDER / "depth.png"), cv2.IMREAD_UNCHANGED)
    assert millimetres is not None
    return (millimetres[..., None] / _MILLIMETRES_PER_METRE).astype(np.float32)
