"""Tests of views at random poses: the training targets, and the input of corruptions."""

from __future__ import annotations

from functools import partial

import numpy as np

from mitigate.corruptions import Schedule
from mitigate.training import poses
from mitigate.worlds.apartments.world import ApartmentsWorld


def test_corruption_gets_a_picture_in_every_view(monkeypatch):
    """A corruption that may return the image of a different view."""
    displayed = []

    def look(frames, *_):
        displayed.append(frames["rgb"])
        return frames

    monkeypatch.setattr(poses, "corrupt_observation", look)
    world, schedule = partial(ApartmentsWorld, 32), Schedule("per_frame", 0.6)
    source = poses.Poses(None, world, None, "rgb", schedule, panoramas=2)
    job = (3, 0, 1, 2, schedule.state_dict())
    half, whole = [], []
    for every, pieces in ((2, half), (1, whole)):
        source.every = every
        pieces += source.work(job)
    assert len(half) == len(whole) == 2 and len(displayed) == 4
    assert half[0][0].shape == (6, 32, 32, 3) and whole[0][0].shape == (12, 32, 32, 3)
    assert all(view.std() > 0 for frames in displayed for view in frames)
    learned, panorama = half[0][1], displayed[0]
    assert all(any(np.array_equal(view, seen) for seen in learned) for view in panorama)
