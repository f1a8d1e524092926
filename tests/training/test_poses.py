"""Tests of views at random poses: their training targets, and the frames that corruptions
receive."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

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


def test_displaced_camera_has_the_targets_of_the_camera_in_its_place():
    schedule = Schedule("clean", 0.0)
    job = (3, 0, 1, 4, schedule.state_dict())
    world = partial(ApartmentsWorld, 32)
    rows = {
        share: poses.Poses(None, world, None, "rgb", schedule, 4, camera_share=share).work(job)
        for share in (0.0, 1.0)
    }
    for level, moved in zip(rows[0.0], rows[1.0], strict=True):
        assert np.array_equal(level[0], level[1]), "no camera is displaced with camera_share=0"
        assert np.array_equal(level[1], moved[1]), "the clean frames stay the same"
        assert not np.array_equal(moved[0], moved[1])


def test_camera_share_is_the_fraction_of_displaced_panoramas():
    schedule = Schedule("clean", 0.0)
    world = partial(ApartmentsWorld, 16)
    source = poses.Poses(None, world, None, "depth", schedule, 40, camera_share=0.3)
    rows = source.work((0, 0, 1, 40, schedule.state_dict()))
    displaced = sum(not np.array_equal(frames, clean) for frames, clean, _ in rows)
    assert 3 <= displaced <= 21  # the expected count is 12, and its standard deviation is 2.9


def test_camera_share_needs_a_world_that_renders_displaced_cameras():
    class Fixed(ApartmentsWorld):
        def put(self, xy, heading, *, views=None, rgb=True):
            return super().put(xy, heading, views=views, rgb=rgb)

    source = poses.Poses(
        None, lambda: Fixed(16), None, "rgb", Schedule("clean", 0.0), camera_share=0.5
    )
    with pytest.raises(ValueError, match="camera_share must be 0 in Fixed, got 0.5"):
        source.work((0, 0, 1, 1, source.schedule.state_dict()))
