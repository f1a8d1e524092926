"""Tests of a world with one forward camera, which shows the panorama's first view."""

from __future__ import annotations

import numpy as np
import pytest

from mitigate.core.observation import DEPTH, RGB, RIGHT
from mitigate.corruptions import Corruption
from mitigate.worlds.apartments.labels import COLUMNS, CONCEPTS
from mitigate.worlds.apartments.tasks import load_episodes
from mitigate.worlds.apartments.world import ApartmentsWorld
from mitigate.worlds.world import Corrupted

EPISODE = load_episodes("val_seen")[0]


def test_camera_equals_the_front_view():
    one, all_round = ApartmentsWorld(views=1), ApartmentsWorld()
    for world in (one, all_round):
        world.reset(EPISODE)
    ahead, panorama = one.step(RIGHT), all_round.step(RIGHT)
    assert ahead[RGB].shape == one.sensors[RGB].shape == (64, 64, 3)
    assert np.array_equal(ahead[RGB], panorama[RGB][0])
    assert np.array_equal(ahead[DEPTH], panorama[DEPTH][0])
    assert one.sensors[RGB].yaws == (0.0,)


def test_camera_labels_describe_columns_and_directions():
    world = ApartmentsWorld(views=1)
    world.reset(EPISODE)
    truth = world.truth()
    assert truth["concepts"].shape == (COLUMNS, len(CONCEPTS))
    assert truth["goal"].shape == (COLUMNS,) and truth["free"].shape == (30, 12)
    wide = ApartmentsWorld()
    wide.reset(EPISODE)
    around = wide.truth()["free"]
    left, right = around[110], around[19]  # the directions 45 degrees to each side
    assert np.array_equal(truth["free"][0], left) and np.array_equal(truth["free"][-1], right)


def test_furniture_on_the_left_is_in_left_columns():
    """When the agent turns right, furniture moves to columns farther left."""
    world = ApartmentsWorld(views=1)
    world.enter("apartments/train/000003")
    rng = np.random.default_rng(0)
    middles = {before: [] for before in (True, False)}
    for _ in range(40):
        xy, heading = world.point(rng), float(rng.uniform(-3, 3))
        displayed = [
            world.put(xy, h)[1]["concepts"][:, :20] for h in (heading, heading - np.radians(22.5))
        ]
        both = np.flatnonzero(displayed[0].any(0) & displayed[1].any(0))
        for before, columns in zip((True, False), displayed, strict=True):
            middles[before] += [np.flatnonzero(columns[:, i]).mean() for i in both]
    moved = np.subtract(middles[True], middles[False])
    assert len(moved) > 20 and moved.mean() > 0.5 and (moved < -0.5).mean() < 0.1


def test_corrupted_world_changes_the_single_frame():
    world = Corrupted(ApartmentsWorld(views=1), Corruption("defocus", 0.6), 0)
    seen = world.reset(EPISODE)
    assert seen[RGB].shape == (64, 64, 3) and not np.array_equal(seen[RGB], seen.clean[RGB])


def test_world_rejects_other_numbers_of_views():
    with pytest.raises(ValueError, match="views must be 12 .*got 3"):
        ApartmentsWorld(views=3)
