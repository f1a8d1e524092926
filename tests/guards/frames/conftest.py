"""Fixtures: a panorama of an apartment, and untrained restorers."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from mitigate.core.seeding import generator
from mitigate.guards.frames.restorer import Restorer
from mitigate.worlds.apartments.world import ApartmentsWorld


@pytest.fixture(scope="session")
def panorama() -> dict[str, np.ndarray]:
    """A clean observation from a val_seen apartment, with 12 views of 64 x 64 pixels."""
    world = ApartmentsWorld(64)
    world.enter("apartments/val_seen/100000")
    seen, _ = world.put(world.point(generator(0, "place")), 0.3, views=None, rgb=True)
    return {name: np.copy(value) for name, value in seen.items()}


@pytest.fixture
def untrained() -> Restorer:
    """A small restorer whose gate classifies every frame as corrupted."""
    torch.manual_seed(0)
    return opened(Restorer(width=8, depth_width=8).eval())


def opened(restorer: Restorer, threshold: float = -1e9) -> Restorer:
    """Set all thresholds of ``restorer`` to this value, and return it."""
    for net in restorer.parts().values():
        net.threshold.fill_(threshold)
    return restorer
