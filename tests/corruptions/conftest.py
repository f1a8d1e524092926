"""A small analytic RGB-D scene that can be rendered at any size."""

import numpy as np
import pytest

from tools.pages.curves import psnr, ssim


def draw(height: int, width: int, view: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Return a chequered scene of two boxes in front of a sloping wall.

    The result is RGB, uint8 [H, W, 3], and depth, metres [H, W].
    """
    v = ((np.arange(height) + 0.5) / height)[:, None]
    u = ((np.arange(width) + 0.5) / width)[None, :]
    shift = 0.7 * view
    bands = np.sin(23 * u + 5 * v + shift) + np.sin(31 * v - 9 * u + 2 * shift)
    rgb = np.stack([128 + (40 - 6 * c) * bands + 12 * np.sin(60 * u * v + c) for c in range(3)], -1)
    rgb += 30.0 * ((np.floor(40 * u) + np.floor(30 * v)) % 2)[..., None] - 15.0
    depth = 2.5 + 4.0 * u + 1.2 * v + 0.2 * bands
    for left, top, size, grey, near in ((0.15, 0.3, 0.25, 210, 1.3), (0.55, 0.5, 0.35, 40, 2.1)):
        left = (left + 0.05 * view) % 0.6
        box = (u > left) & (u < left + size) & (v > top) & (v < top + size)
        rgb[box] = grey + 0.4 * (rgb[box] - 128)
        depth[box] = near + 0.05 * bands[box]
    return np.rint(np.clip(rgb, 0, 255)).astype(np.uint8), depth.astype(np.float32)


def panorama_of(views: int, height: int, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Return RGB [V, H, W, 3] and depth [V, H, W, 1] with a few invalid pixels."""
    drawn = [draw(height, width, view) for view in range(views)]
    rgb, depth = np.stack([d[0] for d in drawn]), np.stack([d[1] for d in drawn])[..., None]
    depth[:, :3, :5] = 0.0
    depth[0, 10, 10:14, 0] = np.nan, np.inf, -np.inf, -1.0
    return rgb, depth


@pytest.fixture(scope="session")
def panorama():
    """A read-only panorama of 12 views, 48 x 64."""
    rgb, depth = panorama_of(12, 48, 64)
    rgb.flags.writeable = depth.flags.writeable = False
    return rgb, depth


@pytest.fixture(scope="session")
def scene():
    """The functions above as attributes, for tests that need other sizes."""

    class Scene:
        pass

    Scene.draw, Scene.ssim, Scene.psnr, Scene.panorama_of = map(
        staticmethod, (draw, ssim, psnr, panorama_of)
    )
    return Scene
