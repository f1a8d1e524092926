"""Fixtures with a panorama in the format of the suite and in the format of Habitat."""

import numpy as np
import pytest


@pytest.fixture(scope="module")
def panorama():
    """Return RGB, uint8 [12, 32, 32, 3], and depth, which has a different size, values in [0, 1]
    and holes."""
    rng = np.random.default_rng(0)
    depth = rng.uniform(0.06, 0.4, (12, 40, 48, 1)).astype(np.float32)
    depth[:, :3, :5] = 0.0
    return rng.integers(20, 230, (12, 32, 32, 3), dtype=np.uint8), depth


@pytest.fixture
def obs(panorama):
    """Return an observation as ETPNav receives it.

    The entry rgb_A faces A degrees to the left. It has the index ``12 - A / 30`` in the panorama.
    """
    rgb, depth = panorama
    entries = {"instruction": "go", "rgb": rgb[0], "depth": depth[0]}
    for step in range(1, 12):
        entries[f"rgb_{30 * step}"] = rgb[-step]
        entries[f"depth_{30 * step}"] = depth[-step]
    return entries | {"rgb_features": np.ones(3), "depth_scale": 2}
